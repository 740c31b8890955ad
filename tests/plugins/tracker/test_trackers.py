"""Trackers log what lies in a case's folder, each case once, from several processes at a time."""

import json
import math
import subprocess
import sys

import pytest

from plugins.tracker.figures import attempt_figures, case_figures, flat, numbers
from plugins.tracker.jsonl import Jsonl
from plugins.tracker.mlflow import MlflowTracker
from plugins.tracker.none import NoTracker
from sgcad_core.errors import ConfigError
from sgcad_core.records import Generation, Query
from sgcad_core.settings import ROOT

RESULT = {
    "case": "c1",
    "config": "kit",
    "status": "generated",
    "attempts": {"road": 2, "scenario": 1},
    "network": {"intersections": 1, "components": 1, "mean_lanes": 1.5, "segments": [{"id": "a", "lanes_forward": 1}]},
    "actors": [{"id": "V1"}],
    "collision": {"declared": {"striker": "V1"}, "observed": {"t_s": 4.2}, "realised": True},
    "grounding": {"road.$.legs": 0.75},
    "seconds": {"read": 0.1, "road": 1.4},
}
METRICS = {"thresholds": {"theta": 1.0}, "paper": {"ice": 0.0, "level": "high"}, "exact": {"time_to_collision_s": None}}
PARAMS = {"seed": 42, "road_writer": {"name": "template"}, "validators": [{"name": "topology"}]}
GENERATION = Generation(text="{}", seconds=1.5, prompt_tokens=11, model_calls=2, grounding={"$.legs": 0.75})


@pytest.fixture
def case_dir(tmp_path):
    folder = tmp_path / "out" / "kit" / "c1"
    for number, count in ((1, 2), (2, 0)):
        place = folder / "attempts" / f"road-{number:02d}"
        place.mkdir(parents=True)
        (place / "findings.json").write_text(json.dumps([{"severity": "repair"}] * count + [{"severity": "note"}]))
        (place / "attempt.json").write_text(json.dumps({"stage": "road", "number": number, "seconds": 0.5 * number}))
    (folder / "metrics.json").write_text(json.dumps(METRICS))
    (folder / "player.html").write_text("<html>")
    return folder


def test_leaves_are_named_by_their_path():
    assert dict(flat({"a": {"b": 1}, "c": [2, {"d": 3}]})) == {"a_b": 1, "c_0": 2, "c_1_d": 3}


def test_only_finite_numbers_are_figures():
    assert numbers({"a": 1, "b": True, "c": math.nan, "d": math.inf, "e": "x", "f": None}) == {"a": 1.0, "b": 1.0}


def test_case_figures_are_flat_and_leave_constants_out(case_dir):
    figures = case_figures(case_dir, RESULT)
    assert figures["collision_realised"] == figures["generated"] == 1.0
    assert figures["failed"] == 0.0
    assert figures["paper_ice"] == 0.0
    assert figures["attempts_road"] == 2.0
    assert figures["network_mean_lanes"] == 1.5
    assert figures["grounding_road.$.legs"] == 0.75
    assert not any("theta" in name or "segments" in name for name in figures)


def test_attempts_are_steps(case_dir):
    assert list(attempt_figures(case_dir)) == [
        (1, {"road_findings": 2.0, "road_seconds": 0.5}),
        (2, {"road_findings": 0.0, "road_seconds": 1.0}),
    ]


def test_a_failed_case_without_network_has_figures(tmp_path):
    figures = case_figures(tmp_path, {"status": "failed", "network": None, "collision": {"realised": False}})
    assert figures["failed"] == 1.0
    assert figures["collision_realised"] == 0.0


def test_no_tracker_leaves_nothing(case_dir):
    before = sorted(case_dir.parent.parent.rglob("*"))
    NoTracker().log_case("kit", PARAMS, case_dir, RESULT)
    assert sorted(case_dir.parent.parent.rglob("*")) == before


