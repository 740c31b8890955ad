"""Where the lines of roads lie at a node: through lanes line up, and a ramp meets the outer lane of its road.

A left-turn lane before a junction takes up room to the left of the through lanes: there the line between the directions
swings to the left, and the road behind the junction begins as far to the right. Metres; a road's own `aside` is to the
right of the line through its nodes, in forward direction. Geometry of a spec's nodes; knows no curves and no XML.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import RAMP
from sgcad_core.records.specs import Node, Point, Road

STRAIGHT_ON_DEG = 30.0
"""Two roads that bend less at a node go on into each other."""
LEFT_DEG = 50.0
"""A road that bends more to the left is one to turn into."""

_ALONG_RAD = math.radians(60)
"""A ramp runs along a road that it leaves or joins at less than this."""


class RoadSection(NamedTuple):
    """What alignment needs to know of a road's cross-section: metres."""

    lane_m: float
    gap_m: float
    """Between the directions: a median, or a two-way left-turn lane."""
    border_m: float
    """From its line to the right, where the lanes of a one-way road begin."""


class Meeting(NamedTuple):
    """A road at one of its nodes, and the way it points there."""

    road: Road
    node: str
    outward_rad: float

    @property
    def inward_is_forward(self) -> bool:
        return self.road.to_node == self.node

    @property
    def lanes_in(self) -> int:
        return self.road.lanes_forward if self.inward_is_forward else self.road.lanes_backward

    @property
    def lanes_out(self) -> int:
        return self.road.lanes_backward if self.inward_is_forward else self.road.lanes_forward

    @property
    def both(self) -> bool:
        return self.lanes_in > 0 and self.lanes_out > 0


class Through(NamedTuple):
    """Two roads that go on into each other at a node, and the left-turn lanes of each there."""

    a: Meeting
    b: Meeting
    left_a: int
    left_b: int


class Alignment(NamedTuple):
    """Shift of every road, and the gap between the directions at its (from, to) node."""

    aside_m: Mapping[str, float]
    gaps_m: Mapping[tuple[str, str], float]
    """(road, node) -> gap, where another road goes on there."""


def meetings(nodes: Mapping[str, Node], meeting: Mapping[str, Sequence[Road]], node: str) -> list[Meeting]:
    """The roads at a node that can go on into each other: no ramps and no pieces of a circle."""
    return [Meeting(r, node, _outward(r, node, nodes)) for r in meeting[node] if r.kind != RAMP and not r.circle]


def _outward(road: Road, node: str, nodes: Mapping[str, Node]) -> float:
    points: list[Point] = [nodes[road.from_node], *road.via, nodes[road.to_node]]
    here, there = points[:2] if road.from_node == node else points[:-3:-1]
    return math.atan2(there.y_m - here.y_m, there.x_m - here.x_m)


def throughs(nodes: Mapping[str, Node], meeting: Mapping[str, Sequence[Road]]) -> Iterator[Through]:
    """The straightest pair of roads first, at every node; each road is in one pair a node."""
    for node in nodes:
        if any(road.circle for road in meeting[node]):
            continue
        roads = meetings(nodes, meeting, node)
        pairs = [(abs(_bend_deg(a, b)), i, j) for i, a in enumerate(roads) for j, b in enumerate(roads) if i < j]
        taken: set[int] = set()
        for bend, i, j in sorted(pairs):
            if bend <= STRAIGHT_ON_DEG and not taken & {i, j}:
                taken |= {i, j}
                a, b = roads[i], roads[j]
                yield Through(a, b, _left_lanes(a, b, roads), _left_lanes(b, a, roads))


def _bend_deg(a: Meeting, b: Meeting) -> float:
    """By how much one turns from the one road into the other; left positive."""
    turn = b.outward_rad - a.outward_rad - math.pi
    return math.degrees((turn + math.pi) % (2 * math.pi) - math.pi)


def _left_lanes(a: Meeting, b: Meeting, roads: Sequence[Meeting]) -> int:
    """Lanes at the left of an approach that lead to the left alone (as `connections` uses them)."""
    turns = a.road.turns_forward if a.inward_is_forward else a.road.turns_backward
    left = any(r.lanes_out and r.road is not a.road and _bend_deg(a, r) > LEFT_DEG for r in roads)
    if not b.lanes_out:
        return 0
    if len(turns) == a.lanes_in:
        return next((k for k, turn in enumerate(reversed(turns)) if turn != "left"), 0)
    return int(left and a.lanes_in > b.lanes_out)


