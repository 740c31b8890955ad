"""Checks that a behavior declares a near crash if the narrative tells one: no contact, the pair in conflict."""

from __future__ import annotations

from collections.abc import Iterator

from plugins.validator._told import as_question, quoted
from sgcad_core.case.records import Finding, Severity
from sgcad_core.findings import FindingFactory
from sgcad_core.reading.reading import Reading
from sgcad_core.records.specs import BehaviorSpec

_finding = FindingFactory("behavior_narrative")
_TOLD_BY = ("contacts.0.striker", "contacts.0.struck")


def near_crash_findings(behavior: BehaviorSpec, reading: Reading) -> Iterator[Finding]:
    """At most one finding; a note if the text does not state the near crash. A stated contact or near crash of which
    the scenario has nothing is to be repaired."""
    facts = reading.crash
    near = facts.near_crash
    if near is None:
        if behavior.near_crash is not None and any(c.stated for c in facts.contacts):
            found = _finding(
                "the report tells a contact, no near crash", "near_crash", "declared", "declare the contact"
            )
            yield quoted(found, reading, _TOLD_BY)
        return
    told = facts.contacts[0]
    pair = {told.striker, told.struck}
    between = f"{told.striker} and {told.struck}"
    said = behavior.near_crash
    if behavior.contacts:
        touch = behavior.contacts[0]
        found = _finding("nobody touches anybody in the report", "contacts", f"{touch.striker} into {touch.struck}",
                         f"declare a near crash of {between}")  # fmt: skip
        yield _softened(found, near.stated, reading, between)
    elif said is None:
        what = "the report tells a near crash, but none is declared"
        severity: Severity = "repair" if near.stated else "note"
        yield quoted(_finding(what, "near_crash", "", f"declare one of {between}", severity), reading, _TOLD_BY)
    elif {said.conflict.striker, said.conflict.struck} != pair:
        value = f"{said.conflict.striker} and {said.conflict.struck}"
        what = f"the report's near crash is of {between}"
        found = _finding(what, "near_crash.conflict", value, f"declare {between}")
        yield _softened(found, near.stated, reading, between)


def _softened(found: Finding, stated: bool, reading: Reading, between: str) -> Finding:
    """A question, a doubt where no fact has the sentence of what is stated, a note where it is not stated."""
    asked = as_question(found, reading, _TOLD_BY, f"a near crash of {between}")
    severity: Severity = "question" if stated and asked.told else "doubt" if stated else "note"
    return asked.model_copy(update={"severity": severity})
