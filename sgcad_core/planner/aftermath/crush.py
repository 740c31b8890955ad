"""How vehicles sink into what they meet: at a narrow thing that stays they slow over a distance, not at once, and roll
back off it; fronts that meet in part glance off each other.

The deceleration is even over the pulse of a crash into a pole (0.1 s at most, so that 15 m/s take 0.7 m); meanwhile the
boxes overlap by the depth of the crush. Then the vehicle rebounds with a share of the speed, and the boxes, which do
not crush, are moved apart as fast.

Fronts that overlap little crush to a slant: the blow is along the normal of that surface, not along the vehicles, so
that both go on, slower, and are pushed aside (the angle of the crush surface in R. M. Brach, R. M. Brach, Vehicle
Accident Analysis and Reconstruction Methods, ch. 6). Knows two bodies and the clock. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

from sgcad_core.geometry.plane import Floats, Size
from sgcad_core.planner.aftermath.impact import USUAL, Body, Impact, Point, approach, body, collide, slow_parting
from sgcad_core.planner.aftermath.wreck_bodies import (
    Mover,
    Pair,
    Separation,
    center_of,
    key_of,
    separation,
    touch_points,
)

NARROW_M, _WIDE_M = 1.2, 1.5
"""A wider thing is met by the whole of a side, which crushes little; a narrower body (a bicycle) hardly crushes."""
_LEAST_MPS = 5.0
"""A slower vehicle stops within the depth at which any touch takes effect."""
_PULSE_S, DEEPEST_M = 0.1, 0.8
"""Duration of the pulse, and the most crush: a faster vehicle slows in less time."""
_PASS_S = 0.7
"""The longest that two pass each other: two lengths of a car at 12 m/s."""
_MOST_SHARE, _ENDS_ON = 0.5, math.cos(math.radians(30.0))
"""Of the narrower front, the most that overlaps where two glance off each other, more of it locks them; and the least
cosine of the angle between a front and the way of the blow."""
_REBOUND = 0.12
"""Share of the speed with which a vehicle rolls back off a pole."""
_PARTING_MPS, _OFF_IT_MPS = 0.3, 1.2
"""Speed at which overlapping bodies are moved apart; those that crushed part as they rebound, not by creeping."""
STEP_LONGEST_S = 0.005


@dataclass
class _Pulse:
    """One crush: its end, the deceleration, the normal at its beginning, and the speed of the rebound."""

    until_s: float
    mps2: float
    normal: Point
    rebound_mps: float


@dataclass
class Crushes:
    """The crushes of a simulation by pair."""

    impact: Impact = USUAL
    pulses: dict[tuple[str, str], _Pulse] = field(default_factory=dict)
    passing: dict[tuple[str, str], float] = field(default_factory=dict)
    """Pairs that glance off each other, with the time until which they pass."""

    def begins(self, a: Mover, b: Mover, seen: Separation, now_s: float) -> bool:
        """Whether two bodies that come to touch crush; they then do so from now on."""
        if not (a.fixed or b.fixed) and key_of(a, b) not in self.passing and glance(a.body, b.body, seen, self.impact):
            self.passing[key_of(a, b)] = now_s + _PASS_S
            return True
        thing, by = (a, b) if a.fixed else (b, a)
        if not thing.fixed or max(thing.body.size) > NARROW_M or by.fixed or min(by.body.size) < _WIDE_M:
            return False
        closing = approach(a.body, b.body, (thing.body.x, thing.body.y), seen.normal)
        if closing < _LEAST_MPS:
            return False
        lasts_s = min(_PULSE_S, 2 * DEEPEST_M / closing)
        self.pulses[key_of(a, b)] = _Pulse(now_s + lasts_s, closing / lasts_s, seen.normal, _REBOUND * closing)
        return True

    def last(self, a: Mover, b: Mover, now_s: float) -> bool:
        """Whether two still crush, or pass each other."""
        pulse, until_s = self.pulses.get(key_of(a, b)), self.passing.get(key_of(a, b), 0.0)
        return now_s < until_s or (pulse is not None and now_s <= pulse.until_s)

    def parting_mps(self, a: Mover, b: Mover) -> float:
        """The speed at which two bodies are moved apart that still overlap."""
        return _OFF_IT_MPS if key_of(a, b) in self.pulses else _PARTING_MPS

    def squeeze(self, pairs: Iterable[Pair], now_s: float, step_s: float) -> None:
        """Slows the approach of those that crush over a step; they part with the rebound where it ends. Those that
        glanced off each other touch as any bodies do once they are apart."""
        for a, b in pairs:
            if self.passing.get(key_of(a, b), 0.0) > now_s:
                if separation(a.body, b.body).gap_m > 0.0:
                    self.passing[key_of(a, b)] = now_s
            elif self.last(a, b, now_s):
                self._squeeze(a, b, now_s, step_s)

    def _squeeze(self, a: Mover, b: Mover, now_s: float, step_s: float) -> None:
        pulse, thing = self.pulses[key_of(a, b)], a if a.fixed else b
        at = thing.body.x, thing.body.y
        closing = approach(a.body, b.body, at, pulse.normal)
        left = closing - pulse.mps2 * step_s
        if left <= 0.0 or now_s + step_s > pulse.until_s:
            left, pulse.until_s = -pulse.rebound_mps, now_s
        slow_parting(a.body, b.body, at, pulse.normal, left - closing)


# ------------------------------------------------------------------ fronts that glance off each other
def glance(a: Body, b: Body, seen: Separation, impact: Impact) -> bool:
    """Whether two bodies that come to touch glance off each other; they then have the velocities behind the blow."""
    at = corner_of(a, b, seen.normal) if impact.glance_rad else None
    if at is None or approach(a, b, at, seen.normal) < _LEAST_MPS:
        return False
    collide(a, b, at, slanted(a, at, seen.normal, impact.glance_rad), impact.restitution, impact.friction)
    return True


def corner_of(a: Body, b: Body, normal: Point) -> Point | None:
    """The middle of the part of two fronts that meet head on, where it is small enough to glance; None otherwise.

    `normal`: unit vector from the first to the second.
    """
    ahead = [math.cos(one.heading) * normal[0] + math.sin(one.heading) * normal[1] for one in (a, b)]
    if ahead[0] < _ENDS_ON or -ahead[1] < _ENDS_ON:
        return None
    points = touch_points(a, b)
    across = [p[1] * normal[0] - p[0] * normal[1] for p in points]
    little = max(across) - min(across) <= _MOST_SHARE * min(a.size[1], b.size[1])
    return center_of(points) if len(points) > 1 and little else None


def meet_in_part(one: tuple[Floats, Size], other: tuple[Floats, Size]) -> bool:
    """Whether two boxes that touch, (3,) poses and sizes, are fronts that meet head on in a small part of them."""
    a, b = (body((float(p[0]), float(p[1]), float(p[2])), size, 1.0) for p, size in (one, other))
    return corner_of(a, b, separation(a, b).normal) is not None


def slanted(a: Body, at: Point, normal: Point, by_rad: float) -> Point:
    """A normal from the first body, turned to the side of it on which a place lies: that of its crushed corner."""
    left = (at[1] - a.y) * normal[0] - (at[0] - a.x) * normal[1]
    c, s = math.cos(by_rad), math.copysign(math.sin(by_rad), left)
    return normal[0] * c - normal[1] * s, normal[0] * s + normal[1] * c
