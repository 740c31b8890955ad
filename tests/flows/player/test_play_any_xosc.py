"""`sgcad play` leaves a table of motion, a page, contacts, metrics and what was noted."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from flows.player import play_any_xosc
from sgcad_core.errors import ConfigError, Unsupported
from tests.sgcad_core.formats.xosc_samples import at, scenario, world

DECLARED = '<ParameterDeclaration name="v" parameterType="double" value="5"/>'
HIT = scenario({"VRU": world(0, 0), "Ego": world(20, 0)}, speeds={"VRU": "$v"}, parameters=DECLARED)


@pytest.fixture
def file(tmp_path):
    made = tmp_path / "hit.xosc"
    made.write_text(HIT, encoding="utf-8")
    return made


def test_a_played_file_leaves_everything_there_is_to_see(file, tmp_path):
    (folder,) = play_any_xosc.play(file, tmp_path / "out", ["v=10"], [], 5, 300.0)
    lines = (folder / "trajectories.csv").read_text().splitlines()
    assert lines[0] == "t_s,actor,x_m,y_m,heading_rad,speed_mps"
    assert len(lines) == 1 + 2 * 81
    (contact,) = json.loads((folder / "contacts.json").read_text())
    assert (contact["actor"], contact["other"], contact["t_s"]) == ("Ego", "VRU", 1.55)
    assert json.loads((folder / "metrics.json").read_text())["exact"]
    told = json.loads((folder / "played.json").read_text())
    assert told["parameters"] == {"v": "10"}
    assert "the map 'road.xodr' is not there" in told["notes"][0]["what"]
    assert "the map 'road.xodr' is not there" in (folder / "player.html").read_text()


def test_without_speed_nothing_touches(file, tmp_path):
    (folder,) = play_any_xosc.play(file, tmp_path / "out", ["v=0"], [], 5, 300.0)
    assert json.loads((folder / "contacts.json").read_text()) == []


def test_what_is_not_played_leaves_nothing(file, tmp_path):
    file.write_text(HIT.replace("SimulationTimeCondition", "UserDefinedValueCondition"))
    with pytest.raises(Unsupported, match=r"<UserDefinedValueCondition> in line 2 of hit.xosc"):
        play_any_xosc.play(file, tmp_path / "out", [], [], 5, 300.0)
    assert not (tmp_path / "out").exists()


def test_a_parameter_needs_a_value(file, tmp_path):
    with pytest.raises(ConfigError, match=r"--set v: write NAME=VALUE"):
        play_any_xosc.play(file, tmp_path / "out", ["v"], [], 5, 300.0)


def test_the_command_prints_the_page_and_ends_with_2_on_a_bad_file(file, tmp_path):
    command = [sys.executable, "-c", "from flows.cli import main; main()", "play"]
    done = subprocess.run([*command, str(file), "--out", str(tmp_path / "o")], capture_output=True, text=True)
    assert done.stdout.strip().endswith("player.html")
    bad = subprocess.run([*command, str(tmp_path / "gone.xosc")], capture_output=True, text=True)
    assert bad.returncode == 2
    assert "no such file" in bad.stderr


@pytest.mark.parametrize("name", ["...xosc", "..xosc", ".. .xosc", "a\nb.xosc"])
def test_whatever_the_file_is_called_its_folder_lies_in_out(file, tmp_path, name):
    odd = file.rename(tmp_path / name)
    (folder,) = play_any_xosc.play(odd, tmp_path / "deep" / "out", [], [], 5, 300.0)
    assert folder.resolve().parent == (tmp_path / "deep" / "out").resolve()
    assert {path.name for path in tmp_path.iterdir()} == {name, "deep"}
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["out"]


def test_of_very_many_entities_the_nearest_are_measured(file, tmp_path, monkeypatch):
    places = {f"V{k}": world(10 * k, 0) for k in range(1, 7)}
    file.write_text(scenario(places, speeds={"V1": 5}))
    monkeypatch.setattr(play_any_xosc, "MAX_PAIR_INSTANTS", 3 * 81)
    (folder,) = play_any_xosc.play(file, tmp_path / "out", [], [], 5, 300.0)
    notes = [note["what"] for note in json.loads((folder / "played.json").read_text())["notes"]]
    assert "the metrics are those of the 3 of 6 entities that come nearest to V1" in notes
    assert json.loads((folder / "metrics.json").read_text())["exact"]["collision"]
    assert len(json.loads((folder / "played.json").read_text())["entities"]) == 6


def test_the_sample_ends_by_itself():
    assert at(4) in HIT
