"""One OpenDRIVE road: its reference line, its lane sections and the lanes' places and widths.

Elevation is left out: played motion is plane. Formulas: ASAM OpenDRIVE 1.8, section 11.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

import numpy as np

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.openscenario.roads.road_geometry import MAX_ROAD_M, reference_line
from sgcad_core.geometry.plane import Floats

DRIVABLE = (
    "driving", "bidirectional", "entry", "exit", "onRamp", "offRamp", "connectingRamp", "biking", "restricted", "bus",
    "taxi", "HOV", "slipLane", "stop", "parking", "mwyEntry", "mwyExit",
)  # fmt: skip
MAX_LANES = 100
"""Lanes on one side of a section."""


@dataclass(frozen=True, eq=False)
class Lane:
    """One lane of one section: its width or outer border over s, and the lanes it leads to."""

    node: XmlNode
    kind: str
    widths: Floats
    borders: Floats
    """(n, 5) begin, a, b, c, d by rising begin: a + b d + c d² + d d³ with d counted from there."""
    before: int | None
    after: int | None


@dataclass(frozen=True, eq=False)
class LaneSection:
    """Lanes of one section by id, without lane 0; s in [begin, end)."""

    begin_m: float
    end_m: float
    lanes: dict[int, Lane]

    def center_t(self, lane: int, s_m: Floats) -> Floats:
        """t of a lane's center, from the (offset) center line."""
        inner, outer = self.edges_t(lane, s_m)
        return (inner + outer) / 2

    def edges_t(self, lane: int, s_m: Floats) -> tuple[Floats, Floats]:
        """t of a lane's inner and outer edge: widths of the lanes inside added up, or borders where they stand."""
        sign, inner = (1 if lane > 0 else -1), np.zeros_like(s_m)
        outer = inner
        for i in range(1, abs(lane) + 1):
            inner, outer = outer, self._outer(sign * i, outer, s_m)
        return inner, outer

    def _outer(self, lane: int, inner: Floats, s_m: Floats) -> Floats:
        if (found := self.lanes.get(lane)) is None:
            return inner
        if len(found.borders) and not len(found.widths):
            return cubics(found.borders, s_m - self.begin_m)
        moved: Floats = inner + (1 if lane > 0 else -1) * cubics(found.widths, s_m - self.begin_m)
        return moved


