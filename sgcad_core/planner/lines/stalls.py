"""The line out of a parking stall: straight back, then along the aisle, facing the later direction of travel.

Plane geometry on a course along the aisle. Metres, radians; knows no time and no other actor.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.plane import Floats, arc_lengths
from sgcad_core.metrics.drivability import REAR_AXLE
from sgcad_core.planner.lines.actor_course import Course, Passage
from sgcad_core.planner.lines.path import draw

RADIUS_M = 5.0
"""Of the rear axle when it backs out with the wheel turned full."""
STRAIGHT_M = 4.5
"""Straight part, until the nose clears the cars beside."""
REACH_M = 1.0
"""From the edge of the lane to the place of the contact behind it."""
_ALONG_M = 12.0
_BEFORE_NODE_M = 6.0
_STEPS = 16


def out_of_stall(course: Course, length_m: float) -> Course:
    """The course out of a stall beside the aisle, beginning in the stall; `length_m`: of the box."""
    nodes = [p.entry_m for p in course.passages if p.entry_m > course.start_m]
    at_m = (nodes[0] if nodes else (course.start_m + course.end_m) / 2) - _BEFORE_NODE_M
    line = _line(course.path.poses([at_m])[0], course.beside_m["parking"] - REAR_AXLE * length_m)
    met_m = max(course.beside_m["parking"] - course.lane_width_m / 2 - length_m / 2, 0.5) + REACH_M
    total_m = float(arc_lengths(line)[-1])
    leaves = Passage("stall", 0.01, 2 * met_m, False)
    road = next((name for name, a, b in course.roads if a <= at_m <= b), "")
    return replace(
        course, path=draw(line), start_m=0.0, end_m=total_m, passages=(leaves,), turn=None,
        roads=((road, 0.0, total_m),), beside_m={}, crosswalks=(),
    )  # fmt: skip


def _line(pose: Floats, aside_m: float) -> Floats:
    """From the stall into the aisle and back along it: (n, 2) points, as the rear axle goes."""
    x, y, heading = pose
    ahead, left = np.array([math.cos(heading), math.sin(heading)]), np.array([-math.sin(heading), math.cos(heading)])
    start = np.array([x, y]) - aside_m * left
    middle = start + STRAIGHT_M * left - RADIUS_M * ahead
    sweep = np.linspace(0.0, math.pi / 2, _STEPS)
    arc = middle + RADIUS_M * (np.outer(np.cos(sweep), ahead) + np.outer(np.sin(sweep), left))
    found: Floats = np.vstack((start, arc, arc[-1] - _ALONG_M * ahead))
    return found
