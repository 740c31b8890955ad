"""Whether vehicles come to rest as told, and as bodies do: one table of a runs folder, for each config.

    python -m research.benchmarks.scenes.endings RUNS [CONFIG ...] [--cases]

Reads road.net.xml, trajectories.csv, result.json and report.txt of every case; nothing that a run says of its own
motion is believed. What is told is what the rules read in the report. Counted of told endings:

- *zone and side*: the last place is in the told zone, on the told side of it (`rest_error`)
- *lane*: the last place is in the told lane, or in one of the told direction
- *facing*: within 20 degrees
- *distance*: between the place of the first contact and the last one, within 30 % or a metre
- *spin*: the vehicle turns to the told side after its first contact, and by the told angle within a quarter of it or 30
  degrees

and of all vehicles that touch something:

- *crawls*: more than 2.5 s at a stretch in which it slows by less than 1.3 m/s2 (half of the friction where that is
  less: on ice) and does not stand
- *bends*: the way turns by more than 60 degrees between two contacts, or behind the last one
- *dead stops*: from more than 5 m/s it stands within 0.2 s and keeps its heading, at a thing that is no wall and no
  vehicle

`--cases` names every vehicle that is counted against. A vehicle that is told to roll over slides on its side: it has no
facing, no spin and no crawl.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from research.benchmarks.run_tables import by_config, options_of, show
from research.benchmarks.scenes.lanes import Figures, Run
from sgcad_core.case.records import sizes_of
from sgcad_core.geometry.plane import Floats, runs, wrap_angle
from sgcad_core.kinds import actor_kind
from sgcad_core.metrics.drivability import STEP_S
from sgcad_core.metrics.labels.motion_label_match import Path as Way
from sgcad_core.metrics.labels.observed_crash import Crash
from sgcad_core.metrics.rest_error import SPINS_RAD, near_m, near_turn_rad, rest_errors
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.records.course import CourseTold

CRAWLS_MPS2, CRAWLS_S = 1.3, 2.5
BENDS_DEG = 60.0
DEAD_MPS, DEAD_S, DEAD_DEG = 5.0, 0.2, 3.0
_MOVES_MPS, _STANDS_MPS = 0.7, 0.3
_BLOW = 6
"""Samples of an impact, behind which the way begins."""
_RATE = 10
"""Samples over which a deceleration is taken."""
_WALL_M = 2.5
"""A wider thing stops a vehicle as a wall does."""
TOLD = ("zone and side", "lane", "facing", "distance", "spin")
FAULTS = ("crawls", "bends", "dead stops")
HEAD = "| config | cases | vehicles | " + " | ".join((*TOLD, *FAULTS)) + " |"


class Ended(NamedTuple):
    """One vehicle that touches something: (n, 3) poses 0.05 s apart, the samples of its touches, what it touches."""

    pose: Floats
    hits: tuple[int, ...]
    others: tuple[str, ...]

    @property
    def turned_deg(self) -> float:
        """Rotation from its first contact to its rest, left positive."""
        return math.degrees(float(wrap_angle(np.diff(self.pose[self.hits[0] - 1 :, 2])).sum()))

    @property
    def distance_m(self) -> float:
        """From the place of its first contact to that of its rest."""
        return math.dist(self.pose[self.hits[0], :2], self.pose[-1, :2])

    @property
    def speed(self) -> Floats:
        """(n - 1,) m/s between the samples."""
        found: Floats = np.hypot(*np.diff(self.pose[:, :2], axis=0).T) / STEP_S
        return found

    def crawls_s(self, least_mps2: float = CRAWLS_MPS2) -> float:
        """The longest time at a stretch in which it slows by less, and moves."""
        speed = self.speed[self.hits[0] + _BLOW :]
        rate = (speed[:-_RATE] - speed[_RATE:]) / (_RATE * STEP_S)
        slow = (rate < least_mps2) & (speed[:-_RATE] > _STANDS_MPS) & (speed[_RATE:] > 0.0)
        return max((last - first + 1 for first, last in runs(slow)), default=0) * STEP_S

    @property
    def bends_deg(self) -> float:
        """The most that the way turns between two contacts, or behind the last one."""
        return max(map(self._bend_deg, self.hits, (*self.hits[1:], len(self.pose))))

    def _bend_deg(self, begin: int, end: int) -> float:
        moves = np.diff(self.pose[begin + _BLOW : end, :2], axis=0)
        moves = moves[np.hypot(*moves.T) > _MOVES_MPS * STEP_S]
        if len(moves) < 2:
            return 0.0
        way = np.unwrap(np.arctan2(moves[:, 1], moves[:, 0]))
        return math.degrees(float(np.abs(way - way[0]).max()))

    def stops_dead(self, hit: int) -> bool:
        """Whether it stands shortly behind a touch, and keeps its heading."""
        speed, last = self.speed, min(hit + round(DEAD_S / STEP_S), len(self.pose) - 2)
        turned = abs(float(wrap_angle(self.pose[-1:, 2] - self.pose[max(hit - 1, 0), 2])[0]))
        came = float(speed[max(hit - 2, 0) : hit + 1].max())
        return came > DEAD_MPS and float(speed[last]) < _STANDS_MPS and math.degrees(turned) < DEAD_DEG


def endings(crash: Crash) -> dict[str, Ended]:
    """Every actor that touches something."""
    found = {}
    for actor, path in crash.paths.items():
        mine = [(t, b if a == actor else a) for t, a, b in crash.touches if actor in (a, b)]
        hits = tuple(int(np.searchsorted(path.t_s, t - 1e-6)) for t, _ in mine)
        if hits and hits[0] > 0:
            found[actor] = Ended(path.pose, hits, tuple(other for _, other in mine))
    return found


# ------------------------------------------------------------------ what is told
class Seen(NamedTuple):
    """A told part of an ending, whether it is met, and what is there."""

    part: str
    met: bool
    words: str


def told_parts(one: Ended, told: CourseTold, crash: Crash) -> Iterator[Seen]:
    """The told parts of a vehicle's ending, each against its motion."""
    rest = told.rest
    errors = rest_errors(rest, one.pose[-1:], float(one.pose[one.hits[0] - 1, 2]), crash.surface, one.pose[0])
    if errors.where_m is not None:
        met = all(error[0] <= 1e-9 for error in (errors.where_m, errors.side_rad) if error is not None)
        side = f", {math.degrees(errors.side_rad[0]):.0f} degrees" if errors.side_rad is not None else ""
        yield Seen("zone and side", met, f"{rest.where} {rest.side or ''}: off by {errors.where_m[0]:.1f} m{side}")
    if errors.lane_m is not None:
        lane = f"{rest.lane or 'lanes'} {rest.lane_way or ''}: off by {errors.lane_m[0]:.1f} m"
        yield Seen("lane", bool(errors.lane_m[0] <= 1e-9), lane)
    if errors.facing_rad is not None and not told.rolls:
        yield Seen(
            "facing", bool(errors.facing_rad[0] <= 1e-9), f"off by {math.degrees(errors.facing_rad[0]) + 20:.0f}"
        )
    if rest.distance_m is not None:
        off = abs(one.distance_m - rest.distance_m)
        yield Seen("distance", off <= near_m(rest.distance_m), f"{one.distance_m:.1f} m, told {rest.distance_m:.1f}")
    if (told.spin or told.spin_deg) and not told.rolls:
        way = {"counterclockwise": 1.0, "clockwise": -1.0}.get(told.spin or "", math.copysign(1.0, one.turned_deg))
        turned = way * one.turned_deg
        met = turned > math.degrees(SPINS_RAD)
        if told.spin_deg:
            met &= abs(math.radians(turned - told.spin_deg)) <= near_turn_rad(math.radians(told.spin_deg))
        yield Seen("spin", met, f"{turned:.0f} degrees {told.spin or 'either way'}, told {told.spin_deg or 'none'}")


