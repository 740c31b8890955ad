"""Bringing wrecks to rest where and as the report tells: the impact's and the drivers' free choices are fitted.

Free are, within physical bounds, friction and restitution between the bodies, and for every vehicle its braking, its
steering and its resistance to turning once it runs out. The blow itself is simulated once for each choice of friction
and restitution, the ways of running out all at once (`ground.run_out`); the best few are then simulated whole, since
wrecks meet again. What cannot be reached is said, with by how much. Deterministic; a fixed number of simulations.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.metrics.rest import FACING_RAD, SIDE_RAD, RestErrors, rest_errors
from sgcad_core.planner.ground import Released, RunOut, run_out
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import Scene
from sgcad_core.roads.surface import RoadSurface
from sgcad_core.told_course import Courses, CourseTold, RestTold

IMPACTS = ((0.5, 0.1), (0.3, 0.0), (0.6, 0.3), (0.3, 0.3))
"""Friction and restitution between bodies that are tried: within what Brach finds for vehicles."""
_BRAKES_SHARE = (0.07, 0.2, 0.35, 0.55, 0.8, 0.95)
"""Of the friction: from rolling on with bent wheels to four locked ones."""
_BENDS_PER_M = (0.0, 0.02, -0.02, 0.05, -0.05, 0.1, -0.1, 0.15, -0.15)
"""Down to a turning circle of 13 m."""
_TURNING = (1.0, 0.6, 0.35)
"""Resistance to turning: rolling tires give less than locked ones."""
_BLOW_S = 0.3
"""After the first touch the bodies have parted or slide together; then drivers and wheels count."""
_COARSE_S = 0.1
_WHOLE = 3
"""Choices that are simulated whole."""
_WELL_RAD, _WELL_M = math.radians(15.0), 0.8
"""Within the allowed by so much is as good as can be."""
_TOLD, _UNUSUAL = 1.0, 0.02
_SPIN_RAD = math.radians(15.0)


class Choice(NamedTuple):
    """Friction, restitution, and how each vehicle runs out."""

    friction: float
    restitution: float
    runs: Mapping[str, RunOut]


@dataclass(frozen=True)
class Rests:
    """What the vehicles of a scene are to come to."""

    scene: Scene
    told: Courses
    surface: RoadSurface

    def settle(self) -> list[str]:
        """Choose, settle the scene so, and say what is missed by how much."""
        wanted = self.wanted
        if not wanted:
            return []
        best, least = self._choice(), self.cost()
        for choice in self._choices():
            if least <= _UNUSUAL * len(wanted):
                break
            self._take(choice)
            if (cost := self.cost()) < least - 1e-9:
                best, least = choice, cost
        if self._choice() != best:
            self._take(best)
        return self.missed()

    @cached_property
    def wanted(self) -> dict[str, CourseTold]:
        """Told courses of the vehicles that are struck and of whose end anything is told."""
        struck = {name for touch in self.scene.touches for name in (touch.first, touch.second)}
        return {
            name: course
            for name, course in self.told.items()
            if name in struck and name in self.scene.tracks and (not course.rest.empty or course.spin)
        }

    # -------------------------------------------------------------- choices
    def _choice(self) -> Choice:
        return Choice(self.scene.friction, self.scene.restitution, dict(self.scene.runs))

    def _take(self, choice: Choice) -> None:
        self.scene.friction, self.scene.restitution = choice.friction, choice.restitution
        self.scene.runs = dict(choice.runs)
        self.scene.settle()

    def _choices(self) -> list[Choice]:
        """The most promising choices, best first."""
        found = []
        for friction, restitution in IMPACTS:
            self.scene.friction, self.scene.restitution = friction, restitution
            cost, runs = self._run_outs()
            found.append((cost, len(found), Choice(friction, restitution, runs)))
        return [choice for _, _, choice in sorted(found, key=lambda one: one[:2])[:_WHOLE]]

    def _run_outs(self) -> tuple[float, dict[str, RunOut]]:
        """For one choice of the impact the best ways of running out, each vehicle for itself, and what they cost."""
        scene = self.scene
        until = scene.contact + round(_BLOW_S / STEP_S)
        scene.runs = {}
        wreck = scene.wreck()
        wreck.settle(until)
        total, chosen = 0.0, {}
        for name, course in self.wanted.items():
            mover, track = wreck.named[name], scene.tracks[name]
            if not mover.free or mover.fixed:
                continue
            grip = scene.drag(track).across
            runs = [RunOut(until * STEP_S, share * grip, bend, turning)
                    for share, bend, turning in product(_BRAKES_SHARE, _BENDS_PER_M, _TURNING)]  # fmt: skip
            released, end = Released(mover.body, until * STEP_S), (scene.count - 4) * STEP_S
            ends = run_out(released, scene.drag(track), runs, end, _COARSE_S)
            costs = self._costs(name, course, ends) + _oddities(runs, grip)
            best = int(np.argmin(costs))
            total, chosen[name] = total + float(costs[best]), runs[best]
        return total, chosen

    # -------------------------------------------------------------- how well
    def cost(self) -> float:
        """How far the scene as it is settled is from what is told."""
        ends = {name: self.scene.tracks[name].poses[-1:] for name in self.wanted}
        return sum(float(self._costs(name, course, ends[name])[0]) for name, course in self.wanted.items())

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
        return [note for name, course in self.wanted.items() for note in self._missed(name, course.rest)]

    def _missed(self, name: str, rest: RestTold) -> Iterator[str]:
        errors = rest_errors(rest, self.scene.tracks[name].poses[-1:], self._came_rad(name), self.surface)
        yield from (f"{name} {words}" for words in _in_words(rest, errors))


def _oddities(runs: Sequence[RunOut], grip: float) -> Floats:
    """A little for every departure from braking straight: of two that do as well the plainer one is taken."""
    return _UNUSUAL * np.array(
        [abs(r.along_mps2 / grip - 0.6) + 4 * abs(r.bend_per_m) + (1 - r.turning) / 2 for r in runs]
    )


def _in_words(rest: RestTold, errors: RestErrors) -> Iterator[str]:
    facing, where, side = errors
    if facing is not None and facing[0] > 0:
        off = math.degrees(float(facing[0]) + FACING_RAD)
        yield f"comes to rest facing {off:.0f} degrees off what is told"
    if where is not None and where[0] > 0:
        yield f"comes to rest {float(where[0]):.1f} m from the told place ({_words(rest)})"
    if side is not None and side[0] > 0:
        yield f"comes to rest on another side than told ({rest.side})"


def _words(rest: RestTold) -> str:
    return (rest.where or "").replace("_", " ")
