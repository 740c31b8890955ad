"""Gores: the painted triangles between a road and a ramp that leaves or joins it. Metres; taken from the lane graph."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import arc_lengths, offset_polyline, resample
from sgcad_core.kinds import RAMP
from sgcad_core.roads.lane_graph import Edge, Floats, LaneGraph

WIDEST_M = 7.0
"""Distance between the two roads at the end of the painted area; beyond lies grass."""
_LONGEST_M = 40.0
_ALONG_RAD = math.radians(60)
_KIND = "kind"
"""The parameter of an edge that names its kind (`formats/sumo/parameters.py`)."""


class Gore(NamedTuple):
    """One gore: the edge of the road and that of the ramp, and its corners, (n, 2), from its tip along the road."""

    road: str
    ramp: str
    leaves: bool
    """Whether the ramp leaves the road (both begin at the node)."""
    corners: Floats


def gores(graph: LaneGraph) -> tuple[Gore, ...]:
    """All gores of a network, cached."""
    if "gores" not in graph.derived:
        graph.derived["gores"] = tuple(_gores(graph))
    found: tuple[Gore, ...] = graph.derived["gores"]
    return found


def _gores(graph: LaneGraph) -> Iterator[Gore]:
    for ramp in graph.edges.values():
        if ramp.parameters.get(_KIND) != RAMP:
            continue
        for leaves in (True, False):
            road = _beside(graph, ramp, leaves)
            corners = None if road is None else _corners(road, ramp, leaves)
            if road is not None and corners is not None:
                yield Gore(road.id, ramp.id, leaves, corners)


def _beside(graph: LaneGraph, ramp: Edge, leaves: bool) -> Edge | None:
    """The road that leaves the node with a ramp (or comes to it) in nearly the same direction."""
    node = ramp.from_node if leaves else ramp.to_node
    here = [e for e in graph.edges.values() if (e.from_node if leaves else e.to_node) == node]
    roads = [e for e in here if e.parameters.get(_KIND) not in (None, RAMP) and not graph.is_around(e)]
    apart = {e.id: abs(_turn(e, ramp, leaves)) for e in roads}
    best = min(roads, key=lambda e: apart[e.id], default=None)
    return best if best is not None and 0.02 < apart[best.id] < _ALONG_RAD else None


def _turn(road: Edge, ramp: Edge, leaves: bool) -> float:
    """The ramp's direction at the node seen from the road's, left positive, as one drives."""
    angle = [math.atan2(*(step[::-1])) for step in (_step(road, leaves), _step(ramp, leaves))]
    return math.remainder(angle[1] - angle[0], 2 * math.pi)


def _step(edge: Edge, leaves: bool) -> Floats:
    shape = edge.lanes[0].shape
    step: Floats = shape[1] - shape[0] if leaves else shape[-1] - shape[-2]
    return step


def _corners(road: Edge, ramp: Edge, leaves: bool) -> Floats | None:
    """From the tip along the road's border and back along the ramp's; None where they lie too near or too far apart."""
    hand = (1 if _turn(road, ramp, leaves) > 0 else -1) * (1 if leaves else -1)
    borders = [_border(road, hand), _border(ramp, -hand)]
    away = [border if leaves else border[::-1] for border in borders]
    stations = np.arange(0.0, min(_LONGEST_M, *(float(arc_lengths(line)[-1]) for line in away)), 1.0)
    one, two = (resample(line, stations) for line in away)
    gaps = np.hypot(*(one - two).T)
    opens = int(gaps.argmin())
    ends = np.flatnonzero((gaps > WIDEST_M) & (np.arange(len(gaps)) > opens))
    last = int(ends[0]) if len(ends) else len(gaps) - 1
    if last - opens < 2 or gaps[opens] > WIDEST_M:
        return None
    return np.vstack((one[opens : last + 1], two[opens : last + 1][::-1]))


def _border(edge: Edge, hand: int) -> Floats:
    """The outermost line of an edge on its left (1) or right (-1)."""
    lane = edge.lanes[-1 if hand > 0 else 0]
    return offset_polyline(lane.shape, hand * lane.width_m / 2)