class Place(NamedTuple):
    """Where vehicles come to rest: things that are no walls, and the least deceleration that is no crawl."""

    crash: Crash
    narrow: frozenset[str]
    least_mps2: float = CRAWLS_MPS2


def faults(one: Ended, at: Place, *, rolls: bool = False) -> Iterator[str]:
    """What no body does, by its name in `FAULTS`."""
    if one.crawls_s(at.least_mps2) > CRAWLS_S and not rolls:
        yield "crawls"
    if one.bends_deg > BENDS_DEG:
        yield "bends"
    if any(other in at.narrow and one.stops_dead(hit) for hit, other in zip(one.hits, one.others, strict=True)):
        yield "dead stops"


# ------------------------------------------------------------------ cases
def count(folder: Path, figures: Figures) -> None:
    """Add one case's folder to the counts."""
    figures.counts["cases"] += 1
    if not (folder / "trajectories.csv").exists():
        return
    run = Run(folder)
    sizes = sizes_of(run.actors.values())
    crash = Crash({m.actor: Way(m.t_s, m.pose, sizes[m.actor]) for m in run.motions}, run.graph)
    narrow = frozenset(
        a.id for a in run.actors.values() if actor_kind(a.type).thing and max(sizes[a.id]) < _WALL_M
    )  # fmt: skip
    at = Place(crash, narrow, min(CRAWLS_MPS2, DRIVING.sliding_mps2(run.reading.crash.surface) / 2))
    for actor, one in endings(crash).items():
        if actor_kind(run.actors[actor].type).wheeled:
            told = run.reading.crash.courses.get(actor, CourseTold())
            judge_ending(f"{folder.name} {actor}", one, told, at, figures)


def judge_ending(named: str, one: Ended, told: CourseTold, at: Place, figures: Figures) -> None:
    """Add one vehicle to the counts."""
    for seen in told_parts(one, told, at.crash):
        figures.judge(seen.part, seen.met, f"{named}: {seen.words}")
    found = set(faults(one, at, rolls=told.rolls))
    words = {"crawls": f"{one.crawls_s(at.least_mps2):.1f} s", "bends": f"{one.bends_deg:.0f} degrees"}
    for fault in FAULTS:
        figures.judge(fault, fault not in found, f"{named}: {words.get(fault, '/'.join(one.others))}")


def table(runs: Path, configs: Sequence[str], *, cases: bool = False) -> str:
    """The table, a row for each config."""
    found = by_config(runs, configs, Figures, count)
    rows = [HEAD, "|---|" + "---:|" * (HEAD.count("|") - 2)]
    for name, figures in found.items():
        n = figures.counts
        told = [f"{n[f'{part} right']} of {n[part]}" for part in TOLD]
        wrong = [str(n[fault] - n[f"{fault} right"]) for fault in FAULTS]
        rows.append(f"| {name} | " + " | ".join([str(n["cases"]), str(n[FAULTS[0]]), *told, *wrong]) + " |")
        rows += figures.lines if cases else []
    return "\n".join(rows)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    options = options_of(__doc__, arguments, "name every vehicle that is counted against")
    show(table(options.runs, options.configs, cases=options.cases))


if __name__ == "__main__":
    main()
