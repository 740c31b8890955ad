"""Plan-view geometry of OpenDRIVE as dense polylines: line, arc, spiral, poly3, paramPoly3.

A vertex every 0.25 m: within 2 mm of the curve at a radius of 5 m. Formulas: ASAM OpenDRIVE 1.8, section 7.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.geometry.plane import Floats

STEP_M = 0.25
MAX_ROAD_M = 20_000.0


def reference_line(road: XmlNode) -> Floats:
    """(n, 4) s, x, y, heading along a road's reference line; headings are continuous. Raises InvalidOutput."""
    found = road.need("planView").children("geometry")
    if not found:
        raise road.fault("has no geometry", remedy="add a <geometry> to its <planView>")
    lengths = [_length(geometry) for geometry in found]
    road.spend("geometries", len(found))
    road.spend("points of roads", sum(map(_count, lengths)))
    parts = [_sampled(geometry, length) for geometry, length in zip(found, lengths, strict=True)]
    rows = np.vstack(parts)
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    rows[:, 3] = np.unwrap(rows[:, 3])
    return rows


def _length(geometry: XmlNode) -> float:
    length = geometry.number("length")
    if not 0 <= length <= MAX_ROAD_M:
        raise geometry.fault(f"length must lie within 0 and {MAX_ROAD_M:g} m", f"{length:g}")
    return length


def _count(length_m: float) -> int:
    return max(2, math.ceil(length_m / STEP_M) + 1)


def _sampled(geometry: XmlNode, length: float) -> Floats:
    """(n, 4) s, x, y, heading of one <geometry>; s is the arc length scaled to the stated length."""
    shape = geometry.find(*_SHAPES) or geometry.only()
    if shape.tag not in _SHAPES:
        raise shape.unsupported(f"the player does not know <{shape.tag}> geometry")
    share = np.linspace(0.0, 1.0, _count(length))
    u, v, turn = _SHAPES[shape.tag](shape, share, length)
    x, y, heading = (geometry.number(name) for name in ("x", "y", "hdg"))
    c, s = math.cos(heading), math.sin(heading)
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(u), np.diff(v)))))
    scaled = along * (length / along[-1] if along[-1] > 0 else 0.0)
    return np.column_stack((geometry.number("s") + scaled, x + u * c - v * s, y + u * s + v * c, heading + turn))


Local = tuple[Floats, Floats, Floats]


def _line(shape: XmlNode, share: Floats, length: float) -> Local:
    return share * length, np.zeros_like(share), np.zeros_like(share)


def _arc(shape: XmlNode, share: Floats, length: float) -> Local:
    k = shape.number("curvature")
    return _curved(k * share * length, share, length)


def _spiral(shape: XmlNode, share: Floats, length: float) -> Local:
    first, last = shape.number("curvStart"), shape.number("curvEnd")
    return _curved((first + (last - first) * share / 2) * share * length, share, length)


def _curved(turn: Floats, share: Floats, length: float) -> Local:
    """The curve with a given heading at every share of its length (midpoint rule: exact to 1e-4 m a step)."""
    step, middle = np.diff(share) * length, (turn[1:] + turn[:-1]) / 2
    chord = np.sinc(np.diff(turn) / (2 * math.pi))  # sin(x) / x: exact for a constant curvature
    u = np.concatenate(([0.0], np.cumsum(step * chord * np.cos(middle))))
    v = np.concatenate(([0.0], np.cumsum(step * chord * np.sin(middle))))
    return u, v, turn


def _param_poly3(shape: XmlNode, share: Floats, length: float) -> Local:
    p = share * (1.0 if shape.text("pRange", "normalized") == "normalized" else length)
    k = [shape.number(name) for name in ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV")]
    u = k[0] + p * (k[1] + p * (k[2] + p * k[3]))
    v = k[4] + p * (k[5] + p * (k[6] + p * k[7]))
    du, dv = k[1] + p * (2 * k[2] + 3 * p * k[3]), k[5] + p * (2 * k[6] + 3 * p * k[7])
    return u, v, np.unwrap(np.arctan2(dv, du))


def _poly3(shape: XmlNode, share: Floats, length: float) -> Local:
    """v = a + b u + c u² + d u³ with u along the start heading; u ends where the arc length is the stated one."""
    a, b, c, d = (shape.number(name) for name in "abcd")
    u = share * length
    v = a + u * (b + u * (c + u * d))
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(u), np.diff(v)))))
    last = float(np.interp(length, along, u)) if along[-1] > 0 else 0.0
    u = share * last
    v, slope = a + u * (b + u * (c + u * d)), b + u * (2 * c + 3 * u * d)
    return u, v, np.arctan(slope)


_SHAPES: dict[str, Callable[[XmlNode, Floats, float], Local]] = {
    "line": _line, "arc": _arc, "spiral": _spiral, "paramPoly3": _param_poly3,
    "poly3": _poly3,
}  # fmt: skip
