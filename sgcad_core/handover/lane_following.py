"""The lanes of the network along which a road user goes on, and the edges that its way takes.

`gone_on` continues a trajectory beyond the contact that ends its script: along the lane (or connection across a
junction) that runs at the vehicle's place and in its direction; the maneuver chooses at a junction, the vehicle's own
offset from the lane fades. `route_of` names the edges of a way as SUMO names a route; where a way leaves the lanes (a
verge, a lot) nothing is matched. Knows the lane graph; no time.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.distances import nearest_on
from sgcad_core.geometry.plane import Floats, arc_lengths, distinct, headings, resample
from sgcad_core.roads.lane_graph import Connection, Direction, Lane, LaneGraph

_NEAR_M = 3.5
_TURNED_RAD = math.radians(40)
_PER_RAD_M = 4.0
"""Distance that counts as much as a difference in direction of one radian."""
_FADES_M = 30.0
"""Distance over which the offset from the center of the lane fades."""
_TAKES_OVER_M = 16.0
"""Distance over which the lane replaces the vehicle's own bend."""
_STEP_M = 0.5
_EVERY_M = 2.0
"""Between the places of a way at which its edge is looked up."""
_AHEAD = 3
"""Edges added to a route behind its last known one: near a junction a way across it is needed."""
_MOST_STRIPS = 12
_TURNS: dict[str, Direction] = {"turn_left": "left", "turn_right": "right", "u_turn": "u_turn"}


class Strip(NamedTuple):
    """A lane, or a connection across a node, as a directed line."""

    line: Floats
    of: Lane | Connection
    edge: str


class Start(NamedTuple):
    """End of the script: place, direction of travel, and its change (1/m, left positive)."""

    x_m: float
    y_m: float
    course_rad: float
    bend_per_m: float = 0.0


def continued_line(graph: LaneGraph, start: Start, length_m: float, maneuver: str) -> Floats:
    """(n, 2) points from a place on, half a metre apart, at least `length_m` long.

    The first metres continue the present bend and pass over to the lane; straight on where no lane fits.
    """
    here = np.array([start.x_m, start.y_m])
    at = np.arange(0.0, length_m + 2 * _STEP_M, _STEP_M)
    held = _held(start, at)
    strip = strip_at(graph, here, start.course_rad)
    if strip is None:
        return held
    first, line = _from(strip.line, here), _followed(graph, strip, length_m, maneuver)
    line = _extended(line, length_m + first)
    points = resample(line, first + at)
    fade = np.clip(1 - at / _FADES_M, 0.0, 1.0) ** 2
    lane = points + fade[:, None] * (here - points[0])
    share = np.clip(at / _TAKES_OVER_M, 0.0, 1.0)
    over = (share**2 * (3 - 2 * share))[:, None]
    joined: Floats = (1 - over) * held + over * lane
    return joined


def _held(start: Start, at: Floats) -> Floats:
    """The continuation of the present bend, which straightens out."""
    step = np.diff(at, prepend=0.0)
    bend = start.bend_per_m * np.clip(1 - at / _TAKES_OVER_M, 0.0, 1.0)
    course = start.course_rad + np.cumsum(bend * step)
    middle = course - bend * step / 2
    way = np.cumsum(np.column_stack((np.cos(middle), np.sin(middle))) * step[:, None], axis=0)
    held: Floats = np.array([start.x_m, start.y_m]) + way
    return held


def strips(graph: LaneGraph) -> Iterator[Strip]:
    """Every lane for cars and every connection."""
    for edge in graph.edges.values():
        for lane in edge.car_lanes:
            yield Strip(lane.shape, lane, edge.id)
    for connection in graph.connections:
        if len(connection.via_shape) > 1 and float(arc_lengths(connection.via_shape)[-1]) > 0.5:
            yield Strip(connection.via_shape, connection, connection.from_edge)


