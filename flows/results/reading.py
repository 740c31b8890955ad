"""A study read from its folder: study.json and the finished cases of every arm.

A folder of runs without study.json (`sgcad evaluate --out`) counts as a study whose arms are its configs. Unfinished
cases are left out.
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from flows.case_files.case_folder import read_json
from flows.results.levels import level_of
from sgcad_core.case.records import Finding, Stage
from sgcad_core.case.traffic import ROLE
from sgcad_core.errors import ConfigError, InvalidOutput
from sgcad_core.formats.sumo.net_xml import lanes_between
from sgcad_core.metrics.generation import AttemptRecord, CaseRecord
from sgcad_core.metrics.labels.label_match import GeneratedCase
from sgcad_core.metrics.labels.motion_label_match import Path as Motion
from sgcad_core.roads.lane_graph import road_counts

STUDY = "study.json"
DEFAULT_SIZE = (4.6, 1.8)
_STAGES: Mapping[str, Stage] = {"road": "road", "scenario": "scenario"}


@dataclass(frozen=True)
class Arm:
    """One arm of a study as study.json names it."""

    name: str
    label: str
    config: str = ""
    overrides: tuple[str, ...] = ()
    published: str | None = None
    factors: Mapping[str, Any] = field(default_factory=dict)

    @property
    def level(self) -> str | None:
        """Its robustness level, if it names one."""
        return level_of(self.factors, self.overrides)


@dataclass(frozen=True)
class FinishedCase:
    """One finished case of one arm."""

    arm: str
    case: str
    folder: Path
    result: Mapping[str, Any]
    metrics: Mapping[str, Any]

    @property
    def generated(self) -> bool:
        """Whether it ended with an executed scenario."""
        return bool(self.result["status"] == "generated")

    def seen(self) -> CaseRecord:
        """Its attempts and their findings, for the generation figures."""
        places = sorted((self.folder / "attempts").glob("*-*"))
        attempts = (_attempt(place) for place in places if place.name.rpartition("-")[0] in _STAGES)
        return CaseRecord(self.result["status"], tuple(attempts))


@dataclass(frozen=True)
class Study:
    """A study and its finished cases. `labels` are the ground truth by case; empty without truth."""

    folder: Path
    name: str
    title: str
    arms: tuple[Arm, ...]
    cases: tuple[str, ...]
    reference: str | None = None
    labels: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    about: Mapping[str, Any] = field(default_factory=dict)
    """Content of study.json: versions, digests, hardware."""

    @cached_property
    def ran(self) -> Mapping[str, Mapping[str, FinishedCase]]:
        """arm -> case -> finished case, in the study's order."""
        return {arm.name: {ran.case: ran for ran in self._finished(arm.name)} for arm in self.arms}

    def arm(self, name: str) -> Arm:
        """An arm by name."""
        return next(arm for arm in self.arms if arm.name == name)

    def progress(self) -> tuple[int, int]:
        """Finished and planned cases, all arms together."""
        return sum(map(len, self.ran.values())), len(self.arms) * len(self.cases)

    def _finished(self, arm: str) -> Iterator[FinishedCase]:
        for case in self.cases:
            folder = self.folder / arm / case
            result = read_json(folder / "result.json")
            if result and "status" in result:
                yield FinishedCase(arm, case, folder, result, read_json(folder / "metrics.json"))


# ------------------------------------------------------------------ the study
def find_study(given: Path, out: Path = Path("runs")) -> Path:
    """The folder that a path, or a name under <out>/studies/, means. Raises ConfigError naming the studies there."""
    for folder in (given, out / "studies" / given):
        if (folder / STUDY).is_file() or (folder.is_dir() and any(folder.glob("*/*/result.json"))):
            return folder
    known = sorted(f.parent.name for f in (out / "studies").glob(f"*/{STUDY}"))
    there = f"studies in {out / 'studies'}: {', '.join(known)}" if known else f"there is none in {out / 'studies'}"
    raise ConfigError(f"{given}: no study and no folder of runs; {there}; `sgcad study` makes one in --out")


