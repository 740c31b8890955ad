"""Two boxes in plain floats: how far apart, along which axis, and where they touch.

The scalar twin of `geometry.plane.box_gaps`, for stepping through a crash one small step at a time, where arrays of
one row cost more than they save. Metres and radians.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sgcad_core.planner.impact import Body, Point

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
    way, reach, x, y = max(rows, key=lambda row: abs(row[0]) - row[1])
    sign = 1.0 if way >= 0 else -1.0
    return Apart(abs(way) - reach, (sign * x, sign * y))


def touch_points(a: Body, b: Body) -> list[Point]:
    """The corners of either box in (or within centimetres of) the other; the point midway where there are none."""
    points = [p for one, other in ((a, b), (b, a)) for p in _corners(one) if _holds(other, p)]
    return points or [((a.x + b.x) / 2, (a.y + b.y) / 2)]


def mean(points: list[Point]) -> Point:
    """The center of some points."""
    return sum(p[0] for p in points) / len(points), sum(p[1] for p in points) / len(points)


def radius(a: Body) -> float:
    """From the center to a corner."""
    return math.hypot(*a.size) / 2


def _corners(a: Body) -> list[Point]:
    lc, ls = a.size[0] / 2 * math.cos(a.heading), a.size[0] / 2 * math.sin(a.heading)
    wc, ws = a.size[1] / 2 * math.cos(a.heading), a.size[1] / 2 * math.sin(a.heading)
    return [(a.x + i * lc - j * ws, a.y + i * ls + j * wc) for i, j in ((1, 1), (-1, 1), (-1, -1), (1, -1))]


def _holds(a: Body, p: Point) -> bool:
    c, s, dx, dy = math.cos(a.heading), math.sin(a.heading), p[0] - a.x, p[1] - a.y
    inside = abs(dx * c + dy * s) <= a.size[0] / 2 + _NEAR_M
    return inside and abs(dy * c - dx * s) <= a.size[1] / 2 + _NEAR_M
