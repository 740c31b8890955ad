"""The place where a ramp meets its road: at the outer lane, not at the middle. Metres; geometry of a spec's nodes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import RAMP
from sgcad_core.records.specs import Node, Road

_ALONG_RAD = math.radians(60)
"""A ramp runs along a road that it leaves or joins at less than this."""


class JoinedRoad(NamedTuple):
    """The direction of a road along which a ramp runs: of travel there (unit vector), and its lanes."""

    travel: Floats
    road: Road
    lanes: int


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
    return JoinedRoad(outward if leaves else -outward, road, lanes) if lanes else None


def _unit(a: Node, b: Node) -> Floats:
    step = np.array([b.x_m - a.x_m, b.y_m - a.y_m], dtype=float)
    size = float(np.hypot(*step))
    return step / size if size else step