def aligned(
    found: Sequence[Through], section: Callable[[Road], RoadSection], single: Callable[[Road], bool]
) -> Alignment:
    """Shifts and gaps by which the through lanes of all pairs line up, as far as they can.

    `single`: whether a road is one-way and lies on its own (a one-way road with a twin beside it keeps its place).
    """
    aside: dict[str, float] = {}
    for a, b, left_a, left_b in found:
        for end, left in ((a, left_a), (b, left_b)):
            if left and end.both:
                to_left = left * section(end.road).lane_m / 2
                aside[end.road.id] = aside.get(end.road.id, 0.0) + (-to_left if end.inward_is_forward else to_left)
    _spread(found, aside)
    for pair in found:
        _place_single(pair, aside, section, single)
    gaps: dict[tuple[str, str], float] = {}
    for a, b, left_a, left_b in found:
        if a.both and b.both and (any(section(m.road).gap_m for m in (a, b)) or left_a != left_b):
            more = (left_a - left_b) * section(a.road).lane_m
            gap_a = max(section(a.road).gap_m, section(b.road).gap_m - more)
            gaps[a.road.id, a.node], gaps[b.road.id, b.node] = gap_a, gap_a + more
    return Alignment(aside, gaps)


def _spread(found: Sequence[Through], aside: dict[str, float]) -> None:
    """Pieces of one road lie on one line: what shifts one shifts those that it goes on into."""
    plain = [(a, b) for a, b, left_a, left_b in found if not left_a and not left_b and a.both and b.both]
    for _ in plain:
        for a, b in (*plain, *((b, a) for a, b in plain)):
            if a.road.id in aside and b.road.id not in aside:
                aside[b.road.id] = aside[a.road.id] * (1 if a.inward_is_forward != b.inward_is_forward else -1)


def _place_single(
    pair: Through, aside: dict[str, float], section: Callable[[Road], RoadSection], single: Callable[[Road], bool]
) -> None:
    """A one-way road begins its lanes where the road before it or behind it has its through lanes."""
    a, b, left = (
        (pair.a, pair.b, pair.left_a) if pair.a.lanes_in and pair.b.lanes_out else (pair.b, pair.a, pair.left_b)
    )
    if not (a.lanes_in and b.lanes_out) or all(not single(m.road) or m.road.id in aside for m in (a, b)):
        return
    starts = [_border(m.road, section) for m in (a, b)]
    step = starts[0] + left * section(a.road).lane_m - starts[1]
    at_a = aside.get(a.road.id, 0.0) * (1 if a.inward_is_forward else -1)
    at_b = aside.get(b.road.id, 0.0) * (-1 if b.inward_is_forward else 1)
    if single(b.road) and b.road.id not in aside:
        aside[b.road.id] = (at_a + step) * (-1 if b.inward_is_forward else 1)
        aside.setdefault(a.road.id, 0.0)
    else:
        aside[a.road.id] = (at_b - step) * (1 if a.inward_is_forward else -1)


def _border(road: Road, section: Callable[[Road], RoadSection]) -> float:
    """From a road's line to the right, where the lanes of a direction begin."""
    own = section(road)
    return own.gap_m / 2 if road.lanes_forward and road.lanes_backward else own.border_m


# ------------------------------------------------------------------ ramps
class JoinedRoad(NamedTuple):
    """The direction of a road along which a ramp runs: of travel there (unit vector), and its lanes."""

    travel: Floats
    road: Road
    lanes: int
    forward: bool
    """Whether one travels so in the road's forward direction."""


def joined_road(ramp: Road, nodes: Mapping[str, Node], meeting: Mapping[str, Sequence[Road]]) -> JoinedRoad | None:
    """The direction of a road that a one-way ramp enters or leaves; None without one on its right side."""
    if ramp.kind != RAMP or (ramp.lanes_forward and ramp.lanes_backward):
        return None
    start, end = (ramp.from_node, ramp.to_node) if ramp.lanes_forward else (ramp.to_node, ramp.from_node)
    for node, enters in ((end, True), (start, False)):
        if len(meeting[node]) > 2:
            heading = _unit(nodes[start], nodes[end])
            away = _unit(nodes[node], nodes[start if enters else end])
            found = [way for road in meeting[node] if (way := _way(road, node, nodes, enters)) and road.kind != RAMP]
            along = [way for way in found if float(way.travel @ heading) > math.cos(_ALONG_RAD)]
            best = max(along, key=lambda way: float(way.travel @ heading), default=None)
            return best if best and float(best.travel[0] * away[1] - best.travel[1] * away[0]) < 0 else None
    return None


def _way(road: Road, node: str, nodes: Mapping[str, Node], leaves: bool) -> JoinedRoad | None:
    """The direction of a road that leaves a node (or leads into it); None where it has no lanes."""
    outward = _unit(nodes[node], nodes[road.to_node if road.from_node == node else road.from_node])
    forward = (road.from_node == node) == leaves
    lanes = road.lanes_forward if forward else road.lanes_backward
    return JoinedRoad(outward if leaves else -outward, road, lanes, forward) if lanes else None


def _unit(a: Node, b: Node) -> Floats:
    step = np.array([b.x_m - a.x_m, b.y_m - a.y_m], dtype=float)
    size = float(np.hypot(*step))
    return step / size if size else step
