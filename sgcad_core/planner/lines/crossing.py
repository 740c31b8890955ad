"""Steep changes of line, by which an end of one vehicle meets a flank of another that drives or stands beside it.

A box touches a flank with its corner, and the touch counts as the end's only where the two are turned by more than
atan(width / length) against each other, some 22 degrees. The vehicle turns so within the room between the two lanes:
from the far side of its own lane if need be. Costs as in `sgcad_core.planner.encounter.maneuver_choices`. Knows one
actor.
"""

from __future__ import annotations

import math

from sgcad_core.planner.actor_plan import Drift, Role, is_beside, is_standing
from sgcad_core.planner.encounter.meeting_place import TURNING

LEAVES, IMPLIED = "leaves its lane", "leaves its lane, as the told lanes and sides imply"
_STEEP_SIN, _STEEP_RUN, _STEEP_AT = 0.47, 2.8, 0.4
"""Sine of an angle at which a corner clearly touches a flank (28 degrees); length over width of the change of line that
reaches it, and the share of that length after which it does."""
_LEAST_ROOM_M = 0.5
_ALONG, _INTO_ONCOMING = 0.35, 0.6
"""Costs of a change of line that nobody tells and that the told lanes and sides imply, and of one that leads into
oncoming traffic: that is odd driving."""


def implied_crossings(role: Role) -> list[Drift]:
    """Untold changes of line that the told lanes imply, where an end is told to meet a flank."""
    aside = role.place.aside_m
    if not end_meets_flank(role) or abs(aside) < 1.0 or is_standing(role) or role.actor.maneuver in TURNING:
        return []
    more, note = (_ALONG, IMPLIED) if math.cos(role.place.angle_rad) > 0 else (_INTO_ONCOMING, LEAVES)
    return [d._replace(note=note) for d in crossings(role, math.copysign(1.0, aside), more)]


def end_meets_flank(role: Role) -> bool:
    """Whether an end of one and a flank of the other are told to touch on courses that run side by side."""
    told = role.side is not None and role.other_side is not None
    return told and is_beside(role.side) != is_beside(role.other_side) and abs(math.sin(role.place.angle_rad)) < 0.5


def crossings(role: Role, way: float, more: float = 0.0) -> list[Drift]:
    """Steep changes of line to the left (`way` 1) or right (-1): half over, and steepest, where the two touch."""
    length, width = role.size
    reach = width / 2 if is_beside(role.side) else (length * _STEEP_SIN + width) / 2
    room = max(abs(role.place.aside_m) - role.other_width_m / 2 - reach, _LEAST_ROOM_M)
    beside = max((role.course.lane_width_m - width) / 2, 0.0)
    found = []
    for aside, share, cost in ((beside, 0.3, 0.0), (beside, 0.2, 0.05), (0.0, 0.3, 0.05), (0.0, 0.2, 0.1)):
        left = (room + aside) / share
        end = role.place.station_m + (1.0 - _STEEP_AT) * _STEEP_RUN * left
        found.append(Drift(cost + more, way * left, _STEEP_RUN * left, end, before_m=-way * aside))
    return found
