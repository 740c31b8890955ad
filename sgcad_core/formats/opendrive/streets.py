"""Roads of an OpenDRIVE map from the edges of a lane graph: both directions of a street are one road.

The reference line is the left border of the forward edge's lanes or, where a median parts the directions,
runs in its middle. Right lanes (-1, -2, ...) are the forward edge's, left lanes (1, 2, ...) the backward
edge's. Metres; knows no XML.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.opendrive.reference import Piece, length_of, pieces, pose_at
from sgcad_core.formats.opendrive.widths import Width, clean, fitted, offsets_at, offsets_or_end, stations_of
from sgcad_core.geometry.plane import Floats, arc_lengths, parallel_polyline, resample
from sgcad_core.roads.lane_graph import ROAD_WORKS, Edge, Lane, LaneGraph, road_of

Side = Literal["left", "right"]
SAME_M = 0.005
"""Borders nearer than this are one line; a width that varies by less is constant."""
WIDEST_M = 40.0
OVERLAP_M = 0.05
"""Directions farther apart than the one, or overlapping by more than the other, are roads of their own."""
LEAST_LENGTH_M = 0.05
BESIDE_TYPES = ("biking", "parking", "shoulder", "sidewalk", ROAD_WORKS)
"""Lanes that are not for cars, by the type that the .net.xml names; OpenDRIVE calls them the same."""
CURB_M = 0.15
"""The outermost part of a sidewalk towards the lanes, as wide as a curb (6 in)."""
BESIDE_SHARE = 0.3
"""Two directions that do not lie beside each other over more of the road are roads of their own."""


@dataclass(frozen=True)
class RoadLane:
    """A lane of a road: its id, OpenDRIVE type, widths, and the SUMO lane that it is (None: a median)."""

    id: int
    type: str
    widths: tuple[Width, ...]
    lane: Lane | None = None

    def width_at(self, s_m: float) -> float:
        """Width in metres at s."""
        entry = next(w for w in reversed(self.widths) if w.s_m <= s_m + 1e-9 or w is self.widths[0])
        return entry.a + entry.b * (s_m - entry.s_m)


@dataclass(frozen=True, eq=False)
class Street:
    """One road: its edges, its reference line and its lanes from the reference line outwards."""

    id: str
    forward: Edge
    backward: Edge | None
    line: tuple[Piece, ...]
    right: tuple[RoadLane, ...]
    left: tuple[RoadLane, ...] = ()

    @cached_property
    def length_m(self) -> float:
        """Length of the reference line."""
        return length_of(self.line)

    @property
    def name(self) -> str:
        """The road's name in this project."""
        return road_of(self.forward.id)[0]

    @property
    def edges(self) -> tuple[Edge, ...]:
        """Forward, then backward where there is one."""
        return (self.forward, self.backward) if self.backward else (self.forward,)

    def strips(self, side: Side) -> tuple[RoadLane, ...]:
        """Lanes of a side from the reference line outwards."""
        return self.right if side == "right" else self.left

    def side_of(self, edge: str) -> Side:
        """The side on which an edge's lanes lie."""
        return "right" if edge == self.forward.id else "left"

    def strip_of(self, edge: str, index: int) -> RoadLane:
        """The lane that is a SUMO lane."""
        return next(s for s in self.strips(self.side_of(edge)) if s.lane is not None and s.lane.index == index)

    def border_t(self, strip: RoadLane, s_m: float, inner: bool = False) -> float:
        """t of a lane's outer (or inner) border at s; left positive."""
        side: Side = "right" if strip.id < 0 else "left"
        reach = sum(s.width_at(s_m) for s in self.strips(side) if abs(s.id) < abs(strip.id) + (not inner))
        return -reach if side == "right" else reach

    def driven_end(self, edge: str, at_end: bool) -> float:
        """s where an edge ends (or begins), as one drives."""
        return self.length_m if at_end == (self.side_of(edge) == "right") else 0.0

    def lane_pose(self, edge: str, index: int, at_end: bool) -> Pose:
        """Pose of a lane's center where it ends (or begins), in its driving direction."""
        s, strip = self.driven_end(edge, at_end), self.strip_of(edge, index)
        pose = pose_at(self.line, s)
        t = (self.border_t(strip, s) + self.border_t(strip, s, inner=True)) / 2
        x, y = pose.left(t)
        return Pose(x, y, pose.heading_rad if strip.id < 0 else pose.heading_rad + np.pi)


