"""The chain of roads that an actor drives, from its road, direction, exit and maneuver.

Knows the lane graph and the specs; no time, no other actor. Where the network offers no such way (an illegal turn, a
driveway that was not drawn, a missing direction), a way is made up and noted.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import count, pairwise
from typing import NamedTuple

import numpy as np

from sgcad_core.case.records import Finding
from sgcad_core.errors import InvalidOutput
from sgcad_core.geometry.plane import arc_lengths, resample
from sgcad_core.planner.lines.path import end_heading
from sgcad_core.records.specs import Actor
from sgcad_core.roads.lane_graph import Edge, Lane, LaneGraph, edge_id, road_of

AHEAD_M = 120.0
BEHIND_M = 160.0
_FITTING = math.radians(25)
_INTO = 0.9
OPENING_M = 60.0
"""A leg opens into a roundabout at an angle; its direction is taken at this distance."""
TURN_RAD = {"turn_left": math.pi / 2, "turn_right": -math.pi / 2, "u_turn": math.pi}


class Way(NamedTuple):
    """One direction of a road as an actor drives it; lanes for cars from right to left."""

    id: str
    from_node: str
    to_node: str
    lanes: tuple[Lane, ...]
    wrong_way: bool = False

    @property
    def road(self) -> str:
        """The road's id in the spec."""
        return road_of(self.id)[0]

    @property
    def length_m(self) -> float:
        """Length of its first lane."""
        return self.lanes[0].length_m


class Route(NamedTuple):
    """Ways in driving order; `start` is the index of the actor's own road, `turn` of the way before its turn."""

    ways: tuple[Way, ...]
    start: int
    turn: int | None
    made_up_turn_rad: float = 0.0
    """A turn behind the last way that the network does not have; 0: none."""
    notes: tuple[str, ...] = ()
    astray: bool = False
    """Whether the network lacks the way: another one was taken, or a made-up turn."""


def find_route(graph: LaneGraph, actor: Actor) -> Route:
    """The chain of ways of one actor. Raises InvalidOutput for a road id that the network does not have."""
    start = start_way(graph, actor)
    notes = [f"{actor.id} drives {start.road} against its only direction"] if start.wrong_way else []
    ways, turn, made_up = _onward(graph, start, actor, notes)
    ways, turn = _through_circles(graph, ways, turn)
    before = _upstream(graph, start)
    shifted = None if turn is None else turn + len(before)
    reached = actor.exit_road in (None, actor.road, *(way.road for way in ways))
    astray = start.wrong_way or bool(made_up) or not reached
    return Route((*before, *ways), len(before), shifted, made_up, tuple(notes), astray)


def start_way(graph: LaneGraph, actor: Actor) -> Way:
    """The way on which an actor starts; a direction that the road lacks is driven the wrong way."""
    check_road(graph, actor.road, f"actor {actor.id}, road")
    if actor.exit_road is not None:
        check_road(graph, actor.exit_road, f"actor {actor.id}, exit_road")
    return _way(graph, edge_id(actor.road, actor.direction))


def check_road(graph: LaneGraph, road: str, where: str) -> None:
    """Raises InvalidOutput, listing the known ids, unless the network has the road."""
    if road in graph.edges or f"-{road}" in graph.edges:
        return
    known = ", ".join(sorted({road_of(edge)[0] for edge in graph.edges}))
    finding = Finding(source="planner", what="no such road", where=where, value=road, remedy=f"use one of: {known}")
    raise InvalidOutput(finding.line(), [finding])


def turn_angle(first: Way, second: Way) -> float:
    """Heading change from one way to the next, radians, left positive; across a roundabout that of its legs."""
    a, b = first.lanes[0].shape, second.lanes[0].shape
    if first.to_node != second.from_node:
        a, b = (resample(line, np.minimum([0.0, OPENING_M], arc_lengths(line)[-1])) for line in (a[::-1], b))
        a = a[::-1]
    return math.remainder(end_heading(b, at_end=False) - end_heading(a, at_end=True), 2 * math.pi)


