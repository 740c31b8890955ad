"""Whether a stated turn, lane change, evasion or speed shows before the first contact, by the rules of `sgcad score`.

Knows one actor's course and its poses up to the contact; no other actor.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import ACROSS_LANES
from sgcad_core.metrics.labels.course_label_match import brakes, steers
from sgcad_core.metrics.labels.observed_crash import BEFORE_S
from sgcad_core.planner.actor_plan import Role, usual_speed
from sgcad_core.planner.encounter.meeting_place import TURNING
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.planner.motion import STEP_S, Motion
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import Actor

TURNED_RAD, MOVED_M = math.radians(12.0), 0.7
"""A smaller change of heading is no visible turn, a smaller shift no visible lane change."""


SPEED_SHOWS_S = 0.3
"""Time for which a stated speed is driven before the contact at least."""


def seen_s(role: Role, motion: Motion, contact_s: float) -> float:
    """Time before the contact at which the clock must begin to show a stated speed; 0 where it is never driven."""
    if motion.standing or role.actor.speed_mph is None:
        return 0.0
    seen = contact_s - motion.seen_at(usual_speed(role), contact_s)
    return seen + SPEED_SHOWS_S if math.isfinite(seen) else 0.0


def unseen_maneuver(actor: Actor, course: Course, poses: Floats) -> str | None:
    """The note on a maneuver that (n, 3) poses from the start to the contact do not show; None where it shows."""
    turned = float(np.unwrap(poses[:, 2])[-1] - poses[0, 2])
    if actor.maneuver in TURNING:
        way = -1.0 if actor.maneuver == "turn_right" else 1.0
        return None if way * turned >= TURNED_RAD else f"{actor.id} has hardly begun to turn when they touch"
    if actor.maneuver not in ACROSS_LANES or abs(turned) >= TURNED_RAD:
        return None
    moved = abs(_aside(course, poses[-1]) - _aside(course, poses[0]))
    return None if moved >= MOVED_M else f"{actor.id} has hardly begun to change lanes when they touch"


def unseen_evasion(actor: str, course: Course, told: CourseTold, poses: Floats) -> Iterator[str]:
    """The parts of the stated evasion that (n, 3) poses do not show, in words; the rules are those of `sgcad score`."""
    recent = poses[-round(BEFORE_S / STEP_S) - 1 :]
    steps_m = np.hypot(*np.diff(recent[:, :2], axis=0).T)
    aside = np.array([_aside(course, pose) for pose in recent[[0, -2, -1]]]) if told.steers else np.zeros(0)
    if told.steers and not told.moves and not steers(told.steers, aside, float(steps_m[-1])):
        yield f"{actor} has hardly begun to steer aside when they touch"
    if told.brakes and not brakes(steps_m / STEP_S):
        yield f"{actor} has hardly begun to brake when they touch"


def _aside(course: Course, pose: Floats) -> float:
    """How far to the left of its lane's line a pose is, metres."""
    path = course.path
    offset = pose[:2] - path.points
    nearest = int(np.hypot(*offset.T).argmin())
    angle = path.tangents[nearest]
    return float(offset[nearest, 1] * math.cos(angle) - offset[nearest, 0] * math.sin(angle))
