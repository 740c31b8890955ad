"""What Prefect shows of a case, and what a flow run is called."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from flows.batch.batch_flow import run_name
from flows.batch.case_task import made_of, state_of
from flows.case.run_case import Ending
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
    ending = Ending({"status": status, "reason": "because", "account": account})
    state = state_of(ending)
    assert made_of(state) is ending
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
