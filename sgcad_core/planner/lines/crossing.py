"""Steep changes of line, by which an end of one vehicle meets a flank of another that drives or stands beside it.

A box touches a flank with its corner, and the touch counts as the end's only where the two are turned by more than
atan(width / length) against each other, some 22 degrees. The vehicle turns so within the room between the two lanes:
from the far side of its own lane if need be. Costs as in `sgcad_core.planner.encounter.maneuver_choices`. Knows one
actor.
"""

from __future__ import annotations

import math

from sgcad_core.planner.actor_plan import Drift, Role, comes_against, is_beside, is_standing
from sgcad_core.planner.encounter.meeting_place import TURNING
from sgcad_core.planner.lines.axle_to_box import tightest

LEAVES, IMPLIED = "leaves its lane", "leaves its lane, as the told lanes and sides imply"
_STEEP_SIN, _STEEP_RUN, _STEEP_AT = 0.47, 2.8, 0.4
"""Sine of an angle at which a corner clearly touches a flank (28 degrees); length over width of the change of line that
reaches it, and the share of that length after which it does."""
_LEAST_ROOM_M = 0.5
_BEHIND_M = 1.5
"""Sideways from the other one up to which a vehicle is behind it."""
_SWING_RUN, _SWING_BEND = 3.6, 0.46
"""Length over width of a way out that reaches 27 degrees, and the tightest radius over its width: the largest second
derivative of the step is 5.77."""
_REAR_M, _FLANK_AT, _LATE = 2.4, 0.3, 0.35
"""From the middle of a car to its rear; where along its length a flank touches, from its middle; and the share of such
a way that is left then."""
_PAST_M = ((0.1, 0.05), (0.5, 0.05), (1.0, 0.1), (1.6, 0.15))
"""Room beside the other one behind such ways, with their costs."""
_ALONG, _BEHIND_STANDING, _INTO_ONCOMING = 0.35, 0.15, 0.6
"""Costs of a change of line that nobody tells and that the told lanes and sides imply, of one back behind somebody who
stands and was passed, and of one that leads into oncoming traffic: that is odd driving."""
_ALONG_SIN, _BRUSHES = 0.35, ((0.25, 0.0), (0.5, 0.05), (0.12, 0.05))
"""Sine of the angle between two that drive along each other; overlaps at the end of a line that brushes, with costs."""
_BRUSH_RUN, _BRUSH_LEAST_M = 8.0, 8.0
"""Length over width of such a line (an angle of 13 degrees), and its least length."""
_GRAZE_RUN, _GRAZE_LATE = 15.0, 0.35
"""Length over width of one that grazes slightly, and the share of it that is left where the ends of both meet: the two
are nearly side by side by then."""


def implied_crossings(role: Role) -> list[Drift]:
    """Untold changes of line that the told lanes imply, where an end is told to meet a flank."""
    aside = role.place.aside_m
    if not end_meets_flank(role) or abs(aside) < 1.0 or is_standing(role) or role.actor.maneuver in TURNING:
        return []
    more, note = (_ALONG, IMPLIED) if math.cos(role.place.angle_rad) > 0 else (_INTO_ONCOMING, LEAVES)
    more, note = (_BEHIND_STANDING, IMPLIED) if _cuts_in_behind(role) else (more, note)
    return [d._replace(note=note) for d in crossings(role, math.copysign(1.0, aside), more)]


def _cuts_in_behind(role: Role) -> bool:
    """Whether its flank is told to touch the rear of one that stands and that it passes the other way."""
    stands = role.other_mps == 0.0 and comes_against(role)
    return stands and is_beside(role.side) and role.other_side == "back"


def brushing(role: Role) -> list[Drift]:
    """Untold changes of line by which its told flank brushes that of one that stands, as it passes."""
    stands = role.other_mps == 0.0 and not is_standing(role) and abs(math.sin(role.place.angle_rad)) < _ALONG_SIN
    if not stands or not (is_beside(role.side) and is_beside(role.other_side)):
        return []
    hand, touch = 1.0 if role.side == "left" else -1.0, (role.size[1] + role.other_width_m) / 2
    found = []
    for overlap, cost in _BRUSHES:
        left = role.place.aside_m - hand * (touch - overlap)
        run = max((_GRAZE_RUN if role.told.slight else _BRUSH_RUN) * abs(left), _BRUSH_LEAST_M)
        meets_m = (role.size[0] / 2 + _REAR_M) - _GRAZE_LATE * run if role.told.slight else -run / 4
        found.append(Drift(cost, left, run, role.place.station_m - meets_m, note=IMPLIED))
    return found


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
    return [*found, *_swings_out(role, way, more)]


def _swings_out(role: Role, way: float, more: float) -> list[Drift]:
    """Ways out from behind the other one along which a flank still meets its rear: as steep as the vehicle can bend."""
    if not is_beside(role.side) or role.other_side != "back" or abs(role.place.aside_m) > _BEHIND_M:
        return []
    touch, bend = (role.size[1] + role.other_width_m) / 2, _SWING_BEND / tightest(role.size[0])
    lefts = [(max(touch + past, bend), cost) for past, cost in _PAST_M]
    runs = [(_SWING_RUN * left, left, cost) for left, cost in dict(lefts).items()]
    touches_m = role.place.station_m - _REAR_M - _FLANK_AT * role.size[0]
    return [Drift(cost + more, way * left, run, touches_m + _LATE * run) for run, left, cost in runs]
