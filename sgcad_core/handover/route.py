"""Which edges of the network a way takes, as SUMO names a route.

The way is laid on the strips that run where it runs and point as it moves; where it leaves the lanes (a verge, a lot)
nothing is matched. Knows the lane graph; no time.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.handover.after_contact import strip_at
from sgcad_core.roads.lane_graph import Connection, LaneGraph

_STEP_M = 2.0
_AHEAD = 3
"""Edges that a route goes on behind its last known one: who nears a junction must have a way across it."""


def route_of(graph: LaneGraph, poses: Iterable[tuple[float, float, float]]) -> tuple[str, ...]:
    """Edges along poses (x, y, course of the movement), connected, then straight on; () where no lane runs there."""
    found: list[str] = []
    for x, y, course in poses:
        strip = strip_at(graph, np.array([x, y]), course)
        edges = (
            ()
            if strip is None
            else (strip.edge, strip.of.to_edge)
            if isinstance(strip.of, Connection)
            else (strip.edge,)
        )
        found += [e for e in edges if e not in found]
    return _onward(graph, _connected(graph, found))


def poses_of(pose: Floats, step_m: float = _STEP_M) -> list[tuple[float, float, float]]:
    """Places of a way (n, 3) some metres apart, with the course of the movement there."""
    points = pose[:, :2]
    kept = [0]
    for k in range(1, len(points)):
        if np.hypot(*(points[k] - points[kept[-1]])) >= step_m:
            kept.append(k)
    if len(kept) < 2:
        return [(float(points[0, 0]), float(points[0, 1]), float(pose[0, 2]))]
    course = [float(np.arctan2(*(points[b] - points[a])[::-1])) for a, b in pairwise(kept)]
    return [(float(points[k, 0]), float(points[k, 1]), c) for k, c in zip(kept, course, strict=False)]


def _connected(graph: LaneGraph, edges: list[str]) -> list[str]:
    """The edges up to the first that cannot be reached from the one before it."""
    kept = edges[:1]
    for edge in edges[1:]:
        if any(c.to_edge == edge for c in graph.leaving(kept[-1])):
            kept.append(edge)
    return kept


def _onward(graph: LaneGraph, edges: list[str]) -> tuple[str, ...]:
    route = list(edges)
    for _ in range(_AHEAD if route else 0):
        through = [c.to_edge for c in graph.leaving(route[-1]) if c.direction == "through" and c.to_edge not in route]
        if not through:
            break
        route.append(through[0])
    return tuple(route)