def test_jsonl_keeps_a_line_a_case_and_a_line_a_call(case_dir, tmp_path):
    tracker = Jsonl(folder=tmp_path / "log")
    tracker.log_case("kit", PARAMS, case_dir, RESULT)
    tracker.log_case("kit", PARAMS, case_dir, RESULT | {"status": "refused"})
    tracker.log_generation("kit", "c1", Query(task="draw"), GENERATION)
    lines = [json.loads(line) for line in (tmp_path / "log" / "cases.jsonl").read_text().splitlines()]
    assert [line["result"]["status"] for line in lines] == ["generated", "refused"]
    assert lines[0]["figures"]["paper_ice"] == 0.0
    assert json.loads((tmp_path / "log" / "calls.jsonl").read_text())["query"]["task"] == "draw"


def test_jsonl_lies_beside_the_configs_by_default(case_dir):
    Jsonl().log_case("kit", PARAMS, case_dir, RESULT)
    assert (case_dir.parent.parent / "cases.jsonl").is_file()


# ------------------------------------------------------------------ MLflow
def runs_of(database):
    import mlflow

    client = mlflow.MlflowClient(tracking_uri=f"sqlite:///{database}")
    experiment = client.get_experiment_by_name("sgcad")
    return client, client.search_runs([experiment.experiment_id], order_by=["attributes.start_time ASC"])


@pytest.mark.slow
def test_mlflow_has_a_parent_a_config_and_a_child_a_case(case_dir):
    import mlflow

    tracker = MlflowTracker()
    tracker.log_case("kit", PARAMS, case_dir, RESULT)
    tracker.log_generation("kit", "c1", Query(task="draw", attempt=2, stage="road"), GENERATION)
    MlflowTracker().log_case("kit", PARAMS, case_dir, RESULT | {"status": "failed"})
    client, runs = runs_of(case_dir.parent.parent / "mlflow.db")
    (parent,) = [r for r in runs if "mlflow.parentRunId" not in r.data.tags]
    children = [r for r in runs if r.data.tags.get("mlflow.parentRunId") == parent.info.run_id]
    assert [(r.info.run_name, r.info.status) for r in children] == [("c1", "FINISHED"), ("c1", "FAILED")]
    child = children[0]
    assert child.data.params["road_writer_name"] == "template"
    assert child.data.metrics["collision_realised"] == 1.0
    history = client.get_metric_history(child.info.run_id, "attempt_road_findings")
    assert [(m.step, m.value) for m in history] == [(1, 2.0), (2, 0.0)]
    assert {f.path for f in client.list_artifacts(child.info.run_id)} >= {"player.html", "metrics.json", "attempts"}
    mlflow.flush_trace_async_logging()
    (trace,) = client.search_traces(locations=[child.info.experiment_id])
    (span,) = trace.data.spans
    assert span.name == "c1[2]"
    assert span.inputs["task"] == "draw"
    assert span.outputs["grounding"] == {"$.legs": 0.75}
    assert span.attributes["attempt"] == 2
    assert trace.info.trace_metadata["mlflow.sourceRun"] == child.info.run_id
    assert (span.end_time_ns - span.start_time_ns) / 1e9 == pytest.approx(1.5, abs=0.01)


@pytest.mark.slow
def test_four_processes_log_to_one_database(case_dir):
    code = (
        "import json, sys; from pathlib import Path; from plugins.tracker.mlflow import MlflowTracker\n"
        "tracker = MlflowTracker(); folder = Path(sys.argv[1])\n"
        "for _ in range(2): tracker.log_case('kit', {'seed': 1}, folder, json.loads(sys.argv[2]))\n"
    )
    MlflowTracker(artifacts=False).log_case("kit", PARAMS, case_dir, RESULT)
    command = [sys.executable, "-c", code, str(case_dir), json.dumps(RESULT)]
    started = [subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True) for _ in range(4)]
    ended = [(p.communicate()[1], p.returncode) for p in started]
    assert [code for _, code in ended] == [0] * 4, ended
    _, runs = runs_of(case_dir.parent.parent / "mlflow.db")
    assert sum("mlflow.parentRunId" in r.data.tags for r in runs) == 9


def test_a_database_that_is_none_is_refused_with_a_remedy(case_dir, tmp_path):
    (tmp_path / "no.db").write_text("this is no database, and it is long enough not to look empty " * 20)
    with pytest.raises(ConfigError, match=r"no.db: cannot be used as MLflow's database .*tracker=jsonl"):
        MlflowTracker(database=tmp_path / "no.db").log_case("kit", PARAMS, case_dir, RESULT)