def streets(graph: LaneGraph, trims: Mapping[tuple[str, bool], float] | None = None) -> tuple[Street, ...]:
    """All roads in the order of their edges, ids "1", "2", ...

    `trims`: (edge, whether at its end) -> metres that the road is cut back there.
    """
    found: list[Street] = []
    taken: set[str] = set()
    for edge in graph.edges.values():
        if edge.id in taken:
            continue
        other = _opposite(edge, graph, taken)
        ahead, back = (other, edge) if other and edge.id.startswith("-") else (edge, other)
        street = _street(str(len(found) + 1), ahead, back, trims or {})
        if street is None:
            street, other = _street(str(len(found) + 1), edge, None, trims or {}), None
        if street is not None:
            found.append(street)
        taken |= {edge.id} | ({other.id} if other else set())
    return tuple(found)


def _opposite(edge: Edge, graph: LaneGraph, taken: set[str]) -> Edge | None:
    """The edge of the same road the other way, else the only one between the same nodes."""
    road, way = road_of(edge.id)
    named = graph.edges.get(road if way == "backward" else f"-{road}")
    ends = (edge.to_node, edge.from_node)
    if named is not None:
        return named if (named.from_node, named.to_node) == ends and named.id not in taken else None
    others = [e for e in graph.edges.values() if (e.from_node, e.to_node) == ends]
    return others[0] if len(others) == 1 and others[0].id not in taken and _alone(edge, graph) else None


def _alone(edge: Edge, graph: LaneGraph) -> bool:
    ends = (edge.from_node, edge.to_node)
    return sum((e.from_node, e.to_node) == ends for e in graph.edges.values()) == 1


# ------------------------------------------------------------------ one road


def _street(name: str, forward: Edge, backward: Edge | None, trims: Mapping[tuple[str, bool], float]) -> Street | None:
    """A road of one or two edges; None where two are not one road, or nothing is left of it."""
    ahead = _left_border(forward)
    line, back = ahead, None if backward is None else _left_border(backward)[::-1]
    varies = False
    if back is not None:
        gaps = _gaps(ahead, back)
        if gaps is None or gaps.max() > WIDEST_M or gaps.min() < -OVERLAP_M:
            return None
        if gaps.max() > SAME_M:
            line, varies = _middle(ahead, back), bool(np.ptp(gaps) > SAME_M)
    cut = _trimmed(line, forward, backward, trims)
    if cut is None:
        return None
    line = cut
    reach = (_reach(backward) if backward else 0.0), _reach(forward)
    drawn = pieces(line, reach)
    right = _strips(forward, -1, line, ahead, varies, backward is not None)
    left = () if backward is None or back is None else _strips(backward, 1, line, back, varies, False)
    return Street(name, forward, backward, drawn, right, left)


def _reach(edge: Edge) -> float:
    return sum(lane.width_m for lane in edge.lanes)


def _left_border(edge: Edge) -> Floats:
    inner = edge.lanes[-1]
    return parallel_polyline(clean(inner.shape), inner.width_m / 2)


def _gaps(line: Floats, other: Floats) -> Floats | None:
    """How far another line lies to the left at its stations; None where it does not run beside it."""
    found = offsets_at(line, other, stations_of(line))
    inner = found[~np.isnan(found)]
    return None if np.isnan(found[1:-1]).mean() > BESIDE_SHARE or not len(inner) else inner


def _middle(one: Floats, two: Floats) -> Floats:
    """The line between two lines that run side by side, a vertex for each of both."""
    shares = np.union1d(*(np.round(arc_lengths(x) / max(arc_lengths(x)[-1], 1e-9), 9) for x in (one, two)))
    halves = [resample(x, shares * arc_lengths(x)[-1]) for x in (one, two)]
    return clean(np.asarray((halves[0] + halves[1]) / 2))


