"""Fits the free parameters of impact and run-out so that vehicles come to rest as the report states.

Free within physical bounds are friction and restitution between the bodies, and for every vehicle its braking, steering
and resistance to turning in the run-out. The impact is simulated once for each friction and restitution, all run-outs
at once (`ground_friction.run_out_paths`); the best are simulated whole, since vehicles meet again, and the result
corrects the next choice. What cannot be reached is noted with its error. Deterministic; a fixed number of simulations
at most.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.metrics.rest_error import (
    SIDE_RAD,
    SPINS_RAD,
    RestErrors,
    against_errors,
    in_words,
    near_m,
    near_turn_rad,
    rest_errors,
)
from sgcad_core.planner.aftermath.crush import meet_in_part
from sgcad_core.planner.aftermath.ground_friction import Released, run_out_paths
from sgcad_core.planner.aftermath.impact import IMPACTS, Impact
from sgcad_core.planner.aftermath.rest_candidates import (
    TOLD,
    BlowWays,
    Choice,
    VehicleWays,
    all_runs,
    eased,
    loops,
    odd_ways,
    oddities,
    part_missed,
    rolling_back,
)
from sgcad_core.planner.aftermath.rollover import rolls_over
from sgcad_core.planner.aftermath.second_contact import WRONG_SIDE, missed_again
from sgcad_core.planner.aftermath.told_order import ToldOrder
from sgcad_core.planner.later.later_courses import RunOuts, run_outs, with_run
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import Scene
from sgcad_core.records.course import Courses, CourseTold, RestTold, sense_of
from sgcad_core.roads.surface import RoadSurface

_BLOW_S = 0.2
"""Duration of the impact; then the bodies have parted or slide together, and drivers and wheels count."""
_COARSE_S = 0.1
_PARTED = 100.0
"""Cost of a rest that takes away a told contact: more than any end that is missed."""
_LAST_RUNS = 2
"""Run-outs behind the last touch of a vehicle that are simulated."""
_WHOLE = 3
"""Whole simulations at most, beyond one for each friction and restitution."""
_WHOLE_AGAIN = 10
"""The same where the two meet again: where they then push each other depends on more."""
_WELL_RAD, _WELL_M = math.radians(15.0), 0.8
"""Margin inside the allowed error that counts as best."""
_FACING_SCALE_RAD, _PLACE_SCALE_M = math.radians(45.0), 5.0
"""Errors of which half of the cost of an error is reached."""
_USUAL_SHARE = 0.6
"""Of the friction: some braking, some dragging wheels."""
_SPIN_RAD, _MOST_UNTOLD_RAD, _WHIRLS = math.radians(15.0), math.radians(200.0), 1.3
_MOST_SPIN_RAD = math.radians(320.0)
"""The most of a told rotation without told degrees."""


@dataclass(frozen=True)
class RestFit:
    """The stated ends of the vehicles of a scene."""

    scene: Scene
    told: Courses
    surface: RoadSurface
    rolling: frozenset[str] = frozenset()
    """Vehicles with a further contact: of two run-outs the longer one is taken."""
    impacts: Sequence[Impact] = IMPACTS
    """Friction and restitution that are tried."""
    order: ToldOrder | None = None
    """The contacts that come about, and must go on to."""

    def fit(self) -> None:
        """Chooses the best parameters and settles the scene with them."""
        if not self.wanted:
            return
        best, least = self._choice(), self.cost()
        ways: list[BlowWays] = []
        impacts = [impact for impact in self.impacts if not impact.glance_rad or self._glances]
        for number in range(len(impacts) + (_WHOLE_AGAIN if self.scene.again else _WHOLE)):
            if least <= self._well:
                break
            if number < len(impacts):
                ways.append(self._ways(impacts[number]))
            left = [w for w in ways if w.best()]
            if not left:
                continue
            way = min(left, key=lambda w: w.predicted())
            if number >= len(impacts) and way.predicted() >= least:
                break
            choice = way.choice()
            self._take(choice)
            way.learn(choice, {name: self.scene.tracks[name].poses[-1] for name in way.vehicles})
            if (cost := self.cost()) < least - 1e-9:
                best, least = self._choice(), cost
        if self._choice() != best:
            self._take(best)

    def finish(self) -> None:
        """Lets vehicles that met something after the first contact run out to their stated ends from there on."""
        blow = self.scene.contact + 2 * round(_BLOW_S / STEP_S)
        for name, course in self.wanted.items():
            now = float(self._costs(name, course, self.scene.tracks[name].poses[-1:])[0])
            found = run_outs(self.scene, name, 0) if now >= TOLD else None
            if found is not None and found.sample > blow:
                self._finish(name, self._costs(name, course, found.ways[-1]) + found.odd, found, now - TOLD / 2)

    def _finish(self, name: str, costs: Floats, found: RunOuts, most: float) -> None:
        """Takes the first of the best run-outs of a vehicle with which the whole scene is nearer to what is stated."""
        scene, before, least = self.scene, self.scene.runs, self.cost()
        able = (n for n in np.argsort(costs, kind="stable")[:_LAST_RUNS] if costs[n] < most)
        for n in able:
            scene.runs = with_run(scene, name, found.runs[int(n)])
            scene.settle()
            if self.cost() < least - TOLD / 2:
                return
            scene.runs = before
        scene.settle()

    @property
    def _well(self) -> float:
        """A cost below which further tries are not worth it."""
        return 0.35 * sum(not self.scene.tracks[name].motion.fixed for name in self.wanted)

    @cached_property
    def wanted(self) -> dict[str, CourseTold]:
        """Stated courses of the struck vehicles with a stated end or a second contact."""
        again = {name for pair in self.scene.again for name in pair}
        struck = {name for touch in self.scene.touches for name in (touch.first, touch.second)}
        told = {name: self.told.get(name, CourseTold()) for name in self.scene.tracks if name in struck}
        return {
            name: course for name, course in told.items()
            if not course.rest.empty or course.spin or name in again or name in self._makes_way
            or self._odd_way(name, course) > 0.0
        }  # fmt: skip

    @cached_property
    def _makes_way(self) -> frozenset[str]:
        """Vehicles in the first contact with one that has a further contact, and must not stand in its way."""
        first = {name for touch in self.scene.touches[:1] for name in (touch.first, touch.second)}
        return frozenset(first if first & self.rolling else ())

    @property
    def _glances(self) -> bool:
        """Whether the first two that touch are vehicles that meet head on with a part of their fronts."""
        names = [name for touch in self.scene.touches[:1] for name in (touch.first, touch.second)]
        tracks = [self.scene.tracks[name] for name in names]
        fixed = any(track.motion.fixed for track in tracks)
        return bool(tracks) and not fixed and meet_in_part(*((t.driven[self.scene.contact], t.size) for t in tracks))

    # -------------------------------------------------------------- choices
    def _choice(self) -> Choice:
        return Choice(self.scene.impact, dict(self.scene.runs))

    def _take(self, choice: Choice) -> None:
        self.scene.impact = choice.impact
        self.scene.runs = dict(choice.runs)
        self.scene.settle()

    def _ways(self, impact: Impact) -> BlowWays:
        """All run-outs for one choice of the impact, each vehicle on its own."""
        scene = self.scene
        scene.impact, scene.runs = impact, {}
        until = scene.contact + round(_BLOW_S / STEP_S)
        wreck = scene.wreck()
        wreck.settle(until)
        free = [name for name in self.wanted if wreck.named[name].free and not wreck.named[name].fixed]
        told = scene.sides.get(frozenset(free), {})
        sides = (told.get(free[0]), told.get(free[-1])) if free else (None, None)
        found = BlowWays(impact, any(pair <= set(free) for pair in scene.again), sides)
        if not free:
            return found
        at_s, end_s = until * STEP_S, (scene.count - 4) * STEP_S
        drags = [scene.drag(scene.tracks[name]) for name in free]
        upright = [not rolls_over(self.wanted[name]) for name in free]
        released = [Released(wreck.named[name].body, at_s) for name in free]
        runs = [
            all_runs(at_s, drag.across, one.body.speed, on_wheels=on)
            for one, drag, on in zip(released, drags, upright, strict=True)
        ]
        each = run_out_paths(released, drags, runs, end_s, _COARSE_S)
        for name, one, drag, mine, ways in zip(free, released, drags, runs, each, strict=True):
            odd = oddities(mine, drag.across, 0.0 if name in self.rolling else _USUAL_SHARE) + loops(ways, _COARSE_S)
            odd = odd + rolling_back(mine, one.body, drag.across)
            if not scene.again:  # there are few ways to a second contact
                odd = odd + odd_ways(self.wanted[name], ways, self.surface)
            judge = partial(self._costs, name, self.wanted[name])
            found.vehicles[name] = VehicleWays(mine, ways, odd, judge, scene.tracks[name].size)
        return found

    # -------------------------------------------------------------- how well
    def cost(self) -> float:
        """The cost of the settled scene: its distance from what is stated."""
        ends = {name: self.scene.tracks[name].poses[-1:] for name in self.wanted}
        missed = sum(missed_again(self.scene, pair) for pair in self.scene.again if pair <= self.scene.tracks.keys())
        if self.order is not None:
            missed += WRONG_SIDE * self.order.sides_missed if self.order.kept else _PARTED
        missed += sum(self._odd_way(name, course) for name, course in self.wanted.items())
        return missed + sum(float(self._costs(name, course, ends[name])[0]) for name, course in self.wanted.items())

    def _odd_way(self, name: str, course: CourseTold) -> float:
        """The cost of how a vehicle gets to its end in the settled scene."""
        way = self.scene.tracks[name].poses[self.scene.contact :, None]
        return float(odd_ways(course, way, self.surface)[0])

    def _meet_again(self, pair: frozenset[str]) -> bool:
        """Whether two touch a second time."""
        return sum({t.first, t.second} == pair for t in self.scene.touches) > 1

    def _costs(self, name: str, course: CourseTold, ends: Floats) -> Floats:
        """(n,) costs of (n, 3) last poses: 1 and more for every missed part."""
        facing, where, side, lane = self._errors(name, course.rest, ends)
        total = part_missed(len(ends), (facing, _WELL_RAD, _FACING_SCALE_RAD))
        total += part_missed(len(ends), (where, _WELL_M, _PLACE_SCALE_M), (side, _WELL_RAD, SIDE_RAD))
        total += part_missed(len(ends), (lane, _WELL_M, _PLACE_SCALE_M))
        if course.rest.distance_m is not None:
            off = np.abs(self._way_m(name, ends) - course.rest.distance_m)
            total += TOLD * (off > near_m(course.rest.distance_m)) + eased(off / course.rest.distance_m)
        total += part_missed(len(ends), (self._from_prop(name, course.rest, ends), _WELL_M, _PLACE_SCALE_M))
        return total + (self._unspun(name, course, ends) if course.spin else self._whirled(name, ends))

    def _from_prop(self, name: str, rest: RestTold, ends: Floats) -> Floats | None:
        """(n,) metres by which last poses are too far from what it struck last, where it is told to rest at it."""
        prop = self.scene.last_fixed(name) if rest.against else None
        return None if prop is None else against_errors(ends, self.scene.tracks[name].size, prop.poses[-1], prop.size)

    def _way_m(self, name: str, ends: Floats) -> Floats:
        """(n,) metres from the place of a vehicle at the first contact to (n, 3) last poses."""
        way: Floats = np.hypot(*(ends[:, :2] - self.scene.tracks[name].driven[self.scene.contact, :2]).T)
        return way

    def _unspun(self, name: str, course: CourseTold, ends: Floats) -> Floats:
        """(n,) costs of rotation otherwise than stated: by other degrees, or in the other sense."""
        turned = sense_of(course.spin) * (ends[:, 2] - self._came_rad(name))
        wanted = math.radians(course.spin_deg) if course.spin_deg else 2 * _SPIN_RAD
        off, wrong = np.maximum(wanted - turned, 0.0), turned < SPINS_RAD
        if course.spin_deg:
            off = np.abs(wanted - turned)
            wrong |= off > near_turn_rad(wanted)
        else:
            wrong |= turned > _MOST_SPIN_RAD
        return TOLD * wrong + eased(off / (2 * wanted))

    def _whirled(self, name: str, ends: Floats) -> Floats:
        """(n,) costs of an untold rotation by more than half a turn: more than of a facing that is missed."""
        return np.where(np.abs(ends[:, 2] - self._came_rad(name)) > _MOST_UNTOLD_RAD, _WHIRLS, 0.0)

    def _errors(self, name: str, rest: RestTold, ends: Floats) -> RestErrors:
        """Errors of (n, 3) last poses of a vehicle."""
        return rest_errors(rest, ends, self._came_rad(name), self.surface, self.scene.tracks[name].driven[0])

    def _came_rad(self, name: str) -> float:
        """An actor's heading at the first contact, as its motion had it."""
        return float(self.scene.tracks[name].driven[self.scene.contact, 2])

    def missed(self) -> list[str]:
        """Notes on the stated rests that are not reached, with the errors."""
        notes = []
        for pair in self.scene.again:
            if not self._meet_again(pair):
                notes.append(f"{' and '.join(sorted(pair))} do not touch a second time, as is told")
            elif pair <= self.scene.tracks.keys() and missed_again(self.scene, pair):
                notes.append(f"{' and '.join(sorted(pair))} touch a second time on other sides than told")
        return notes + [note for name, course in self.wanted.items() for note in self._missed(name, course.rest)]

    def _missed(self, name: str, rest: RestTold) -> Iterator[str]:
        errors = self._errors(name, rest, self.scene.tracks[name].poses[-1:])
        yield from (f"{name} {words}" for words in in_words(rest, errors))
        beyond = self._from_prop(name, rest, self.scene.tracks[name].poses[-1:])
        if beyond is not None and beyond[0] > 0:
            yield f"{name} does not come to rest at the {rest.against}"
        if rest.distance_m is not None:
            way = float(self._way_m(name, self.scene.tracks[name].poses[-1:])[0])
            if abs(way - rest.distance_m) > near_m(rest.distance_m):
                yield f"{name} comes to rest {way:.0f} m from the contact (told: {rest.distance_m:.0f} m)"
