"""What trackers log of a case, and the trackers that need no database."""

import json
import math

import pytest

from plugins.tracker.figures import (
    attempt_figures,
    case_figures,
    case_parameters,
    flat,
    means,
    numbers,
    parameters,
)  # fmt: skip
from plugins.tracker.jsonl import Jsonl
from plugins.tracker.none import NoTracker

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
GENERATION = {"seconds": 1.5, "prompt_tokens": 11, "model_calls": 2, "grounding": {"$.legs": 0.75}}


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
    assert figures["paper/ice"] == 0.0
    assert figures["attempts/road"] == 2.0
    assert figures["network/mean_lanes"] == 1.5
    assert figures["grounding/road.$.legs"] == 0.75
    assert figures["seconds/total"] == 1.5
    assert not any("theta" in name or "segments" in name for name in figures)


def test_attempts_are_steps(case_dir):
    about = {"stage": "road", "number": 2, "seconds": 1.0, "generation": GENERATION}
    (case_dir / "attempts" / "road-02" / "attempt.json").write_text(json.dumps(about))
    assert list(attempt_figures(case_dir)) == [
        (1, {"attempt/road_findings": 2.0, "attempt/road_seconds": 0.5}),
        (2, {"attempt/road_findings": 0.0, "attempt/road_seconds": 1.0, "attempt/road_prompt_tokens": 11.0,
             "attempt/road_model_calls": 2.0}),
    ]  # fmt: skip


def test_a_failed_case_without_network_has_figures(tmp_path):
    figures = case_figures(tmp_path, {"status": "failed", "network": None, "collision": {"realised": False}})
    assert figures["failed"] == 1.0
    assert figures["collision_realised"] == 0.0


def test_no_tracker_leaves_nothing(case_dir):
    before = sorted(case_dir.parent.parent.rglob("*"))
    NoTracker().log_case("kit", PARAMS, case_dir, RESULT)
    assert sorted(case_dir.parent.parent.rglob("*")) == before


def test_jsonl_keeps_a_line_a_case_and_a_line_a_model_answer(case_dir, tmp_path):
    about = {"stage": "road", "number": 2, "generation": GENERATION}
    (case_dir / "attempts" / "road-02" / "attempt.json").write_text(json.dumps(about))
    (case_dir / "attempts" / "road-02" / "prompt.txt").write_text("draw")
    tracker = Jsonl(folder=tmp_path / "log")
    tracker.log_case("kit", PARAMS, case_dir, RESULT)
    (calls,) = [json.loads(line) for line in (tmp_path / "log" / "calls.jsonl").read_text().splitlines()]
    assert (calls["case"], calls["number"], calls["prompt"]) == ("c1", 2, "draw")
    assert calls["generation"]["grounding"] == {"$.legs": 0.75}
    tracker.log_case("kit", PARAMS, case_dir, RESULT | {"status": "refused"})
    lines = [json.loads(line) for line in (tmp_path / "log" / "cases.jsonl").read_text().splitlines()]
    assert [line["result"]["status"] for line in lines] == ["generated", "refused"]
    assert lines[0]["figures"]["paper/ice"] == 0.0


def test_jsonl_lies_beside_the_configs_by_default(case_dir):
    Jsonl().log_case("kit", PARAMS, case_dir, RESULT)
    assert (case_dir.parent.parent / "cases.jsonl").is_file()


def test_parameters_are_called_as_the_yaml_calls_them():
    params = {"seed": 42, "decoder": {"name": "cad", "alpha": 0.7}, "road_writer": "template", "backbone": None}
    params["validators"] = [{"name": "topology", "most": 3}, "agreement"]
    assert parameters(params) == {
        "seed": "42",
        "decoder": "cad",
        "decoder.alpha": "0.7",
        "road_writer": "template",
        "backbone": "none",
        "validators": "topology,agreement",
        "validators.topology.most": "3",
    }


def test_means_are_over_the_cases_that_have_the_figure_and_keep_its_name():
    generated = {"generated": 1.0, "refused": 0.0, "paper/ice": 0.5, "attempt/road_findings": 3.0}
    found = means([generated, generated | {"paper/ice": 1.0}, {"generated": 0.0, "refused": 1.0}])
    assert found["paper/ice"] == 0.75
    assert found["generated"] == pytest.approx(2 / 3)
    assert (found["cases"], found["cases_generated"], found["cases_refused"], found["cases_failed"]) == (3, 2, 1, 0)
    assert "attempt/road_findings" not in found


def test_a_case_has_only_the_parameters_that_tell_arms_apart():
    params = {"seed": 42, "max_attempts": 10, "decoder": {"name": "cad", "alpha": 0.7}, "validators": ["topology"]}
    params |= {"backbone": {"name": "hf_vision", "model": "m", "dtype": "native"}, "simulator": {"name": "libsumo"}}
    assert case_parameters(parameters(params)) == {
        "seed": "42", "decoder": "cad", "decoder.alpha": "0.7", "backbone": "hf_vision", "backbone.model": "m",
    }  # fmt: skip
