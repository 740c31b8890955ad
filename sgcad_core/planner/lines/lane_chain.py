"""The lane of every road of a route and the connections between them; lanes that are closed ahead are left.

Knows the lane graph and the route; no time, no other actor.
"""

from __future__ import annotations

import math
from dataclasses import replace

from sgcad_core.kinds import ACROSS_LANES
from sgcad_core.planner.lines.path import TURN_BACK_M
from sgcad_core.planner.lines.route import Route, Way, turn_angle
from sgcad_core.records.specs import Actor
from sgcad_core.roads.areas.closures import merging_line, taper_of
from sgcad_core.roads.lane_graph import Connection, Lane, LaneGraph, edge_id, road_of

_ONWARD_RAD = 0.6
"""A way that turns less goes straight on."""
_BACK_RAD = math.radians(140.0)
"""A way that turns more leads back: into the lane that a vehicle reaches in one sweep."""


def lane_chain(
    graph: LaneGraph, route: Route, actor: Actor, notes: list[str]
) -> tuple[list[Lane], list[Connection | None]]:
    """A lane for every way and the connection (or None) between each two."""
    lanes: list[Lane] = [route.ways[0].lanes[0]] * len(route.ways)
    links: list[Connection | None] = [None] * (len(route.ways) - 1)
    lanes[route.start] = _first_lane(graph, route, actor, notes)
    for i in range(route.start, len(links)):
        links[i], lanes[i + 1] = _next_lane(graph, route.ways[i], lanes[i], route.ways[i + 1])
    for i in range(route.start - 1, -1, -1):
        links[i], lanes[i] = _previous_lane(graph, route.ways[i], route.ways[i + 1], lanes[i + 1])
    return lanes, links


def _first_lane(graph: LaneGraph, route: Route, actor: Actor, notes: list[str]) -> Lane:
    way = route.ways[route.start]
    if actor.lane == len(way.lanes) + 1 and (center := center_lane(graph, way)) is not None:
        return center
    if actor.lane is not None:
        if actor.lane > len(way.lanes):
            notes.append(f"{actor.id}: lane {actor.lane} of {way.road} taken as {len(way.lanes)}, its leftmost")
        return way.lanes[min(actor.lane, len(way.lanes)) - 1]
    linked = list(way.lanes)
    if route.start + 1 < len(route.ways):
        onward = {c.from_lane for c in graph.leaving(way.id) if c.to_edge == route.ways[route.start + 1].id}
        linked = [lane for lane in way.lanes if lane.index in onward] or linked
    leftmost = actor.maneuver in ("turn_left", "u_turn", "crossing_centerline", "departing_road_left", "overtaking")
    return linked[-1 if leftmost or actor.maneuver == "lane_change_right" else 0]


def center_lane(graph: LaneGraph, way: Way) -> Lane | None:
    """The two-way left-turn lane of a road as a way drives it; None where it has none.

    It belongs to the forward edge. Backward it has no number of its own: no connection leads out of it there.
    """
    road, direction = road_of(way.id)
    edge = graph.edges.get(edge_id(road, "forward"))
    lane = edge.center_lane if edge and not way.wrong_way else None
    if lane is None or direction == "forward":
        return lane
    return replace(lane, index=-1, shape=lane.shape[::-1])


def _is_center(graph: LaneGraph, way: Way, lane: Lane) -> bool:
    center = center_lane(graph, way)
    return center is not None and (center.id, center.index) == (lane.id, lane.index)


def _next_lane(graph: LaneGraph, way: Way, lane: Lane, onward: Way) -> tuple[Connection | None, Lane]:
    if _is_center(graph, way, lane):
        return _out_of_center(graph, way, lane, onward)
    if abs(turn_angle(way, onward)) > _BACK_RAD:
        from_m = lane.shape[-1]
        return None, min(onward.lanes, key=lambda x: abs(math.dist(x.shape[0], from_m) - 2 * TURN_BACK_M))
    between = [c for c in graph.leaving(way.id, lane.index) if c.to_edge == onward.id]
    by_index = {other.index: other for other in onward.lanes}
    between = [c for c in between if c.to_lane in by_index]
    if between and not way.wrong_way:
        side = from_right(way, lane)
        best = min(between, key=lambda c: abs(from_right(onward, by_index[c.to_lane]) - side))
        return best, by_index[best.to_lane]
    return None, onward.lanes[min(from_right(way, lane), len(onward.lanes) - 1)]


def _out_of_center(graph: LaneGraph, way: Way, lane: Lane, onward: Way) -> tuple[Connection | None, Lane]:
    """Out of a center turn lane: on in that of the road ahead, else into the leftmost lane."""
    links = {c.to_lane: c for c in graph.leaving(way.id, lane.index) if c.to_edge == onward.id}
    ahead = center_lane(graph, onward) if abs(turn_angle(way, onward)) < _ONWARD_RAD else None
    goal = ahead or onward.lanes[-1]
    return links.get(goal.index), goal


def _previous_lane(graph: LaneGraph, way: Way, onward: Way, lane: Lane) -> tuple[Connection | None, Lane]:
    if _is_center(graph, onward, lane):
        before = center_lane(graph, way) if abs(turn_angle(way, onward)) < _ONWARD_RAD else None
        links = {c.from_lane: c for c in graph.leaving(way.id) if (c.to_edge, c.to_lane) == (onward.id, lane.index)}
        source = before or way.lanes[-1]
        return links.get(source.index), source
    by_index = {other.index: other for other in way.lanes}
    into = [c for c in graph.leaving(way.id) if (c.to_edge, c.to_lane) == (onward.id, lane.index)]
    into = [c for c in into if c.from_lane in by_index]
    if into and not onward.wrong_way:
        return into[0], by_index[into[0].from_lane]
    return None, way.lanes[min(from_right(onward, lane), len(way.lanes) - 1)]


def from_right(way: Way, lane: Lane) -> int:
    """Number of lanes to the right of a lane; a center turn lane has all of its way there."""
    return next((i for i, other in enumerate(way.lanes) if other.index == lane.index), len(way.lanes))


def merged(
    graph: LaneGraph, route: Route, lanes: list[Lane], links: list[Connection | None], actor: Actor
) -> tuple[list[Lane], list[Connection | None]]:
    """The chain with a merge along the taper where its lane is closed ahead; maneuvers that change lanes are left
    alone."""
    if actor.maneuver in ACROSS_LANES:
        return lanes, links
    for i, way in enumerate(route.ways[:-1]):
        taper = taper_of(graph, way.id)
        if (
            taper is None
            or taper.onward != route.ways[i + 1].id
            or lanes[i].index not in {x.index for x in taper.lanes}
        ):
            continue
        kept = [lane for lane in way.lanes if lane.index not in {x.index for x in taper.lanes}]
        beside = min(kept, key=lambda lane: abs(lane.index - lanes[i].index))
        link, onward = _next_lane(graph, way, beside, route.ways[i + 1])
        shape = merging_line(lanes[i].shape, beside.shape, taper.length_m)
        lanes = [*lanes[:i], replace(lanes[i], shape=shape), onward, *lanes[i + 2 :]]
        links = [*links[:i], link, *links[i + 1 :]]
    return lanes, links
