"""OpenDRIVE reference lines and lane centers as dense polylines, for playing lane-bound scenarios.

A vertex every 0.25 m: within 2 mm of the curve at a radius of 5 m. Knows lines, arcs, spirals and
paramPoly3; elevation is left out. Formulas: ASAM OpenDRIVE 1.7, sections 7 and 9.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sgcad_core.formats.openscenario.motion import Pose
from sgcad_core.formats.openscenario.read import Node
from sgcad_core.geometry.plane import Floats

STEP_M = 0.25
MAX_ROAD_M = 20_000.0
DRIVABLE = ("driving", "bidirectional", "entry", "exit", "onRamp", "offRamp", "connectingRamp", "biking", "restricted")


@dataclass(frozen=True, eq=False)
class LaneSection:
    """Lanes of one section: id -> its element; s in [begin, end)."""

    begin_m: float
    end_m: float
    lanes: dict[int, Node]

    def center_t(self, lane: int, s_m: Floats) -> Floats:
        """t of a lane's center, from the (offset) center line: inner lanes' widths and half of its own."""
        sign = 1 if lane > 0 else -1
        inner = [self._widths(sign * i, s_m) for i in range(1, abs(lane))]
        t: Floats = sign * (sum(inner, np.zeros_like(s_m)) + self._widths(lane, s_m) / 2)
        return t

    def _widths(self, lane: int, s_m: Floats) -> Floats:
        if (node := self.lanes.get(lane)) is None:
            return np.zeros_like(s_m)
        return polynomials(node.children("width"), "sOffset", s_m - self.begin_m)


class RoadLine:
    """One road: its sampled reference line and its lanes."""

    def __init__(self, node: Node) -> None:
        self.node, self.id = node, node.text("id")
        self.length_m = node.positive("length")
        if self.length_m > MAX_ROAD_M:
            raise node.fault(f"road longer than {MAX_ROAD_M:g} m", f"{self.length_m:g}")
        self.sections = self._sections()

    @cached_property
    def reference(self) -> Floats:
        """(n, 4) s, x, y, heading along the reference line; headings are continuous."""
        parts = [_sampled(g) for g in self.node.need("planView").children("geometry")]
        if not parts:
            raise self.node.fault("has no geometry", remedy="add a <geometry> to its <planView>")
        rows = np.vstack(parts)
        rows[:, 3] = np.unwrap(rows[:, 3])
        return rows

    def pose(self, s_m: float, t_m: float = 0.0) -> Pose:
        """Pose at road coordinates. Raises ValueError beyond the road."""
        self.check(s_m)
        s, x, y, h = self.reference.T
        heading = float(np.interp(s_m, s, h))
        here = float(np.interp(s_m, s, x)), float(np.interp(s_m, s, y))
        return Pose(here[0] - t_m * math.sin(heading), here[1] + t_m * math.cos(heading), heading)

    def lane_t(self, lane: int, s_m: float) -> float:
        """t of a lane's center there. Raises ValueError where there is no such lane."""
        section = self.section(s_m)
        if lane not in section.lanes:
            known = ", ".join(str(i) for i in sorted(section.lanes, reverse=True)) or "none"
            raise ValueError(f"road {self.id!r} has no lane {lane} at s = {s_m:g} m; lanes there: {known}")
        s = np.array([s_m])
        return float((self._offset(s) + section.center_t(lane, s))[0])

    def center(self, index: int, lane: int) -> Floats:
        """(n, 4) s, x, y and reference heading of a lane's center through one section, s rising."""
        section = self.sections[index]
        inner = self.reference[(self.reference[:, 0] > section.begin_m) & (self.reference[:, 0] < section.end_m)]
        s = np.concatenate(([section.begin_m], inner[:, 0], [section.end_m]))
        x, y, h = (np.interp(s, self.reference[:, 0], self.reference[:, i]) for i in (1, 2, 3))
        inside = np.minimum(s, section.end_m - 1e-9)
        t = self._offset(inside) + section.center_t(lane, inside)
        return np.column_stack((s, x - t * np.sin(h), y + t * np.cos(h), h))

    def section(self, s_m: float) -> LaneSection:
        """The lane section there."""
        return self.sections[self.section_index(s_m)]

    def section_index(self, s_m: float) -> int:
        """Index of the lane section there. Raises ValueError beyond the road."""
        self.check(s_m)
        return max((i for i, part in enumerate(self.sections) if part.begin_m <= s_m + 1e-9), default=0)

    def check(self, s_m: float) -> None:
        """Raise ValueError beyond the road's ends (1 cm is forgiven)."""
        if not -0.01 <= s_m <= self.length_m + 0.01:
            raise ValueError(f"s = {s_m:g} m lies beyond road {self.id!r}, which has s = 0 to {self.length_m:g} m")

    def _offset(self, s_m: Floats) -> Floats:
        return polynomials(self.node.need("lanes").children("laneOffset"), "s", s_m)

    def _sections(self) -> list[LaneSection]:
        nodes = self.node.need("lanes").children("laneSection")
        if not nodes:
            raise self.node.fault("has no lane section")
        ends = [*(n.number("s") for n in nodes[1:]), self.length_m]
        return [LaneSection(n.number("s"), end, _lanes(n)) for n, end in zip(nodes, ends, strict=True)]


