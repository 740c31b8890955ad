"""On which side of the road a vehicle leaves it, and how far beside its lane it then is.

Knows one course and what is told of one vehicle; no other actor and no time.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import Maneuver
from sgcad_core.metrics.road_departure import hand_of
from sgcad_core.planner.encounter.meeting_place import TURNING
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.records.course import DepartureSide

OFF_ROAD_M = 4.0
"""From the edge of the road to a vehicle that has left it."""
DEPARTURES: dict[Maneuver, int] = {"departing_road_left": 1, "departing_road_right": -1}
"""Maneuvers off the road, and the side: 1 to the left."""
_STAYS: frozenset[Maneuver] = frozenset({"u_turn", "stopped", "parked", "backing"})
"""Maneuvers with a line of their own, or none, from which the road is not left."""
_BEHIND_TURN_M = 12.0
_LEAST_MEDIAN_M, _BESIDE_M = 0.6, 1.0
"""Width from which a median is one, and how far over the edge of its lanes a vehicle in a narrow one is."""
_MOUTH_M = 2.0
"""Before and behind a junction, on which a vehicle beside the road is in the road that joins there."""
_BEFORE_M, _BEND_RAD = 40.0, math.radians(4.0)
"""Length before the place over which a bend shows, and its least angle."""


def departs(maneuver: Maneuver, told: DepartureSide | None) -> bool:
    """Whether a vehicle drives off the road by what is told beside its maneuver."""
    return told is not None and maneuver not in _STAYS


def side_of(maneuver: Maneuver, told: DepartureSide | None) -> DepartureSide | None:
    """The side on which the road is left: told last, else that of the maneuver; "either" names no side."""
    of_maneuver = {1: "left", -1: "right"}.get(DEPARTURES.get(maneuver, 0))
    return of_maneuver if of_maneuver and told in (None, "either") else told  # type: ignore[return-value]


def departure_station(course: Course, maneuver: Maneuver, usual_m: float) -> float:
    """The station at which a vehicle is off the road: the usual one of its maneuver, or behind its turn."""
    return course.turn.exit_m + _BEHIND_TURN_M if course.turn and maneuver in TURNING else usual_m


def departure_sides(course: Course, station_m: float, told: DepartureSide) -> tuple[int, ...]:
    """The sides on which the road may be left at a station, the likeliest first: 1 left, -1 right.

    A compass word becomes a hand by the heading there. Where no side is told it is the outside of a bend, else the
    right, since nothing has to be crossed.
    """
    heading = float(course.path.poses([station_m])[0, 2])
    if hand := hand_of(told, heading):
        return (1 if hand == "left" else -1,)
    came = float(course.path.poses([station_m - _BEFORE_M])[0, 2])
    bend = math.remainder(heading - came, 2 * math.pi)
    return (1, -1) if bend < -_BEND_RAD else (-1, 1)


def aside_m(course: Course, side: int) -> float:
    """How far to the left of its lane's line a vehicle is that has left the road on a side, metres: in the median where
    there is one, else beyond the other direction."""
    if side < 0:
        return -(course.right_edge_m + OFF_ROAD_M)
    if course.median_m > _LEAST_MEDIAN_M:
        return course.own_left_m + min(max(course.median_m / 2, _BESIDE_M), OFF_ROAD_M)
    return course.left_edge_m + OFF_ROAD_M


def on_the_road(course: Course, left_m: Floats) -> NDArray[np.bool_]:
    """(n,) whether offsets from its line are still within the edges of the road."""
    within: NDArray[np.bool_] = (left_m < course.left_edge_m) & (-left_m < course.right_edge_m)
    median = (left_m > course.own_left_m) & (left_m < course.own_left_m + course.median_m)
    return within & ~median


def in_a_mouth(course: Course, s_m: Floats, left_m: Floats) -> NDArray[np.bool_]:
    """(n,) whether offsets from its line at stations lie beside its road at a junction: in a road that joins there."""
    beside = ~on_the_road(course, left_m)
    mouth = np.zeros(len(s_m), dtype=bool)
    for crossed in course.passages:
        if crossed.is_junction:
            mouth |= (s_m > crossed.entry_m - _MOUTH_M) & (s_m < crossed.exit_m + _MOUTH_M)
    return beside & mouth
