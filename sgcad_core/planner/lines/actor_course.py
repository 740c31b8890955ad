"""The line of an actor along its route, with the landmarks on it.

Chooses lanes, joins them through the junctions and measures the room to either side. Knows no time and no
other actor.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.sumo.parameters import KIND
from sgcad_core.geometry.distances import distance_to
from sgcad_core.geometry.plane import Floats, arc_lengths, distinct, resample
from sgcad_core.kinds import DRIVEWAY
from sgcad_core.planner.lines.lane_chain import from_right, lane_chain, merged
from sgcad_core.planner.lines.path import Path, bezier, draw, end_heading
from sgcad_core.planner.lines.route import Route, Way, find_route
from sgcad_core.planner.motion import LATERAL_MPS2
from sgcad_core.records.specs import Actor
from sgcad_core.roads.areas.closures import taper_of
from sgcad_core.roads.lane_graph import Connection, Lane, LaneGraph, edge_id, road_of
from sgcad_core.units import MPS_PER_MPH

_MADE_UP_RADIUS_M = 7.0
_MADE_UP_RUN_M = 25.0
_RUN_OUT_M = 40.0
"""Way on from the end of a road, over the junction and off the road."""
_OF_JUNCTION = 3
_AHEAD = ("straight", "departing_road_left", "departing_road_right")
_SMOOTH_MPS = 26.0
_OVER_M = 1.0
"""A line that comes nearer to the center line of a crosswalk crosses it."""


class Passage(NamedTuple):
    """A node on the way: stations where its area begins and ends, and whether roads really meet there.

    `around`: behind it the way goes on around a roundabout. `taper_m`: length of a work zone's taper before it.
    """

    node: str
    entry_m: float
    exit_m: float
    is_junction: bool
    around: bool = False
    taper_m: float = 0.0


@dataclass(frozen=True, eq=False)
class Course:
    """An actor's undisturbed line with its landmarks; metres, stations on `path`."""

    path: Path
    start_m: float
    """Station at which the road of the actor begins."""
    end_m: float
    """Station at which the last road of the route ends."""
    passages: tuple[Passage, ...]
    turn: Passage | None
    """The junction of its turn; None without one."""
    lane_width_m: float
    opposite_m: float
    """To the center of the nearest lane of the other direction (left of the own lane)."""
    left_edge_m: float
    right_edge_m: float
    limit_mps: float
    roads: tuple[tuple[str, float, float], ...]
    """Road ids with the stations between which they are driven."""
    notes: tuple[str, ...] = ()
    crosswalks: tuple[float, ...] = ()
    """Stations of crosswalks."""
    beside_m: Mapping[str, float] = field(default_factory=dict)
    """To the middle of what lies beside the lanes (biking, parking, shoulder, sidewalk), right of the own lane."""
    stalls: bool = False
    """Whether vehicles park square to the line: an aisle of a parking lot."""
    own_left_m: float = math.inf
    """To the left edge of the lanes of its direction; beyond lies the median or the other direction."""
    median_m: float = 0.0
    """Width of the median; 0 where the two directions lie beside each other."""
    queued_m: float = 0.0
    """Room that those need who stand ahead in the lane, before the junction."""
    astray: bool = False
    """Whether the requested route does not exist: another one was taken, or one off the road."""

    @property
    def first_m(self) -> float:
        """Station at which the first road of the route begins; a pedestrian has none."""
        return min((a for _, a, _ in self.roads), default=float(self.path.s_m[0]))

    def on_road(self, road: str) -> tuple[float, float] | None:
        """Stations between which a road is driven; None for other roads."""
        return next(((a, b) for name, a, b in self.roads if name == road), None)

    def reversed(self) -> Course:
        """The course of backing along the same lane: against its direction, from its end."""
        passages = tuple(Passage(p.node, -p.exit_m, -p.entry_m, p.is_junction) for p in reversed(self.passages))
        roads = tuple((road, -b, -a) for road, a, b in reversed(self.roads))
        return replace(
            self, path=self.path.reversed(), start_m=-self.end_m, end_m=-self.start_m, passages=passages, turn=None,
            crosswalks=tuple(-s for s in reversed(self.crosswalks)), beside_m={},
            roads=roads, left_edge_m=self.right_edge_m, right_edge_m=self.left_edge_m, own_left_m=math.inf,
        )  # fmt: skip


