"""Where actors start: in a lane, or beside all of them. Knows motions and the lane graph; not who said so."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from sgcad_core.case.records import ActorInfo, ObservedContact, Trajectory
from sgcad_core.geometry.distances import distance_to
from sgcad_core.geometry.plane import Floats
from sgcad_core.roads.lane_graph import LaneGraph

START_M = 6.0
"""A start on the shoulder, one and a half lanes from a center line, still stands on the road."""
_DRIVES_M = 0.5
_OFF_ROAD = ("parked", "departing_road_left", "departing_road_right")


def off_lane(
    actors: Sequence[ActorInfo], motions: Sequence[Trajectory], graph: LaneGraph, contact: ObservedContact | None
) -> Iterator[tuple[str, float]]:
    """Actors that drive before the first contact and do not start in a lane, with their distance to one, metres."""
    lines = _lane_lines(graph)
    kinds = {a.id: a for a in actors}
    until = contact.t_s if contact else np.inf
    for motion in motions:
        actor = kinds[motion.actor]
        if actor.record.laneless or actor.maneuver in _OFF_ROAD or not _drives(motion, until):
            continue
        start = np.array([[motion.x_m[0], motion.y_m[0]]])
        away = min(float(distance_to(line, start)[0]) for line in lines)
        if away > START_M:
            yield actor.id, away


def _drives(motion: Trajectory, until_s: float) -> bool:
    before = motion.t_s <= until_s
    way = np.hypot(motion.x_m - motion.x_m[0], motion.y_m - motion.y_m[0])[before]
    return bool(way.max() > _DRIVES_M)


def _lane_lines(graph: LaneGraph) -> list[Floats]:
    lanes = [lane.shape for edge in graph.edges.values() for lane in edge.lanes]
    return [line for line in [*lanes, *(c.via_shape for c in graph.connections)] if len(line) > 1]
