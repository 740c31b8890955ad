"""A vehicle out of control: it slides into its contact while it turns; one that touches nothing sways and catches
itself, or spins and slides to a stop.

Knows one actor and what is told of it; no other actor and no time.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.actor_plan import Drift, Role, Swing, Twist, usual_speed
from sgcad_core.planner.lines.axle_to_box import eased
from sgcad_core.planner.lines.departures import shift_length_m
from sgcad_core.planner.lines.path import Path, ramp, ramp_length_m
from sgcad_core.planner.motion import EMERGENCY_SHARE, LEAST_SLIDE_MPS, YAW_RADPS, Pace, drag_work
from sgcad_core.records.course import sense_of

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

_RISE, _PLACE_AT = 0.25, 0.9
"""Share of a skid over which its yaw rate grows, and over which it falls; where on it the contact is: tires that slide
slow the turn, which still goes on there."""
_TURNED_THERE = float(eased(np.array([_PLACE_AT]), _RISE)[0])
"""Share of the whole rotation that is then done."""
_SKID_RADPS, _SPIN_RADPS = 1.4, 3.0
"""Yaw rate of a skid, under the 1.5 rad/s that count, and at most, as in spins on dry roads."""
_PEAK = _PLACE_AT / _TURNED_THERE / (1.0 - _RISE)
"""The yaw rate of a skid over its mean up to the contact, at most."""
_FASTEST_MPS = 30.0
"""Speed that is assumed before a skid, at most."""
_TAKES = 0.5
"""Share of the kinetic energy that a slide takes before the contact, at most while the yaw rate allows."""
_LEAST_SKID_M = 9.0
_UNTURNED, _MOSTLY, _STOPPED = 3.0, 0.85, 6.0
"""Cost of a contact before a told skid has begun, more than is given up for a rest; none from that share of its angle
on; cost of one behind the place at which it has slid to a stop."""


def spins_out(role: Role) -> bool:
    """Whether a vehicle is told to turn so far that it does not catch itself."""
    told = role.told
    return told.spin is not None and (told.spin_deg or 0.0) >= SPINS_DEG


def lost_lines(role: Role) -> list[Drift]:
    """The line of a told loss of control at its place; none where it meets something, or where its moves are told."""
    if not (role.untouched and role.told.lost_control) or role.told.moves or role.skids_as_told:
        return []
    if not spins_out(role):
        return [swaying(role)]
    speed = usual_speed(role)
    begins_m, way_m = role.place.station_m - _BEFORE_S * speed, max(speed**2 / (2 * _STOPS_MPS2), _LEAST_M)
    return [spinning(role, 0.0, begins_m, way_m)]


def sense(role: Role) -> float:
    """How it turns: 1 counter-clockwise, also where it is not told, -1 clockwise."""
    return float(sense_of(role.told.spin) or sense_of(role.told.yaws) or 1)


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


# ------------------------------------------------------------------ into a contact
class Slide(NamedTuple):
    """A path with its box turned in a skid; the deceleration of tires that slide across, (n,) m/s2 at its points;
    the cost there of an encounter before it has turned or behind its stop; the station where a told skid begins."""

    path: Path
    drag_mps2: Floats | None = None
    unturned: Floats | float = 0.0
    begins_m: float = math.inf


def slid(role: Role, path: Path, twist: Twist, speed_mps: float) -> Slide:
    """A path with the skid of its box.

    A told skid begins so early that the box still turns on a little as it comes to its place. Another one turns as
    slowly as the yaw rate allows, and keeps its angle from just before the place.
    """
    place_m, angle = role.place.station_m, twist.angle_rad
    if not angle or not twist.skids:
        return Slide(path)
    if not twist.told:
        length = max(12.0 + 8.0 * abs(angle), 1.875 * abs(angle) * speed_mps / YAW_RADPS)
        return Slide(path.turned(angle * ramp(path.s_m, place_m - 5.0 - length, length)))
    before_m = skid_m(role, angle, speed_mps)
    turned = angle / _TURNED_THERE * eased((path.s_m - place_m) * _PLACE_AT / before_m + _PLACE_AT, _RISE)
    slip = path.heading_rad + turned - path.tangents
    drag = DRIVING.sliding_mps2(role.surface) * np.abs(np.sin(slip)) * (turned != 0.0)
    unturned = _UNTURNED * np.clip(1.0 - turned / (_MOSTLY * angle), 0.0, 1.0)
    stopped = speed_mps**2 - drag_work(path.lengths, drag) < LEAST_SLIDE_MPS**2
    return Slide(path.turned(turned), drag, unturned + _STOPPED * stopped, place_m - before_m)


def skid_m(role: Role, angle_rad: float, speed_mps: float) -> float:
    """The way from the loss of control to the place at which the box has turned by an angle, metres.

    The box turns at the usual rate of a skid, or faster where the slide would take more of its energy than a share
    before it comes there.
    """
    usual, fastest = (_PEAK * abs(angle_rad) * speed_mps / rate for rate in (_SKID_RADPS, _SPIN_RADPS))
    affords = _TAKES * speed_mps**2 / (2 * _drag_mps2(role, angle_rad))
    return max(min(usual, affords), fastest, _LEAST_SKID_M)


def entering_mps(role: Role, twist: Twist, speed_mps: float) -> float:
    """The speed at which a vehicle loses control that comes to its contact at its usual one, where none is told.

    Over a way in proportion to the speed v, a deceleration a takes from it as much as v^2 - 2 a (way / v) v says.
    """
    if not twist.told or role.actor.speed_mph is not None:
        return speed_mps
    half = _drag_mps2(role, twist.angle_rad) * _PEAK * abs(twist.angle_rad) / _SKID_RADPS
    most = min(speed_mps / math.sqrt(1.0 - _TAKES), max(speed_mps, _FASTEST_MPS))
    return min(half + math.hypot(half, speed_mps), most)


def _drag_mps2(role: Role, angle_rad: float) -> float:
    """The mean deceleration of a slide in which the box turns by an angle: that of the sine of its slip."""
    turned = min(max(abs(angle_rad), 1e-6), math.pi)
    return (1.0 - math.cos(turned)) / turned * DRIVING.sliding_mps2(role.surface)
