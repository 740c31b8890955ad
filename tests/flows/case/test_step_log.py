"""Steps of a case: what waits for what, how each ends, and that times enclose the work."""

import time

import pytest

from flows.case.run_case import run_case
from flows.case.step_log import Steps, judged, waits_for
from flows.case_files.find_cases import Case
from sgcad_core.case.records import Attempt, Finding
from sgcad_core.config import load

SEEN = ["read", "retrieve[road]", "road[1]", "road[2]", "retrieve[scenario]", "scenario[1]", "simulate", "measure"]


@pytest.mark.parametrize(("name", "after"), [
    ("read", ()),
    ("opinion", ("read",)),
    ("retrieve[road]", ("read",)),
    ("road[1]", ("retrieve[road]",)),
    ("road[2]", ("road[1]",)),
    ("retrieve[scenario]", ("read",)),
    ("scenario[1]", ("retrieve[scenario]", "road[2]")),
    ("simulate", ("scenario[1]",)),
    ("draw", ("measure",)),
    ("track", ("draw",)),
])  # fmt: skip
def test_a_step_waits_for_what_it_needs(name, after):
    seen = [*SEEN, "draw"] if name == "track" else SEEN[: SEEN.index(name)] if name in SEEN else SEEN
    assert waits_for(name, seen) == after


def test_the_tenth_attempt_is_later_than_the_ninth_and_what_never_came_is_waited_for_by_nobody():
    attempts = [f"road[{n}]" for n in (10, 9)]
    assert waits_for("scenario[1]", ["retrieve[scenario]", *attempts]) == ("retrieve[scenario]", "road[10]")
    assert waits_for("retrieve[road]", ["read", "opinion"]) == ("opinion",)
    assert waits_for("track", ["read", "retrieve[road]", "road[1]"]) == ("road[1]",)


def test_begin_and_end_are_told_and_a_step_gone_on_with_is_one():
    told = []
    steps = Steps(told.append)
    with steps.during("measure"):
        time.sleep(0.01)
    first = steps.done[0]
    with steps.during("measure"):
        pass
    assert [step.ended is None for step in told] == [True, False, True, False]
    assert [step.name for step in steps.done] == ["measure"]
    assert steps.done[0].began == first.began < first.ended <= steps.done[0].ended


def test_a_step_that_raises_has_failed_with_its_reason():
    steps = Steps()
    with pytest.raises(ValueError, match="no such"), steps.during("read"):
        raise ValueError("no such report")
    assert (steps.done[0].state, steps.done[0].kind, steps.done[0].message) == ("Failed", "failed", "no such report")


@pytest.mark.parametrize(("severities", "state", "kind"), [
    ((), "Accepted", "completed"), (("note",), "Accepted", "completed"), (("doubt",), "Doubted", "completed"),
    (("doubt", "repair"), "Repair", "completed"), (("refuse",), "Refused", "cancelled"),
])  # fmt: skip
def test_an_attempt_ends_by_its_verdict(severities, state, kind):
    found = tuple(Finding(source="s", severity=severity, what="w") for severity in severities)
    step = judged(Steps()._begin("road[1]"), Attempt(stage="road", number=1, findings=found))
    assert (step.state, step.kind) == (state, kind)


def test_a_case_tells_its_steps_in_the_order_of_its_work(reports, config_file, tmp_path):
    told = []
    case = Case(reports(c1="") / "c1", "c1")
    ending = run_case(load(config_file()), case, tmp_path / "out", "d", tell=told.append)
    names = [step.name for step in ending.steps]
    assert [name for name in names if name != "measure"] == [
        "read", "retrieve[road]", "road[1]", "retrieve[scenario]", "scenario[1]", "simulate", "draw",
    ]  # fmt: skip
    assert all(step.ended >= step.began > 1e9 for step in ending.steps)
    assert {step.name for step in told if step.ended is None} == set(names)


def test_a_case_that_dies_in_a_stage_ends_with_that_step_failed(reports, config_file, tmp_path):
    case = Case(reports(c1="RAISE") / "c1", "c1")
    ending = run_case(load(config_file()), case, tmp_path / "out", "d")
    assert (ending.steps[-1].name, ending.steps[-1].state) == ("road[1]", "Failed")
