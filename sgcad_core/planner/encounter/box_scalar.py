"""Two boxes in plain floats: how far apart, along which axis, and where they touch.

The scalar twin of `geometry.plane.box_gaps`, for stepping through a crash one small step at a time, where arrays of
one row cost more than they save. Metres and radians.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sgcad_core.planner.aftermath.impact import Body, Point

_NEAR_M = 0.03
"""Corners this close to the other box take part in a touch."""


class Apart(NamedTuple):
    """Separation along the best axis (negative: overlap) and that axis, a unit vector from the first to the second."""

    gap_m: float
    normal: Point


def apart(a: Body, b: Body) -> Apart:
    """The separating-axis test: exact in sign, a lower bound of the distance where positive."""
    dx, dy = b.x - a.x, b.y - a.y
    ca, sa, cb, sb = math.cos(a.heading), math.sin(a.heading), math.cos(b.heading), math.sin(b.heading)
    along, across = abs(ca * cb + sa * sb), abs(ca * sb - sa * cb)
    al, aw, bl, bw = a.size[0] / 2, a.size[1] / 2, b.size[0] / 2, b.size[1] / 2
    rows = (
        (dx * ca + dy * sa, al + bl * along + bw * across, ca, sa),
        (dy * ca - dx * sa, aw + bl * across + bw * along, -sa, ca),
        (dx * cb + dy * sb, bl + al * along + aw * across, cb, sb),
        (dy * cb - dx * sb, bw + al * across + aw * along, -sb, cb),
    )
    gap, best = -math.inf, rows[0]
    for row in rows:  # the first of the widest; max() with a key takes three times as long
        if (wide := abs(row[0]) - row[1]) > gap:
            gap, best = wide, row
    way, _, x, y = best
    return Apart(gap, (x, y) if way >= 0 else (-x, -y))


def touch_points(a: Body, b: Body) -> list[Point]:
    """The corners of either box in (or within centimetres of) the other; the point midway where there are none."""
    one, two = _frame(a), _frame(b)
    points = [*_held(one, two), *_held(two, one)]
    return points or [((a.x + b.x) / 2, (a.y + b.y) / 2)]


def mean(points: list[Point]) -> Point:
    """The center of some points."""
    if len(points) == 1:
        return points[0]
    return sum([p[0] for p in points]) / len(points), sum([p[1] for p in points]) / len(points)


_Frame = tuple[float, float, float, float, float, float]
"""Center, cosine and sine of the heading, half length and half width of a box."""


def _frame(a: Body) -> _Frame:
    return a.x, a.y, math.cos(a.heading), math.sin(a.heading), a.size[0] / 2, a.size[1] / 2


def _held(one: _Frame, other: _Frame) -> list[Point]:
    """The corners of a box in (or within centimetres of) another, counter-clockwise from front left."""
    x, y, c, s, length, width = one
    lc, ls, wc, ws = length * c, length * s, width * c, width * s
    corners = (
        (x + lc - ws, y + ls + wc), (x - lc - ws, y - ls + wc), (x - lc + ws, y - ls - wc), (x + lc + ws, y + ls - wc)
    )  # fmt: skip
    x, y, c, s, length, width = other
    length, width = length + _NEAR_M, width + _NEAR_M
    return [
        p for p in corners
        if abs((p[0] - x) * c + (p[1] - y) * s) <= length and abs((p[1] - y) * c - (p[0] - x) * s) <= width
    ]  # fmt: skip
