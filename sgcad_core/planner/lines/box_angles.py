"""Angles by which a box is turned before a contact: standing askew, steered aside, skidding or sliding.

Costs as in `sgcad_core.planner.encounter.maneuver_choices`. Knows one actor.
"""

from __future__ import annotations

import math

from sgcad_core.planner.actor_plan import Role, Twist, is_standing, mismatch
from sgcad_core.planner.lines.axle_to_box import tightest

ASKEW, STEERS, SKIDS = "stands askew", "steers aside before contact", "skids before contact"
SLIDES = "slides into the contact at an angle that no steering explains"
_IN_A_ROW_RAD, _PARKED_ACROSS = math.radians(20.0), 0.5
"""Angle to the curb from which on a parked vehicle is out of its row, and the cost of that."""
_AGAINST = 0.8
"""Cost of a skid that turns the vehicle otherwise than told."""
_STEERED = 0.5
"""Cost of steering where it is told to turn out of control."""
_LEAST_BACK_RAD = math.radians(90.0)
"""Angle of the box from which on a told sense may take it the longer way round."""
_SLIDING = 2.0
"""Cost of a slide: more than any steering."""


def aiming(role: Role) -> list[Twist]:
    """Angles by which the box turns its wanted side to the approaching actor; none where it already faces there."""
    off = mismatch(role)
    if abs(off) < math.radians(30):
        return []
    off = _as_told(role, off)
    angles = [off - math.copysign(math.radians(k), off) for k in (45, 25, 0)]
    return [twist for a in angles for twist in _turned(role, a, 0.5 + abs(a) / 1.6 + _unlike(role, a))]


def _turned(role: Role, angle_rad: float, cost: float) -> list[Twist]:
    """The ways to reach an angle: standing, by steering, and in a skid where the report states one."""
    if is_standing(role):
        across = role.actor.maneuver == "parked" and abs(angle_rad) > _IN_A_ROW_RAD
        return [Twist(cost + _PARKED_ACROSS * across, angle_rad, ASKEW)]
    lost = _turns_out_of_control(role)
    driven = cost + _STEERED * lost
    found = [Twist(driven, angle_rad, STEERS)]
    if abs(role.place.aside_m) < 16:
        found.append(Twist(driven + 0.05, angle_rad, STEERS, through=True))
        reach = 1 - math.cos(angle_rad)
        if abs(role.place.aside_m) > 1.0 and role.place.aside_m * angle_rad > 0 and reach > 0.02:
            radius = max(abs(role.place.aside_m) / reach, 1.2 / tightest(role.size[0]))
            found.append(Twist(driven + 0.02, angle_rad, STEERS, radius_m=radius))
    if role.may_skid:
        slid = 0.0 if lost else 0.1
        found.append(Twist(cost + slid + _AGAINST * (_sense(role) * angle_rad < 0.0), angle_rad, SKIDS, skids=True))
    return found


def _turns_out_of_control(role: Role) -> bool:
    """Whether it is told which way it turns before the contact, out of control."""
    return role.may_skid and role.told.yaws is not None


def _straight(role: Role) -> list[Twist]:
    """Straight on; of one that is told to turn out of control, first small angles of a skid in that sense."""
    if not _turns_out_of_control(role):
        return [Twist(0.0)]
    slips = ((22.0, 0.0), (35.0, 0.1), (14.0, 0.1))
    turned = [Twist(cost, math.radians(_sense(role) * deg), SKIDS, skids=True) for deg, cost in slips]
    return [*turned, Twist(_AGAINST)]


def _sense(role: Role) -> float:
    """How it is told to turn before the contact: 1 counter-clockwise, -1 clockwise, 0 untold."""
    return {"counterclockwise": 1.0, "clockwise": -1.0}.get(role.told.yaws or "", 0.0)


def _as_told(role: Role, angle_rad: float) -> float:
    """An angle of the box, or the longer way round to it where that is the told sense and no more than three quarters
    of a turn."""
    way = _sense(role)
    if way * angle_rad >= 0.0 or not role.may_skid or abs(angle_rad) < _LEAST_BACK_RAD:
        return angle_rad
    return angle_rad + way * 2 * math.pi


def _unlike(role: Role, angle_rad: float) -> float:
    """Cost of a straight maneuver that is visibly turned (by more than 28 degrees), so that the other actor turns
    instead."""
    return 0.4 if role.actor.maneuver == "straight" and abs(angle_rad) > math.radians(28) else 0.0


def skids(role: Role) -> list[Twist]:
    """Straight on, slight steering, and the angles that bring the wanted side about."""
    small = [t for a in (12, -12, 26, -26) for t in _turned(role, math.radians(a), abs(a) / 60)]
    return [*_straight(role), *small, *aiming(role)]


def spins(role: Role) -> list[Twist]:
    """Any angle, in steps of 45 degrees, and small ones."""
    angles = [math.radians(a) for a in (24, -24, 45, -45, 90, -90, 135, -135, 180)]
    return [*_straight(role), *(t for a in angles for t in _turned(role, a, abs(a) + _unlike(role, a)))]


def slides(role: Role) -> list[Twist]:
    """The box at any angle to its direction without a stated loss of control: dearer than all driving."""
    angles = [math.radians(a) for a in (24, -24, 45, -45, 90, -90, 135, -135, 180)]
    off = mismatch(role)
    facing_it = [Twist(_SLIDING, off, SLIDES, skids=True)] if abs(off) > math.radians(15) else []
    return [Twist(0.0), *facing_it, *(Twist(_SLIDING + abs(a), a, SLIDES, skids=True) for a in angles)]