class _Piece(NamedTuple):
    points: Floats
    way: int
    is_crossing: bool


def find_course(graph: LaneGraph, actor: Actor, gentle_mps2: float = LATERAL_MPS2) -> Course:
    """The line of one actor, smooth for a sideways acceleration.

    Raises InvalidOutput for a road id that the network does not have.
    """
    route = find_route(graph, actor)
    notes = list(route.notes)
    lanes, links = lane_chain(graph, route, actor, notes)
    pieces = _pieces(*merged(graph, route, lanes, links, actor))
    if route.made_up_turn_rad:
        notes.append(f"{actor.id}: {route.ways[-1].road} offers no such turn; it turns off the road")
        pieces.append(_Piece(_made_up(pieces[-1].points, route.made_up_turn_rad), len(route.ways), True))
    elif _runs_out(graph, route, actor):
        pieces.append(_Piece(_straight_on(pieces[-1].points), len(route.ways), True))
    lane = lanes[route.start]
    usual = actor.speed_mph * MPS_PER_MPH if actor.speed_mph else lane.speed_mps
    smooth = min(usual, _SMOOTH_MPS) * math.sqrt(LATERAL_MPS2 / gentle_mps2)
    return _measured(graph, route, lane, pieces, (tuple(notes), smooth))


# ------------------------------------------------------------------ line
def _pieces(lanes: list[Lane], links: list[Connection | None]) -> list[_Piece]:
    pieces = []
    for i, lane in enumerate(lanes):
        pieces.append(_Piece(lane.shape, i, False))
        if i < len(links):
            link = links[i]
            across = link.via_shape if link is not None else _made_up_link(lane.shape, lanes[i + 1].shape)
            pieces.append(_Piece(across, i, True))
    return pieces


def _made_up_link(first: Floats, second: Floats) -> Floats:
    """A made-up way from the end of one lane to the start of the next."""
    return bezier(first[-1], end_heading(first, at_end=True), second[0], end_heading(second, at_end=False))


def _made_up(before: Floats, turn_rad: float) -> Floats:
    """An arc off the end of the last lane and a straight run behind it."""
    heading = end_heading(before, at_end=True)
    side = math.copysign(1.0, turn_rad)
    sweep = np.linspace(0, turn_rad, 16) + heading - side * math.pi / 2
    circle = np.column_stack((np.cos(sweep), np.sin(sweep)))
    arc = before[-1] + _MADE_UP_RADIUS_M * (circle - circle[0])
    away = heading + turn_rad
    return np.vstack((arc, arc[-1] + _MADE_UP_RUN_M * np.array([math.cos(away), math.sin(away)])))


def _runs_out(graph: LaneGraph, route: Route, actor: Actor) -> bool:
    """Whether the road of an actor ends at a junction that nothing leads on from straight ahead, and it goes on."""
    goes = actor.exit_road is None and actor.record.wheeled and actor.maneuver in _AHEAD
    return goes and _degree(graph, route.ways[-1].to_node) >= _OF_JUNCTION


def _straight_on(before: Floats) -> Floats:
    """A straight run off the end of the last lane."""
    heading = end_heading(before, at_end=True)
    return np.vstack((before[-1], before[-1] + _RUN_OUT_M * np.array([math.cos(heading), math.sin(heading)])))


