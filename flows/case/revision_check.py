"""Whether a person's edit may stand: what the case came to with it, against what it was before."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flows.case.case_in_words import state_words
from flows.case.chain import CaseRun
from sgcad_core.case.records import Finding
from sgcad_core.errors import WrongEdit
from sgcad_core.records.edits import AS_READ, Edit
from sgcad_core.result import as_declared
from sgcad_core.revision.standing_edits import SOURCE


def findings_of(run: CaseRun) -> list[Finding]:
    """Findings of the valid attempts, and the planner's notes."""
    told = [attempt for outcome in run.outcomes.values() if (attempt := outcome.told_by)]
    found = [finding for attempt in told for finding in attempt.findings]
    scenario = run.record().scenario
    notes = scenario.notes if scenario else ()
    return [*found, *(Finding(source="planner", severity="note", what=n, where=_place(n)) for n in notes)]


def _place(note: str) -> str:
    """The words of a note that name its actors, as `Finding.where` has them."""
    return note.partition(":")[0][:120]


def check_revision(
    former: Mapping[str, Any],
    result: Mapping[str, Any],
    findings: Sequence[Finding],
    new: Sequence[Edit],
    undoing: bool,
) -> None:
    """Raise WrongEdit where an edit has no effect, or makes the case's result worse."""
    asked = {edit.field for edit in new if edit.value != AS_READ}
    void = [f for f in findings if f.source == SOURCE and f.where in asked]
    if void:
        lines = [f"{f.where} = {f.value}: {f.what.partition(': ')[2]}" for f in void]
        raise WrongEdit("; ".join(lines), void)
    if undoing and result["status"] != "failed":
        return
    if _standing(result) < _standing(former) or result["status"] == "failed":
        given = ", ".join(f"{e.field} = {e.value}" for e in new) or "undone"
        now, before = state_words(result), state_words(former)
        raise WrongEdit(f"with {given} the case is {now}; before it was {before}; nothing was changed", findings)


def _standing(result: Mapping[str, Any]) -> int:
    """Rank of a result: as declared 3, generated 2, exhausted 1, no scenario 0."""
    if result["status"] == "generated":
        return 3 if as_declared(result) else 2
    return {"exhausted": 1}.get(str(result["status"]), 0)
