"""Reference lines of OpenDRIVE roads: lengths, poses at both ends, and a smooth curve between two poses.

Metres and radians. Knows <line> and <paramPoly3> (all that netconvert writes) and <arc>; a road with another
geometry has no pose here (None). Formulas: ASAM OpenDRIVE 1.7, section 7 (geometry).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.xml import Element
from sgcad_core.geometry.plane import Floats

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_PANELS = 24
_AT = np.concatenate([(_NODES + 1 + 2 * k) / (2 * _PANELS) for k in range(_PANELS)])
_WEIGHT = np.tile(_WEIGHTS, _PANELS) / (2 * _PANELS)


class Pose(NamedTuple):
    """A point and a heading, metres and radians."""

    x_m: float
    y_m: float
    heading_rad: float

    def left(self, t_m: float) -> tuple[float, float]:
        """The point t_m metres to the left (OpenDRIVE's t axis)."""
        return self.x_m - t_m * math.sin(self.heading_rad), self.y_m + t_m * math.cos(self.heading_rad)


def number(element: Element, name: str) -> float:
    """A number attribute; 0 where it is missing, none or not finite. The schema finds fault with such files."""
    try:
        value = float(element.get(name, 0))
    except ValueError:
        return 0.0
    return value if math.isfinite(value) else 0.0


def geometries(road: Element) -> list[Element]:
    """The road's <geometry> elements in order."""
    return list(road.iterfind("planView/geometry"))


def start_pose(geometry: Element) -> Pose:
    """Pose at the beginning of one geometry, the curve's own direction included."""
    pose = _origin(geometry)
    poly = geometry.find("paramPoly3")
    if poly is None:
        return pose
    b_u, b_v = number(poly, "bU"), number(poly, "bV")
    return pose._replace(heading_rad=pose.heading_rad + (math.atan2(b_v, b_u) if (b_u, b_v) != (0, 0) else 0.0))


def end_pose(geometry: Element) -> Pose | None:
    """Pose at the end of one geometry; None where its kind is not known here."""
    pose, length = _origin(geometry), number(geometry, "length")
    if geometry.find("line") is not None:
        return _placed(pose, length, 0.0, 0.0)
    if (arc := geometry.find("arc")) is not None:
        k = number(arc, "curvature")
        if abs(k) < 1e-12:
            return _placed(pose, length, 0.0, 0.0)
        return _placed(pose, math.sin(k * length) / k, (1 - math.cos(k * length)) / k, k * length)
    if (poly := geometry.find("paramPoly3")) is not None:
        u, v, du, dv = _at(_coefficients(poly), _range(poly, length))
        return _placed(pose, u, v, math.atan2(dv, du))
    return None


def arc_lengths_of(found: Sequence[Element]) -> Floats:
    """(n,) true lengths of paramPoly3 geometries, metres (Gauss-Legendre; errors below 1e-4 m even near a cusp)."""
    polys = [(geometry.find("paramPoly3"), number(geometry, "length")) for geometry in found]
    table = np.array([_coefficients(poly) for poly, _ in polys]).reshape(-1, 8)
    return cubic_lengths(table, np.array([_range(poly, length) for poly, length in polys]))


def cubic_lengths(table: Floats, p_end: Floats) -> Floats:
    """(n,) true lengths of curves (n, 8) aU bU cU dU aV bV cV dV from p = 0 to `p_end`, metres."""
    p = p_end[:, None] * _AT
    du = table[:, 1:2] + 2 * table[:, 2:3] * p + 3 * table[:, 3:4] * p**2
    dv = table[:, 5:6] + 2 * table[:, 6:7] * p + 3 * table[:, 7:8] * p**2
    lengths: Floats = p_end * (np.hypot(du, dv) @ _WEIGHT)
    return lengths


def hermite(start: Pose, end: Pose, tangents_m: tuple[float, float] | None = None) -> tuple[float, ...]:
    """aU bU cU dU aV bV cV dV (normalized) of the cubic from pose to pose, in the frame of the start pose.

    Without given lengths the tangents are those of a circular arc with the same turn (the distance of the ends on a
    straight way), at least 0.1 m: a bend around one point needs some length to have headings.
    """
    dx, dy = end.x_m - start.x_m, end.y_m - start.y_m
    c, s = math.cos(start.heading_rad), math.sin(start.heading_rad)
    u, v = dx * c + dy * s, dy * c - dx * s
    turn = end.heading_rad - start.heading_rad
    if tangents_m is None:
        half = min(abs(wrap(turn)), 3.0) / 2
        reach = max(math.hypot(u, v) * (2 * math.tan(half / 2) / math.sin(half) if half > 1e-6 else 1.0), 0.1)
        tangents_m = reach, reach
    first, last = tangents_m
    u1, v1 = last * math.cos(turn), last * math.sin(turn)
    return 0.0, first, 3 * u - 2 * first - u1, u1 + first - 2 * u, 0.0, 0.0, 3 * v - v1, v1 - 2 * v


def wrap(angle_rad: float) -> float:
    """The same angle in [-pi, pi)."""
    return (angle_rad + math.pi) % (2 * math.pi) - math.pi


def _placed(pose: Pose, u: float, v: float, turn_rad: float) -> Pose:
    c, s = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return Pose(pose.x_m + u * c - v * s, pose.y_m + u * s + v * c, pose.heading_rad + turn_rad)


def _origin(geometry: Element) -> Pose:
    return Pose(number(geometry, "x"), number(geometry, "y"), number(geometry, "hdg"))


def _at(k: Sequence[float], p: float) -> tuple[float, float, float, float]:
    u = k[0] + p * (k[1] + p * (k[2] + p * k[3]))
    v = k[4] + p * (k[5] + p * (k[6] + p * k[7]))
    return u, v, k[1] + p * (2 * k[2] + 3 * p * k[3]), k[5] + p * (2 * k[6] + 3 * p * k[7])


def _coefficients(poly: Element) -> list[float]:
    return [number(poly, name) for name in ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV")]


def _range(poly: Element, length: float) -> float:
    return 1.0 if poly.get("pRange", "normalized") == "normalized" else length
