"""How many edits and seconds mend a case that came out wrong? A script mends it from its truth, fault by fault.

    python -m benchmarks.mending CASES TRUTH --out OUT [--form truth|incidents] [--most 20] [--only sgo]

Runs `sgcad evaluate` with the template config on copies of the cases, scores every case (`sgcad score`'s
marks, or those of benchmarks/incident_scores.py), and lays for each wrong measure the facts that the truth states over
the case with `flows.revising.revise`, until nothing is wrong or no fact is left. Facts of one measure are laid
together. Printed: one line a case and their sums. The script knows what is wrong, so this bounds the effort from below:
a person has to find the fault first.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.incident_scores import Run, scores
from flows import person, revising
from flows.results.reading import made_of
from sgcad_core.errors import SgcadError
from sgcad_core.metrics.truth import compare
from sgcad_core.revision.values import contacts_of

CONFIG = "template"
Facts = dict[str, object]
_SPECIES = {"cyclist": "bicycle", "pedestrian": "pedestrian"}
_DONE = {"lane_change": "lane_change_left"}
_SIDES = ("front", "back", "left", "right")


@dataclass
class Effort:
    """What it took to mend one case."""

    case: str
    wrong: list[str]
    left: list[str]
    edits: int
    seconds: list[float]
    refused: list[str]

    def line(self) -> str:
        """One line of the table."""
        end = "mended" if not self.left else f"left: {', '.join(self.left)}"
        refused = f"; refused: {self.refused[0][:110]}" if self.refused and self.left else ""
        longest = max(self.seconds, default=0.0)
        return (f"{self.case:32s} {self.edits:2d} edits {len(self.seconds):2d} runs {sum(self.seconds):5.1f} s "
                f"(longest {longest:4.1f})  {', '.join(self.wrong)}: {end}{refused}")  # fmt: skip


# ------------------------------------------------------------------ what is wrong
def wrong_of(form: str, folder: Path, truth: Mapping[str, Any]) -> list[str]:
    """Measures that a case's folder has wrong."""
    if form == "incidents":
        return [name for name, right in scores(Run.of(folder), truth).items() if not right and name != "whole"]
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    marks = compare(truth, made_of(folder, result)).items()
    return [f for f, mark in marks if not f.endswith("_any") and (mark > 0 if f.endswith("_error") else mark < 1)]


# ------------------------------------------------------------------ what the truth says of it
def facts_for(form: str, measure: str, truth: Mapping[str, Any], specs: person.Specs) -> Iterator[Facts]:
    """Facts that would put a measure right, tried in order; those of one try are laid together."""
    if form == "incidents":
        yield from _of_incident(measure, truth, specs)
    elif measure in ("maneuver", "initial_heading", "relative_heading"):
        yield from ({f"{v['id']}.heading": v["initial_heading"]} for v in _vehicles(truth) if v.get("initial_heading"))
        yield from ({f"{v['id']}.maneuver": how} for v in _vehicles(truth) if (how := _how(v)))
        yield {f"{v['id']}.maneuver": how for v in _vehicles(truth) if (how := _how(v))}
    elif measure.startswith("collision"):
        yield from _contact(truth)
    elif measure in ("legs", "intersection_count_error"):
        yield from ({"junction.kind": kind} for kind in _kinds(truth))
    elif measure in ("lane_count_error", "lanes_total"):
        yield from _lanes(truth, specs)
    elif measure == "vehicle_count":
        yield from ({f"{v['id']}.present": True} for v in _vehicles(truth))


