"""How the two of an encounter come to it in time: up to a stop at which one is struck, and slowly onto its rear.

The encounter is searched with a box that stands and one that keeps its speed. Here the one gets its way to the stop, as
far as the other one leaves it room, and the other one brakes where little speed is left at the contact: a low speed is
told, or a slight blow. The place of the contact stays. Knows one encounter; no scene and no world clock.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.plane import Floats, gaps_where_near
from sgcad_core.planner.actor_plan import Role, usual_speed
from sgcad_core.planner.encounter.motion_options import Option
from sgcad_core.planner.encounter.pairing import Encounter
from sgcad_core.planner.motion import LEAD_S, STEP_S, Motion, Pace, drive, gentle_mps2
from sgcad_core.planner.told_pace import free_speed
from sgcad_core.units import MPS_PER_MPH

STANDS_S = 1.5
"""Time for which a vehicle is seen standing before it is struck."""
MOVES_UP_M = 5.0
"""From its first stop to its last one: about a car's length."""
_BRAKES_MPS2, _STARTS_MPS2 = 2.4, 1.5
_MOVES_OFF_S, _MOVING_OFF_S = 1.0, 3.0
"""Time for which one that has begun to move off is seen moving before it is struck, and for which it gains speed."""
_STRAIGHT_RAD = 1e-3
CLOSING_MPS = 2.8
"""Speed over that of the one ahead at which the one behind runs into it in a slight blow: about 6 mph."""
SLOW_MPH = 12
"""A told speed of one that runs into another's rear is that at the contact, up to this one."""
_ALONG_RAD, _SLOW_S = 0.6, 0.4
_CLEAR_M = 0.3
"""Distance to the other one before the contact, at least."""
_BEFORE_S = 0.5
"""As long before the contact that distance is not asked for."""

_One = tuple[Option, Motion, float]
"""Option, motion and own time at the contact."""


def as_they_come(found: Encounter) -> tuple[_One, _One]:
    """The pair of an encounter, with the told way of a standing one to its stop where the other one leaves it room, and
    with the little speed of the one behind."""
    meeting = found.meeting
    first, second = (found.first, meeting.first, meeting.first_s), (found.second, meeting.second, meeting.second_s)
    first, second = _running_up(first, second), _running_up(second, first)
    return _coming(first, second), _coming(second, first)


def _running_up(this: _One, other: _One) -> _One:
    """One that runs into the rear of another, braking so that little speed is left, on a clock that is 0 at the
    contact."""
    option, motion, own_s = this
    role, behind = option.role, (option.role.side, option.role.other_side) == ("front", "back")
    along = abs(math.remainder(float(_pose(other)[2] - _pose(this)[2]), 2 * math.pi)) < _ALONG_RAD
    free = not (motion.standing or option.pacing.from_stop or role.pushed or role.told.lost_control)
    final = _final_mps(role, _speed(this), _speed(other))
    if not (behind and along and free and role.actor.record.wheeled) or final is None:
        return this
    at = float(motion.stations([own_s])[0])
    cruise = max(free_speed(role.told.pace, role.course.limit_mps, role.actor.record.pace_mps), final)
    slow_m = at - _SLOW_S * final
    pace = Pace(cruise, slow_at_m=slow_m, slow_mps=final, grip_mps2=role.grip_mps2)
    time, station = drive(motion.axle or motion.path, pace, at, (motion.path, role.course.path))
    brakes_m = (cruise**2 - final**2) / (2 * pace.braking_mps2)
    come = replace(motion, time_s=time, station_m=station, begins_m=slow_m - brakes_m)
    return (option, come, 0.0) if _is_clear(come, other, 0.0) else this


def _final_mps(role: Role, own_mps: float, ahead_mps: float) -> float | None:
    """The speed at the contact of one that runs into the rear of another with its speed; None: its own one."""
    if role.actor.speed_mph is not None:
        slow = role.actor.speed_mph <= SLOW_MPH and ahead_mps < 0.5
        return max(role.actor.speed_mph * MPS_PER_MPH, 0.4) if slow else None
    slower = role.told.slight and not role.told.no_evasion and own_mps > ahead_mps + CLOSING_MPS
    return ahead_mps + CLOSING_MPS if slower else None