def _measured(
    graph: LaneGraph, route: Route, lane: Lane, pieces: list[_Piece], more: tuple[tuple[str, ...], float]
) -> Course:
    """`more`: notes, and the speed for which the line is smooth."""
    notes, speed_mps = more
    stations = np.concatenate(([0.0], np.cumsum([arc_lengths(p.points)[-1] for p in pieces])))
    path = draw(distinct(np.vstack([p.points for p in pieces])), speed_mps=speed_mps)
    passages, turn, roads = [], None, []
    for piece, a, b in zip(pieces, stations, stations[1:], strict=False):
        way = route.ways[min(piece.way, len(route.ways) - 1)]
        if not piece.is_crossing:
            roads.append((way.road, float(a), float(b)))
            continue
        onward = route.ways[piece.way + 1].id if piece.way + 1 < len(route.ways) else ""
        around = onward in graph.edges and graph.is_around(graph.edges[onward])
        taper = taper_of(graph, way.id)
        cones_m = taper.length_m if taper and taper.onward == onward else 0.0
        passages.append(
            Passage(way.to_node, float(a), float(b), _degree(graph, way.to_node) >= _OF_JUNCTION, around, cones_m)
        )
        turn = passages[-1] if piece.way == route.turn or piece.way == len(route.ways) else turn
    own = next(i for i, p in enumerate(pieces) if p.way == route.start and not p.is_crossing)
    opposite, own_left, left, right, median = _room(graph, route.ways[route.start], lane)
    return Course(
        path=path, start_m=float(stations[own]), end_m=float(stations[-1]), passages=tuple(passages), turn=turn,
        lane_width_m=lane.width_m, opposite_m=opposite, left_edge_m=left, right_edge_m=right,
        limit_mps=lane.speed_mps, roads=tuple(roads), notes=notes, crosswalks=_crosswalks(graph, path),
        beside_m=_beside(graph, route.ways[route.start], right),
        stalls=_has_stalls(graph, route.ways[route.start]), own_left_m=own_left, median_m=median,
        astray=route.astray,
    )  # fmt: skip


def _crosswalks(graph: LaneGraph, path: Path) -> tuple[float, ...]:
    found = []
    for crossing in graph.crossings:
        away = distance_to(crossing.shape, path.points)
        if away.min() < _OVER_M:
            found.append(float(path.s_m[int(away.argmin())]))
    return tuple(sorted(found))


def _has_stalls(graph: LaneGraph, way: Way) -> bool:
    edge = graph.edges.get(way.id)
    return edge is not None and edge.parameters.get(KIND) == DRIVEWAY and any(x.type == "parking" for x in edge.lanes)


def _beside(graph: LaneGraph, way: Way, right_m: float) -> dict[str, float]:
    """Lanes beside those for cars, metres right of the own lane's center; `right_m`: to the edge of the lanes."""
    found: dict[str, float] = {}
    for lane in reversed(graph.edges[way.id].lanes if way.id in graph.edges else ()):
        if lane.type:
            found[lane.type] = right_m + lane.width_m / 2
            right_m += lane.width_m
    return found


def _degree(graph: LaneGraph, node: str) -> int:
    return len({road_of(e.id)[0] for e in graph.edges.values() if node in (e.from_node, e.to_node)})


def _room(graph: LaneGraph, way: Way, lane: Lane) -> tuple[float, float, float, float, float]:
    """To the nearest opposing lane center, the left edge of its direction's lanes, the left and the right edge of the
    road, and the width of the median, metres."""
    side = from_right(way, lane)
    right = lane.width_m / 2 + sum(other.width_m for other in way.lanes[:side])
    left = lane.width_m / 2 + sum(other.width_m for other in way.lanes[side + 1 :])
    road, direction = road_of(way.id)
    back = graph.edges.get(edge_id(road, "backward" if direction == "forward" else "forward"))
    if back is None or way.wrong_way:
        return left + lane.width_m / 2, left, left, right, 0.0
    facing = (back.car_lanes or back.lanes)[-1]
    gap = _distance(lane.shape, facing.shape)
    center = back.center_lane or graph.edges[way.id].center_lane
    median = 0.0 if center else max(gap - facing.width_m / 2 - left, 0.0)
    return gap, left, gap - facing.width_m / 2 + sum(other.width_m for other in back.lanes), right, median


def _distance(first: Floats, second: Floats) -> float:
    """From the middle of one line to the nearest point of another, metres."""
    middle = resample(first, arc_lengths(first)[-1] / 2)[0]
    dense = resample(second, np.linspace(0, arc_lengths(second)[-1], 60))
    return float(np.hypot(*(dense - middle).T).min())
