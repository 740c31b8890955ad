"""Bringing wrecks to rest where and as the report tells: the impact's and the drivers' free choices are fitted.

Free are, within physical bounds, friction and restitution between the bodies, and for every vehicle its braking, its
steering and its resistance to turning once it runs out. The blow itself is simulated once for each choice of friction
and restitution, the ways of running out all at once (`ground.run_out`); the best are then simulated whole, since wrecks
meet again, and what that shows corrects the next choice. What cannot be reached is said, with by how much.
Deterministic; a fixed number of simulations at most.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import product
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats, Size, box_gaps
from sgcad_core.metrics.rest import FACING_RAD, SIDE_RAD, RestErrors, rest_errors
from sgcad_core.planner.ground import Released, RunOut, run_out
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import Scene
from sgcad_core.roads.surface import RoadSurface
from sgcad_core.told_course import Courses, CourseTold, RestTold

IMPACTS = ((0.5, 0.1), (0.1, 0.1), (0.3, 0.0), (0.6, 0.3))
"""Friction and restitution between bodies that are tried, within what Brach finds for vehicles: little of both where
they graze each other, more friction where they lock."""
_BRAKES_SHARE = (0.05, 0.12, 0.22, 0.36, 0.58, 0.92)
"""Of the friction: from rolling on with bent wheels to four locked ones."""
_BENDS_PER_M = (0.0, 0.02, -0.02, 0.05, -0.05, 0.1, -0.1, 0.15, -0.15)
"""Down to a turning circle of 13 m."""
_TURNING = (1.0, 0.6, 0.35)
"""Resistance to turning: rolling tires give less than locked ones."""
_BLOW_S = 0.3
"""After the first touch the bodies have parted or slide together; then drivers and wheels count."""
_COARSE_S = 0.2
_WHOLE = 7
"""Choices that are simulated whole, at most."""
_WELL_RAD, _WELL_M = math.radians(15.0), 0.8
"""Within the allowed by so much is as good as can be."""
_TOLD, _UNUSUAL = 1.0, 0.02
_USUAL_SHARE = 0.6
"""Of the friction: one brakes, some wheels drag."""
_MISSED = 1.5
"""Cost of a told second contact that does not come about."""
_MEETING = 24
"""Of the ways of each of two that meet again so many are looked at."""
_PARTED_M = 0.06
_SPIN_RAD = math.radians(15.0)


class Choice(NamedTuple):
    """Friction, restitution, and how each vehicle runs out."""

    friction: float
    restitution: float
    runs: Mapping[str, RunOut]


@dataclass
class _Runs:
    """All ways in which one vehicle may run out from one blow, where each would end, and what that costs."""

    runs: Sequence[RunOut]
    ways: Floats
    """(m, n, 3) poses of each way, a coarse step apart."""
    odd: Floats
    judge: Callable[[Floats], Floats]
    size: Size
    off: Floats = field(default_factory=lambda: np.zeros(3))
    """How far the whole simulation ended from where the way alone would, at the last try."""

    @property
    def ends(self) -> Floats:
        """(n, 3) poses at rest."""
        last: Floats = self.ways[-1]
        return last

    def costs(self) -> Floats:
        """(n,) of each way, as far as is known from the last try."""
        return self.judge(self.ends + self.off) + self.odd

    def best(self) -> int:
        """The way that promises most."""
        return int(np.argmin(self.costs()))


@dataclass
class _Ways:
    """One choice of friction and restitution with its vehicles' ways."""

    friction: float
    restitution: float
    again: bool = False
    """Whether the two meet once more."""
    vehicles: dict[str, _Runs] = field(default_factory=dict)
    tried: set[tuple[int, ...]] = field(default_factory=set)

    def best(self) -> tuple[int, ...]:
        """The most promising way of each vehicle that was not tried; () where none is left."""
        each = [v.costs() for v in self.vehicles.values()]
        if not each:
            return ()
        if self.again and len(each) == 2:
            return self._meeting(each[0], each[1])
        found = tuple(int(np.argmin(costs)) for costs in each)
        return () if found in self.tried else found

    def _meeting(self, first: Floats, second: Floats) -> tuple[int, ...]:
        """The cheapest pair of ways that part and meet again, among the best of each."""
        a, b = self.vehicles.values()
        mine, theirs = np.argsort(first, kind="stable")[:_MEETING], np.argsort(second, kind="stable")[:_MEETING]
        pairs = [(int(i), int(j)) for i in mine for j in theirs if (int(i), int(j)) not in self.tried]
        if not pairs:
            return ()
        i, j = np.array(pairs).T
        steps = len(a.ways)
        gaps = box_gaps(a.ways[:, i].reshape(-1, 3), a.size, b.ways[:, j].reshape(-1, 3), b.size).reshape(steps, -1)
        apart = np.maximum.accumulate(gaps, axis=0) > _PARTED_M
        meets = (apart & (gaps <= 0.0)).any(axis=0)
        best = int(np.argmin(first[i] + second[j] + _MISSED * ~meets))
        return pairs[best]

    def predicted(self) -> float:
        """What the most promising ways cost."""
        return sum(float(v.costs()[k]) for v, k in zip(self.vehicles.values(), self.best(), strict=True))

    def choice(self) -> Choice:
        """The most promising ways, noted as tried."""
        best = self.best()
        self.tried.add(best)
        runs = {name: v.runs[i] for (name, v), i in zip(self.vehicles.items(), best, strict=True)}
        return Choice(self.friction, self.restitution, runs)

    def learn(self, choice: Choice, ends: Mapping[str, Floats]) -> None:
        """Take in where the vehicles came to rest in the whole simulation of a choice."""
        for name, v in self.vehicles.items():
            v.off = ends[name] - v.ends[v.runs.index(choice.runs[name])]