def _lanes(section: Node) -> dict[int, Node]:
    lanes = (lane for side in section.children("left", "right") for lane in side.children("lane"))
    return {int(lane.number("id")): lane for lane in lanes}


def polynomials(entries: Sequence[Node], start: str, s_m: Floats) -> Floats:
    """Piecewise cubics a + b d + c d² + d d³ at s; 0 before the first entry."""
    total = np.zeros_like(s_m)
    for entry in entries:
        begin = entry.number(start)
        d = s_m - begin
        a, b, c, cubic = (entry.number(k, 0.0) for k in "abcd")
        total = np.where(d >= -1e-9, a + d * (b + d * (c + d * cubic)), total)
    return total


# ------------------------------------------------------------------ geometry
def _sampled(geometry: Node) -> Floats:
    """(n, 4) s, x, y, heading of one <geometry>; s is the arc length scaled to the stated length."""
    length = geometry.number("length")
    if not 0 <= length <= MAX_ROAD_M:
        raise geometry.fault(f"length must lie within 0 and {MAX_ROAD_M:g} m", f"{length:g}")
    shape = geometry.only()
    if shape.tag not in _SHAPES:
        raise shape.unsupported(f"the player does not know <{shape.tag}> geometry")
    share = np.linspace(0.0, 1.0, max(2, math.ceil(length / STEP_M) + 1))
    u, v, turn = _SHAPES[shape.tag](shape, share, length)
    x, y, heading = (geometry.number(name) for name in ("x", "y", "hdg"))
    c, s = math.cos(heading), math.sin(heading)
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(u), np.diff(v)))))
    scaled = along * (length / along[-1] if along[-1] > 0 else 0.0)
    return np.column_stack((geometry.number("s") + scaled, x + u * c - v * s, y + u * s + v * c, heading + turn))


Local = tuple[Floats, Floats, Floats]


def _line(shape: Node, share: Floats, length: float) -> Local:
    return share * length, np.zeros_like(share), np.zeros_like(share)


def _arc(shape: Node, share: Floats, length: float) -> Local:
    k = shape.number("curvature")
    return _curved(k * share * length, share, length)


def _spiral(shape: Node, share: Floats, length: float) -> Local:
    first, last = shape.number("curvStart"), shape.number("curvEnd")
    return _curved((first + (last - first) * share / 2) * share * length, share, length)


def _curved(turn: Floats, share: Floats, length: float) -> Local:
    """The curve with a given heading at every share of its length (midpoint rule: exact to 1e-4 m a step)."""
    step, middle = np.diff(share) * length, (turn[1:] + turn[:-1]) / 2
    chord = np.sinc(np.diff(turn) / (2 * math.pi))  # sin(x) / x: exact for a constant curvature
    u = np.concatenate(([0.0], np.cumsum(step * chord * np.cos(middle))))
    v = np.concatenate(([0.0], np.cumsum(step * chord * np.sin(middle))))
    return u, v, turn


def _param_poly3(shape: Node, share: Floats, length: float) -> Local:
    p = share * (1.0 if shape.text("pRange", "normalized") == "normalized" else length)
    k = [shape.number(name) for name in ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV")]
    u = k[0] + p * (k[1] + p * (k[2] + p * k[3]))
    v = k[4] + p * (k[5] + p * (k[6] + p * k[7]))
    du, dv = k[1] + p * (2 * k[2] + 3 * p * k[3]), k[5] + p * (2 * k[6] + 3 * p * k[7])
    return u, v, np.unwrap(np.arctan2(dv, du))


_SHAPES: dict[str, Callable[[Node, Floats, float], Local]] = {
    "line": _line, "arc": _arc, "spiral": _spiral, "paramPoly3": _param_poly3,
}  # fmt: skip