def _vehicles(truth: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [v for v in truth.get("vehicles", ()) if str(v.get("id", "")).startswith("V")]


def _how(vehicle: Mapping[str, Any]) -> str | None:
    how = vehicle.get("manoeuvre_resolved") or vehicle.get("manoeuvre")
    return how if how in ("straight", "turn_left", "turn_right", "u_turn", "stopped", "parked") else None


def _contact(truth: Mapping[str, Any]) -> Iterator[Facts]:
    event = next((e for e in truth.get("events", ()) if str(e.get("other", "")).startswith("V")), None)
    if event is None:
        return
    pair: Facts = {"contacts.0.striker": event["actor"], "contacts.0.struck": event["other"]}
    for one in _areas(event.get("actor_area")):
        for two in _areas(event.get("other_area")):
            yield pair | {"contacts.0.striker_area": one, "contacts.0.struck_area": two}


def _areas(said: Any) -> list[str]:
    """The sides that a label allows: both of a corner."""
    parts = str(said or "").replace("rear", "back").split("_")
    return [part for part in parts if part in _SIDES] or ["front"]


def _kinds(truth: Mapping[str, Any]) -> list[str]:
    network = truth["network"]
    known = network.get("layout_best")
    by_count = {0: ["none"], 1: ["t", "four_leg", "driveway"]}.get(network.get("intersections") or 0, [])
    return list(dict.fromkeys([*([known] if known in ("t", "four_leg", "driveway") else []), *by_count]))


def _lanes(truth: Mapping[str, Any], specs: person.Specs) -> Iterator[Facts]:
    """Lanes leg by leg as the drawing's truth has them; of coded totals every even split of a road's axis."""
    segments = truth["network"].get("segments") or ()
    names = {road.id for road in specs.road.roads} if specs.road else set()
    told: Facts = {}
    for segment in segments:
        if segment.get("compass") in names:
            inward = str(segment["to"]).upper().startswith("J")
            ways = ("lanes_towards_to", "lanes_towards_from") if inward else ("lanes_towards_from", "lanes_towards_to")
            told |= {f"roads.{segment['compass']}.lanes_forward": segment[ways[0]] or 0,
                     f"roads.{segment['compass']}.lanes_backward": segment[ways[1]] or 0}  # fmt: skip
    if told:
        yield told
    for road in truth["network"].get("roads", ()):
        for axis in (("N", "S"), ("E", "W"), ("NE", "SW"), ("SE", "NW")):
            if road.get("lanes_total") and set(axis) <= names:
                yield _split(axis, int(road["lanes_total"]), road.get("lanes_scope") == "both_directions")


def _split(axis: tuple[str, str], total: int, both: bool) -> Facts:
    """A total spread over both directions of a road, or given to each of them."""
    ahead, back = (total - total // 2, total // 2) if both else (total, total)
    first, second = axis
    return {f"roads.{first}.lanes_forward": ahead, f"roads.{first}.lanes_backward": back,
            f"roads.{second}.lanes_forward": back, f"roads.{second}.lanes_backward": ahead}  # fmt: skip


def _of_incident(measure: str, truth: Mapping[str, Any], specs: person.Specs) -> Iterator[Facts]:
    met = contacts_of(specs.behavior)[:1] if specs.behavior else ()
    other = next((n for c in met for n in (c.striker, c.struck) if n != "V1"), "V2")
    if measure in ("subject_manoeuvre", "other_manoeuvre"):
        role = measure.partition("_")[0]
        how = str(truth[role]["manoeuvre"])
        yield {f"{'V1' if role == 'subject' else other}.maneuver": _DONE.get(how, how)}
        if how == "lane_change":
            yield {f"{'V1' if role == 'subject' else other}.maneuver": "lane_change_right"}
    elif measure == "areas":
        for one in (s for code in truth["subject"]["areas"] for s in _areas(code)):
            for two in (s for code in truth["other"]["areas"] for s in _areas(code)):
                yield _touch(other, one, two)
    elif measure == "intersection":
        yield from ({"junction.kind": kind} for kind in ("four_leg", "t"))
    elif measure in ("contact", "actors", "generated"):
        kind = truth["other"]["kind"]
        name = {"pedestrian": "P1", "cyclist": "B1", "object": "O1", "animal": "A1"}.get(kind, "V2")
        is_thing = name[0] in "OA"
        added: Facts = {f"{name}.present": True, f"{name}.kind": _SPECIES.get(kind, "object" if is_thing else "car")}
        if truth["contact"]:
            yield _touch(other if specs.behavior and other != "V2" else name, "front", "back")
            yield added | _touch(name, "front", "back" if name == "V2" else "left")
        else:
            yield {"near_crash": True}


def _touch(other: str, mine: str, theirs: str) -> Facts:
    return {"contacts.0.striker": "V1", "contacts.0.struck": other,
            "contacts.0.striker_area": mine, "contacts.0.struck_area": theirs}  # fmt: skip


# ------------------------------------------------------------------ mending
def mend(form: str, folder: Path, truth: Mapping[str, Any], limit_s: float = 60.0) -> Effort:
    """Mend one case as far as its truth's facts lead; a try that leaves as much wrong as before is undone."""
    wrong = wrong_of(form, folder, truth)
    effort = Effort(folder.name, wrong, list(wrong), 0, [], [])
    started = time.perf_counter()
    for measure in wrong:
        for facts in facts_for(form, measure, truth, person.read_specs(folder)):
            if measure not in effort.left or time.perf_counter() - started > limit_s:
                break
            _try(form, folder, truth, facts, effort)
    return effort


def _try(form: str, folder: Path, truth: Mapping[str, Any], facts: Facts, effort: Effort) -> None:
    try:
        revised = revising.revise(folder, facts, who="benchmark")
    except SgcadError as fault:
        effort.refused.append(str(fault))
        return
    if not revised.changed:
        return
    effort.seconds.append(revised.seconds)
    left = wrong_of(form, folder, truth)
    if len(left) < len(effort.left):
        effort.edits += len(facts)
        effort.left = left
    else:
        revising.undo(folder)


def main() -> None:
    """Run, mend, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", type=Path)
    parser.add_argument("truth", type=Path)
    parser.add_argument("--out", type=Path, required=True, help="an empty folder: cases are copied there, and mended")
    parser.add_argument("--form", choices=("truth", "incidents"), default="truth")
    parser.add_argument("--most", type=int, help="wrong cases at most, in the order of their names")
    parser.add_argument("--only", default="", help="cases whose name begins so")
    args = parser.parse_args()
    names = [f.stem for f in sorted(args.truth.glob(f"{args.only}*.json")) if (args.cases / f.stem).is_dir()]
    for name in names:
        shutil.copytree(args.cases / name, args.out / "cases" / name, dirs_exist_ok=True)
    command = [sys.executable, "-c", "from flows.cli import main; main()", "evaluate", str(args.out / "cases")]
    subprocess.run([*command, "--config", CONFIG, "--out", str(args.out / "runs")], check=False,  # noqa: S603 - ours
                   stdout=subprocess.DEVNULL)  # fmt: skip
    print("\n".join(table(args.form, args.truth, names, args.out / "runs" / CONFIG, args.most)))  # noqa: T201 - a command prints


def table(form: str, truth: Path, names: Sequence[str], runs: Path, most: int | None) -> list[str]:
    """A line a wrong case, then their sums."""
    known = {name: json.loads((truth / f"{name}.json").read_text(encoding="utf-8")) for name in names}
    faulty = [name for name in names if wrong_of(form, runs / name, known[name])][:most]
    done = [mend(form, runs / name, known[name]) for name in faulty]
    return [*(effort.line() for effort in done), *_sums(done, len(names))]


def _sums(done: Sequence[Effort], of: int) -> list[str]:
    mended = [effort for effort in done if not effort.left]
    if not done:
        return [f"none of {of} cases is wrong"]
    runs = [seconds for effort in done for seconds in effort.seconds]
    edits = [effort.edits for effort in mended] or [0]
    under = f"{sum(s < 2 for s in runs)} of {len(runs)} under 2"
    return [
        f"{len(done)} wrong cases of {of}; {len(mended)} mended",
        f"edits a mended case: median {median(edits):g}, most {max(edits)}",
        f"seconds a revision: median {median(runs or [0]):.2f}, longest {max(runs, default=0):.2f}; {under}",
    ]


if __name__ == "__main__":
    main()