def _pose(one: _One) -> Floats:
    """(3,) its pose at the contact."""
    pose: Floats = one[1].poses([one[2]])[0]
    return pose


def _speed(one: _One) -> float:
    """Its speed at the contact, m/s."""
    _, motion, own_s = one
    if motion.standing:
        return 0.0
    return float(np.hypot(*(motion.poses([own_s]) - motion.poses([own_s - STEP_S]))[0, :2])) / STEP_S


def _coming(this: _One, other: _One) -> _One:
    """One of a pair with its way to its stop, on a clock of its own that shows 0 at the contact."""
    option, motion, own_s = this
    told, upright = option.role.told.comes, abs(option.twist.angle_rad) < _STRAIGHT_RAD
    if told is None or option.role.actor.maneuver != "stopped" or not motion.standing or not upright:
        return this
    stop_m = float(motion.stations([own_s])[0])
    if told == "moves_off":
        time, station = _moves_off(stop_m)
    else:
        time, station = _moves_up(stop_m) if told == "moves_up" else _drives_up(option, motion, stop_m)
    come = replace(motion, time_s=time, station_m=station, standing=False, begins_m=float(station[1]))
    return (option, come, 0.0) if _is_clear(come, other) else this


def _drives_up(option: Option, motion: Motion, stop_m: float) -> tuple[Floats, Floats]:
    """Times and stations: at its usual speed, braking, at a stop."""
    path, role = motion.path, option.role
    near = np.abs(path.curvature[(path.s_m < stop_m) & (path.s_m > stop_m - 60.0)])
    bends = math.sqrt(gentle_mps2(role.grip_mps2) / max(float(near.max(initial=0.0)), 1e-3))
    speed = min(usual_speed(role), bends)
    braking_s = speed / _BRAKES_MPS2
    since = np.arange(0.0, LEAD_S[1] + STEP_S, STEP_S)[::-1]
    left_m = np.where(since < braking_s, _BRAKES_MPS2 * since**2 / 2, speed * (since - braking_s / 2))
    return np.append(-since - STANDS_S, 0.0), np.append(stop_m - left_m, stop_m)


def _moves_up(stop_m: float) -> tuple[Floats, Floats]:
    """Times and stations: at its first stop, moving up, at its last one."""
    top = math.sqrt(2 * MOVES_UP_M / (1 / _STARTS_MPS2 + 1 / _BRAKES_MPS2))
    starting_s, braking_s = top / _STARTS_MPS2, top / _BRAKES_MPS2
    lasts_s = starting_s + braking_s
    since = np.arange(0.0, lasts_s + STEP_S, STEP_S)[::-1]
    gone_s = np.maximum(lasts_s - since, 0.0)
    starting, braking = _STARTS_MPS2 * gone_s**2 / 2, MOVES_UP_M - _BRAKES_MPS2 * since**2 / 2
    moved = np.where(since > braking_s, starting, braking)
    first = stop_m - MOVES_UP_M
    return (
        np.concatenate(([-LEAD_S[1]], -since - STANDS_S, [0.0])),
        np.concatenate(([first], first + moved, [stop_m])),
    )


def _moves_off(at_m: float) -> tuple[Floats, Floats]:
    """Times and stations: at its stop, and moving off a little before it is struck there, then on."""
    since = np.arange(0.0, _MOVES_OFF_S + LEAD_S[1], STEP_S)
    moved = np.where(since < _MOVING_OFF_S, since**2 / 2, _MOVING_OFF_S * (since - _MOVING_OFF_S / 2)) * _STARTS_MPS2
    first = at_m - _STARTS_MPS2 * _MOVES_OFF_S**2 / 2
    return np.append(-LEAD_S[1], since - _MOVES_OFF_S), np.append(first, first + moved)


def _is_clear(come: Motion, other: _One, clear_m: float = _CLEAR_M) -> bool:
    """Whether it comes there without coming nearer to the other one than a distance."""
    _, motion, own_s = other
    before = np.arange(-LEAD_S[1], -_BEFORE_S, STEP_S)
    theirs = motion.poses(np.full(len(before), own_s) if motion.standing else own_s + before)
    gaps = gaps_where_near(come.poses(before), come.size, theirs, motion.size, clear_m)
    return bool((gaps > clear_m).all())
