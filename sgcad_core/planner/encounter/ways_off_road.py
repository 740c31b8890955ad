"""Ways off the road: far beside it, or up to what runs along it.

Costs as in `sgcad_core.planner.encounter.maneuver_choices`. Knows one actor.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from sgcad_core.metrics.drivability import REAR_AXLE
from sgcad_core.planner.actor_plan import Drift, Role
from sgcad_core.planner.encounter.meeting_place import TURNING
from sgcad_core.planner.lines.box_angles import told_skids
from sgcad_core.planner.lines.departures import (
    GENTLY,
    OFF_ROAD_M,
    aside_m,
    change_of_line,
    departure_sides,
    half_gone,
    has_median,
    rail_m,
    still_leaving,
)
from sgcad_core.planner.long_things import corner_m, reach_m

_OTHER_SIDE, _STAYS_ON_ROAD = 0.25, 2.5
"""Costs of leaving the road on the unlikelier side, and of a told departure that is not driven."""
_OFF_BEHIND_TURN_M = 16.0
"""Length of the way off the road of a vehicle that turns first."""
_RAIL_SHARES = ((0.0, 0.0), (-0.8, 0.08), (0.8, 0.1), (1.6, 0.2))
"""Further from the road than usual, in metres, where there is room; and the costs."""
_OTHER_LANE = 0.06
"""Cost of coming from the next lane."""
_EASES = ((GENTLY, 0.0), (1.0, 0.04), (0.75, 0.12), (0.6, 0.25))
"""How hard a vehicle leaves the road, with costs."""
_YAWS_RAD, _LOST_YAW_RAD = (math.radians(6.0), 0.03), (math.radians(20.0), 0.1)
"""Angles of the box against its line as it meets the rail, with costs: within the slip that tires allow, and in a told
loss of control."""


def departures(role: Role, *, fine: bool) -> list[Drift]:
    """Ways off the road on the side that is told, or on the likelier one and the other."""
    shares = [(1.0, 0.0), (0.8, 0.1), (1.3, 0.15), (1.7, 0.3)] if fine else [(1.0, 0.0), (1.3, 0.15)]
    found: list[Drift] = []
    sides = departure_sides(role.course, role.place.station_m, role.told.departs or "either")
    for rank, side in enumerate(sides):
        if role.other_long_m:
            found += _to_rail(role, side, _OTHER_SIDE * rank)
            continue
        wide = aside_m(role.course, side, OFF_ROAD_M)
        for share, cost, ease in eased(shares):
            drift = change_of_line(role, wide * share, cost + _OTHER_SIDE * rank, ease)
            slides = role.skids_as_told and role.actor.maneuver not in TURNING
            found.append(half_gone(role, drift, ease) if slides else still_leaving(role, drift, ease))
    if role.actor.maneuver in TURNING:
        found = [drift._replace(length_m=min(drift.length_m, _OFF_BEHIND_TURN_M)) for drift in found]
    return sorted([*found, Drift(_STAYS_ON_ROAD)], key=lambda drift: drift.cost)


def eased(shares: Sequence[tuple[float, float]]) -> Iterator[tuple[float, float, float]]:
    """Shares with their costs and an ease."""
    for ease, more, count in ((GENTLY, 0.0, None), (1.0, 0.12, 3), (0.6, 0.4, 3)):
        yield from ((share, cost + more, ease) for share, cost in shares[:count])


def _to_rail(role: Role, side: int, cost: float) -> Iterator[Drift]:
    """Ways up to what runs along the road on a side, steepest where the corner ahead meets it; for an end the box is
    turned further than its line."""
    flank = role.side in ("left", "right")
    corner = side * _corner_m(role)
    at_m = rail_m(role.course, side, role.other_long_m) - corner
    bounded = side > 0 and has_median(role.course)
    steers = not flank and not role.skids_as_told  # the angle of a told skid is that of its box
    yaws = [(0.0, 0.0), _YAWS_RAD] if steers else [(0.0, 0.0)]
    yaws += [_LOST_YAW_RAD] if role.told.lost_control and steers else []
    ways = product(_RAIL_SHARES[: 1 if bounded else None], _EASES, yaws, _lanes_from(role, side))
    for (further, *more), (ease, harder), (yaw, turned), (before_m, crossed) in ways:
        line = change_of_line(
            role, at_m + side * further - before_m, cost + sum(more) + harder + turned + crossed, ease
        )
        yield half_gone(role, line, ease)._replace(yaw_rad=2 * side * yaw, before_m=before_m)


def _corner_m(role: Role) -> float:
    """How far beside its line the corner of a vehicle meets what runs along the road, metres."""
    if not (skids := told_skids(role)):
        return corner_m(role.size, role.side, REAR_AXLE * role.size[0])
    return float(reach_m(role.size, np.array([math.pi / 2 - skids[0].angle_rad]))[0])


def _lanes_from(role: Role, side: int) -> list[tuple[float, float]]:
    """How far to the left of its line it comes from, with costs: where no lane is told also the next one on the other
    hand, across which it comes at a larger angle."""
    course, found = role.course, [(0.0, 0.0)]
    room = course.right_edge_m if side > 0 else course.own_left_m
    if role.actor.lane is None and room > course.lane_width_m:
        found.append((-side * course.lane_width_m, _OTHER_LANE))
    return found
