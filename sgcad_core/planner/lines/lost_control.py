"""The lines of a vehicle that loses control and touches nothing: it sways and catches itself, or spins and slides to a
stop.

Knows one actor and what is told of it; no other actor and no time.
"""

from __future__ import annotations

import math

from sgcad_core.planner.actor_plan import Drift, Role, Swing, usual_speed
from sgcad_core.planner.lines.departures import shift_length_m
from sgcad_core.planner.lines.path import ramp_length_m
from sgcad_core.planner.motion import EMERGENCY_SHARE, Pace

_SWAYS_M = (0.9, -0.6)
"""Where the two sways of a vehicle that catches itself end, metres to the left, or to the right in a clockwise turn."""
_YAWS_RAD = (math.radians(13.0), math.radians(-10.0))
"""Angles of the box against its line there."""
_TURNS_ON = 0.6
"""Share of the way to its stop on which a vehicle turns."""
_BEFORE_S, _STOPS_MPS2, _LEAST_M = 0.3, 5.0, 8.0
"""Time before its place at which one that touches nothing begins to brake, and its braking, as scenes have it; the
least way of a slide, metres."""
SPINS_DEG, USUAL_SPIN_DEG = 60.0, 180.0
"""A told rotation from which on a vehicle slides to a stop; the rotation of a spin whose angle is not told."""


def spins_out(role: Role) -> bool:
    """Whether a vehicle is told to turn so far that it does not catch itself."""
    told = role.told
    return told.spin is not None and (told.spin_deg or 0.0) >= SPINS_DEG


def lost_lines(role: Role) -> list[Drift]:
    """The line of a told loss of control at its place; none where it meets something, or where its moves are told."""
    if not (role.untouched and role.told.lost_control) or role.told.moves:
        return []
    if not spins_out(role):
        return [swaying(role)]
    speed = usual_speed(role)
    begins_m, way_m = role.place.station_m - _BEFORE_S * speed, max(speed**2 / (2 * _STOPS_MPS2), _LEAST_M)
    return [spinning(role, 0.0, begins_m, way_m)]


def sense(role: Role) -> float:
    """1 counter-clockwise, -1 clockwise."""
    return -1.0 if role.told.spin == "clockwise" else 1.0


def swaying(role: Role) -> Drift:
    """To one hand and the other and back on its line, the box turned meanwhile; over at its place."""
    hand, speed = sense(role), usual_speed(role)
    out, over = (hand * left for left in _SWAYS_M)
    yaw, back = (hand * angle for angle in _YAWS_RAD)
    hard_mps2 = Pace(speed, grip_mps2=role.grip_mps2, hard=True).lateral_mps2  # what the pace allows on such a line
    lengths = [ramp_length_m(left, speed, hard_mps2) for left in (out, over - out, -over)]
    end_m = role.place.station_m
    first = Swing(out, lengths[0], end_m - lengths[1] - lengths[2], yaw)
    second = Swing(over - out, lengths[1], end_m - lengths[2], back - yaw)
    return Drift(0.0, 0.0, lengths[2], end_m, earlier=(first, second), yaw_rad=-back)


def spinning(role: Role, left_m: float, begins_m: float, way_m: float) -> Drift:
    """A slide to the left of its line by some distance, with the told rotation on the first part of the way on which it
    comes to a stop."""
    turned = math.radians(role.told.spin_deg or USUAL_SPIN_DEG) * sense(role)
    length = _TURNS_ON * way_m
    end_m = begins_m + length
    aside = Swing(left_m, max(shift_length_m(role, left_m, 1.0), length), end_m)
    return Drift(0.0, left_m, length, end_m, earlier=(aside,), yaw_rad=turned)


def slide_m(role: Role) -> float:
    """The way on which it slides to a stop, metres."""
    return max(usual_speed(role) ** 2 / (2 * EMERGENCY_SHARE * role.grip_mps2), _LEAST_M)
