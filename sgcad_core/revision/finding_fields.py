"""Editable fields that a finding concerns, and validators that edits overrule.

A validator that holds an artifact against the narrative has nothing to say where a person said otherwise: its finding
stays as a note. What cannot be drawn, driven or simulated stays a fault, also of a person's edit.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.interfaces import Validator
from sgcad_core.records.edits import Edit, effective
from sgcad_core.records.specs import BehaviorSpec, RoadSpec
from sgcad_core.revision.fields import EDITABLE, kind_of
from sgcad_core.revision.standing_edits import SOURCE, unapplied_edits

FROM_NARRATIVE = ("road_narrative", "behavior_narrative", "evidence_gate")
"""Sources of findings that hold an artifact against the evidence."""
_GATED = {
    "lanes": ("roads.",), "road layout": ("junction.",), "actors": ("vehicles.", "others."),
    "first contact": ("contacts.",),
}  # fmt: skip
"""Missing evidence of the gate -> prefixes of the fields that an edit may give instead."""


class OverruledValidator(Validator):
    """A validator whose findings from the narrative become notes where an edit says otherwise."""

    inner: Validator
    edits: tuple[Edit, ...]

    @property
    def stage(self) -> str:  # type: ignore[override]
        """That of the validator."""
        return self.inner.stage

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """The inner validator's findings, overruled ones as notes."""
        return [overruled(f, self.edits) for f in self.inner.findings(artifact, evidence)]


class UnappliedEdits(Validator):
    """A validator with a doubt for each edit without effect."""

    edits: tuple[Edit, ...]
    stage = "both"

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """One an edit."""
        if isinstance(artifact, RoadNetwork):
            return unapplied_edits(self.edits, "road", artifact.spec)
        network = evidence.network
        return unapplied_edits(self.edits, "scenario", network.spec if network else None, artifact.behavior)


def overruled_validators(validators: Sequence[Validator], edits: Sequence[Edit]) -> tuple[Validator, ...]:
    """Validators that a person overrules, and one that says which edits do not stand; the same ones without edits."""
    if not effective(edits):
        return tuple(validators)
    return (*(OverruledValidator(inner=v, edits=tuple(edits)) for v in validators), UnappliedEdits(edits=tuple(edits)))


def overruled(finding: Finding, edits: Iterable[Edit]) -> Finding:
    """A note in the place of a finding from the narrative that concerns an edited field."""
    if finding.source not in FROM_NARRATIVE or finding.severity == "note":
        return finding
    if not any(concerns(finding, edit.field) for edit in effective(edits)):
        return finding
    return finding.model_copy(update={"severity": "note", "remedy": "a person says otherwise", "holds": ()})


def concerns(finding: Finding, field: str) -> bool:
    """Whether a finding concerns a field."""
    if finding.source == "evidence_gate":
        begins = _GATED.get(finding.value, ())
        return field.startswith(begins) if begins else False
    if finding.source == SOURCE:
        return finding.where == field
    return kind_of(field).concerned(field, finding.where)


def findings_by_field(
    findings: Iterable[Finding], road: RoadSpec | None, behavior: BehaviorSpec | None, edits: Iterable[Edit] = ()
) -> Mapping[str, tuple[Finding, ...]]:
    """Field -> the findings that concern it; under "" those that concern no field of this case."""
    from sgcad_core.revision.fields import fields_of

    names = list(dict.fromkeys([*(f.name for f in fields_of(road, behavior)), *(e.field for e in effective(edits))]))
    found: dict[str, list[Finding]] = {}
    for finding in findings:
        for name in [name for name in names if concerns(finding, name)] or [""]:
            found.setdefault(name, []).append(finding)
    return {name: tuple(said) for name, said in found.items()}


__all__ = [
    "EDITABLE",
    "FROM_NARRATIVE",
    "OverruledValidator",
    "UnappliedEdits",
    "concerns",
    "findings_by_field",
    "overruled",
    "overruled_validators",
]
