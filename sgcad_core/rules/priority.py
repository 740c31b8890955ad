"""Precedence at a junction: which of two passages yields, from link states, signals and directions.

UVC 11-401 (no control: the vehicle on the right first), 11-402 (left turns), 11-403 (stop and yield signs), 11-404
(driveways), 11-202 (signals). `None`: the map does not say. Knows passages and lights; no motion beyond them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sgcad_core.formats.sumo.parameters import CONTROL
from sgcad_core.metrics.drivability import STEP_S
from sgcad_core.roads.lane_graph import Connection, LaneGraph
from sgcad_core.rules.passages import Passage
from sgcad_core.rules.records import RuleScene
from sgcad_core.rules.red_light import stopped


class Duty(NamedTuple):
    """Whether one must yield to the other (None: unknown), and why."""

    yields: bool | None
    why: str


FREE = Duty(False, "")


def duty(scene: RuleScene, one: Passage, other: Passage) -> Duty:
    """The duty of one vehicle towards another at the same junction."""
    if one.link.from_edge == other.link.from_edge:
        return FREE
    if one.link.light and other.link.light:
        return _at_signal(scene, one, other)
    ranks = _rank(scene.graph, one.link), _rank(scene.graph, other.link)
    if ranks[0] != ranks[1]:
        return Duty(True, "the other road goes first") if ranks[0] > ranks[1] else FREE
    if _opposite(scene.graph, one.link, other.link):
        return _left_turn(one, other)
    if ranks[0] == 0 and not _uncontrolled(scene.graph, one):
        return FREE
    return _in_turn(scene, one, other)


def _left_turn(one: Passage, other: Passage) -> Duty:
    turns = one.link.direction in ("left", "u_turn") and other.link.direction in ("through", "right")
    return Duty(True, "a left turn yields to oncoming traffic") if turns else FREE


def _at_signal(scene: RuleScene, one: Passage, other: Passage) -> Duty:
    states = []
    for passage in (one, other):
        shown = scene.shown(passage.link, passage.line)
        states.append(shown.state if shown else "")
    if "" in states:
        return Duty(None, "the map tells no plan of the signals")
    if states[1] == "red":
        return FREE
    if states[0] == "red":
        right = one.link.direction == "right" and stopped(one, scene.limits) is not None
        return Duty(True, "a right turn on red yields") if right else FREE
    return _left_turn(one, other) if _opposite(scene.graph, one.link, other.link) else FREE


def _rank(graph: LaneGraph, link: Connection) -> int:
    """0 of an approach that has the right of way, 1 of one that has not; 0 for all without any control."""
    edge = graph.edges[link.from_edge]
    if graph.is_around(edge):
        return 0
    states = {c.state for c in graph.leaving(edge.id)}
    if graph.nodes[edge.to_node].parameters.get(CONTROL) == "none" and not states & set("sw"):
        met = [e.priority for e in graph.edges.values() if e.to_node == edge.to_node]
        return int(edge.priority < max(met, default=edge.priority))
    return 0 if "M" in states else 1


def _uncontrolled(graph: LaneGraph, one: Passage) -> bool:
    return graph.nodes[one.node].parameters.get(CONTROL) == "none"


def _in_turn(scene: RuleScene, one: Passage, other: Passage) -> Duty:
    """The first to come goes first; at the same time the one on the right."""
    came = [arrival(scene, passage) for passage in (one, other)]
    if abs(came[0] - came[1]) > scene.limits.same_time_s:
        return Duty(True, "the other came first") if came[0] > came[1] else FREE
    return Duty(True, "the other comes from the right") if _from_right(scene.graph, one.link, other.link) else FREE


def arrival(scene: RuleScene, one: Passage) -> float:
    """When a vehicle arrives: it stands at the line, or passes it."""
    stands = stopped(one, scene.limits)
    return (one.line if stands is None else stands) * STEP_S


def _course(graph: LaneGraph, link: Connection) -> float:
    """Heading of an approach at its end, radians."""
    lane = next(one for one in graph.edges[link.from_edge].lanes if one.index == link.from_lane)
    east, north = lane.shape[-1] - lane.shape[-2]
    return math.atan2(float(north), float(east))


def _opposite(graph: LaneGraph, one: Connection, other: Connection) -> bool:
    return math.cos(_course(graph, one) - _course(graph, other)) < -0.7


def _from_right(graph: LaneGraph, one: Connection, other: Connection) -> bool:
    """Whether the other approach lies to the right: its heading is turned to the left of one's own."""
    return math.sin(_course(graph, other) - _course(graph, one)) > 0.3
