"""Angles by which a box is turned before a contact: standing askew, steered aside, skidding or sliding.

A vehicle that turns out of control goes on the way that it went, so that after a quarter turn to the left its right
side leads, after half a turn its back.

Costs as in `sgcad_core.planner.encounter.maneuver_choices`. Knows one actor.
"""

from __future__ import annotations

import math

from sgcad_core.planner.actor_plan import Role, Twist, along_with, facing, is_beside, is_standing, mismatch
from sgcad_core.planner.lines.axle_to_box import tightest
from sgcad_core.planner.lines.departures import departure_sides

ASKEW, STEERS, SKIDS = "stands askew", "steers aside before contact", "skids before contact"
SLIDES = "slides into the contact at an angle that no steering explains"
_IN_A_ROW_RAD, _PARKED_ACROSS = math.radians(20.0), 0.5
"""Angle to the curb from which on a parked vehicle is out of its row, and the cost of that."""
_AGAINST = 1.1
"""Cost of a skid that turns the vehicle otherwise than told, of steering or driving straight where a skid is told: from
there on the search goes on."""
_LEADS = ((0.0, 0.0), (-20.0, 0.04), (20.0, 0.06), (-40.0, 0.1), (40.0, 0.14))
"""Degrees by which a skid may end short of the angle at which its side leads, or beyond it, with costs."""
_SLIGHTLY = ((22.0, 0.0), (35.0, 0.04), (14.0, 0.06), (52.0, 0.1))
"""Angles of a skid in which the front still leads, degrees, with costs."""
_FRONT_LEADS_RAD, _FAR_RAD, _SLIGHT_FLANK = math.radians(45.0), math.radians(200.0), 0.2
"""Angle up to which the front leads; that from which on a flank may also be met in a slight skid, and its cost."""
_MOST_DEG = 300.0
"""Nothing turns farther before its contact."""
_OVERTURNS = ((80.0, 0.0),)
"""The same of one that overturns without a contact, over its leading flank."""
_WAY_OFF_RAD = math.radians(12.0)
"""Angle of the way off the road to the road, about."""
_FLANK_ALONG = ((-10.0, 0.0), (-16.0, 0.04), (-5.0, 0.06), (10.0, 0.1), (16.0, 0.12))
_END_ALONG = ((-35.0, 0.0), (-15.0, 0.04), (-55.0, 0.06), (15.0, 0.1))
"""The same at what runs along the road, which a flank meets within 21 degrees of its corner, an end beyond that."""
_LEAST_BACK_RAD = math.radians(90.0)
"""Angle of the box from which on a told sense may take it the longer way round."""
_SLIDING = 2.0
"""Cost of a slide: more than any steering."""


def aiming(role: Role) -> list[Twist]:
    """Angles by which the box turns its wanted side to the approaching actor; none where it already faces there."""
    off = mismatch(role)
    if abs(off) < math.radians(30):
        return told_skids(role)
    off = _as_told(role, off)
    angles = [off - math.copysign(math.radians(k), off) for k in (45, 25, 0)]
    turned = [twist for a in angles for twist in _turned(role, a, 0.5 + abs(a) / 1.6 + _unlike(role, a))]
    return [*told_skids(role), *turned]


def _turned(role: Role, angle_rad: float, cost: float) -> list[Twist]:
    """The ways to reach an angle: standing, by steering, and in a skid where the report states one."""
    if is_standing(role):
        across = role.actor.maneuver == "parked" and abs(angle_rad) > _IN_A_ROW_RAD
        return [Twist(cost + _PARKED_ACROSS * across, angle_rad, ASKEW)]
    lost = bool(role.skids_as_told)
    driven = cost + _AGAINST * lost
    found = [Twist(driven, angle_rad, STEERS)]
    if abs(role.place.aside_m) < 16:
        found.append(Twist(driven + 0.05, angle_rad, STEERS, through=True))
        reach = 1 - math.cos(angle_rad)
        if abs(role.place.aside_m) > 1.0 and role.place.aside_m * angle_rad > 0 and reach > 0.02:
            radius = max(abs(role.place.aside_m) / reach, 1.2 / tightest(role.size[0]))
            found.append(Twist(driven + 0.02, angle_rad, STEERS, radius_m=radius))
    if role.may_skid:
        slid = 0.0 if lost else 0.1
        against = role.skids_as_told * angle_rad < 0.0
        found.append(Twist(cost + slid + _AGAINST * against, angle_rad, SKIDS, skids=True, told=lost and not against))
    return found


def told_skids(role: Role) -> list[Twist]:
    """The angles in the told sense by which a vehicle out of control meets the contact with its side, the likeliest
    first; none where no such turn is told."""
    way = role.skids_as_told
    if not way:
        return []
    leads = (way * _to_face(role)) % (2 * math.pi)
    if not role.other_long_m and leads > 2 * math.pi - _FRONT_LEADS_RAD:
        leads = 0.0
    return [Twist(cost, way * math.radians(deg), SKIDS, skids=True, told=True) for deg, cost in _degrees(role, leads)]


def _degrees(role: Role, leads_rad: float) -> list[tuple[float, float]]:
    """Angles at which a side meets the contact that leads at one, degrees, with costs."""
    if role.side is None and role.told.rolls:
        return list(_OVERTURNS)
    ends = role.side in ("front", "back")
    if leads_rad < _FRONT_LEADS_RAD or (role.side == "front" and role.other_long_m and leads_rad < math.pi):
        return list(_SLIGHTLY)
    near = _LEADS if not role.other_long_m else _END_ALONG if ends else _FLANK_ALONG
    found = [(math.degrees(leads_rad) + off, cost) for off, cost in near]
    if leads_rad > _FAR_RAD:
        found += [(deg, cost + _SLIGHT_FLANK) for deg, cost in _SLIGHTLY]
    return sorted((angle for angle in found if angle[0] < _MOST_DEG), key=lambda angle: angle[1])


def _to_face(role: Role) -> float:
    """The angle to its way at which its side faces what it meets, radians: a rail, one alongside, or one ahead."""
    if role.other_long_m:
        return _along_rail(role)
    if along_with(role) and is_beside(role.side) and is_beside(role.other_side):
        return math.copysign(math.pi / 2, role.place.aside_m) - facing(role.side or "front")
    return mismatch(role)


def _along_rail(role: Role) -> float:
    """The angle to its way at which its side faces what runs along the road on the hand on which it leaves the road,
    radians."""
    hand = departure_sides(role.course, role.place.station_m, role.told.departs or "either")[0]
    return hand * (math.pi / 2 - _WAY_OFF_RAD) - facing(role.side or "front")


def _straight(role: Role) -> list[Twist]:
    """Straight on; of one that is told to turn out of control, first the skids in that sense."""
    return [*told_skids(role), Twist(_AGAINST * bool(role.skids_as_told))]


def _as_told(role: Role, angle_rad: float) -> float:
    """An angle of the box, or the longer way round to it where that is the told sense and no more than three quarters
    of a turn."""
    way = role.skids_as_told
    if way * angle_rad >= 0.0 or abs(angle_rad) < _LEAST_BACK_RAD:
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
