"""A study of drivers in a real MLflow database: its arms bear the same names, so that they compare as they stand."""

import subprocess
import sys
from pathlib import Path

import pytest
import yaml

DEMO = Path(__file__).resolve().parents[3] / "docs" / "demo"
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def parents(tmp_path_factory):
    """The arms' runs, by name, of a study of two drivers over the demo reports."""
    from mlflow import MlflowClient

    place = tmp_path_factory.mktemp("study")
    arms = [{"name": d, "config": "template.yaml", "set": [f"drive.drivers={d}"]} for d in ("script", "aeb")]
    file = place / "two.yaml"
    file.write_text(yaml.safe_dump({"title": "Two", "reference": "script", "arms": arms, "cases": [str(DEMO)]}))
    code = "from flows.cli import main; main()"
    ended = subprocess.run(
        [sys.executable, "-c", code, "study", str(file), "--out", str(place / "runs"), "--jobs", "1"],
        capture_output=True, text=True, timeout=560,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stdout + ended.stderr
    client = MlflowClient(f"sqlite:///{place / 'runs' / 'mlflow.db'}")
    experiment = client.get_experiment_by_name("study/two")
    words = "tags.`sgcad.level` = 'config' and metrics.`driven/responder_avoided` >= 0"
    return {r.info.run_name.split("/")[-1]: r for r in client.search_runs([experiment.experiment_id], words)}


def test_one_search_finds_every_arm_by_the_same_name(parents):
    assert set(parents) == {"script", "aeb"}


def test_arms_have_the_same_figures_of_drives(parents):
    names = {arm: {m for m in run.data.metrics if m.startswith("driven/")} for arm, run in parents.items()}
    told = {f"driven/{role}_{o}" for role in ("initiator", "responder")
            for o in ("avoided", "mitigated", "unchanged", "worse", "lost", "failed")}  # fmt: skip
    assert told <= names["script"] & names["aeb"]


def test_figures_are_shares_over_the_cases_and_the_drivers_differ(parents):
    script, aeb = parents["script"].data, parents["aeb"].data
    assert script.metrics["driven/responder_unchanged"] == 1.0
    assert aeb.metrics["driven/responder_unchanged"] < 1.0
    assert script.metrics["driven/responder_delta_v_mps"] > aeb.metrics["driven/responder_delta_v_mps"]
    assert (script.params["drive.drivers"], aeb.params["drive.drivers"]) == ("script", "aeb")
