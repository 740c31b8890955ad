"""How the command line tells the way in which a scenario file is written."""

import pytest

from tests.flows.test_cli import sgcad


@pytest.mark.parametrize("command", ["run", "evaluate"])
def test_an_unknown_encoding_is_refused(here, reports, tmp_path, command):
    place = reports(a="") if command == "evaluate" else reports(a="") / "a"
    ended = here(command, place, "--config", "template.yaml", "--encoding", "evnts", "--out", tmp_path / "out")
    assert ended.returncode == 2
    assert "encoding" in ended.stderr
    assert "'timed' or 'events'" in ended.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_plan_can_be_written_as_events(reports, tmp_path):
    words = ["--config", "template.yaml", "--set", "tracker=none", "--encoding", "events", "--out", tmp_path / "out"]
    ended = sgcad("run", reports(a="") / "a", *words)
    assert ended.returncode == 0
    text = (tmp_path / "out" / "template-events" / "a" / "scenario.xosc").read_text()
    assert "<SpeedAction>" in text
    assert "<Timing" not in text
