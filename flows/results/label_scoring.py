"""`sgcad score`: the runs of one config compared with the truth of their cases, field by field.

Reads run folders and label files (docs/metrics.md). Uses no figure that a run reports about itself.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from flows.case_files.case_folder import read_json
from flows.results.reading import made_of, paths_of
from sgcad_core.errors import BadInput, InvalidOutput
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.metrics.labels.course_label_match import course_marks
from sgcad_core.metrics.labels.course_labels import Agreement, CourseLabel, agreed, agreements, course_label
from sgcad_core.metrics.labels.label_match import NETWORK_FIELDS, compare
from sgcad_core.metrics.labels.observed_crash import Crash


class Scored(NamedTuple):
    """Marks by field and case, and the agreement of two readings of the labels (empty with one reading)."""

    marks: dict[str, dict[str, list[float]]]
    agreement: list[Agreement]

    def table(self) -> dict[str, tuple[float, int]]:
        """field -> (mean over all marks, how many there are)."""
        pooled = {f: [m for marks in cases.values() for m in marks] for f, cases in self.marks.items()}
        return {field: (sum(marks) / len(marks), len(marks)) for field, marks in pooled.items() if marks}

    def text(self, each: bool = False) -> str:
        """The table; `each`: also the cases that have a field wrong."""
        rows = [f"{field:28s} {mean:7.3f}  n={count}" for field, (mean, count) in self.table().items()]
        rows += [f"{a.field:28s} agreed {a.agreed:.3f}  kappa {a.kappa:.3f}  n={a.places}" for a in self.agreement]
        return "\n".join([*rows, *(self._wrong() if each else ())])

    def _wrong(self) -> Iterator[str]:
        for field, cases in self.marks.items():
            for case, marks in cases.items():
                if not field.startswith(NETWORK_FIELDS) and min(marks) < 1.0:
                    yield f"{case}: {field} {', '.join(f'{m:g}' for m in marks)}"


def score(
    runs: Path, truth: Path | None = None, labels: Path | None = None, second: Path | None = None, only: str = ""
) -> Scored:
    """Score every case that has truth or a label of its course.

    `second`: another reading of the same labels; only what both say counts. Raises BadInput for folders without
    results, truth or labels, and for label files that cannot be read.
    """
    if not any(runs.glob("*/result.json")):
        raise BadInput(f"{runs}: no <case>/result.json in it; give the folder of one config, such as runs/template")
    marks: dict[str, dict[str, list[float]]] = {}
    for case, raw in _files(truth, only):
        if "network" not in raw:
            raise BadInput(f"{truth}/{case}.json: no label (it lacks `network`); --labels takes those of a course")
        result = read_json(runs / case / "result.json")
        _add(marks, case, {"generated": [float(result.get("status") == "generated")]})
        _add(marks, case, {f: [m] for f, m in compare(raw, made_of(runs / case, result)).items()})
    told, agreement = _labels(labels, second, only)
    for case, label in told.items():
        _add(marks, case, course_marks(label, _crash(runs / case)))
    if not marks:
        raise BadInput(f"no case begins with {only!r} in {truth or labels}; give a folder of <case>.json files")
    return Scored(marks, agreement)


def _add(marks: dict[str, dict[str, list[float]]], case: str, found: Mapping[str, list[float]]) -> None:
    for field, values in found.items():
        marks.setdefault(field, {})[case] = values


def _labels(first: Path | None, second: Path | None, only: str) -> tuple[dict[str, CourseLabel], list[Agreement]]:
    one = {case: course_label(raw, case) for case, raw in _files(first, only)}
    if second is None:
        return one, []
    two = {case: course_label(raw, case) for case, raw in _files(second, only)}
    return {case: agreed(label, two[case]) for case, label in one.items() if case in two}, agreements(one, two)


def _files(folder: Path | None, only: str) -> Iterator[tuple[str, dict[str, Any]]]:
    if folder is None:
        return
    files = sorted(folder.glob(f"{only}*.json"))
    if not files and not only:
        raise BadInput(f"{folder}: no <case>.json in it; give the folder that holds the labels")
    for file in files:
        try:
            raw = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as fault:
            raise BadInput(f"{file}: cannot be read ({fault}); correct or remove it") from fault
        if not isinstance(raw, dict):
            raise BadInput(f"{file}: {type(raw).__name__} instead of a JSON object; correct or remove it")
        yield file.stem, raw


def _crash(folder: Path) -> Crash | None:
    """The crash of a generated case; None if missing or unreadable."""
    result = read_json(folder / "result.json")
    try:
        if result.get("status") != "generated":
            return None
        graph = parse_net((folder / "road.net.xml").read_text(encoding="utf-8"))
        paths = paths_of(folder, result)
    except (OSError, ValueError, KeyError, TypeError, InvalidOutput):
        return None
    return Crash(paths, graph) if paths else None


def as_json(scored: Scored) -> str:
    """All marks and the table, for other programs."""
    table = {field: {"mean": mean, "count": count} for field, (mean, count) in scored.table().items()}
    agreement = [a._asdict() for a in scored.agreement]
    return json.dumps({"fields": table, "agreement": agreement, "marks": scored.marks}, indent=1)
