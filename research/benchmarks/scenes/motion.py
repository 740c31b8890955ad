"""Whether the motions of a runs folder can be driven, and whether what collides stays apart: one table a config.

    python -m research.benchmarks.scenes.motion RUNS [CONFIG ...] [--cases]

Reads trajectories.csv, result.json and report.txt of every case; nothing that a run says about its own motion is
believed. Vehicles are held to the limits of `sgcad_core.metrics.thresholds` up to their own first touch; a report that
tells a loss of control excuses slip and yaw, not friction. Depths of overlap are those of boxes, after the first touch;
at poles and other narrow things, at which vehicles crush, only what overlaps at rest counts.
A stated speed (as the rules read it) is reached where the vehicle drives it, to 5 % or 0.5 m/s, at some time up to its
first touch. `--cases` names every vehicle and pair that is counted.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from flows.case_files.case_folder import read_trajectories
from research.benchmarks.run_tables import by_config, options_of, show
from sgcad_core.case.records import Trajectory
from sgcad_core.geometry.plane import Size
from sgcad_core.kinds import actor_kind
from sgcad_core.metrics.drivability import deepest_overlap, driving_peaks, first_touches
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.aftermath.crush import NARROW_M
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.reading.reading import read
from sgcad_core.units import MPS_PER_MPH

DEEP_M = 0.05
STILL_MPS = 0.2
"""The file's last centimetres are driven evenly to its end (vertices nearer than 0.11 m are not written)."""
HEAD = (
    "| config | cases | with motion | declared contact realised | vehicles over friction | over {yaw:g} rad/s | "
    "slip over {slip:g} degrees | overlap at rest | deeper than {deep:g} cm | still moving at the end | "
    "stated speeds reached |"
)


@dataclass
class Figures:
    """Counts over the cases of one config; `lines` name what is counted."""

    cases: int = 0
    moving: int = 0
    declared: int = 0
    realised: int = 0
    lateral: int = 0
    yaw: int = 0
    slip: int = 0
    rest: int = 0
    deep: int = 0
    unrested: int = 0
    stated: int = 0
    reached: int = 0
    lines: list[str] = field(default_factory=list)


def read_motions(file: Path) -> tuple[Trajectory, ...]:
    """The trajectories of a trajectories.csv, in the order of their names."""
    return tuple(sorted(read_trajectories(file), key=lambda t: t.actor))


def count(case: Path, figures: Figures) -> None:
    """Add one case's folder to the counts."""
    result = json.loads((case / "result.json").read_text(encoding="utf-8"))
    figures.cases += 1
    if result["collision"]["declared"]:
        figures.declared += 1
        figures.realised += bool(result["collision"]["realised"])
    if not (case / "trajectories.csv").exists():
        return
    figures.moving += 1
    motions = read_motions(case / "trajectories.csv")
    sizes = {a["id"]: (a["length_m"], a["width_m"]) for a in result["actors"]}
    touches = first_touches(motions, sizes)
    reading = read((case / "report.txt").read_text(encoding="utf-8"))
    kinds = {a["id"]: a for a in result["actors"]}
    for motion in motions:
        if actor_kind(kinds[motion.actor]["type"]).wheeled:
            _vehicle(case.name, motion, kinds[motion.actor], (touches, reading.crash, reading.lost_control), figures)
    poles = {name for name, a in kinds.items() if actor_kind(a["type"]).thing and max(sizes[name]) <= NARROW_M}
    _overlaps(case.name, motions, sizes, poles, figures)


def _vehicle(
    case: str,
    motion: Trajectory,
    actor: dict[str, Any],
    told: tuple[dict[str, int], CrashFacts, bool],
    figures: Figures,
) -> None:
    touches, facts, lost = told
    until = touches.get(motion.actor)
    seen = driving_peaks(motion, actor["length_m"], until, backing=actor["maneuver"] == "backing")
    over = seen.excesses(facts.surface)
    excused = [word for word in over if lost and not word.startswith("lateral")]
    counted = [word for word in over if word not in excused]
    for name, word in (("lateral", "lateral"), ("yaw", "yaw"), ("slip", "slip")):
        setattr(figures, name, getattr(figures, name) + any(w.startswith(word) for w in counted))
    if counted:
        figures.lines.append(f"{case} {motion.actor} ({actor['maneuver']}): {'; '.join(counted)}")
    vehicle = facts.vehicle(motion.actor)
    if vehicle is not None and vehicle.speed_mph and not vehicle.standing:
        _speed(case, motion, until, vehicle.speed_mph * MPS_PER_MPH, figures)


def _speed(case: str, motion: Trajectory, until: int | None, told_mps: float, figures: Figures) -> None:
    before = motion.speed_mps[: until + 1 if until is not None else None]
    nearest = float(before[np.argmin(np.abs(before - told_mps))])
    figures.stated += 1
    if abs(nearest - told_mps) <= max(0.05 * told_mps, 0.5):
        figures.reached += 1
    else:
        figures.lines.append(f"{case} {motion.actor}: told {told_mps:.1f} m/s, drives up to {before.max():.1f}")


def _overlaps(
    case: str, motions: tuple[Trajectory, ...], sizes: dict[str, Size], poles: set[str], figures: Figures
) -> None:
    """Vehicles crush at `poles`: there only what overlaps at rest counts."""
    rest, who = deepest_overlap(motions, sizes, at_rest=True)
    deep, pair = deepest_overlap([m for m in motions if m.actor not in poles], sizes)
    figures.rest += rest > 0
    figures.deep += deep > DEEP_M
    moving = [m.actor for m in motions if m.actor in first_touches(motions, sizes) and m.speed_mps[-1] > STILL_MPS]
    figures.unrested += bool(moving)
    if rest > 0:
        figures.lines.append(f"{case}: {who} overlap by {rest:.2f} m at rest")
    if deep > DEEP_M:
        figures.lines.append(f"{case}: {pair} overlap by {deep:.2f} m")
    if moving:
        figures.lines.append(f"{case}: {', '.join(moving)} still moving at the end")


def table(runs: Path, configs: list[str], *, cases: bool = False) -> str:
    """The Markdown table of all configs in a folder, or of those named; with the cases counted below it."""
    found = by_config(runs, configs, Figures, count)
    head = HEAD.format(yaw=DRIVING.yaw_radps, slip=DRIVING.slip_deg, deep=100 * DEEP_M)
    lines = [head, "|" + "---|" * (head.count("|") - 1), *(_row(name, f) for name, f in found.items())]
    return "\n".join([*lines, *_named(found)] if cases else lines)


def _named(found: dict[str, Figures]) -> Iterator[str]:
    for name, figures in found.items():
        yield from (f"{name}: {line}" for line in figures.lines)


def _row(name: str, f: Figures) -> str:
    cells = (
        name, f.cases, f.moving, f"{f.realised} of {f.declared}", f.lateral, f.yaw, f.slip, f.rest, f.deep,
        f.unrested, f"{f.reached} of {f.stated}",
    )  # fmt: skip
    return "| " + " | ".join(str(c) for c in cells) + " |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    options = options_of(__doc__, arguments, "name every vehicle and pair that is counted")
    show(table(options.runs, options.configs, cases=options.cases))


if __name__ == "__main__":
    main()