def _trimmed(
    line: Floats, forward: Edge, backward: Edge | None, trims: Mapping[tuple[str, bool], float]
) -> Floats | None:
    """The part of a reference line beside which every lane lies; None where that is nearly nothing."""
    first = [_along(line, lane.shape[0]) for lane in forward.lanes]
    last = [_along(line, lane.shape[-1]) for lane in forward.lanes]
    for lane in backward.lanes if backward else ():
        first.append(_along(line, lane.shape[-1]))
        last.append(_along(line, lane.shape[0]))
    start = max(0.0, *first) + _trim(trims, forward, backward, at_start=True)
    total = float(arc_lengths(line)[-1])
    end = min(total, *last) - _trim(trims, forward, backward, at_start=False)
    if end - start < LEAST_LENGTH_M:
        return None
    if start < SAME_M / 5 and total - end < SAME_M / 5:
        return line
    along = arc_lengths(line)
    inner = along[(along > start + 1e-3) & (along < end - 1e-3)]
    return resample(line, np.concatenate(([start], inner, [end])))


def _trim(trims: Mapping[tuple[str, bool], float], forward: Edge, backward: Edge | None, at_start: bool) -> float:
    keys = [(forward.id, not at_start)] + ([(backward.id, at_start)] if backward else [])
    return max(trims.get(key, 0.0) for key in keys)


def _along(line: Floats, point: Floats) -> float:
    """s of a point near an end of a line, measured on the straight end pieces (negative before the line)."""
    start, first = line[0], line[1] - line[0]
    end, last = line[-1], line[-1] - line[-2]
    before = float((point - start) @ first / np.hypot(*first))
    after = float((point - end) @ last / np.hypot(*last))
    near_start = np.hypot(*(point - start)) < np.hypot(*(point - end))
    return before if near_start else float(arc_lengths(line)[-1]) + after


# ------------------------------------------------------------------ lanes
def _strips(
    edge: Edge, sign: int, line: Floats, border: Floats, varies: bool, center_lane: bool
) -> tuple[RoadLane, ...]:
    """Lanes of one side from the inside out, a median strip first where the border lies off the line."""
    lanes = list(reversed(edge.lanes))
    stations = stations_of(line)
    if varies:
        inner = [border, *(parallel_polyline(clean(lane.shape), -lane.width_m / 2)[::-sign] for lane in lanes)]
        offsets = np.abs([offsets_or_end(line, b, stations) for b in inner])
        widths = [fitted(stations, w) for w in (offsets[0], *np.diff(offsets, axis=0))]
    else:
        gap = abs(float(np.mean(offsets_or_end(line, border, stations))))
        widths = [(Width(0.0, gap),), *((Width(0.0, lane.width_m),) for lane in lanes)]
    wide = max(w.a for w in widths[0]) > SAME_M / 2
    rows: list[tuple[str, Lane | None, tuple[Width, ...]]] = [("median", None, widths[0])] if wide else []
    for lane, wide_m in zip(lanes, widths[1:], strict=True):
        kind = _lane_type(lane, edge, center_lane)
        if kind == "sidewalk":
            rows.append(("curb", None, (Width(0.0, CURB_M),)))
            wide_m = tuple(replace(w, a=w.a - CURB_M) for w in wide_m)
        rows.append((kind, lane, wide_m))
    return tuple(RoadLane(sign * i, kind, w, lane) for i, (kind, lane, w) in enumerate(rows, 1))


def _lane_type(lane: Lane, edge: Edge, two_way: bool) -> str:
    """A two-way left-turn lane is the innermost one, closed to through traffic (`plain_xml`)."""
    if lane.type in BESIDE_TYPES:
        return lane.type
    if two_way and not lane.allows_cars and lane is edge.lanes[-1]:
        return "bidirectional"
    return "driving" if lane.allows_cars else "restricted"
