"""Joints between tractors and trailers while both slide: one place in the frame of either box.

Plain floats; knows two bodies, no clock. SI units.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.aftermath.impact import Body, Point, compliance, solve

_STILL_MPS = 1e-4
_DRAWN = 0.2
"""Share of the gap of a hitch that is closed in one step."""


class Hitch(NamedTuple):
    """A joint of two movers by name: the same place in the frame of either box."""

    first: str
    second: str
    on_first: Point
    on_second: Point


def hitched(names: tuple[str, str], first: Floats, second: Floats, behind_m: float) -> Hitch:
    """The joint `behind_m` behind the first box's center, as both stand in two poses (x, y, heading)."""
    x, y, heading = (float(v) for v in first)
    at = (x - behind_m * math.cos(heading), y - behind_m * math.sin(heading))
    return Hitch(*names, (-behind_m, 0.0), _local(second, at))


def equalize_velocities(hitch: Hitch, a: Body, b: Body) -> bool:
    """Applies an impulse after which both ends of a hitch have one velocity; whether one was needed."""
    at = _place(a, hitch.on_first)
    (ax, ay), (bx, by) = a.velocity_at(*at), b.velocity_at(*at)
    if math.hypot(ax - bx, ay - by) < _STILL_MPS:
        return False
    jx, jy = solve(compliance(a, b, at), (ax - bx, ay - by))
    a.push(-jx, -jy, *at)
    b.push(jx, jy, *at)
    return True


def draw_together(hitch: Hitch, a: Body, b: Body) -> bool:
    """Closes the gap of a hitch by moving the trailer."""
    (ax, ay), (bx, by) = _place(a, hitch.on_first), _place(b, hitch.on_second)
    b.x += _DRAWN * (ax - bx)
    b.y += _DRAWN * (ay - by)
    return True


def _local(pose: Floats, at: Point) -> Point:
    c, s, dx, dy = math.cos(pose[2]), math.sin(pose[2]), at[0] - float(pose[0]), at[1] - float(pose[1])
    return dx * c + dy * s, dy * c - dx * s


def _place(one: Body, local: Point) -> Point:
    c, s = math.cos(one.heading), math.sin(one.heading)
    return one.x + local[0] * c - local[1] * s, one.y + local[0] * s + local[1] * c
