"""Generation quality over a batch: how often a scenario came out whole, how often a file was wrong, and in which
layer it failed.

Knows statuses, findings by their source and counts. A scenario is three files (the paper's list): road.net.xml and
road.xodr from the road stage, scenario.xosc from the scenario stage; the formulas are the paper's GSR and AER.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from sgcad_core.case.records import Finding, Stage
from sgcad_core.findings import HARD

Layer = Literal["parse", "schema", "netconvert", "references", "execution", "content"]
LAYERS: tuple[Layer, ...] = ("parse", "schema", "netconvert", "references", "execution", "content")
"""In the order in which an answer passes them; a file fails in the first with a fault.

parse: no document, JSON or Python to be read. schema: SUMO's, OpenSCENARIO's. netconvert: it compiles nothing.
references: elements, lanes and places that are not there, or a file that SUMO or the player cannot take.
execution: a script raises, breaks its rules or its limits; a scenario that dies in the simulator. content: valid
files that say something else than the report; no error of syntax or API, so left out of the AER.
"""
FILES: Mapping[Stage, int] = {"road": 2, "scenario": 1}
_BY_SOURCE: Mapping[str, Layer] = {
    "answer": "parse", "backbone": "parse", "layout": "parse", "python_syntax": "parse", "xosc": "parse",
    "sumo_xsd": "schema",
    "netconvert": "netconvert",
    "sumo_load": "references", "opendrive": "references", "openscenario": "references", "agreement": "references",
    "scenario": "references", "road": "references", "planner": "references", "net_xml": "references",
    "xodr": "references", "sumo_routes": "references",
    "python": "execution", "python_rules": "execution", "python_limit": "execution",
}  # fmt: skip


class FileCounts(NamedTuple):
    """Files that one scenario's writers produced, and those of them with an error."""

    written: int
    faulty: int


@dataclass(frozen=True)
class AttemptRecord:
    """One attempt of a stage with its findings."""

    stage: Stage
    findings: tuple[Finding, ...]

    @property
    def refused(self) -> bool:
        """Whether it ended in a refusal, which is no error."""
        return any(f.severity == "refuse" for f in self.findings)

    @property
    def usable(self) -> bool:
        """Whether no finding asks for a repair or a refusal; questions and doubts are allowed."""
        return not any(f.severity in HARD for f in self.findings)

    @property
    def doubts(self) -> tuple[int, int]:
        """Number of questions, then of doubts."""
        severities = [f.severity for f in self.findings]
        return severities.count("question"), severities.count("doubt")

    @property
    def layer(self) -> Layer | None:
        """The layer in which it failed; None without a finding to repair."""
        found = {layer_of(f) for f in self.findings if f.severity == "repair"}
        return next((layer for layer in LAYERS if layer in found), None)


@dataclass(frozen=True)
class CaseRecord:
    """One case of a batch: how it ended and its attempts, in order."""

    status: str
    attempts: tuple[AttemptRecord, ...]

    def of(self, stage: Stage) -> tuple[AttemptRecord, ...]:
        """A stage's attempts."""
        return tuple(a for a in self.attempts if a.stage == stage)

    def standing(self, stage: Stage) -> AttemptRecord | None:
        """The attempt of a stage that stands: the least doubted usable one (`refine.outcome_of`), else the last."""
        seen = self.of(stage)
        return min((a for a in seen if a.usable), key=lambda a: a.doubts, default=seen[-1] if seen else None)


@dataclass(frozen=True)
class Quality:
    """GSR and AER of a batch as fractions, at the first attempt and after refinement."""

    cases: int
    refused: int
    """Cases that the model or the evidence gate declined; they count as not generated, as in the paper."""
    first_success: float
    success: float
    first_file_errors: float
    file_errors: float
    """Faulty over written files (the paper's AER)."""
    first_scenario_errors: float
    scenario_errors: float
    """Scenarios with any faulty file over those attempted."""
    first_layers: Mapping[Layer, int]
    layers: Mapping[Layer, int]
    """Files (not cases) by the layer in which they failed."""
    attempts: float
    """Mean number of attempts a case, both stages together."""