def strip_at(graph: LaneGraph, here: Floats, course_rad: float) -> Strip | None:
    """The strip at a place in the direction of motion; None without one."""
    found = [(cost, i, s) for i, s in enumerate(strips(graph)) if (cost := _cost(s.line, here, course_rad)) is not None]
    return min(found)[2] if found else None


def _cost(line: Floats, here: Floats, course_rad: float) -> float | None:
    at = _from(line, here)
    away = float(np.hypot(*(resample(line, [at])[0] - here)))
    step = min(int(np.searchsorted(arc_lengths(line), at, side="right")) - 1, len(line) - 2)
    turned = abs(math.remainder(float(headings(line)[max(step, 0)]) - course_rad, 2 * math.pi))
    return None if away > _NEAR_M or turned > _TURNED_RAD else away + _PER_RAD_M * turned


def _from(line: Floats, here: Floats) -> float:
    """Station of the nearest point of a line."""
    return float(nearest_on(line, here[None]).station_m[0])


def _followed(graph: LaneGraph, strip: Strip, length_m: float, maneuver: str) -> Floats:
    """The line of a strip and of those that it leads to, as far as needed."""
    pieces, turns, edge = [strip.line], maneuver, strip.edge
    place: Lane | Connection | None = strip.of
    ahead_m = 0.0
    for _ in range(_MOST_STRIPS):
        if isinstance(place, Connection):
            edge, index = place.to_edge, place.to_lane
            place, turns = next((lane for lane in graph.edges[edge].lanes if lane.index == index), None), "straight"
        elif place is not None:
            place = _connection_for(graph, edge, place, turns)
        if place is None or ahead_m > length_m:
            break
        pieces.append(place.via_shape if isinstance(place, Connection) else place.shape)
        ahead_m += float(arc_lengths(pieces[-1])[-1])
    return distinct(np.vstack(pieces), 1e-2)


def _connection_for(graph: LaneGraph, edge: str, lane: Lane, maneuver: str) -> Connection | None:
    """The connection of the maneuver, else straight on, else any."""
    leaving = graph.leaving(edge, lane.index)
    wanted = _TURNS.get(maneuver, "through")
    order = {wanted: 0, "through": 1, "right": 2, "left": 3, "u_turn": 4}
    return min(leaving, key=lambda c: order.get(c.direction, 5), default=None)


def _extended(points: Floats, length_m: float) -> Floats:
    """A line made long enough, straight on at its end."""
    lack = length_m + _STEP_M - float(arc_lengths(points)[-1])
    if lack <= 0:
        return points
    way = points[-1] - points[-2]
    way = way / max(float(np.hypot(*way)), 1e-9)
    more: Floats = points[-1] + np.arange(_STEP_M, lack + _STEP_M, _STEP_M)[:, None] * way
    return np.vstack((points, more))


# ------------------------------------------------------------------ routes
def route_of(graph: LaneGraph, poses: Iterable[tuple[float, float, float]]) -> tuple[str, ...]:
    """Edges along poses (x, y, course of the motion), connected, then straight on; () where no lane fits."""
    found: list[str] = []
    for x, y, course in poses:
        strip = strip_at(graph, np.array([x, y]), course)
        edges = [strip.edge] if strip else []
        edges += [strip.of.to_edge] if strip and isinstance(strip.of, Connection) else []
        found += [e for e in edges if e not in found]
    return _straight_on(graph, _connected(graph, found))


def poses_of(pose: Floats, step_m: float = _EVERY_M) -> list[tuple[float, float, float]]:
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


def _straight_on(graph: LaneGraph, edges: list[str]) -> tuple[str, ...]:
    """A route and the few edges that lead straight on from its end."""
    route = list(edges)
    for _ in range(_AHEAD if route else 0):
        through = [c.to_edge for c in graph.leaving(route[-1]) if c.direction == "through" and c.to_edge not in route]
        if not through:
            break
        route.append(through[0])
    return tuple(route)
