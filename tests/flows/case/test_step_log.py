"""Steps of a case: begin, end and state of each, in its folder."""

import json
import time
from itertools import pairwise

import pytest

from flows.case.run_case import run_case
from flows.case.step_log import StepLog, verdict
from flows.case_files.find_cases import Case
from sgcad_core.case.records import Attempt, Finding
from sgcad_core.config import load


def test_a_step_is_told_as_it_begins_and_its_times_enclose_the_work():
    told = []
    log = StepLog(told.append)
    with log.during("measure"):
        assert told == ["measure"]
        time.sleep(0.01)
    step = log.steps[0]
    assert step.told()["state"] == "Completed"
    assert 1e9 < step.began_s <= step.ended_s - 0.01


def test_a_step_that_raises_has_failed_with_its_reason():
    log = StepLog()
    with pytest.raises(ValueError, match="no such"), log.during("read"):
        raise ValueError("no such report")
    assert (log.steps[0].state, log.steps[0].message) == ("Failed", "no such report")


def test_a_result_that_was_kept_is_told_as_cached():
    log = StepLog()
    with log.during("road[1]") as step:
        step.judge(Attempt(stage="road", number=1), kept=True)
    assert log.steps[0].told()["state"] == "Cached"


@pytest.mark.parametrize(("severities", "state"), [
    ((), "Accepted"), (("note",), "Accepted"), (("doubt",), "Doubted"), (("doubt", "repair"), "Repair"),
    (("repair", "refuse"), "Refused"),
])  # fmt: skip
def test_an_attempt_ends_by_its_verdict(severities, state):
    found = tuple(Finding(source="s", severity=severity, what="w") for severity in severities)
    assert verdict(Attempt(stage="road", number=1, findings=found))[0] == state


def test_a_case_tells_its_steps_in_the_order_of_its_work(reports, config_file, tmp_path):
    told = []
    case = Case(reports(c1="") / "c1", "c1")
    run_case(load(config_file()), case, tmp_path / "out", "d", tell=told.append)
    kept = json.loads((tmp_path / "out" / "kit" / "c1" / "steps.json").read_text())
    assert told == [step["name"] for step in kept]
    assert list(dict.fromkeys(told)) == [
        "read", "retrieve[road]", "road[1]", "retrieve[scenario]", "scenario[1]", "simulate", "measure", "draw",
        "files",
    ]  # fmt: skip
    assert all(later["began_s"] >= sooner["ended_s"] for sooner, later in pairwise(kept))


def test_a_case_that_dies_in_a_stage_ends_with_that_step_failed(reports, config_file, tmp_path):
    case = Case(reports(c1="RAISE") / "c1", "c1")
    run_case(load(config_file()), case, tmp_path / "out", "d")
    last = json.loads((tmp_path / "out" / "kit" / "c1" / "steps.json").read_text())[-1]
    assert (last["name"], last["state"]) == ("road[1]", "Failed")
    assert "a bug in a plugin" in last["message"]
