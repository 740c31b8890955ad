"""Do maneuver events tell the same crash as timed polylines? Positions and contacts of both encodings of one plan.

    python -m research.benchmarks.scenes.encodings RUNS [--judge esmini] [--path BINARY] [--cases]

RUNS were written with the timed encoding: every trajectories.csv in it is a plan. Its events are written (as `sgcad
generate --encoding events` does) and played by our player and by the judge. Per player: how often the first contact is
the declared one, and how far the box centers lie from the plan until the planned contact (to the end without one), over
all rows and over those on straights, where the plan bends by less than 1 / 200 m. Then what the files are made of.
`--cases` names every actor that is farther away than 0.5 m, and every other contact.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np

from flows.case_files import case_folder
from sgcad_core.case.records import ActorInfo, Execution, Floats, RoadNetwork, Scenario, Trajectory
from sgcad_core.errors import SgcadError
from sgcad_core.execution.contact import realised
from sgcad_core.execution.event_encoding import write_editable
from sgcad_core.execution.playback import execution_of, played
from sgcad_core.formats.openscenario.writing.events import Handover
from sgcad_core.formats.openscenario.writing.writer import DEFAULT_VERSION, Version
from sgcad_core.formats.xml import parse_xml
from sgcad_core.interfaces import Simulator
from sgcad_core.records.specs import Contact
from sgcad_core.registry import plugin_class

LIMIT_M = 0.5
STRAIGHT_PER_M = 1 / 200
OVER_ROWS = 5
"""Curvature is that of this many rows to either side."""
ELEMENTS = (
    "AssignRouteAction", "LaneChangeAction", "LaneOffsetAction", "FollowTrajectoryAction", "AbsoluteTargetSpeed",
    "SynchronizeAction", "RelativeDistanceCondition", "TraveledDistanceCondition", "DistanceCondition",
    "SimulationTimeCondition", "CollisionCondition",
)  # fmt: skip


@dataclass
class Seen:
    """What one player makes of all files; distances by actor."""

    declared: int = 0
    realised: int = 0
    everywhere: list[float] = field(default_factory=list)
    straight: list[float] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 where fewer than 90 % of the contacts come or an actor on a straight is beyond the limit."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--judge", default="", help="a second simulator, such as esmini")
    parser.add_argument("--path", default="", help="its binary, if it has one; default: variable or PATH")
    parser.add_argument("--openscenario", default=DEFAULT_VERSION, help="the version to write")
    parser.add_argument("--cases", action="store_true", help="name what is counted against")
    options = parser.parse_args(arguments)
    try:
        judge = _simulator(options.judge, options.path) if options.judge else None
        seen, told = measured(options.runs, judge, cast("Version", options.openscenario))
    except SgcadError as fault:
        sys.stderr.write(f"{fault}\n")
        return 2
    if not told:
        sys.stderr.write(f"{options.runs}: no trajectories.csv beside a road.xodr; give a folder of runs\n")
        return 2
    sys.stdout.write(table(seen, told, cases=options.cases))
    return int(not all(_passes(s) for s in seen.values()))


def _simulator(name: str, path: str) -> Simulator:
    fields: dict[str, Any] = {"path": path} if path else {}
    simulator = cast("Simulator", plugin_class("simulator", name)(**fields))
    simulator.ready()
    return simulator


def _passes(seen: Seen) -> bool:
    return seen.realised >= 0.9 * seen.declared and max(seen.straight, default=0.0) <= LIMIT_M


def measured(runs: Path, judge: Simulator | None, version: Version) -> tuple[dict[str, Seen], Counter[str]]:
    """What each player makes of the events of all plans under a folder, and how often the files use each element."""
    seen: dict[str, Seen] = defaultdict(Seen)
    told: Counter[str] = Counter()
    for case in sorted(file.parent for file in runs.glob("**/trajectories.csv")):
        if not (case / "road.xodr").is_file():
            continue
        plan, scenario, network = _events(case, version)
        told.update(cases=1, actors=len(scenario.actors))
        told.update(el.tag for el in parse_xml(scenario.xosc or "", "xosc").iter() if el.tag in ELEMENTS)
        for name, execution in _executions(scenario, network, judge):
            _count(case.name, plan, scenario, execution, seen[name])
    return dict(seen), told


def _events(case: Path, version: Version) -> tuple[tuple[Trajectory, ...], Scenario, RoadNetwork]:
    result: dict[str, Any] = json.loads((case / "result.json").read_text(encoding="utf-8"))
    actors = tuple(ActorInfo.model_validate(actor) for actor in result["actors"])
    declared = result["collision"]["declared"]
    network = RoadNetwork(xodr=(case / "road.xodr").read_text(encoding="utf-8"))
    scenario = Scenario(actors=actors, declared=Contact.model_validate(declared) if declared else None)
    plan = tuple(case_folder.read_trajectories(case / "trajectories.csv"))
    contact = execution_of("plan", scenario, plan).contact
    text = write_editable(actors, plan, None, Handover(contact, network.xodr), version)
    return plan, scenario.model_copy(update={"xosc": text}), network


def _executions(scenario: Scenario, network: RoadNetwork, judge: Simulator | None) -> Iterator[tuple[str, Execution]]:
    yield "ours", execution_of("ours", scenario, played(scenario, network))
    if judge is not None:
        yield type(judge).__name__.lower(), judge.execute(scenario, network)


def _count(case: str, plan: Sequence[Trajectory], scenario: Scenario, execution: Execution, seen: Seen) -> None:
    contact = execution_of("plan", scenario, plan).contact
    if scenario.declared and realised(scenario.declared, contact):
        seen.declared += 1
        if realised(scenario.declared, execution.contact):
            seen.realised += 1
        else:
            seen.lines.append(f"{case}: first contact {execution.contact}")
    until_s = contact.t_s if contact else float(plan[0].t_s[-1])
    for wanted in plan:
        found = next(t for t in execution.trajectories if t.actor == wanted.actor)
        away, straight = _away(wanted, found, until_s)
        seen.everywhere.append(float(away.max(initial=0.0)))
        seen.straight.append(float(away[straight].max(initial=0.0)))
        if seen.everywhere[-1] > LIMIT_M:
            seen.lines.append(f"{case} {wanted.actor}: {seen.everywhere[-1]:.2f} m, {seen.straight[-1]:.2f} straight")


def _away(wanted: Trajectory, found: Trajectory, until_s: float) -> tuple[Floats, Floats]:
    """Distance at every row before a time, and whether the plan is straight there."""
    n = int(np.searchsorted(wanted.t_s, until_s - 1e-6))
    t_s = wanted.t_s[:n]
    x, y = (np.interp(t_s, found.t_s, v) for v in (found.x_m, found.y_m))
    away = np.hypot(wanted.x_m[:n] - x, wanted.y_m[:n] - y)
    rows = np.arange(n)
    low, high = np.maximum(rows - OVER_ROWS, 0), np.minimum(rows + OVER_ROWS, len(wanted.t_s) - 1)
    way = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(wanted.x_m), np.diff(wanted.y_m)))))
    turned = np.abs(wanted.heading_rad[high] - wanted.heading_rad[low])
    return away, turned <= STRAIGHT_PER_M * (way[high] - way[low]) + 1e-6


def table(seen: dict[str, Seen], told: Counter[str], *, cases: bool = False) -> str:
    """The Markdown table of players, then the elements, then what is counted against if asked for."""
    head = (
        f"| player | declared contact | actors within {LIMIT_M:g} m | on straights | median m | most m | straight m |"
    )
    lines = [f"{told['cases']} cases, {told['actors']} actors", "", head, "|" + "---|" * (head.count("|") - 1)]
    lines += [_row(name, s) for name, s in seen.items()]
    lines += ["", *(f"{told[name]:5} {name}" for name in ELEMENTS)]
    if cases:
        lines += [f"{name}: {line}" for name, s in seen.items() for line in s.lines]
    return "\n".join([*lines, ""])


def _row(name: str, seen: Seen) -> str:
    within = [sum(d <= LIMIT_M for d in away) for away in (seen.everywhere, seen.straight)]
    cells = (
        name, f"{seen.realised} of {seen.declared}", f"{within[0]} of {len(seen.everywhere)}",
        f"{within[1]} of {len(seen.straight)}", f"{np.median(seen.everywhere):.3f}", f"{max(seen.everywhere):.3f}",
        f"{max(seen.straight):.3f}",
    )  # fmt: skip
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    sys.exit(main())
