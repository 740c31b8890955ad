"""Whether a told turn or change of lane is seen before the first contact, as anybody who looks on would say.

Knows one actor's course and its poses up to the contact; no other actor.
"""

from __future__ import annotations

import math

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.course import Course
from sgcad_core.planner.place import ACROSS_LANES, TURNING
from sgcad_core.specs import Actor

TURNED_RAD, MOVED_M = math.radians(12.0), 0.7
"""A smaller change of heading is no turn to be seen, a smaller shift no change of lane."""


def not_shown(actor: Actor, course: Course, poses: Floats) -> str | None:
    """What of its maneuver is not seen on (n, 3) poses from the start to the contact, in words; None: all is."""
    turned = float(np.unwrap(poses[:, 2])[-1] - poses[0, 2])
    if actor.maneuver in TURNING:
        way = -1.0 if actor.maneuver == "turn_right" else 1.0
        return None if way * turned >= TURNED_RAD else f"{actor.id} has hardly begun to turn when they touch"
    if actor.maneuver not in ACROSS_LANES or abs(turned) >= TURNED_RAD:
        return None
    moved = abs(_aside(course, poses[-1]) - _aside(course, poses[0]))
    return None if moved >= MOVED_M else f"{actor.id} has hardly begun to change lanes when they touch"


def _aside(course: Course, pose: Floats) -> float:
    """How far to the left of its lane's line a pose is, metres."""
    path = course.path
    offset = pose[:2] - path.points
    nearest = int(np.hypot(*offset.T).argmin())
    angle = path.tangents()[nearest]
    return float(offset[nearest, 1] * math.cos(angle) - offset[nearest, 0] * math.sin(angle))
