"""The paved surface of a road network: distance and direction of points from it.

The surface is the union of all lanes that cars may use, of center turn lanes and of the ways across the junctions.
Metres and radians in the network's frame. Knows no actor.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import arc_lengths, resample
from sgcad_core.kinds import DRIVEWAY
from sgcad_core.roads.lane_graph import Floats, Lane, LaneGraph, road_of
from sgcad_core.roads.lane_positions import Position, position

_KIND = "kind"
"""The parameter of an edge (`formats/sumo/parameters.py`)."""
_LONGEST_M = 8.0
"""Longest piece of a center line."""
_LEAST_WIDTH_M = 3.2
"""Least width of a connection across a junction."""


class Junction(NamedTuple):
    """A junction of three or more roads: its center, and its area, within the ends of the lanes that meet there."""

    x_m: float
    y_m: float
    normals: Floats
    """(n, 2) unit vectors out of the area, across each of its sides."""
    reaches_m: Floats
    """(n,) distance of each side from the origin along its normal."""

    def out_m(self, points: Floats) -> Floats:
        """(m,) metres by which (m, 2) points lie out of the area; negative within it."""
        out: Floats = (points @ self.normals.T - self.reaches_m).max(axis=1)
        return out


OfLane = Position | Literal["center", "junction"]
"""A lane for cars, a center turn lane, or a way across a junction."""


class RoadSurface(NamedTuple):
    """Pieces of lanes: (n, 2) their ends, (n,) half their widths; and the junctions."""

    starts: Floats
    ends: Floats
    halves: Floats
    junctions: tuple[Junction, ...]
    lanes: tuple[OfLane, ...] = ()
    """By piece what it is a part of."""
    driveways: tuple[bool, ...] = ()
    """By piece whether it is a part of a driveway, or the way into one."""

    @property
    def ways(self) -> Floats:
        """(n,) directions of travel on the pieces, counter-clockwise from east."""
        east, north = (self.ends - self.starts).T
        found: Floats = np.arctan2(north, east)
        return found

    def part(self, numbers: Sequence[int]) -> RoadSurface:
        """The surface of some of its pieces."""
        chosen = list(numbers)
        lanes = tuple(self.lanes[n] for n in chosen) if self.lanes else ()
        aside = tuple(self.driveways[n] for n in chosen) if self.driveways else ()
        return RoadSurface(self.starts[chosen], self.ends[chosen], self.halves[chosen], self.junctions, lanes, aside)

    @property
    def streets(self) -> RoadSurface:
        """Without driveways; the whole where there is nothing else."""
        chosen = [n for n, aside in enumerate(self.driveways) if not aside]
        return self.part(chosen) if chosen else self

    @property
    def roads(self) -> RoadSurface:
        """Without the ways across junctions."""
        return self.part([n for n, lane in enumerate(self.lanes) if lane != "junction"])

    def off(self, points: Floats) -> tuple[Floats, Floats]:
        """(m,) distance of (m, 2) points beyond the edge of the nearest lane (negative: on it), and the (m,) bearing
        from it.

        Bearings are counter-clockwise from east, from the lane's center line to the point.
        """
        beyond, bearing, _ = self.nearest(points)
        return beyond, bearing

    def nearest(self, points: Floats) -> tuple[Floats, Floats, NDArray[np.int_]]:
        """As `off`, and the (m,) number of the nearest piece of each point."""
        beyond, dx, dy = self.from_pieces(points)
        nearest = np.argmin(beyond, axis=1)
        rows = np.arange(len(points))
        return beyond[rows, nearest], np.arctan2(dy[rows, nearest], dx[rows, nearest]), nearest

    def from_pieces(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """(m, n) distances of (m, 2) points beyond the edge of each piece, and the way to them from its center line to
        the east and to the north, metres."""
        east, north = (self.ends - self.starts).T
        square = np.maximum(east**2 + north**2, 1e-9)
        dx, dy = (points[:, i, None] - self.starts[None, :, i] for i in (0, 1))
        share = np.clip((dx * east + dy * north) / square, 0.0, 1.0)
        dx, dy = dx - share * east, dy - share * north
        return np.hypot(dx, dy) - self.halves, dx, dy


def road_surface(graph: LaneGraph) -> RoadSurface:
    """The surface of a network."""
    pieces = list(_pieces(graph))
    starts, ends = np.vstack([p[0] for p in pieces]), np.vstack([p[1] for p in pieces])
    halves = np.concatenate([np.full(len(p[0]), p[2]) for p in pieces])
    lanes = tuple(lane for begins, _, _, lane, _ in pieces for _ in begins)
    aside = tuple(one for begins, _, _, _, one in pieces for _ in begins)
    return RoadSurface(starts, ends, halves, tuple(_junctions(graph)), lanes, aside)


def _pieces(graph: LaneGraph) -> Iterator[tuple[Floats, Floats, float, OfLane, bool]]:
    aside = {edge.id: edge.parameters.get(_KIND) == DRIVEWAY for edge in graph.edges.values()}
    for edge in graph.edges.values():
        for lane in edge.laid_lanes:
            yield (*_cut(lane.shape), lane.width_m / 2, position(graph, lane.id) or "junction", aside[edge.id])
        if edge.center_lane is not None:
            yield (*_cut(edge.center_lane.shape), edge.center_lane.width_m / 2, "center", aside[edge.id])
    for c in graph.connections:
        widths = [lane.width_m for lane in graph.edges[c.from_edge].lanes if lane.index == c.from_lane]
        half_m = max([*widths, _LEAST_WIDTH_M]) / 2
        yield (*_cut(c.via_shape), half_m, "junction", aside[c.from_edge] or aside[c.to_edge])


def _cut(line: Floats) -> tuple[Floats, Floats]:
    """Straight pieces of a line, as their starts and ends."""
    length = float(arc_lengths(line)[-1])
    if len(line) == 2 or length < 1e-6:
        return line[:-1], line[1:]
    dense = resample(line, np.linspace(0.0, length, max(2, round(length / _LONGEST_M) + 1)))
    return dense[:-1], dense[1:]


def _junctions(graph: LaneGraph) -> Iterator[Junction]:
    from scipy.spatial import ConvexHull  # heavy: a check of a config does without it

    ends: dict[str, list[Floats]] = {}
    roads: dict[str, set[str]] = {}
    for edge in graph.edges.values():
        for node, at, before in ((edge.from_node, 0, 1), (edge.to_node, -1, -2)):
            ends.setdefault(node, []).extend(_corners(lane, at, before) for lane in edge.lanes)
            roads.setdefault(node, set()).add(road_of(edge.id)[0])
    for node, met in roads.items():
        if len(met) >= 3:
            corners = np.vstack(ends[node])
            x, y = corners.mean(axis=0)
            hull = ConvexHull(corners)
            yield Junction(float(x), float(y), hull.equations[:, :2], -hull.equations[:, 2])


def _corners(lane: Lane, at: int, before: int) -> Floats:
    """(2, 2) both corners of a lane at one of its ends."""
    east, north = lane.shape[at] - lane.shape[before]
    across = np.array([-north, east]) * lane.width_m / 2 / max(np.hypot(east, north), 1e-9)
    corners: Floats = lane.shape[at] + np.array([across, -across])
    return corners
