"""Whether vehicles drive where they are told to: one table of a runs folder, for each config.

    python -m research.benchmarks.scenes.lanes RUNS [CONFIG ...] [--cases]

Reads road.net.xml, trajectories.csv, result.json and report.txt of every case; nothing that a run says of its own
places is believed. Counted are vehicles that drive in lanes, up to their own first touch (`lane_places`):

- *untold*: more than half a second on the wrong side, beside or off the lanes, though the report (as the rules read it)
  tells nothing of the kind; and how many of these cases are called whole
- *told lane*: the lane is that told, by number or word, of those whose report tells one; lane changes start in it
- *center lane*: of those told to be in a two-way left-turn lane how many are in it before they turn
- *lane changes out*: of lane changes, merges and those that overtake on several lanes how many leave their carriageway
- *turns ended*: of turns that no contact ends before they are a second on the lanes behind them, how many are within 15
  degrees of the lane there

`--cases` names every vehicle that is counted against.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from flows.case_files.case_folder import read_trajectories
from research.benchmarks.run_tables import by_config, options_of, show
from sgcad_core.case.records import ActorInfo, Trajectory, sizes_of
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.geometry.plane import Floats, wrap_angle
from sgcad_core.metrics.drivability import STEP_S, first_touches
from sgcad_core.metrics.lane_places import LaneSteps, lane_heading, lane_steps
from sgcad_core.metrics.told_lanes import told_lane
from sgcad_core.metrics.untold_places import MOST_S, judged, untold_places
from sgcad_core.reading.reading import Reading, read
from sgcad_core.roads.lane_graph import LaneGraph

TURNED_DEG = 15.0
_STANDS_MPS = 0.5
_BEHIND_S = 1.0
"""Time on the lanes behind a turn from which on a contact does not end it."""
_CHANGES = ("lane_change_left", "lane_change_right", "merge")
_TURNS = ("turn_left", "turn_right")
HEAD = (
    "| config | cases | vehicles | untold | share | cases called whole | told lane | center lane | lane changes out | "
    "turns ended |"
)


@dataclass
class Figures:
    """Counts over the cases of one config; `lines` name what is counted against."""

    counts: Counter[str] = field(default_factory=Counter)
    lines: list[str] = field(default_factory=list)

    def judge(self, what: str, right: bool, line: str) -> None:
        """Count one that is right or wrong."""
        self.counts[what] += 1
        self.counts[f"{what} right"] += right
        if not right:
            self.lines.append(f"{what}: {line}")


@dataclass(frozen=True)
class Run:
    """One case's folder."""

    folder: Path

    @cached_property
    def result(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads((self.folder / "result.json").read_text(encoding="utf-8"))
        return found

    @cached_property
    def actors(self) -> dict[str, ActorInfo]:
        return {a["id"]: ActorInfo.model_validate(a) for a in self.result["actors"]}

    @cached_property
    def motions(self) -> tuple[Trajectory, ...]:
        return read_trajectories(self.folder / "trajectories.csv")

    @cached_property
    def touches(self) -> dict[str, int]:
        return first_touches(self.motions, sizes_of(self.actors.values()))

    @cached_property
    def graph(self) -> LaneGraph:
        return parse_net((self.folder / "road.net.xml").read_text(encoding="utf-8"))

    @cached_property
    def reading(self) -> Reading:
        return read((self.folder / "report.txt").read_text(encoding="utf-8"))

    def before(self, motion: Trajectory) -> Floats:
        """(n, 3) poses up to the first touch of the actor, else of any other."""
        ends = min(self.touches.values(), default=None)
        return motion.pose[: self.touches.get(motion.actor, ends)]


def count(folder: Path, figures: Figures) -> None:
    """Add one case's folder to the counts."""
    figures.counts["cases"] += 1
    if not (folder / "trajectories.csv").exists():
        return
    run = Run(folder)
    whole = (run.result.get("account") or {}).get("verdict") == "whole"
    told = run.reading.crash, run.reading.lost_control
    found = {one.actor: one for one in untold_places(run.graph, run.motions, [*run.actors.values()], *told)}
    figures.counts["untold whole"] += bool(found) and whole
    for motion in run.motions:
        actor = run.actors[motion.actor]
        if not judged(actor):
            continue
        named = f"{folder.name} {actor.id} ({actor.maneuver}{', whole' if whole else ''})"
        figures.judge(
            "place", actor.id not in found, f"{named}: {found[actor.id].words() if actor.id in found else ''}"
        )
        before = run.before(motion)
        if len(before) > 1:
            _lanes(run, actor, before, named, figures)
            _turn(run, actor, motion, named, figures)


# ------------------------------------------------------------------ lanes
def _lanes(run: Run, actor: ActorInfo, before: Floats, named: str, figures: Figures) -> None:
    steps = lane_steps(run.graph, before)
    vehicle = run.reading.crash.vehicle(actor.id)
    told = told_lane(vehicle) if vehicle else None
    if told is not None and any(steps.lanes):
        what = "center" if told.center else "told lane"
        figures.judge(what, told.taken(run.graph, steps), f"{named}: {told.words()} is told, it is {_seen(steps)}")
    if actor.maneuver in _CHANGES:
        out = np.isin(steps.places, ("opposing", "off"))
        figures.judge("change", out.sum() * STEP_S <= MOST_S, f"{named}: {out.sum() * STEP_S:.1f} s out")


def _seen(steps: LaneSteps) -> str:
    return f"first in {steps.lanes[0] or steps.places[0]}, last in {steps.lanes[-1] or steps.places[-1]}"


# ------------------------------------------------------------------ turns
def _turn(run: Run, actor: ActorInfo, motion: Trajectory, named: str, figures: Figures) -> None:
    """A turn that comes to the lanes behind it, or that no contact ends, follows the lane there."""
    if actor.maneuver not in _TURNS:
        return
    pose = motion.pose[: run.touches.get(actor.id)]
    steps, turned = lane_steps(run.graph, pose), np.unwrap(pose[:, 2])
    crossed = np.flatnonzero(np.array(steps.places) == "junction")
    behind = [k for k in range(int(crossed[0]), len(pose)) if steps.lanes[k]] if len(crossed) else []
    if (actor.id in run.touches and len(behind) * STEP_S < _BEHIND_S) or motion.speed_mps[len(pose) - 1] < _STANDS_MPS:
        return  # the contact ends it, or it has stopped
    way = lane_heading(run.graph, pose[behind[-1]]) if behind else None
    if way is not None:
        off = abs(np.degrees(float(wrap_angle(turned[behind[-1]] - way))))
        around = abs(np.degrees(turned[behind[-1]] - turned[0]))
        figures.judge("turn", bool(off <= TURNED_DEG), f"{named}: {off:.0f} degrees off its lane, turned {around:.0f}")
    else:
        figures.judge("turn", False, f"{named}: no contact, and it does not come out of the junction")


# ------------------------------------------------------------------ the table
def table(runs: Path, configs: Sequence[str], *, cases: bool = False) -> str:
    """The Markdown table of all configs in a folder, or of those named; with those counted against below it."""
    found = by_config(runs, configs, Figures, count)
    lines = [HEAD, "|" + "---|" * (HEAD.count("|") - 1), *(_row(name, f) for name, f in found.items())]
    named = (f"{name}: {line}" for name, figures in found.items() for line in sorted(figures.lines))
    return "\n".join([*lines, *named] if cases else lines)


def _row(name: str, figures: Figures) -> str:
    c = figures.counts
    off = c["place"] - c["place right"]
    cells = (
        name, c["cases"], c["place"], off, f"{100 * off / max(c['place'], 1):.1f} %", c["untold whole"],
        *(f"{c[f'{what} right']} of {c[what]}" for what in ("told lane", "center")),
        f"{c['change'] - c['change right']} of {c['change']}", f"{c['turn right']} of {c['turn']}",
    )  # fmt: skip
    return "| " + " | ".join(map(str, cells)) + " |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    options = options_of(__doc__, arguments, "name every vehicle that is counted against")
    show(table(options.runs, options.configs, cases=options.cases))


if __name__ == "__main__":
    main()
