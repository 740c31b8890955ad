"""A road network's SUMO edges in words, for a model that writes routes. Knows no prompt and no crash."""

from __future__ import annotations

import math

from sgcad_core.roads.describe import compass
from sgcad_core.roads.lane_graph import Edge, LaneGraph


def edge_lines(graph: LaneGraph) -> str:
    """One line an edge: lanes, length, heading, and where each lane leads."""
    return "\n".join(_line(edge, graph) for edge in graph.edges.values() if edge.car_lanes)


def _line(edge: Edge, graph: LaneGraph) -> str:
    shape, length = edge.lanes[0].shape, edge.lanes[0].length_m
    heading = compass(math.atan2(*(shape[-1] - shape[0])[::-1]))
    count = len(edge.lanes)
    ways: dict[str, list[int]] = {}
    for way in graph.leaving(edge.id):
        ways.setdefault(f"{way.to_edge} ({way.direction})", []).append(way.from_lane)
    onward = "; ".join(f"{to} from lane {', '.join(map(str, sorted(set(lanes))))}" for to, lanes in ways.items())
    counted = f"{count} lane{'s' if count > 1 else ''}"
    return f"- edge {edge.id}: heads {heading}, {counted}, {length:.0f} m; leads to {onward or 'nothing'}"