def load_study(folder: Path, truth: Path | None = None, only: str = "") -> Study:
    """Read a study's folder.

    `truth`: folder of labels, before the one that study.json names. `only`: cases whose name begins so.
    Raises ConfigError where study.json cannot be read, a label cannot, or no case is left.
    """
    about = _about(folder) if (folder / STUDY).is_file() else _runs(folder)
    cases = tuple(c for c in about["cases"] if c.startswith(only))
    if not cases:
        raise ConfigError(f"{folder}: no case begins with {only!r}; it has {', '.join(about['cases'][:5])} ...")
    named = truth or (Path(about["truth"]) if about.get("truth") else None)
    if truth and not truth.is_dir():
        raise ConfigError(f"--truth {truth}: no such folder; give the one that holds <case>.json")
    arms = tuple(_arm(raw) for raw in about["arms"])
    reference = about.get("reference")
    if reference and reference not in {arm.name for arm in arms}:
        raise ConfigError(f"{folder / STUDY}: reference {reference!r} is no arm; arms: {[a.name for a in arms]}")
    labels = dict(_labels(named, cases)) if named else {}
    return Study(folder, about["study"], about["title"], arms, cases, reference, labels, about)


def _about(folder: Path) -> dict[str, Any]:
    file = folder / STUDY
    try:
        about = json.loads(file.read_text(encoding="utf-8"))
        missing = {"study", "title", "arms", "cases"} - set(about)
    except (OSError, ValueError, TypeError) as fault:
        raise ConfigError(
            f"{file}: cannot be read ({fault}); run `sgcad study` again, which writes the file"
        ) from fault
    if missing:
        raise ConfigError(
            f"{file}: {', '.join(sorted(missing))} missing; run `sgcad study` again, which writes the file"
        )
    return dict(about)


def _runs(folder: Path) -> dict[str, Any]:
    """Content like study.json's for a folder of runs."""
    found = defaultdict(list)
    for file in sorted(folder.glob("*/*/result.json")):
        found[file.parent.parent.name].append(file.parent.name)
    cases = sorted({case for names in found.values() for case in names})
    name = folder.resolve().name
    return {"study": name, "title": f"Runs in {name}", "cases": cases, "arms": [{"name": arm} for arm in found]}


def _arm(raw: Mapping[str, Any]) -> Arm:
    label, overrides = raw.get("label") or raw["name"], tuple(raw.get("set") or ())
    return Arm(raw["name"], label, raw.get("config") or "", overrides, raw.get("published"), raw.get("factors") or {})


def _labels(truth: Path, cases: Sequence[str]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    for case in cases:
        file = truth / f"{case}.json"
        if not file.is_file():
            continue
        label = read_json(file)
        if "network" not in label:
            raise ConfigError(f"{file}: no label (a JSON object with `network`); correct it or give another --truth")
        yield case, label


# ------------------------------------------------------------------ one case
def made_of(folder: Path, result: Mapping[str, Any]) -> GeneratedCase | None:
    """A generated case's roads and motion, to compare with its truth; None if missing or unreadable."""
    try:
        if result.get("status") != "generated":
            return None
        roads = road_counts(lanes_between((folder / "road.net.xml").read_text(encoding="utf-8")))
        return GeneratedCase(roads, paths_of(folder, result))
    except (OSError, ValueError, KeyError, TypeError, InvalidOutput):
        return None


def paths_of(folder: Path, result: Mapping[str, Any]) -> dict[str, Motion]:
    """The actors' motion by id, from trajectories.csv; empty where there is none. Raises ValueError if malformed."""
    file = folder / "trajectories.csv"
    if not file.is_file():
        return {}
    sizes = {a["id"]: (float(a["length_m"]), float(a["width_m"])) for a in result.get("actors", ())}
    rows: dict[str, list[tuple[float, ...]]] = defaultdict(list)
    head, *lines = file.read_text(encoding="utf-8").split()
    order = [head.split(",").index(name) for name in ("t_s", "x_m", "y_m", "heading_rad")]
    actor = head.split(",").index("actor")
    for line in lines:
        fields = line.split(",")
        if fields[-1] == ROLE:
            continue
        rows[fields[actor]].append(tuple(float(fields[k]) for k in order))
    found = {}
    for name, values in rows.items():
        table = np.array(sorted(values))
        found[name] = Motion(table[:, 0], table[:, 1:], sizes.get(name, DEFAULT_SIZE))
    return found


def _attempt(place: Path) -> AttemptRecord:
    findings = json.loads((place / "findings.json").read_text(encoding="utf-8"))
    return AttemptRecord(_STAGES[place.name.rpartition("-")[0]], tuple(Finding(**f) for f in findings))