# ------------------------------------------------------------------ formulas
def generation_success_rate(statuses: Iterable[str]) -> float:
    """GSR of the paper: generated scenarios over all attempted, a fraction; nan-free: 0 of none is 0."""
    seen = list(statuses)
    return sum(s == "generated" for s in seen) / len(seen) if seen else 0.0


def api_error_rate(files: Iterable[FileCounts]) -> float:
    """AER of the paper: simulation files with an error over all files generated, a fraction (per file)."""
    counts = list(files)
    written = sum(c.written for c in counts)
    return sum(c.faulty for c in counts) / written if written else 0.0


def layer_of(finding: Finding) -> Layer:
    """The layer of a finding, by its source; findings of narratives and of foreign validators are content.

    Three sources belong to more than one layer: SUMO's schema names the document where it is no XML, OpenSCENARIO's
    schema locates faults by line and not by element, and contacts are content.
    """
    source, where = finding.source, finding.where
    if source.startswith("sumo_xsd ") or (source in FILES and not where):  # an answer without findings is unreadable
        return "parse"
    if source == "openscenario" and where.startswith("line "):
        return "schema"
    if source == "agreement" and where.startswith("contacts"):
        return "content"
    return _BY_SOURCE.get(source, "content")


# ------------------------------------------------------------------ a batch
def quality(cases: Sequence[CaseRecord]) -> Quality:
    """Figures of one config's cases."""
    first, last = [_files(c, first=True) for c in cases], [_files(c) for c in cases]
    count = max(len(cases), 1)
    return Quality(
        cases=len(cases),
        refused=sum(c.status == "refused" for c in cases),
        first_success=generation_success_rate("generated" if _at_once(c) else "not" for c in cases),
        success=generation_success_rate(c.status for c in cases),
        first_file_errors=api_error_rate(c for c, _ in first),
        file_errors=api_error_rate(c for c, _ in last),
        first_scenario_errors=sum(c.faulty > 0 for c, _ in first) / count,
        scenario_errors=sum(c.faulty > 0 for c, _ in last) / count,
        first_layers=_sum(layers for _, layers in first),
        layers=_sum(layers for _, layers in last),
        attempts=sum(len(c.attempts) for c in cases) / count,
    )


def written_files(case: CaseRecord) -> FileCounts:
    """Files of a case after refinement: written, and those with an error."""
    return _files(case)[0]


def _at_once(case: CaseRecord) -> bool:
    """Whether it was generated without any refinement."""
    return case.status == "generated" and all(a.usable for stage in FILES for a in case.of(stage)[:1])


def _files(case: CaseRecord, first: bool = False) -> tuple[FileCounts, Counter[Layer]]:
    """Files of each stage's attempt that stands, or of its first, and the layers in which the faulty ones failed.

    A refused attempt writes no file. A stage that was never reached has none either. Of a road attempt both
    files fail together, but where OpenDRIVE alone is at fault.
    """
    written, layers = 0, Counter[Layer]()
    for stage, files in FILES.items():
        seen = next(iter(case.of(stage)), None) if first else case.standing(stage)
        if seen is None or seen.refused:
            continue
        written += files
        if (layer := seen.layer) is not None and layer != "content":
            layers[layer] += 1 if _only_opendrive(seen) else files
    if not first and not layers and case.status == "failed" and case.of("scenario"):  # the execution failed
        layers["execution"] += FILES["scenario"]
    return FileCounts(written, layers.total()), layers


def _only_opendrive(attempt: AttemptRecord) -> bool:
    return {f.source for f in attempt.findings if f.severity == "repair"} == {"opendrive"}


def _sum(counts: Iterable[Counter[Layer]]) -> dict[Layer, int]:
    total = Counter[Layer]()
    for count in counts:
        total += count
    return {layer: total[layer] for layer in LAYERS if total[layer]}