def has_connection(graph: LaneGraph, first: Way, second: Way) -> bool:
    """Whether the network lets traffic from one way to the other, where need be around a roundabout."""
    if first.to_node != second.from_node:
        return _circle(graph, first.to_node, second.from_node) != []
    return any(c.to_edge == second.id for c in graph.leaving(first.id))


# ------------------------------------------------------------------ roundabouts
def _circle(graph: LaneGraph, start: str, end: str) -> list[Way]:
    """The pieces of a roundabout from node to node, as one drives; all of it where both are one. Empty: none."""
    around = {e.from_node: e for e in graph.edges.values() if graph.is_around(e)}
    found: list[Way] = []
    node = start
    while node in around and len(found) < len(around):
        edge = around[node]
        found.append(_way(graph, edge.id))
        node = edge.to_node
        if node == end:
            return found
    return []


def _through_circles(graph: LaneGraph, ways: list[Way], turn: int | None) -> tuple[list[Way], int | None]:
    """The chain with the pieces of the roundabouts on it; a turn inside a roundabout has no single place (None)."""
    if not graph.circles:
        return ways, turn
    found, place = ways[:1], turn
    for i, (one, two) in enumerate(pairwise(ways)):
        back = one.road == two.road and one.to_node in graph.center_of
        pieces = _circle(graph, one.to_node, two.from_node) if back or one.to_node != two.from_node else []
        found += [*pieces, two]
        if turn is not None and place is not None and i <= turn and pieces:
            place = None if i == turn else place + len(pieces)
    return found, place


# ------------------------------------------------------------------ ways
def _way(graph: LaneGraph, edge: str) -> Way:
    if edge in graph.edges:
        found = graph.edges[edge]
        return Way(edge, found.from_node, found.to_node, _driven(found))
    road, direction = road_of(edge)
    other = graph.edges[edge_id(road, "forward" if direction == "backward" else "backward")]
    lanes = tuple(replace(lane, shape=lane.shape[::-1]) for lane in reversed(_driven(other)))
    return Way(edge, other.to_node, other.from_node, lanes, wrong_way=True)


def _driven(edge: Edge) -> tuple[Lane, ...]:
    """Lanes for cars, including lanes that a work zone closes, which are entered from the lane before."""
    return edge.laid_lanes or edge.lanes


def _leaving(graph: LaneGraph, way: Way, *, back: bool = False) -> list[Way]:
    """Ways out of the node at the end of a way, in the network's order; its own reverse only with `back`.

    A roundabout is left by any of its legs.
    """
    center = graph.center_of.get(way.to_node)
    ids = [e.id for e in graph.edges.values() if e.from_node == way.to_node]
    if center is not None and graph.center_of.get(way.from_node) != center:
        legs = (e for e in graph.edges.values() if graph.center_of.get(e.from_node) == center)
        ids = [e.id for e in legs if not graph.is_around(e)]
    return [_way(graph, e) for e in ids if back or road_of(e)[0] != way.road]


def _straightest(graph: LaneGraph, way: Way, limit_rad: float = math.radians(50)) -> Way | None:
    """The way straight on: the least heading change, connected ways first."""
    fitting = [w for w in _leaving(graph, way) if abs(turn_angle(way, w)) < limit_rad]
    return min(fitting, key=lambda w: _bend(graph, way, w), default=None)


# ------------------------------------------------------------------ onward
def _onward(graph: LaneGraph, start: Way, actor: Actor, notes: list[str]) -> tuple[list[Way], int | None, float]:
    if actor.maneuver == "u_turn":
        return _turned_back(graph, start, actor)
    if actor.exit_road not in (None, actor.road):
        found = _to_road(graph, start, str(actor.exit_road))
        if found is not None:
            return _extended(graph, found), len(found) - 2, 0.0
        notes.append(f"no way from {actor.road} to {actor.exit_road} for {actor.id}; its maneuver decides")
    wanted = TURN_RAD.get(actor.maneuver)
    return (_extended(graph, [start]), None, 0.0) if wanted is None else _turning(graph, start, wanted)


