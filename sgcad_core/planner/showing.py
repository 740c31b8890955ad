"""Whether a told turn, change of lane or evasion is seen before the first contact, as anybody who looks on would say.

Knows one actor's course and its poses up to the contact; no other actor.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.metrics.crash_seen import BEFORE_S
from sgcad_core.metrics.truth_course import BRAKES_MPS, BRAKES_MPS2, STEERS_M, STEERS_RAD
from sgcad_core.planner.course import Course
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.place import ACROSS_LANES, TURNING
from sgcad_core.specs import Actor
from sgcad_core.told_course import CourseTold, Steering

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


def not_evading(actor: str, course: Course, told: CourseTold, poses: Floats) -> Iterator[str]:
    """What of its told evasion is not seen on such poses, in words."""
    recent = poses[-round(BEFORE_S / STEP_S) - 1 :]
    if told.steers and not _steers(told.steers, course, recent):
        yield f"{actor} has hardly begun to steer aside when they touch"
    if told.brakes and not _brakes(recent):
        yield f"{actor} has hardly begun to brake when they touch"


def _steers(hand: Steering, course: Course, poses: Floats) -> bool:
    """As `sgcad score` sees it: by the way sideways, or by the heading against the lane."""
    begin, last, end = (_aside(course, pose) for pose in (poses[0], poses[-2], poses[-1]))
    ahead = float(np.hypot(*(poses[-1, :2] - poses[-2, :2])))
    way, angle = end - begin, math.atan2(end - last, max(ahead, 1e-6))
    sign = {"left": 1.0, "right": -1.0}.get(hand)
    if sign is None:
        return abs(way) > STEERS_M or abs(angle) > STEERS_RAD
    return way * sign > STEERS_M or angle * sign > STEERS_RAD


def _brakes(poses: Floats) -> bool:
    """As `sgcad score` sees it: by the speed that is lost, in half a second and in all."""
    speed = np.hypot(*np.diff(poses[:, :2], axis=0).T) / STEP_S
    half = round(0.5 / STEP_S)
    fast = len(speed) > half and float((speed[:-half] - speed[half:]).max()) / 0.5 >= BRAKES_MPS2
    return fast and float(speed.max() - speed[-1]) >= BRAKES_MPS


def _aside(course: Course, pose: Floats) -> float:
    """How far to the left of its lane's line a pose is, metres."""
    path = course.path
    offset = pose[:2] - path.points
    nearest = int(np.hypot(*offset.T).argmin())
    angle = path.tangents()[nearest]
    return float(offset[nearest, 1] * math.cos(angle) - offset[nearest, 0] * math.sin(angle))
