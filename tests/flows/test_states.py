"""What Prefect shows of a case, and what a flow run is called."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from uuid import uuid4

import pytest

from flows.batch.batch_flow import run_name
from flows.batch.prefect_case_end import shows_every_step
from flows.batch.prefect_case_task import _state
from flows.batch.prefect_tasks import StepRuns
from flows.case.run_case import Ending
from flows.case.step_log import Step
from flows.case_files.find_cases import Case

ACCOUNT = {"verdict": "lacking", "told": 5, "has": 3, "lacking": 2, "assumed": 0, "items": []}


@pytest.mark.parametrize(("status", "account", "name", "kind"), [
    ("generated", ACCOUNT | {"verdict": "whole"}, "Generated", "COMPLETED"),
    ("generated", ACCOUNT, "Lacking", "COMPLETED"),
    ("refused", None, "Refused", "CANCELLED"),
    ("exhausted", None, "Exhausted", "FAILED"),
    ("failed", None, "Failed", "FAILED"),
])  # fmt: skip
def test_only_a_generated_case_is_a_green_bar_and_what_lacks_is_in_its_name(status, account, name, kind):
    state = _state(Ending({"status": status, "reason": "because", "account": account}))
    assert (state.name, state.type.value) == (name, kind)
    assert state.message == ("2 of 5 things told are lacking" if name == "Lacking" else "because")


@pytest.mark.parametrize(
    ("configs", "cases", "name"),
    [
        (("template",), ("c1",), "template over c1"),
        (("a", "b", "c", "d"), ("c1", "c2"), "a, b, c and 1 more over 2 reports"),
    ],
)
def test_a_flow_run_is_called_by_what_it_does(configs, cases, name):
    named = tuple(SimpleNamespace(name=c) for c in configs)
    batch = SimpleNamespace(configs=named, cases=tuple(Case(Path(c), c) for c in cases))
    assert run_name(batch) == name


@pytest.mark.parametrize(("asked", "every"), [("all", True), ("attempts", False)])
def test_what_is_shown_of_a_case_can_be_decided(monkeypatch, asked, every):
    monkeypatch.setenv("SGCAD_PREFECT_STEPS", asked)
    assert shows_every_step() is every


def test_a_step_that_is_gone_on_with_begins_once_for_the_server(monkeypatch):
    sent = []
    monkeypatch.setattr("flows.batch.prefect_tasks.emit_event", lambda **event: sent.append(event["id"]))
    graph, other = (StepRuns("3e9c5a0e-1c1f-4a34-b7f3-2f6a53a1a0f1", str(uuid4())) for _ in range(2))
    begun = Step("simulate", 10.0)
    for told in (begun, replace(begun, ended=11.0), begun, replace(begun, ended=12.0), Step("measure", 10.0)):
        graph.tell(told)
    other.tell(begun)
    assert sent[0] == sent[2]
    assert len(set(sent)) == 5


def test_a_plain_server_is_shown_attempts_only():
    shown = [
        name for name in ("read", "road[2]", "scenario[1]", "track") if StepRuns("", "", False).shows(Step(name, 0.0))
    ]
    assert shown == ["road[2]", "scenario[1]"]