def _extended(graph: LaneGraph, ways: list[Way]) -> list[Way]:
    """Ways continued straight on until AHEAD_M lie behind the last given one."""
    ways, length = list(ways), 0.0
    while length < AHEAD_M and (onward := _straightest(graph, ways[-1])) and onward.id not in _ids(ways):
        ways.append(onward)
        length += onward.length_m
    return ways


def _turning(graph: LaneGraph, start: Way, wanted: float) -> tuple[list[Way], int | None, float]:
    """The first fitting turn on the way straight on; a made-up one where there is none."""
    ways = [start]
    while True:
        exits = {w: turn_angle(ways[-1], w) for w in _leaving(graph, ways[-1])}
        fitting = {w: abs(abs(angle) - math.pi / 2) for w, angle in exits.items() if _fits(angle, wanted)}
        if fitting:
            chosen = min(fitting, key=lambda w: fitting[w])
            return _extended(graph, [*ways, chosen]), len(ways) - 1, 0.0
        onward = _straightest(graph, ways[-1])
        if onward is None or onward.id in _ids(ways) or len(ways) > 6:
            return [start], 0, wanted
        ways.append(onward)


def _ids(ways: list[Way]) -> set[str]:
    return {way.id for way in ways}


def _fits(angle: float, wanted: float) -> bool:
    return _FITTING < math.copysign(1.0, wanted) * angle < math.radians(165)


def _turned_back(graph: LaneGraph, start: Way, actor: Actor) -> tuple[list[Way], int | None, float]:
    back = _way(graph, start.id[1:] if start.id.startswith("-") else f"-{start.id}")
    if actor.exit_road not in (None, actor.road):
        reachable = [w for w in _leaving(graph, start) if w.road == actor.exit_road]
        back = reachable[0] if reachable else back
    return _extended(graph, [start, back]), 0, 0.0


def _to_road(graph: LaneGraph, start: Way, road: str) -> list[Way] | None:
    """Cheapest chain from a way onto a road: few ways, connected ones, little turning."""
    order = count()
    queue: list[tuple[float, int, list[Way]]] = [(0.0, next(order), [start])]
    done: set[str] = set()
    while queue:
        cost, _, chain = heapq.heappop(queue)
        last = chain[-1]
        if last.road == road:
            return chain
        if last.id in done:
            continue
        done.add(last.id)
        for onward in _candidates(graph, last, road):
            step = 1.0 + 2.0 * (not has_connection(graph, last, onward)) + abs(turn_angle(last, onward)) / 4
            heapq.heappush(queue, (cost + step + 4.0 * onward.wrong_way, next(order), [*chain, onward]))
    return None


def _candidates(graph: LaneGraph, last: Way, road: str) -> Iterator[Way]:
    yield from _leaving(graph, last)
    for edge in (road, f"-{road}"):
        if edge not in graph.edges:
            way = _way(graph, edge)
            if way.from_node == last.to_node:
                yield way


def _upstream(graph: LaneGraph, start: Way) -> list[Way]:
    """Ways that lead straight into the first one, up to BEHIND_M in all."""
    ways, length = [start], 0.0
    while length < BEHIND_M and len(ways) < 8:
        into = [_way(graph, e.id) for e in graph.edges.values() if e.to_node == ways[0].from_node]
        bend = {w.id: _bend(graph, w, ways[0]) for w in into}
        into = [w for w in into if w.road != ways[0].road and w.id not in _ids(ways) and bend[w.id] < _INTO]
        if not into:
            break
        ways.insert(0, min(into, key=lambda w: bend[w.id]))
        length += ways[0].length_m
    return ways[:-1]


def _bend(graph: LaneGraph, first: Way, second: Way) -> float:
    """Heading change from way to way, radians; more where no connection leads across."""
    return abs(turn_angle(first, second)) + 0.35 * (not has_connection(graph, first, second))
