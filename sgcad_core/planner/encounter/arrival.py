"""How a vehicle comes to the stop at which it is struck, where that is told: it drives up, or moves up from another.

The encounter is searched with a box that stands; here it gets the way there, as far as the other one of the pair leaves
it room. Knows one encounter; no scene and no world clock.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.plane import Floats, gaps_where_near
from sgcad_core.planner.actor_plan import usual_speed
from sgcad_core.planner.encounter.motion_options import Option
from sgcad_core.planner.encounter.pairing import Encounter
from sgcad_core.planner.motion import LEAD_S, STEP_S, Motion, gentle_mps2

STANDS_S = 1.5
"""Time for which a vehicle is seen standing before it is struck."""
MOVES_UP_M = 5.0
"""From its first stop to its last one: about a car's length."""
_BRAKES_MPS2, _STARTS_MPS2 = 2.4, 1.5
_STRAIGHT_RAD = 1e-3
_CLEAR_M = 0.3
"""Distance to the other one before the contact, at least."""
_BEFORE_S = 0.5
"""As long before the contact that distance is not asked for."""

Pair = tuple[tuple[Option, Motion, float], tuple[Option, Motion, float]]
"""Options, motions and own times at the contact."""


def as_they_come(found: Encounter) -> Pair:
    """The pair of an encounter, with the told way of a standing one to its stop where the other one leaves it room."""
    meeting = found.meeting
    pair = ((found.first, meeting.first, meeting.first_s), (found.second, meeting.second, meeting.second_s))
    one, two = (_coming(this, other) for this, other in (pair, pair[::-1]))
    return one, two


def _coming(this: tuple[Option, Motion, float], other: tuple[Option, Motion, float]) -> tuple[Option, Motion, float]:
    """One of a pair with its way to its stop, on a clock of its own that shows 0 at the contact."""
    option, motion, own_s = this
    told, upright = option.role.told.comes, abs(option.twist.angle_rad) < _STRAIGHT_RAD
    if told is None or option.role.actor.maneuver != "stopped" or not motion.standing or not upright:
        return this
    stop_m = float(motion.stations([own_s])[0])
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


def _is_clear(come: Motion, other: tuple[Option, Motion, float]) -> bool:
    """Whether it comes there without coming near the other one."""
    _, motion, own_s = other
    before = np.arange(-LEAD_S[1], -_BEFORE_S, STEP_S)
    theirs = motion.poses(np.full(len(before), own_s) if motion.standing else own_s + before)
    gaps = gaps_where_near(come.poses(before), come.size, theirs, motion.size, _CLEAR_M)
    return bool((gaps > _CLEAR_M).all())
