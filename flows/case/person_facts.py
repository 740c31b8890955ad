"""A person's facts in a case: read beside its report, applied to what writers write; model answers that are kept.

specs.json   in a case's folder: the current specs, the attempt of each stage that they are from, whose reading was kept
.source      path of its report, relative to the folder, so that it can be revised
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from flows.case.facts_journal import settled
from flows.case.readings import ReadBy
from sgcad_core.asking.refine import Artifact, Write
from sgcad_core.case.records import (
    Attempt,
    Context,
    CrashReport,
    Finding,
    Generation,
    Query,
    RoadNetwork,
    Scenario,
    StageOutcome,
)
from sgcad_core.errors import BadInput
from sgcad_core.interfaces import Ask, RoadWriter, ScenarioWriter
from sgcad_core.reading.layout.road_ways import apart
from sgcad_core.reading.text.compass import angle_of
from sgcad_core.records.edits import Edit, effective
from sgcad_core.records.facts import Value
from sgcad_core.records.specs import BehaviorSpec, RoadSpec
from sgcad_core.result import CaseRecord
from sgcad_core.revision import apply_road_edits, apply_scenario_edits, read_edits, report_digest
from sgcad_core.revision.actors import HEADING_RAD
from sgcad_core.revision.values import value_of
from sgcad_core.system.report_files import facts_file, read_regular

SPECS = "specs.json"
SOURCE = ".source"
MOST_PATH = 100_000
"""Bytes of a path."""


def with_person_facts(report: CrashReport, source: Path, edits: tuple[Edit, ...] | None = None) -> CrashReport:
    """A report with a person's edits: `edits`, else the facts.yaml beside it. Raises BadInput."""
    if edits is None:
        settled(source)
        file = facts_file(source)
        edits = read_edits(file, report_digest(source)) if file.is_file() else ()
    return report.model_copy(update={"edits": edits}) if edits else report


def with_edits(
    write: Write, report: CrashReport, network: RoadNetwork | None, writer: RoadWriter | ScenarioWriter
) -> Write:
    """A writer's `write` with a report's edits applied to its artifacts; the same function without edits."""
    edits = report.edits
    if not edits:
        return write
    how = {name: value for name in ("version", "encoding")
           if (value := getattr(writer, {"version": "openscenario"}.get(name, name), None))}  # fmt: skip

    def informed_write(findings: tuple[Finding, ...], ask: Ask, attempt: int) -> Artifact:
        made = write(findings, ask, attempt)
        if isinstance(made, RoadNetwork):
            return apply_road_edits(made, report.reading, edits)
        return apply_scenario_edits(made, network, report.reading, edits, **how) if network else made

    return informed_write


# ------------------------------------------------------------------ what a case's folder keeps of its specs
def specs_of(record: CaseRecord, as_read: dict[str, Any] | None = None) -> dict[str, Any]:
    """The current specs of a case (of an exhausted stage those of its best attempt), JSON-able, and the number of
    the attempt that each is from. `as_read`: the same of the case before the first edit, where there is one."""
    artifacts = {stage: outcome.artifact for stage, outcome in record.outcomes.items()}
    road, scenario = artifacts.get("road"), artifacts.get("scenario")
    spec = road.spec if isinstance(road, RoadNetwork) else None
    behavior = scenario.behavior if isinstance(scenario, Scenario) else None
    return {
        "road": spec.model_dump(mode="json") if spec else None,
        "behavior": behavior.model_dump(mode="json") if behavior else None,
        "kept": {stage: outcome.kept for stage, outcome in record.outcomes.items()},
    } | ({"as_read": as_read} if as_read else {})


def report_path(folder: Path) -> Path:
    """The path of a case's report, from its folder. Raises BadInput."""
    try:
        told = read_regular(folder / SOURCE, folder, MOST_PATH).decode("utf-8", "surrogateescape")
    except BadInput as fault:
        raise BadInput(f"{folder}: does not say where its report is: name it with --report") from fault
    return Path(os.path.normpath(folder.resolve() / told))


def write_report_path(into: Path, folder: Path, source: Path) -> None:
    """Note in the folder `into`, which becomes the case's folder `folder`, where its report lies: relative to it."""
    told = os.path.relpath(source.resolve(), folder.resolve())
    (into / SOURCE).write_text(told, encoding="utf-8", errors="surrogateescape")


def disagreement(specs: Mapping[str, Any], edits: Sequence[Edit]) -> dict[str, Any]:
    """The number of facts that are a person's, and of those that the reading and the writers had differently."""
    given, was = effective(edits), specs.get("as_read") or {}
    road, behavior = _validated(was.get("road"), was.get("behavior"))
    said = [(e.field, value_of(e.field, road, behavior), e.value) for e in given]
    return {
        "facts": len(given),
        "disagreed": sum(not _same(field, read, told) for field, read, told in said),
        "read": {field: read for field, read, _ in said},
    }


