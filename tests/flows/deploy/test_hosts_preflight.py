"""What is asked for before a study goes to other hosts."""

import pytest

from flows.deploy import hosts_preflight
from flows.study.plan import plan
from flows.study_file.spec import load_study
from sgcad_core.errors import ConfigError, MissingTool


@pytest.fixture
def made(tmp_path, config_file, reports):
    """Lays a study of one arm out."""

    def lay_out(**options):
        file = tmp_path / "two.yaml"
        file.write_text(f"title: t\narms: [{{name: a, config: {config_file()}}}]\n")
        return plan(load_study(file), tmp_path / "out", cases=[reports(c1="")], **options)

    return lay_out


@pytest.mark.parametrize("url", ["", "http://127.0.0.1:9/api"])
def test_hosts_need_a_server_that_answers(made, monkeypatch, url, tmp_path):
    monkeypatch.setenv("PREFECT_API_URL", url)
    monkeypatch.setenv("PREFECT_HOME", str(tmp_path))
    with pytest.raises(MissingTool, match="a Prefect server that every host reaches"):
        hosts_preflight.run(made(), hosts_preflight.Hosts("memory://x"), lambda *_: None)


def test_a_fresh_study_wants_a_fresh_address(made):
    with pytest.raises(ConfigError, match="give --hosts another address"):
        hosts_preflight.run(made(fresh=True), hosts_preflight.Hosts("memory://x"), lambda *_: None)


def test_shards_that_were_submitted_again_are_told():
    lines = hosts_preflight.resubmitted_lines(["shard 0: no sign of life for 60 s"])
    assert lines == "submitted again: shard 0: no sign of life for 60 s"
