"""The meeting place of two actors: one station on each of two courses.

A first guess only: shifting the clocks moves the contact along the courses.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.records.specs import Actor, Maneuver

STANDING: frozenset[Maneuver] = frozenset({"stopped", "parked"})
TURNING: frozenset[Maneuver] = frozenset({"turn_left", "turn_right", "u_turn"})
_MID_BLOCK: frozenset[Maneuver] = frozenset({
    "crossing_centerline", "overtaking", "lane_change_left", "lane_change_right", "departing_road_left",
    "departing_road_right",
})  # fmt: skip
_BEFORE_JUNCTION_M = 22.0
_ALONG_TAPER = 0.55
"""Share of a taper that is left at the lane change before the closed lane."""
_BENDS_RAD = math.radians(30.0)
"""From a change of heading on at a junction a course turns off there."""
_GRID_M = 2.0
_REACH_M = 25.0
STOP_LINE_M = 1.5
"""From the front of a waiting box to the junction."""


class Place(NamedTuple):
    """A meeting place seen from one actor."""

    station_m: float
    aside_m: float
    """How far to the left the other course passes here, measured across the own heading."""
    angle_rad: float
    """The other course's heading here, relative to the own."""
    apart_m: float
    """Distance between the two courses here."""
    ahead_m: float = 0.0
    """How far ahead the other's meeting place lies, along the own heading (0 where the courses cross)."""


def preferred_station(actor: Actor, course: Course, length_m: float) -> float:
    """The likely station of an actor in the crash, for any other actor."""
    waits = actor.maneuver in STANDING or actor.maneuver == "slowing"
    taper = next((p for p in course.passages if p.taper_m and p.entry_m > course.start_m), None)
    if taper is not None:
        return taper.entry_m - (taper.taper_m + length_m / 2 if waits else _ALONG_TAPER * taper.taper_m)
    if course.turn is not None and not waits:
        share = 0.4 if actor.maneuver == "u_turn" else 0.67
        return course.turn.entry_m + share * (course.turn.exit_m - course.turn.entry_m)
    ahead = [p for p in course.passages if p.entry_m > course.start_m]
    node = next((p for p in ahead if p.is_junction), ahead[0] if ahead else None)
    if node is None:
        own = course.on_road(actor.road) or (course.start_m, course.end_m)
        return (own[0] + own[1]) / 2
    if waits:
        return stop_m(node.entry_m - course.queued_m, length_m)
    if actor.maneuver in _MID_BLOCK and node.around:
        return (node.exit_m + next((p.entry_m for p in ahead if p.entry_m > node.exit_m), node.exit_m)) / 2
    if actor.maneuver in _MID_BLOCK and node.entry_m - _BEFORE_JUNCTION_M > course.start_m:
        return node.entry_m - _BEFORE_JUNCTION_M
    return (node.entry_m + node.exit_m) / 2


def stop_m(line_m: float, length_m: float) -> float:
    """The station of the center of a box that stands before a line."""
    return line_m - STOP_LINE_M - length_m / 2


def meeting_places(
    first: tuple[Actor, Course, float], second: tuple[Actor, Course, float], *, inside: bool = True
) -> tuple[Place, Place]:
    """The stations where two courses (with their boxes' lengths) come nearest to each other and to preference; not
    `inside`: a row meets before its junction."""
    (a, course_a, _), (b, course_b, _) = first, second
    s_a, s_b = _stations(course_a), _stations(course_b)
    p_a, p_b = course_a.path.poses(s_a), course_b.path.poses(s_b)
    apart = np.hypot(p_a[:, None, 0] - p_b[None, :, 0], p_a[:, None, 1] - p_b[None, :, 1])
    wish_a, wish_b = preferred_station(*first), preferred_station(*second)
    if _queue(a, b, (course_a, course_b), inside=inside):
        wish_a, wish_b = _before_junction(wish_a, a, course_a), _before_junction(wish_b, b, course_b)
    cost = 0.5 * apart + _pull(a) * np.abs(s_a - wish_a)[:, None] + _pull(b) * np.abs(s_b - wish_b)[None, :]
    i, j = np.unravel_index(int(np.argmin(cost)), cost.shape)
    gap = float(apart[i, j])
    return _seen(s_a[i], p_a[i], p_b[j], gap), _seen(s_b[j], p_b[j], p_a[i], gap)


def place_near(course: Course, target: Floats) -> Place:
    """The place on a course that is nearest to a pose (x, y, heading)."""
    stations = _stations(course)
    poses = course.path.poses(stations)
    apart = np.hypot(*(poses[:, :2] - target[:2]).T)
    best = int(np.argmin(apart))
    return _seen(stations[best], poses[best], target, float(apart[best]))


def _stations(course: Course) -> Floats:
    return np.arange(course.start_m - _REACH_M, max(course.end_m, course.start_m + 20.0), _GRID_M)


def _pull(actor: Actor) -> float:
    """Weight of the preferred station of an actor, per metre."""
    if actor.gore:
        return 1.0
    if actor.maneuver in TURNING:
        return 0.08
    return 0.04 if actor.maneuver in STANDING else 0.02


def _queue(a: Actor, b: Actor, courses: tuple[Course, Course], *, inside: bool) -> bool:
    """Whether both drive the same way and neither turns: they meet before the junction."""
    around = any(map(_goes_around, (a, b), courses))
    same = a.road == b.road and a.direction == b.direction and not around
    if not inside or "slowing" in (a.maneuver, b.maneuver):
        return same and not any(map(turns_off, courses))
    return same and all(course.turn is None for course in courses)


def turns_off(course: Course) -> bool:
    """Whether a course bends at its junction; one straight on has a turn of its own, which is none."""
    if course.turn is None:
        return False
    entry, exit_ = course.path.poses([course.turn.entry_m, course.turn.exit_m])[:, 2]
    return abs(math.remainder(float(exit_ - entry), 2 * math.pi)) > _BENDS_RAD


def _goes_around(actor: Actor, course: Course) -> bool:
    """Whether an actor performs a mid-block maneuver in a roundabout."""
    return actor.maneuver in _MID_BLOCK and any(p.around for p in course.passages)


def _before_junction(station_m: float, actor: Actor, course: Course) -> float:
    """A station of a row before the junction; one that stands there keeps its place at the stop line."""
    if actor.maneuver in STANDING:
        return station_m
    entries = [p.entry_m for p in course.passages if p.is_junction and p.entry_m > course.start_m]
    return min([station_m, *(e - 8.0 - course.queued_m for e in entries[:1])])


def _seen(station: float, own: Floats, other: Floats, gap: float) -> Place:
    c, s = math.cos(own[2]), math.sin(own[2])
    dx, dy = float(other[0] - own[0]), float(other[1] - own[1])
    angle = math.remainder(float(other[2] - own[2]), 2 * math.pi)
    return Place(float(station), dy * c - dx * s, angle, gap, dx * c + dy * s)
