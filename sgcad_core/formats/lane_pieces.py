"""A road network as pieces that other formats know: every lane and every way across a node, with neighbors.

Knows the lane graph and plane geometry; no format.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from sgcad_core.geometry.plane import Floats, distinct, offset_polyline
from sgcad_core.roads.lane_graph import Connection, Lane, LaneGraph

GAP_M = 0.3
"""Lanes of opposite directions whose left edges are no farther apart share one: there is no ground between them."""
LEAST_M = 0.5
"""A shorter way across a node is left out: its lanes follow each other directly."""


@dataclass(eq=False)
class Piece:
    """One lane, or one way across a node, in travel direction; metres."""

    id: str
    line: Floats
    """(n, 2) center line, n at least 2."""
    width_m: float
    speed_mps: float
    cars: bool
    crosses: bool
    """Whether it leads across a node."""
    before: list[str] = field(default_factory=list)
    after: list[str] = field(default_factory=list)
    left: str = ""
    """The next lane of the same direction to the left, or empty."""
    right: str = ""
    opposite: str = ""
    """The lane against it on its left, or empty; both have `shared` as their left edge, each in its own direction."""
    shared: Floats | None = None

    def side(self, sign: int) -> Floats:
        """(n, 2) its left (1) or right (-1) edge."""
        if self.shared is not None and sign > 0:
            return self.shared
        return offset_polyline(self.line, sign * self.width_m / 2)

    @property
    def polygon(self) -> Floats:
        """(2 n, 2) its outline."""
        return np.vstack((self.side(1), self.side(-1)[::-1]))


def pieces_of(graph: LaneGraph) -> dict[str, Piece]:
    """All pieces by id, with what comes before, behind and beside them."""
    found = {piece.id: piece for piece in _lanes(graph)}
    _join_opposite(graph, found)
    for number, connection in enumerate(graph.connections):
        first, last = (_lane(graph, *end) for end in _ends(connection))
        if first is None or last is None or first.id not in found or last.id not in found:
            continue
        between = _across(number, connection, first, last)
        chain = [found[first.id], found[last.id]] if between is None else [found[first.id], between, found[last.id]]
        if between is not None:
            found[between.id] = between
        for one, two in pairwise(chain):
            one.after.append(two.id)
            two.before.append(one.id)
    return found


def _lanes(graph: LaneGraph) -> Iterator[Piece]:
    for edge in graph.edges.values():
        lanes = [lane for lane in edge.lanes if len(distinct(lane.shape)) > 1]
        for k, lane in enumerate(lanes):
            piece = Piece(lane.id, distinct(lane.shape), lane.width_m, lane.speed_mps, lane.allows_cars, False)
            piece.right = lanes[k - 1].id if k and lanes[k - 1].allows_cars == lane.allows_cars else ""
            beyond = lanes[k + 1] if k + 1 < len(lanes) else None
            piece.left = beyond.id if beyond is not None and beyond.allows_cars == lane.allows_cars else ""
            yield piece


def _join_opposite(graph: LaneGraph, found: dict[str, Piece]) -> None:
    """Give the innermost lanes of both directions of a road one edge where they lie side by side."""
    inner = {
        (edge.from_node, edge.to_node): found[edge.lanes[-1].id]
        for edge in graph.edges.values()
        if edge.lanes and edge.lanes[-1].id in found
    }
    for (start, end), one in inner.items():
        other = inner.get((end, start))
        if other is None or one.opposite or one.cars != other.cars or len(one.line) != len(other.line):
            continue
        mine, theirs = one.side(1), other.side(1)[::-1]
        if float(np.hypot(*(mine - theirs).T).max()) <= GAP_M:
            one.opposite, other.opposite = other.id, one.id
            one.shared = (mine + theirs) / 2
            other.shared = one.shared[::-1]


def _ends(connection: Connection) -> tuple[tuple[str, int], tuple[str, int]]:
    return (connection.from_edge, connection.from_lane), (connection.to_edge, connection.to_lane)


def _lane(graph: LaneGraph, edge: str, index: int) -> Lane | None:
    lanes = graph.edges[edge].lanes if edge in graph.edges else ()
    return next((lane for lane in lanes if lane.index == index), None)


def _across(number: int, connection: Connection, first: Lane, last: Lane) -> Piece | None:
    line = distinct(connection.via_shape)
    if len(line) < 2 or float(np.hypot(*np.diff(line, axis=0).T).sum()) < LEAST_M:
        return None
    width, speed = min(first.width_m, last.width_m), min(first.speed_mps, last.speed_mps)
    return Piece(f"across_{number}", line, width, speed, first.allows_cars, True)
