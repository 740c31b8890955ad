"""Checks that a behavior declares a near crash if the narrative tells one: no contact, the pair in conflict."""

from __future__ import annotations

from collections.abc import Iterator

from sgcad_core.case.records import Finding, Severity
from sgcad_core.findings import FindingFactory
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.records.specs import BehaviorSpec

_finding = FindingFactory("behavior_narrative")


def near_crash_findings(behavior: BehaviorSpec, facts: CrashFacts) -> Iterator[Finding]:
    """At most one finding; a note if the text does not state the near crash."""
    near = facts.near_crash
    if near is None:
        if behavior.near_crash is not None and any(c.stated for c in facts.contacts):
            yield _finding("the report tells a contact, no near crash", "near_crash", "declared", "declare the contact")
        return
    told = facts.contacts[0]
    severity: Severity = "repair" if near.stated else "note"
    pair = {told.striker, told.struck}
    between = f"{told.striker} and {told.struck}"
    said = behavior.near_crash
    if behavior.contacts:
        touch = behavior.contacts[0]
        yield _finding("nobody touches anybody in the report", "contacts", f"{touch.striker} into {touch.struck}",
                       f"declare a near crash of {between}", severity)  # fmt: skip
    elif said is None:
        what = "the report tells a near crash, but none is declared"
        yield _finding(what, "near_crash", "", f"declare one of {between}", severity)
    elif {said.conflict.striker, said.conflict.struck} != pair:
        value = f"{said.conflict.striker} and {said.conflict.struck}"
        what = f"the report's near crash is of {between}"
        yield _finding(what, "near_crash.conflict", value, f"declare {between}", severity)