def leaving(course: CourseTold) -> CourseTold:
    """The course of one who strikes something beside the road: where no place is told, it leaves the road."""
    where = course.rest.where or "off_road"
    return replace(course, rest=replace(course.rest, where=where))


@dataclass(frozen=True)
class Rests:
    """What the vehicles of a scene are to come to."""

    scene: Scene
    told: Courses
    surface: RoadSurface
    rolling: frozenset[str] = frozenset()
    """Vehicles that are to reach something: of two ways the one that leads further is taken."""

    def fit(self) -> None:
        """Choose, and settle the scene so."""
        if not self.wanted:
            return
        best, least = self._choice(), self.cost()
        ways: list[_Ways] = []
        for number in range(_WHOLE):
            if least <= self._well:
                break
            if number < len(IMPACTS):
                ways.append(self._ways(*IMPACTS[number]))
            left = [w for w in ways if w.best()]
            if not left:
                continue
            way = min(left, key=lambda w: w.predicted())
            choice = way.choice()
            self._take(choice)
            way.learn(choice, {name: self.scene.tracks[name].poses[-1] for name in way.vehicles})
            if (cost := self.cost()) < least - 1e-9:
                best, least = self._choice(), cost
        if self._choice() != best:
            self._take(best)

    @property
    def _well(self) -> float:
        """A cost below which nothing is gained by further tries."""
        return 0.35 * len(self.wanted)

    @cached_property
    def wanted(self) -> dict[str, CourseTold]:
        """Told courses of the vehicles that are struck and of whose end anything is told, or who meet again."""
        again = {name for pair in self.scene.again for name in pair}
        struck = {name for touch in self.scene.touches for name in (touch.first, touch.second)}
        return {
            name: course
            for name in self.scene.tracks
            if (course := self.told.get(name, CourseTold())) is not None
            and name in struck
            and (not course.rest.empty or course.spin or name in again)
        }

    # -------------------------------------------------------------- choices
    def _choice(self) -> Choice:
        return Choice(self.scene.friction, self.scene.restitution, dict(self.scene.runs))

    def _take(self, choice: Choice) -> None:
        self.scene.friction, self.scene.restitution = choice.friction, choice.restitution
        self.scene.runs = dict(choice.runs)
        self.scene.settle()

    def _ways(self, friction: float, restitution: float) -> _Ways:
        """For one choice of the impact all ways of running out, each vehicle for itself."""
        scene = self.scene
        scene.friction, scene.restitution, scene.runs = friction, restitution, {}
        until = scene.contact + round(_BLOW_S / STEP_S)
        wreck = scene.wreck()
        wreck.settle(until)
        found = _Ways(friction, restitution, bool(scene.again))
        for name, course in self.wanted.items():
            mover = wreck.named[name]
            if mover.free and not mover.fixed:
                drag = scene.drag(scene.tracks[name])
                runs = _runs(until * STEP_S, drag.across)
                end_s = (scene.count - 4) * STEP_S
                ways = run_out(Released(mover.body, until * STEP_S), drag, runs, end_s, _COARSE_S)
                odd = _oddities(runs, drag.across, 0.0 if name in self.rolling else _USUAL_SHARE)
                found.vehicles[name] = _Runs(
                    runs, ways, odd, partial(self._costs, name, course), scene.tracks[name].size
                )
        return found

    # -------------------------------------------------------------- how well
    def cost(self) -> float:
        """How far the scene as it is settled is from what is told."""
        ends = {name: self.scene.tracks[name].poses[-1:] for name in self.wanted}
        missed = sum(_MISSED for pair in self.scene.again if not self._meet_again(pair))
        return missed + sum(float(self._costs(name, course, ends[name])[0]) for name, course in self.wanted.items())

    def _meet_again(self, pair: frozenset[str]) -> bool:
        """Whether two touch a second time."""
        return sum({t.first, t.second} == pair for t in self.scene.touches) > 1

    def _costs(self, name: str, course: CourseTold, ends: Floats) -> Floats:
        """(n,) costs of (n, 3) last poses: 1 and more for every told part that is missed."""
        errors = rest_errors(course.rest, ends, self._came_rad(name), self.surface)
        total = np.zeros(len(ends))
        for error, well, scale in zip(
            errors, (_WELL_RAD, _WELL_M, _WELL_RAD), (FACING_RAD, 5.0, SIDE_RAD), strict=True
        ):
            if error is not None:
                total += _TOLD * (error > 0) + np.maximum(error + well, 0.0) / scale
        if course.spin and course.rest.facing_deg is None:
            turned = ends[:, 2] - self._came_rad(name)
            way = 1.0 if course.spin == "counterclockwise" else -1.0
            wanted = math.radians(course.spin_deg) if course.spin_deg else 2 * _SPIN_RAD
            total += np.minimum(np.abs(way * turned - wanted) / (2 * wanted), 1.5) * (
                1.0 if course.spin_deg else way * turned < wanted
            )
        return total

    def _came_rad(self, name: str) -> float:
        """An actor's heading at the first contact, as its motion had it."""
        return float(self.scene.tracks[name].driven[self.scene.contact, 2])

    def missed(self) -> list[str]:
        """What of the told rests is not reached, and by how much."""
        apart = [" and ".join(sorted(pair)) for pair in self.scene.again if not self._meet_again(pair)]
        notes = [f"{pair} do not touch a second time, as is told" for pair in apart]
        return notes + [note for name, course in self.wanted.items() for note in self._missed(name, course.rest)]

    def _missed(self, name: str, rest: RestTold) -> Iterator[str]:
        errors = rest_errors(rest, self.scene.tracks[name].poses[-1:], self._came_rad(name), self.surface)
        yield from (f"{name} {words}" for words in _in_words(rest, errors))


def _runs(from_s: float, grip_mps2: float) -> list[RunOut]:
    """All ways of running out."""
    ways = product(_BRAKES_SHARE, _BENDS_PER_M, _TURNING)
    return [RunOut(from_s, share * grip_mps2, bend, turning) for share, bend, turning in ways]


def _oddities(runs: Sequence[RunOut], grip: float, usual_share: float) -> Floats:
    """A little for every departure from braking straight: of two that do as well the plainer one is taken."""
    return _UNUSUAL * np.array(
        [abs(r.along_mps2 / grip - usual_share) + 4 * abs(r.bend_per_m) + (1 - r.turning) / 2 for r in runs]
    )


def _in_words(rest: RestTold, errors: RestErrors) -> Iterator[str]:
    facing, where, side = errors
    if facing is not None and facing[0] > 0:
        off = math.degrees(float(facing[0]) + FACING_RAD)
        yield f"comes to rest facing {off:.0f} degrees off what is told"
    if where is not None and where[0] > 0:
        yield f"comes to rest {float(where[0]):.1f} m from the told place ({(rest.where or '').replace('_', ' ')})"
    if side is not None and side[0] > 0:
        yield f"comes to rest on another side than told ({rest.side})"
