"""The possible run-outs of vehicles after one impact, and the choice among them.

All run-outs of a vehicle are computed at once (`ground_friction.run_out_paths`); whole simulations then show how far
they end elsewhere. Knows bodies and costs; no report and no roads.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats, Size, gaps_where_near
from sgcad_core.metrics.rest_error import whirls
from sgcad_core.planner.aftermath.ground_friction import RunOut
from sgcad_core.planner.aftermath.impact import Body, Impact
from sgcad_core.planner.aftermath.rollover import barrel_costs
from sgcad_core.planner.aftermath.second_contact import MISSED, NOT_AGAIN, WRONG_SIDE, Sides, wrong_sides
from sgcad_core.records.course import CourseTold
from sgcad_core.roads.surface import RoadSurface

Ints = NDArray[np.int_]

_BRAKES_SHARE, _SLOW_SHARE = (0.2, 0.36, 0.58, 0.92), (0.36, 0.58, 0.92)
"""Share of the friction: from rolling on with bent wheels to four locked ones; and of a slow one, which stops."""
_LEAST_MPS2 = 1.4
"""A vehicle that slows less than this crawls, but on ice: there half of the friction is the least."""
_SLOW_MPS = 4.0
"""A slower vehicle has no driver any more who lets it roll: it would crawl for seconds."""
_STRAY_RAD, _STRAYS = math.radians(48.0), 2.5
"""A way that turns more than this is driven in a loop, and the cost of it and of each as much again: more than two
missed parts of what is told."""
_BENDS_PER_M = (0.0, 0.015, -0.015, 0.03, -0.03, 0.06, -0.06, 0.1, -0.1, 0.15, -0.15)
"""Down to a turning circle of 13 m."""
_TURNING = (1.0, 0.8, 0.6, 0.45, 0.35)
"""Resistance to turning: rolling tires give less than locked ones."""
_SLIDES_SHARE, _SLIDES_TURNING = (0.25, 0.4, 0.6, 0.92), (1.0, 0.6, 0.35)
"""Of a body that slides on bent and locked wheels: share of the friction, and resistance to turning."""
_DRAGS = (0.0, 0.25, -0.25, 0.55, -0.55, 1.0, -1.0, 1.8, -1.8)
"""Moment of wheels that drag on one side, as a share of what two that are locked there have."""
_DRAG_LEVER_PER_M = 0.2
"""That moment per m/s2 of braking: half of it acts at half of the track, over the squared radius of gyration of a
car."""
_TRIPS_RADPS2, _TRIPS_S = (2.5, -2.5, 4.5, -4.5), (0.4, 0.7)
"""Moment of wheels that dig in before a vehicle rolls over, and the time for which they do: a furrow takes half of the
weight 1.4 m before the center, over the squared radius of gyration of a car (1.4 m) some 4 rad/s2."""
_DRIVES_ON_S, _DRIVES_ON_PER_M = (1.0, 1.8), 0.06
"""Time for which an able driver goes on before braking, with freely rolling wheels and in no tighter bend: to the
shoulder, out of the junction."""
_BEFORE_IT_ROLLS_PER_M = 0.03
_ROLLS_BACK, _ROLLED_BACK_SHARE = 0.6, 0.3
"""Cost of a way on which a vehicle that a blow threw back rolls on freely: its wheels are bent, and nobody drives it
there; and the share of the friction below which it does."""
_EACH_WAY = 2
"""Number of run-outs of each sort that are compared for two vehicles that meet again."""
_TURNS_FREELY = 0.7
"""Resistance to turning below which a run-out is of another sort."""
_PARTED_M = 0.06
_SOON = 40
"""Steps of the run-outs that are compared: 4 s, later they hardly move."""
_IN_EACH_OTHER_M = 0.25
"""Run-outs on which two boxes would overlap so deep are excluded: they push each other elsewhere."""
_ON_THE_SPOT, _SPOT_RAD = 0.5, math.radians(85.0)
_LEAVES, _LEAVES_M, _SEEN = 0.4, 0.8, 12
"""Cost of a rotation on the spot; of a way off the road before a rest on it, from how far on, and the poses of a way
that are looked at. Both are less than a missed part of what is told."""
TOLD = 1.0
"""Cost of a missed part of what is told."""
UNUSUAL = 0.02
_MOVES_MPS = 0.7
"""Speed from which the direction of a way counts."""


class Choice(NamedTuple):
    """The impact, and how each vehicle runs out."""

    impact: Impact
    runs: Mapping[str, tuple[RunOut, ...]]


@dataclass
class VehicleWays:
    """All run-outs of one vehicle after one impact, their end poses and costs."""

    runs: Sequence[RunOut]
    ways: Floats
    """(m, n, 3) poses of each run-out, a coarse step apart."""
    odd: Floats
    judge: Callable[[Floats], Floats]
    size: Size
    off: Floats = field(default_factory=lambda: np.zeros(3))
    """Difference of the whole simulation from the run-out alone, at the last try."""

    @property
    def ends(self) -> Floats:
        """(n, 3) poses at rest."""
        last: Floats = self.ways[-1]
        return last

    def costs(self) -> Floats:
        """(n,) costs of the run-outs, corrected by the last try."""
        return self.judge(self.ends + self.off) + self.odd

    def cost(self, number: int) -> float:
        """Cost of one run-out."""
        return float(self.judge(self.ends[number : number + 1] + self.off)[0] + self.odd[number])


@dataclass
class BlowWays:
    """One choice of the impact with the run-outs of its vehicles."""

    impact: Impact
    again: bool = False
    """Whether the two touch a second time."""
    sides: Sides = (None, None)
    """The sides on which they then do, in the order of the vehicles."""
    vehicles: dict[str, VehicleWays] = field(default_factory=dict)
    tried: set[tuple[int, ...]] = field(default_factory=set)
    known: tuple[int, ...] | None = None
    """Result of `best`, until the next `learn`."""

    def best(self) -> tuple[int, ...]:
        """The most promising untried run-out of each vehicle; () where none is left."""
        if self.known is None:
            each = [v.costs() for v in self.vehicles.values()]
            self.known = tuple(int(np.argmin(costs)) for costs in each)
            if len(each) == 2 and (self.again or self._in_each_other(self.known)):
                self.known = self._of_two(each[0], each[1])
        return () if self.known in self.tried else self.known

    def _of_two(self, first: Floats, second: Floats) -> tuple[int, ...]:
        """The cheapest pair of run-outs that keep clear of each other once parted, or that meet again, as stated."""
        a, b = self.vehicles.values()
        mine, theirs = (_various(v.runs, costs, again=self.again) for v, costs in ((a, first), (b, second)))
        pairs = [(int(i), int(j)) for i in mine for j in theirs if (int(i), int(j)) not in self.tried]
        if not pairs:
            return ()
        i, j = np.array(pairs).T
        gaps = self._gaps(i, j)
        missed = self._missed_again(gaps, i, j) if self.again else MISSED * (gaps.min(axis=0) < -_IN_EACH_OTHER_M)
        best = int(np.argmin(first[i] + second[j] + missed))
        return pairs[best]

    def _missed_again(self, gaps: Floats, first: Ints, second: Ints) -> Floats:
        """(n,) costs of pairs of run-outs that do not meet again once parted, or on other sides than told."""
        a, b = self.vehicles.values()
        apart = np.maximum.accumulate(gaps, axis=0) > _PARTED_M
        met = apart & (gaps <= 0.0)
        at = met.argmax(axis=0)
        wrong = wrong_sides((a.ways[at, first], a.size), (b.ways[at, second], b.size), self.sides)
        cost: Floats = np.where(met.any(axis=0), WRONG_SIDE * wrong, NOT_AGAIN)
        return cost

    def _in_each_other(self, known: tuple[int, ...]) -> bool:
        """Whether two run-outs lead through each other."""
        return bool(self._gaps(np.array(known[:1]), np.array(known[1:])).min() < -_IN_EACH_OTHER_M)

    def _gaps(self, first: Ints, second: Ints) -> Floats:
        """(m, n) gaps of the two boxes on n pairs of run-outs, metres; inf far apart."""
        a, b = self.vehicles.values()
        mine, theirs = a.ways[:_SOON, first], b.ways[:_SOON, second]
        found = gaps_where_near(mine.reshape(-1, 3), a.size, theirs.reshape(-1, 3), b.size, _PARTED_M)
        return found.reshape(len(mine), -1)

    def predicted(self) -> float:
        """Cost of the most promising run-outs."""
        return sum(v.cost(k) for v, k in zip(self.vehicles.values(), self.best(), strict=True))

    def choice(self) -> Choice:
        """The most promising run-outs, noted as tried."""
        best = self.best()
        self.tried.add(best)
        runs = {name: (v.runs[i],) for (name, v), i in zip(self.vehicles.items(), best, strict=True)}
        return Choice(self.impact, runs)

    def learn(self, choice: Choice, ends: Mapping[str, Floats]) -> None:
        """Corrects the end poses by those of the whole simulation of a choice."""
        for name, v in self.vehicles.items():
            v.off = ends[name] - v.ends[v.runs.index(choice.runs[name][0])]
        self.known = None


def _various(runs: Sequence[RunOut], costs: Floats, *, again: bool) -> list[int]:
    """The cheapest run-outs of each steering; `again`: of each sort, by steering, locked wheels and turning."""
    sorts: dict[tuple[float, ...], list[int]] = {}
    for i in np.argsort(costs, kind="stable").tolist():
        run = runs[i]
        further = (run.slides, np.sign(run.yaws_radps2), run.turning < _TURNS_FREELY) if again else ()
        sorts.setdefault((run.bend_per_m, *further), []).append(i)
    return [i for same in sorts.values() for i in same[: _EACH_WAY if again else 1]]


def all_runs(from_s: float, grip_mps2: float, mps: float, *, on_wheels: bool = True) -> list[RunOut]:
    """All run-outs from a speed; one not `on_wheels` does not drive on, and hardly steers before it rolls over."""
    bends = [bend for bend in _BENDS_PER_M if on_wheels or abs(bend) <= _BEFORE_IT_ROLLS_PER_M]
    shares = _BRAKES_SHARE if mps > _SLOW_MPS else _SLOW_SHARE
    least = min(_LEAST_MPS2, grip_mps2 / 2)
    brakes = [max(share * grip_mps2, least) for share in shares]
    ways = [RunOut(from_s, mps2, bend, turning) for mps2, bend, turning in product(brakes, bends, _TURNING)]
    slides = [max(share * grip_mps2, least) for share in _SLIDES_SHARE if mps > _SLOW_MPS or share >= shares[0]]
    drives_on = on_wheels and mps > _SLOW_MPS
    gentle = [way for way in ways if abs(way.bend_per_m) <= _DRIVES_ON_PER_M and way.turning == _TURNING[0]]
    ways += [
        RunOut(from_s, mps2, 0.0, turning, slides=True, yaws_radps2=drags * _DRAG_LEVER_PER_M * mps2)
        for mps2, turning, drags in product(slides, _SLIDES_TURNING, _DRAGS)
    ]
    if not on_wheels:
        ways += [
            RunOut(from_s, mps2, 0.0, turning, slides=True, yaws_radps2=yaws, yaws_s=lasts)
            for mps2, turning, yaws, lasts in product(slides, _SLIDES_TURNING, _TRIPS_RADPS2, _TRIPS_S)
        ]
    return ways + [way._replace(rolls_s=rolls) for way in gentle for rolls in _DRIVES_ON_S if drives_on]


def oddities(runs: Sequence[RunOut], grip: float, usual_share: float) -> Floats:
    """Small costs of departures from straight braking: of two equal run-outs the plainer one is taken."""
    return UNUSUAL * np.array(
        [
            abs(r.along_mps2 / grip - usual_share)
            + 4 * abs(r.bend_per_m)
            + (1 - r.turning) / 2
            + r.rolls_s / 2
            + abs(r.yaws_radps2) / 2
            for r in runs
        ]
    )


def rolling_back(runs: Sequence[RunOut], body: Body, grip: float) -> Floats:
    """(n,) costs of run-outs on which a body that moves backward hardly slows."""
    back = body.vx * math.cos(body.heading) + body.vy * math.sin(body.heading) < -_MOVES_MPS
    freely = [r.rolls_s > 0.0 or r.along_mps2 < _ROLLED_BACK_SHARE * grip for r in runs]
    cost: Floats = _ROLLS_BACK * back * np.array(freely, dtype=float)
    return cost


def loops(ways: Floats, step_s: float) -> Floats:
    """(n,) costs of (m, n, 3) run-outs that turn far from the direction in which they begin."""
    moves = np.diff(ways[:, :, :2], axis=0)
    moving = np.hypot(*moves.transpose(2, 0, 1)) > _MOVES_MPS * step_s
    way = np.unwrap(np.arctan2(moves[..., 1], moves[..., 0]), axis=0)
    turned = np.where(moving, np.abs(way - way[:1]), 0.0).max(axis=0)
    cost: Floats = _STRAYS * np.where(turned > _STRAY_RAD, turned / _STRAY_RAD, 0.0)
    return cost


def odd_ways(course: CourseTold, ways: Floats, surface: RoadSurface) -> Floats:
    """(n,) costs of (m, n, 3) ways that turn on the spot, or that leave the road of which the told rest is a part and
    come back to it, or on which it rolls over with its front ahead."""
    cost = _ON_THE_SPOT * (whirls(ways) > _SPOT_RAD).astype(float) + barrel_costs(course, ways)
    if course.rest.where == "road":
        some = ways[:: max(len(ways) // _SEEN, 1)]
        off = surface.off(some[..., :2].reshape(-1, 2))[0].reshape(len(some), -1)
        cost = cost + _LEAVES * ((off.max(axis=0) > _LEAVES_M) & (off[0] < 0.0))
    return cost


def part_missed(count: int, *errors: tuple[Floats | None, float, float]) -> Floats:
    """(count,) costs of one stated part: 1 where any of its errors is above 0, and the errors themselves. Each comes
    with the margin that counts as best, and its scale."""
    cost, wrong = np.zeros(count), np.zeros(count, bool)
    for error, well, scale in errors:
        if error is not None:
            wrong |= error > 0
            cost += eased(np.maximum(error + well, 0.0) / scale)
    return TOLD * wrong + cost / len(errors)


def eased(error: Floats) -> Floats:
    """Errors as costs below 1, so that no near miss of one part outweighs that another part is met."""
    eased: Floats = error / (1.0 + error)
    return eased
