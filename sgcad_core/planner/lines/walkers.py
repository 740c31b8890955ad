"""Courses outside the lanes: crossing pedestrians, and cyclists at the edge.

The line of a pedestrian crosses that of the driver. Knows courses, no time.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sgcad_core.planner.encounter.meeting_place import Place, preferred_station
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.planner.lines.path import draw
from sgcad_core.records.specs import Actor, Area

_REACH_M = 14.0
_CROSSWALK_M = 3.0
_EDGE_M = 0.6

_HEADINGS: dict[Area, tuple[int, ...]] = {
    "left": (90, -90), "right": (-90, 90), "front": (180, 90, -90), "back": (0, 90, -90),
}  # fmt: skip
"""Walking directions against the driver's heading, in degrees, in which a side faces the driver: best first."""


def crosswalk_station(driver: Actor, course: Course, length_m: float, walker: Actor) -> float:
    """The station of a driver's course at which a pedestrian crosses: on the pedestrian's road, close to the
    junction."""
    wish = preferred_station(driver, course, length_m)
    span = course.on_road(walker.road)
    if span is None or driver.maneuver in ("stopped", "parked"):
        return wish
    if course.crosswalks:
        return min(course.crosswalks, key=lambda s: abs(s - wish))
    nodes = [p for p in course.passages if p.is_junction]
    if not nodes:
        return min(max(wish, span[0]), span[1])
    nearest = min(nodes, key=lambda p: min(abs(p.entry_m - span[1]), abs(p.exit_m - span[0])))
    before = abs(nearest.entry_m - span[1]) <= abs(nearest.exit_m - span[0])
    return nearest.entry_m - _CROSSWALK_M if before else nearest.exit_m + _CROSSWALK_M


def walking_courses(course: Course, station_m: float, side: Area | None) -> list[tuple[float, Course, Place]]:
    """Lines across (or along) a driver's course at a station with their costs, likeliest first."""
    degrees = _HEADINGS[side] if side else (90, -90)
    return [(0.3 * i, *_line(course, station_m, math.radians(d))) for i, d in enumerate(degrees)]


def _line(course: Course, station_m: float, turn_rad: float) -> tuple[Course, Place]:
    x, y, heading = course.path.poses([station_m])[0]
    way = np.array([math.cos(heading + turn_rad), math.sin(heading + turn_rad)])
    path = draw(np.array([x, y]) + np.array([[-_REACH_M], [_REACH_M]]) * way)
    walk = Course(
        path=path, start_m=0.0, end_m=2 * _REACH_M, passages=(), turn=None, lane_width_m=1.5, opposite_m=1.5,
        left_edge_m=1.0, right_edge_m=1.0, limit_mps=1.5, roads=(),
    )  # fmt: skip
    return walk, Place(_REACH_M, 0.0, math.remainder(-turn_rad, math.tau), 0.0)


def at_the_edge(course: Course) -> Course:
    """The course of a cyclist: on the bicycle lane, else at the right edge of the road."""
    aside = course.beside_m.get("biking", max(course.right_edge_m - _EDGE_M, 0.0))
    return replace(course, path=course.path.moved(-aside * np.ones(len(course.path.s_m))))
