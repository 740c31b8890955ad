"""A road network in words: its lanes in coordinates, or its SUMO edges, for models that write code or routes.

Knows no prompt and no crash.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sgcad_core.formats.opendrive.checks.road_index import RoadIndex, lane_index
from sgcad_core.roads.describe import compass
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


def edge_lines(graph: LaneGraph) -> str:
    """One line an edge: lanes, length, heading, and where each lane leads."""
    return "\n".join(_edge_line(edge, graph) for edge in graph.edges.values() if edge.car_lanes)


def _edge_line(edge: Edge, graph: LaneGraph) -> str:
    shape, length = edge.lanes[0].shape, edge.lanes[0].length_m
    heading = compass(math.atan2(*(shape[-1] - shape[0])[::-1]))
    count = len(edge.lanes)
    ways: dict[str, list[int]] = {}
    for way in graph.leaving(edge.id):
        ways.setdefault(f"{way.to_edge} ({way.direction})", []).append(way.from_lane)
    onward = "; ".join(f"{to} from lane {', '.join(map(str, sorted(set(lanes))))}" for to, lanes in ways.items())
    counted = f"{count} lane{'s' if count > 1 else ''}"
    return f"- edge {edge.id}: heads {heading}, {counted}, {length:.0f} m; leads to {onward or 'nothing'}"
