"""Passages of junctions: which vehicle crosses which line when, and by which connection it goes on.

The line is the stop line of the map's files: its far edge lies 0.3 m before the end of the lane. A vehicle that starts
beyond the line has no passage. Knows motions and the lane graph; no rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.opendrive.signals import LINE_BACK_M, STOP_LINE_M
from sgcad_core.geometry.distances import distance_to, nearest_on
from sgcad_core.geometry.plane import Floats, arc_lengths
from sgcad_core.metrics.lane_places import EDGE_M
from sgcad_core.roads.lane_graph import Connection, Edge, LaneGraph
from sgcad_core.roads.layout import HUB
from sgcad_core.rules.records import Mover

LINE_M = LINE_BACK_M - STOP_LINE_M / 2
MEANS = {"turn_left": "left", "turn_right": "right", "u_turn": "u_turn"}
_AHEAD_M = 15.0
"""Length of the lane behind the junction that belongs to a way across it."""
_SETTLES_M = 6.0
"""A way that is followed for less may still become another one: the maneuver decides."""


class Passage(NamedTuple):
    """A vehicle across a junction. `line`: sample at which its front passes the line; `clear`: at which its rear has
    left the junction, or the last one; `before_m`: (n,) metres of its front before the line."""

    mover: Mover
    node: str
    link: Connection
    line: int
    clear: int
    before_m: Floats

    @property
    def where(self) -> str:
        """The approach in words."""
        return f"from {self.link.from_edge} into {junction_words(self.node)}"


def junction_words(node: str) -> str:
    """A node for a person: the one of a drawn junction has a name that only maps use."""
    return "the junction" if node == HUB else node


def passages(graph: LaneGraph, mover: Mover) -> Iterator[Passage]:
    """The passages of a vehicle in the order of the edges."""
    for edge in graph.edges.values():
        links = graph.leaving(edge.id)
        if not links or not is_junction(graph, edge.to_node):
            continue
        if (crossed := _crossed(edge, mover)) is None:
            continue
        line, lane, before = crossed
        link = _followed(graph, mover, line, [c for c in links if c.from_lane == lane] or links)
        if link is not None:
            yield Passage(mover, edge.to_node, link, line, _clear(mover, line, link), before)


def is_junction(graph: LaneGraph, node: str) -> bool:
    """Whether three and more roads meet at a node, or a signal or sign stands at it."""
    found = graph.derived.get(key := ("rules_junction", node))
    if found is None:
        near = {e.to_node if e.from_node == node else e.from_node for e in graph.edges.values()
                if node in (e.from_node, e.to_node)}  # fmt: skip
        states = {c.state for c in graph.connections if graph.edges[c.from_edge].to_node == node}
        found = graph.derived[key] = len(near) > 2 or bool(states & set("sw")) or node in graph.center_of
    return bool(found)


def _crossed(edge: Edge, mover: Mover) -> tuple[int, int, Floats] | None:
    """The first sample with the front beyond the line of an edge, the lane, and the metres before the line."""
    best: tuple[float, int, int, Floats] | None = None
    for lane in edge.lanes:
        end = lane.shape[-1]
        way = end - lane.shape[-2]
        way = way / max(float(np.hypot(*way)), 1e-9)
        off = mover.front - end
        before: Floats = -(off @ way) - LINE_M
        across = np.abs(off @ np.array([-way[1], way[0]]))
        heads = np.column_stack((np.cos(mover.pose[:, 2]), np.sin(mover.pose[:, 2]))) @ way > 0.5
        hits = np.flatnonzero((before[:-1] > 0) & (before[1:] <= 0) & heads[1:]) + 1
        for hit in hits[:1]:
            aside = float(across[hit])
            if aside <= lane.width_m / 2 + EDGE_M and (best is None or aside < best[0]):
                best = aside, int(hit), lane.index, before
    return None if best is None else best[1:]


def _followed(graph: LaneGraph, mover: Mover, line: int, links: Sequence[Connection]) -> Connection | None:
    """The connection that lies nearest to the way behind the line; of a short way that of the told maneuver."""
    points = mover.pose[line:, :2]
    gone = arc_lengths(points)
    if len(points) < 2 or gone[-1] < _SETTLES_M:
        meant = MEANS.get(mover.info.maneuver, "through")
        links = [c for c in links if c.direction == meant] or links
    reach = gone <= 40.0
    return min(links, key=lambda c: float(distance_to(_line(graph, c), points[reach]).mean()), default=None)


def _line(graph: LaneGraph, link: Connection) -> Floats:
    """The way across and the beginning of the lane behind it."""
    lane = next(one for one in graph.edges[link.to_edge].lanes if one.index == link.to_lane)
    near = arc_lengths(lane.shape) <= _AHEAD_M
    start = graph.edges[link.from_edge]
    before = next(one for one in start.lanes if one.index == link.from_lane).shape[-2:]
    return np.vstack((before, link.via_shape, lane.shape[: max(int(near.sum()) + 1, 2)]))


def _clear(mover: Mover, line: int, link: Connection) -> int:
    """The sample at which the box has left the way across."""
    points = mover.pose[line:, :2]
    end = link.via_shape[-2:]
    if float(np.hypot(*(end[1] - end[0]))) < 1e-6:
        return len(mover.pose) - 1
    along = nearest_on(np.vstack((end[0], end[1], end[1] + (end[1] - end[0]) * 50.0)), points).station_m
    past = np.flatnonzero(along - float(np.hypot(*(end[1] - end[0]))) > mover.info.length_m / 2)
    return line + int(past[0]) if len(past) else len(mover.pose) - 1