class RoadLine:
    """One road: its sampled reference line and its lanes."""

    def __init__(self, node: XmlNode) -> None:
        self.node, self.id = node, node.text("id")
        self.length_m = node.positive("length")
        if self.length_m > MAX_ROAD_M:
            raise node.fault(f"road longer than {MAX_ROAD_M:g} m", f"{self.length_m:g}")
        self.junction = node.text("junction", "-1")
        self.left_hand = node.text("rule", "RHT") == "LHT"
        self.sections = self._sections()
        self._offsets = _cubics(node.need("lanes").children("laneOffset"), "s")
        begins = [section.begin_m for section in self.sections]
        self._begins = list(accumulate(reversed(begins), min))[::-1]
        """Where each section or a later one begins at the earliest: rising, in whatever order they stand."""
        self._centers: dict[tuple[int, int], Floats] = {}

    @cached_property
    def reference(self) -> Floats:
        """(n, 4) s, x, y, heading along the reference line; headings are continuous."""
        return reference_line(self.node)

    @cached_property
    def _columns(self) -> Floats:
        """(4, n) the same, so that a column lies in one piece."""
        return np.ascontiguousarray(self.reference.T)

    def sense(self, lane: int) -> int:
        """1 where traffic drives a lane along s, -1 where against it."""
        return (1 if lane < 0 else -1) * (-1 if self.left_hand else 1)

    def pose(self, s_m: float, t_m: float = 0.0) -> Pose:
        """Pose at road coordinates. Raises ValueError beyond the road."""
        self.check(s_m)
        s, x, y, h = self._columns
        heading = float(np.interp(s_m, s, h))
        here = float(np.interp(s_m, s, x)), float(np.interp(s_m, s, y))
        return Pose(here[0] - t_m * math.sin(heading), here[1] + t_m * math.cos(heading), heading)

    def lane_t(self, lane: int, s_m: float) -> float:
        """t of a lane's center there; lane 0 is the center line. Raises ValueError where there is no such lane."""
        section = self.section(s_m)
        if lane and lane not in section.lanes:
            known = ", ".join(str(i) for i in sorted(section.lanes, reverse=True)) or "none"
            raise ValueError(f"road {self.id!r} has no lane {lane} at s = {s_m:g} m; lanes there: {known}")
        s = np.array([s_m])
        return float((self._offset(s) + section.center_t(lane, s))[0])

    def width_m(self, lane: int, s_m: float) -> float:
        """A lane's width there, metres."""
        inner, outer = self.section(s_m).edges_t(lane, np.array([s_m]))
        return float(abs(outer - inner)[0])

    def lane_at(self, s_m: float, t_m: float) -> int:
        """The lane that holds t there, else the nearest one; 0 where the road has none."""
        section, s = self.section(s_m), np.array([s_m])
        offset = float(self._offset(s)[0])

        def beyond(lane: int) -> float:
            low, high = sorted(float(edge[0]) for edge in section.edges_t(lane, s))
            return max(low - (t_m - offset), (t_m - offset) - high)

        return min(section.lanes, key=beyond, default=0)

    def center(self, index: int, lane: int) -> Floats:
        """(n, 5) s, x, y, reference heading and half width of a lane's center through one section, s rising."""
        if (index, lane) not in self._centers:
            self._centers[index, lane] = self._center(self.sections[index], lane)
        return self._centers[index, lane]

    def _center(self, section: LaneSection, lane: int) -> Floats:
        along = self._columns[0]
        first, last = np.searchsorted(along, section.begin_m, "right"), np.searchsorted(along, section.end_m, "left")
        s = np.concatenate(([section.begin_m], along[first:last], [section.end_m]))
        self.node.spend("points of roads", len(s))
        self.node.spend("edges of lanes", len(s) * abs(lane))
        x, y, h = (np.interp(s, along, column) for column in self._columns[1:])
        inside = np.minimum(s, section.end_m - 1e-9)
        near, far = section.edges_t(lane, inside)
        t = self._offset(inside) + (near + far) / 2
        return np.column_stack((s, x - t * np.sin(h), y + t * np.cos(h), h, np.abs(far - near) / 2))

    def section(self, s_m: float) -> LaneSection:
        """The lane section there."""
        return self.sections[self.section_index(s_m)]

    def section_index(self, s_m: float) -> int:
        """Index of the lane section there. Raises ValueError beyond the road."""
        self.check(s_m)
        return max(bisect_right(self._begins, s_m + 1e-9) - 1, 0)

    def check(self, s_m: float) -> None:
        """Raise ValueError beyond the road's ends (1 cm is forgiven)."""
        if not -0.01 <= s_m <= self.length_m + 0.01:
            raise ValueError(f"s = {s_m:g} m lies beyond road {self.id!r}, which has s = 0 to {self.length_m:g} m")

    def _offset(self, s_m: Floats) -> Floats:
        return cubics(self._offsets, s_m)

    def _sections(self) -> list[LaneSection]:
        nodes = self.node.need("lanes").children("laneSection")
        if not nodes:
            raise self.node.fault("has no lane section")
        ends = [*(n.number("s") for n in nodes[1:]), self.length_m]
        return [LaneSection(n.number("s"), end, _lanes(n)) for n, end in zip(nodes, ends, strict=True)]


def _lanes(section: XmlNode) -> dict[int, Lane]:
    lanes = [lane for side in section.children("left", "right") for lane in side.children("lane")]
    if len(lanes) > 2 * MAX_LANES:
        raise section.fault(f"more than {2 * MAX_LANES} lanes", str(len(lanes)))
    found = {lane.whole("id"): _lane(lane) for lane in lanes}
    if worst := max((i for i in found if abs(i) > MAX_LANES), default=None, key=abs):
        raise section.fault(f"lane ids must lie within +-{MAX_LANES}", str(worst))
    found.pop(0, None)
    return found


def _lane(node: XmlNode) -> Lane:
    link = node.find("link")
    ends = [link.find(side) if link else None for side in ("predecessor", "successor")]
    before, after = (end.whole("id") if end else None for end in ends)
    widths, borders = (_cubics(node.children(tag), "sOffset") for tag in ("width", "border"))
    return Lane(node, node.text("type", "driving"), widths, borders, before, after)


def _cubics(entries: Sequence[XmlNode], start: str) -> Floats:
    rows = np.array([[e.number(start), *(e.number(k, 0.0) for k in "abcd")] for e in entries]).reshape(-1, 5)
    found: Floats = rows[np.argsort(rows[:, 0], kind="stable")]
    return found


def cubics(entries: Floats, s_m: Floats) -> Floats:
    """Piecewise cubics, (n, 5) rows by rising begin, at s; 0 before the first entry."""
    if not len(entries):
        return np.zeros_like(s_m)
    at = np.searchsorted(entries[:, 0], s_m + 1e-9, side="right") - 1
    begin, a, b, c, cubic = entries[np.maximum(at, 0)].T
    d = s_m - begin
    return np.where(at >= 0, a + d * (b + d * (c + d * cubic)), 0.0)
