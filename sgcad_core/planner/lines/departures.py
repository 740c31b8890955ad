"""On which side of the road a vehicle leaves it, how far beside its lane it then is, and over which length.

Knows one course and what is told of one vehicle; no other actor and no time.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import Maneuver
from sgcad_core.metrics.road_departure import hand_of
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.actor_plan import Drift, Role, usual_speed
from sgcad_core.planner.encounter.meeting_place import TURNING
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.planner.lines.path import ramp_length_m
from sgcad_core.records.course import CourseTold, DepartureSide

OFF_ROAD_M = 4.0
"""From the edge of the road to a vehicle that has left it."""
_RAIL_AT_M = 3.2
"""From there to what runs along the road, as guardrails and barriers do, where there is room."""
DEPARTURES: dict[Maneuver, int] = {"departing_road_left": 1, "departing_road_right": -1}
"""Maneuvers off the road, and the side: 1 to the left."""
SWERVE_MPS2 = 6.0
"""Lateral acceleration that gives the length of a swerve; the speed follows from friction."""
GENTLY = 1.7
"""Ease of an ordinary change of line; 1 is hard."""
_STILL_S = 1.0
"""Time on its undisturbed line before it leaves it."""
_STAYS: frozenset[Maneuver] = frozenset({"u_turn", "stopped", "parked", "backing"})
"""Maneuvers with a line of their own, or none, from which the road is not left."""
_BEHIND_JUNCTION_M = 45.0
"""From a junction that was passed to where the road is left: the way of a swing that begins there."""
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


def comes_back(maneuver: Maneuver, told: CourseTold) -> bool:
    """Whether a vehicle that leaves the road is told to come to rest on it, or beyond its other side."""
    side, rest = side_of(maneuver, told.departs), told.rest
    if side is None:
        return False
    return rest.where in ("road", "intersection") or {side, rest.side} == {"left", "right"}


def departure_station(course: Course, maneuver: Maneuver, usual_m: float, *, beyond: bool = False) -> float:
    """The station at which a vehicle is off the road: the usual one of its maneuver, or behind its turn; `beyond`: it
    passes its junction first."""
    crossed = (p for p in course.passages if p.is_junction and course.start_m < p.entry_m and p.exit_m < course.end_m)
    if beyond and (first := next(crossed, None)):
        return min(first.exit_m + _BEHIND_JUNCTION_M, course.end_m)
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


def has_median(course: Course) -> bool:
    """Whether something lies between the two directions."""
    return course.median_m > _LEAST_MEDIAN_M


def aside_m(course: Course, side: int, off_m: float = OFF_ROAD_M) -> float:
    """How far to the left of its lane's line a vehicle is that has left the road on a side, metres: in the median where
    there is one, else beyond the other direction; `off_m`: from the edge of the road."""
    if side < 0:
        return -(course.right_edge_m + off_m)
    if has_median(course):
        return course.own_left_m + min(max(course.median_m / 2, _BESIDE_M), off_m)
    return course.left_edge_m + off_m


def rail_m(course: Course, side: int, depth_m: float) -> float:
    """How far to the left of its lane's line the face of a thing of some depth lies that runs along the road on a side:
    within the median where there is one, else beyond the edge of the road, metres."""
    if side < 0:
        return -(course.right_edge_m + _RAIL_AT_M)
    if has_median(course):
        return course.own_left_m + min(max(course.median_m - depth_m, course.median_m / 2), _RAIL_AT_M)
    return course.left_edge_m + _RAIL_AT_M


def left_of_road_m(course: Course) -> float:
    """How far to the left of its lane's line the road ends: at the median where there is one, metres."""
    return course.own_left_m if has_median(course) else course.left_edge_m


def on_the_road(course: Course, left_m: Floats) -> NDArray[np.bool_]:
    """(n,) whether offsets from its line are still within the edges of the road."""
    within: NDArray[np.bool_] = (left_m < course.left_edge_m) & (-left_m < course.right_edge_m)
    if not has_median(course):  # the lines between two directions are none
        return within
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


def leaving(role: Role, drift: Drift) -> tuple[float, float] | None:
    """Stations at which a vehicle begins to leave the road, and from which on its line is off it up to its place; None
    where it is on it there. One that was off it before, by told moves, begins at the edge."""
    if side_of(role.actor.maneuver, role.told.departs) is None or role.actor.record.walks:
        return None
    s_m = role.course.path.s_m[role.course.path.s_m <= max(role.place.station_m, drift.end_m)]
    on = np.flatnonzero(on_the_road(role.course, drift.profile(s_m)))
    if not len(on) or on[-1] + 1 >= len(s_m):
        return None
    edge_m = float(s_m[on[-1] + 1])
    return (edge_m if drift.earlier else min(drift.begins_m, edge_m)), edge_m


def shift_length_m(role: Role, left_m: float, ease: float) -> float:
    """The length of a shift to the left at the usual speed: ease 1 is hard, more is gentler; longer on snow and ice."""
    dry = ramp_length_m(left_m, ease * usual_speed(role), SWERVE_MPS2)
    return dry * math.sqrt(max(DRIVING.friction_mps2(None) / role.grip_mps2, 1.0))


def room_before_m(role: Role) -> float:
    """The way along its road before its place on which a line may change, metres."""
    return role.place.station_m - role.course.first_m - _STILL_S * usual_speed(role)


def change_of_line(role: Role, left_m: float, cost: float, ease: float, note: str = "") -> Drift:
    """A change as long as its lateral acceleration allows: ease 1 is hard, more is gentler; longer on snow and ice."""
    dry = ramp_length_m(left_m, ease * usual_speed(role), SWERVE_MPS2)
    length = min(shift_length_m(role, left_m, ease), max(room_before_m(role), dry))
    return Drift(cost, left_m, length, role.place.station_m, note=note)


def still_leaving(role: Role, drift: Drift, ease: float) -> Drift:
    """A way off the road that is half done at the place, where its road is too short for the whole of it: the vehicle
    keeps its speed and meets what stands there as it drifts away, since ice allows no sharper line."""
    if drift.length_m >= shift_length_m(role, drift.left_m, ease):
        return drift
    return half_gone(role, drift, ease, max(2 * room_before_m(role), drift.length_m))


def half_gone(role: Role, drift: Drift, ease: float, most_m: float = math.inf) -> Drift:
    """A way off the road that is half done at the place, where it is steepest: there it meets what runs along it.
    `most_m`: its longest."""
    length = min(shift_length_m(role, 2 * drift.left_m, ease), most_m)
    return drift._replace(left_m=2 * drift.left_m, length_m=length, end_m=drift.end_m + length / 2)


def way_off_m(role: Role) -> float:
    """The way along its road that a departure takes on a slippery surface, metres; 0 where there is room for it or the
    road is not left."""
    if not departs(role.actor.maneuver, role.told.departs) or role.actor.maneuver in TURNING:
        return 0.0
    side = departure_sides(role.course, role.place.station_m, role.told.departs or "either")[0]
    wide = aside_m(role.course, side)
    slippery = role.grip_mps2 < DRIVING.friction_mps2(None)
    if not slippery or shift_length_m(role, wide, GENTLY) <= room_before_m(role):
        return 0.0
    return shift_length_m(role, 2 * wide, GENTLY) / 2 + _STILL_S * usual_speed(role)