def _same(field: str, read: Value, told: Value) -> bool:
    """Whether a value is the person's; a heading is the same within an eighth, as the reading's roads are."""
    if field.endswith(".heading") and isinstance(read, str) and isinstance(told, str):
        return apart(angle_of(read), angle_of(told)) < HEADING_RAD  # type: ignore[arg-type]
    return read == told


def _validated(road: Any, behavior: Any) -> tuple[RoadSpec | None, BehaviorSpec | None]:
    return (
        RoadSpec.model_validate(road) if road else None,
        BehaviorSpec.model_validate(behavior) if behavior else None,
    )


@dataclass(frozen=True)
class Specs:
    """A case's specs.json; None where the stage was not written, or its writer gives no spec."""

    road: RoadSpec | None = None
    behavior: BehaviorSpec | None = None
    kept: Mapping[str, int] = field(default_factory=dict)
    as_read: dict[str, Any] | None = None
    """The content of specs.json before the first edit, where there is one."""
    read_by: ReadBy | None = None
    """The readers whose reading was kept; None in folders of earlier versions."""


def read_specs(folder: Path) -> Specs:
    """The specs that a case's folder keeps. Raises BadInput where there are none, or none that can be read."""
    try:
        raw = json.loads(read_regular(folder / SPECS, folder))
        specs = _validated(raw["road"], raw["behavior"])
        return Specs(*specs, dict(raw["kept"]), raw.get("as_read"), raw.get("read_by"))
    except (BadInput, ValueError, KeyError, TypeError, RecursionError) as fault:
        raise BadInput(
            f"{folder}: no {SPECS} that can be read ({type(fault).__name__}): run the case again with this version"
        ) from fault


# ------------------------------------------------------------------ what a model answered before
@dataclass(frozen=True)
class KeptAnswers:
    """The attempts of a stage as a case's folder keeps them; `number` is the valid one."""

    attempts: tuple[Attempt, ...]
    number: int

    def ask(self, context: Context, query: Query) -> Generation:
        """The kept answer, independent of the query."""
        answer = self.attempts[self.number - 1].generation
        return answer or Generation(text=self.attempts[self.number - 1].answer)

    def among_others(self, outcome: StageOutcome) -> StageOutcome:
        """The outcome of validating that answer again, with the other attempts around it."""
        judged = outcome.attempts[-1]
        before = self.attempts[self.number - 1]
        fresh = judged.model_copy(update={"number": self.number, "prompt": before.prompt, "held": before.held})
        attempts = (*self.attempts[: self.number - 1], fresh, *self.attempts[self.number :])
        return outcome.model_copy(update={"attempts": attempts, "kept": self.number if outcome.kept else 0})


def kept_answers(outcomes: Mapping[str, StageOutcome]) -> dict[str, KeptAnswers]:
    """The attempts of stages that have just been written."""
    return {stage: KeptAnswers(o.attempts, o.kept or len(o.attempts)) for stage, o in outcomes.items() if o.attempts}


def read_kept_answers(folder: Path, stage: str, number: int) -> KeptAnswers:
    """A stage's attempts as a case's folder keeps them; `number`: the valid one, 0: the last.

    Raises BadInput where the folder keeps no answer.
    """
    places = sorted((folder / "attempts").glob(f"{stage}-*"))
    attempts = tuple(_attempt(place) for place in places)
    if not attempts:
        raise BadInput(f"{folder}/attempts: no answer of the {stage} stage is kept: run the case again")
    return KeptAnswers(attempts, number or len(attempts))


def _attempt(place: Path) -> Attempt:
    """One attempt of a folder; its tokens are not kept, its grounding is."""
    try:
        about = json.loads((place / "attempt.json").read_text(encoding="utf-8"))
        answer = (place / "answer.txt").read_text(encoding="utf-8")
        found = [Finding.model_validate(row) for row in json.loads((place / "findings.json").read_text("utf-8"))]
        prompt = (place / "prompt.txt").read_text(encoding="utf-8")
        return Attempt(
            stage=about["stage"], number=about["number"], seconds=about["seconds"], prompt=prompt, answer=answer,
            findings=tuple(found), generation=_generation(answer, about.get("generation")),
        )  # fmt: skip
    except (OSError, ValueError, KeyError, ValidationError) as fault:
        raise BadInput(f"{place}: cannot be read ({type(fault).__name__}: {fault}): run the case again") from fault


def _generation(answer: str, about: Any) -> Generation | None:
    """The generation of an answer, as far as the folder keeps it."""
    if not isinstance(about, dict):
        return None
    names: Sequence[str] = ("finish", "prompt_tokens", "model_calls", "seconds", "grounding", "notes")
    return Generation.model_validate({"text": answer, **{n: about[n] for n in names if n in about}})
