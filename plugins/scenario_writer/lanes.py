"""A road network's lanes in coordinates, for a model that places actors itself. Knows no prompt and no crash."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sgcad_core.formats.opendrive.checks.road_index import RoadIndex, lane_index
from sgcad_core.roads.lane_graph import Connection, Edge, Floats, LaneGraph

MOST_POINTS = 5
MOST_CONNECTIONS = 60


def lane_lines(graph: LaneGraph, xodr: str | None) -> str:
    """One line a lane and one a way across a junction: OpenDRIVE road and lane, center points, heading, length."""
    index = lane_index(xodr) if xodr else None
    lines = [line for edge in graph.edges.values() for line in _lanes(edge, index)]
    ways = [_way(c) for c in graph.connections][:MOST_CONNECTIONS]
    return "\n".join([*lines, *(["Ways across junctions, lane to lane:", *ways] if ways else [])])


def _lanes(edge: Edge, index: RoadIndex | None) -> Iterator[str]:
    for lane in edge.car_lanes:
        found = index.lane(edge.id, lane.index) if index else None
        place = f"road {found.road!r} lane {found.lane}, " if found else ""
        points = f"{_points(lane.shape)}, heading {_heading(lane.shape):.3f} rad, {lane.length_m:.0f} m"
        yield f"- {edge.id} lane {lane.index} (0 = rightmost): {place}{points}"


def _way(way: Connection) -> str:
    ends = f"{way.from_edge} lane {way.from_lane} to {way.to_edge} lane {way.to_lane}"
    return f"- {ends} ({way.direction}): {_points(way.via_shape)}"


def _points(line: Floats) -> str:
    picked = np.unique(np.linspace(0, len(line) - 1, min(len(line), MOST_POINTS)).round().astype(int))
    return " ".join(f"({x + 0.0:.1f}, {y + 0.0:.1f})" for x, y in line[picked])


def _heading(line: Floats) -> float:
    first, second = line[0], line[1]
    return math.atan2(second[1] - first[1], second[0] - first[0])
