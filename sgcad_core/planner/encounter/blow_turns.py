"""How well an encounter turns its vehicles as the report tells: by one impulse, and the way that they then slide.

A rough forecast that orders encounters, before any is simulated whole. Knows encounters; no scene and no road.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from sgcad_core.kinds import mass_kg
from sgcad_core.metrics.rest_error import compass_rad
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.aftermath.blow import blow
from sgcad_core.planner.aftermath.crush import corner_of, slanted
from sgcad_core.planner.aftermath.ground_friction import Drag, locked_turning
from sgcad_core.planner.aftermath.impact import USUAL, Body, Impact, body
from sgcad_core.planner.aftermath.wreck_bodies import center_of, separation, touch_points
from sgcad_core.planner.encounter.pairing import Encounter
from sgcad_core.planner.motion import STEP_S, Motion
from sgcad_core.records.course import sense_of

_SLOWS_MPS2 = 3.0
"""Of a body that slides to rest, some wheels locked."""
_ROLLING_SHARE = 0.4
"""Resistance of rolling wheels to rotation, as a share of that of locked ones."""
_STEERS_RADPS2 = 0.4
"""Angular acceleration that dragging wheels add in either sense, over that time."""
_UNUSUAL = 0.2
"""Weight of a rotation that some run-out gives, but not the usual one."""
_SOME_RAD = math.radians(45.0)
"""Rotation of a vehicle of which only the sense is told."""


def turns_told(found: Encounter) -> bool:
    """Whether a rotation or a facing at rest is told of either vehicle."""
    return any(_tells(option.role) for option in (found.first, found.second))


def _tells(role: Role) -> bool:
    told = role.told
    return not role.actor.record.thing and (told.spin is not None or told.rest.facing_deg is not None)


def misturned(found: Encounter, impacts: Sequence[Impact] = (USUAL,)) -> tuple[float, Impact]:
    """Radians by which the vehicles would turn otherwise than told, both together, with the best of some frictions and
    restitutions, the first of equal ones; 0 where no rotation is told."""
    roles = found.first.role, found.second.role
    wanted = [_wanted(role, motion, own) for role, motion, own in zip(roles, *_clocks(found), strict=True)]
    first, second = (_moving(role, motion, own) for role, motion, own in zip(roles, *_clocks(found), strict=True))
    at, normal = center_of(touch_points(first, second)), separation(first, second).normal
    glances = corner_of(first, second, normal) is not None
    grip = Drag(0.0, DRIVING.sliding_mps2(roles[0].surface))
    locked = [locked_turning(one, grip) for one in (first, second)]

    def off(impact: Impact) -> float:
        along = slanted(first, at, normal, impact.glance_rad) if glances else normal
        after = blow((first, second), (at, along), impact)
        return sum(_off(turn, after[k], locked[k]) for k, turn in enumerate(wanted) if turn is not None)

    best = min(impacts, key=off)
    return off(best), best


def _clocks(found: Encounter) -> tuple[tuple[Motion, Motion], tuple[float, float]]:
    meeting = found.meeting
    return (meeting.first, meeting.second), (meeting.first_s, meeting.second_s)


def _wanted(role: Role, motion: Motion, own_s: float) -> float | None:
    """The told rotation, left positive; None where none is told."""
    told, came = role.told, float(motion.poses([own_s])[0, 2])
    if not _tells(role):
        return None
    sign = sense_of(told.spin)
    if sign and told.spin_deg:
        return sign * math.radians(told.spin_deg)
    if told.rest.facing_deg is None:
        return sign * _SOME_RAD
    turn = math.remainder(compass_rad(told.rest.facing_deg) - came, 2 * math.pi)
    return turn if sign * turn >= -_SOME_RAD else turn + sign * 2 * math.pi


def _moving(role: Role, motion: Motion, own_s: float) -> Body:
    """The body as it comes to touch."""
    mass = None if motion.fixed else mass_kg(role.actor.kind, role.size[0])
    before, now = motion.poses([own_s - STEP_S, own_s])
    found = body((float(now[0]), float(now[1]), float(now[2])), role.size, mass)
    if not motion.standing and mass is not None:
        found.vx, found.vy = (float(v) for v in (now - before)[:2] / STEP_S)
    return found


def _off(wanted: float, after: tuple[float, float, float], locked_radps2: float) -> float:
    """What is missing of a rotation after a blow, beyond what wheels that roll and wheels that drag allow.

    `locked_radps2`: what four locked wheels take of the rotation.
    """
    lasts_s = math.hypot(*after[:2]) / _SLOWS_MPS2
    locked = after[2] * abs(after[2]) / (2 * max(locked_radps2, 1e-6))
    least, most = sorted((locked, locked / _ROLLING_SHARE))
    steered = _STEERS_RADPS2 * lasts_s**2
    missing = max(wanted - most - steered, least - steered - wanted, 0.0)
    return missing + _UNUSUAL * abs(wanted - (least + most) / 2)
