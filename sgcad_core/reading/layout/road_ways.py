"""The directions of a road spec's roads as one can drive them: headings, lanes, where they lead.

Plain geometry on node positions and inner points; headings counter-clockwise from east. Knows no vehicle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

from sgcad_core.records.specs import Road, RoadSpec, Turn, centers


class Way(NamedTuple):
    """One direction of a road. `start_rad` and `end_rad`: headings at its first and last metres."""

    road: Road
    direction: Literal["forward", "backward"]
    from_node: str
    to_node: str
    lanes: int
    turns: tuple[Turn, ...]
    start_rad: float
    end_rad: float

    @property
    def heading_rad(self) -> float:
        """Mean of both ends: what a report calls the direction of travel."""
        return self.start_rad + wrapped(self.end_rad - self.start_rad) / 2


def wrapped(angle_rad: float) -> float:
    """The same angle in (-pi, pi]."""
    return math.remainder(angle_rad, 2 * math.pi)


def apart(a_rad: float, b_rad: float) -> float:
    """Unsigned difference of two headings, radians."""
    return abs(wrapped(a_rad - b_rad))


def ways_of(spec: RoadSpec) -> tuple[Way, ...]:
    """Every direction with at least one lane, in the order of the roads.

    A roundabout is one node, and its pieces are no ways: a vehicle drives through it as across a junction.
    """
    center = centers(spec)
    at = {node.id: (node.x_m, node.y_m) for node in spec.nodes}
    found: list[Way] = []
    for road in spec.roads:
        if road.circle or road.from_node not in at or road.to_node not in at:
            continue
        ends = center.get(road.from_node, road.from_node), center.get(road.to_node, road.to_node)
        line = [at[road.from_node], *((p.x_m, p.y_m) for p in road.via), at[road.to_node]]
        begin, end = _heading(line[0], line[1]), _heading(line[-2], line[-1])
        if road.lanes_forward:
            found.append(Way(road, "forward", ends[0], ends[1], road.lanes_forward, road.turns_forward,
                             begin, end))  # fmt: skip
        if road.lanes_backward:
            found.append(Way(road, "backward", ends[1], ends[0], road.lanes_backward, road.turns_backward,
                             end + math.pi, begin + math.pi))  # fmt: skip
    return tuple(found)


def _heading(a: tuple[float, float], b: tuple[float, float]) -> float:
    return math.atan2(b[1] - a[1], b[0] - a[0])


def exits(way: Way, ways: Sequence[Way]) -> tuple[Way, ...]:
    """Ways out of the node at the end, the way's own road left out."""
    return tuple(w for w in ways if w.from_node == way.to_node and w.road.id != way.road.id)


def turn_of(way: Way, onward: Way) -> float:
    """Heading change from one way onto the next, radians, left positive."""
    return wrapped(onward.start_rad - way.end_rad)


def degree(node: str, spec: RoadSpec) -> int:
    """How many roads meet at a node, or at the roundabout that it belongs to."""
    center = centers(spec)
    here = {n for n, name in center.items() if name == center.get(node, "")} or {node}
    return sum((r.from_node in here) + (r.to_node in here) for r in spec.roads if not r.circle)
