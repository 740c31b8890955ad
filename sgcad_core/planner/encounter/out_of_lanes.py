"""Which places on an approach come after driving out of the lanes of the own direction that no maneuver tells.

Knows one actor, its course and its line; no other actor.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import Maneuver
from sgcad_core.metrics.labels.observed_crash import BEFORE_S
from sgcad_core.metrics.untold_places import MOST_S
from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.lines.axle_to_box import offsets
from sgcad_core.planner.lines.departures import departs
from sgcad_core.planner.lines.path import Path
from sgcad_core.planner.motion import LEAD_S

OUT = 50.0
"""Cost of an encounter behind such driving: none of the others comes near it, and the encounter is not taken."""
_OVER_M = 0.25
"""By which a center may lie over the edge of its lanes."""
_INTO_M, _OUT_OF_M = 2.0, 6.0
"""Before and behind a junction no lanes are kept."""
_ASKEW_RAD = math.radians(50)
"""Angle to its lane at which a vehicle stops at most."""
_VERGE_M = 3.0
"""Distance from the road at which a vehicle may start whatever it does (a shoulder, the mouth of a driveway)."""
_STARTS_S = np.linspace(-LEAD_S[0] - 1.0, -LEAD_S[0] + 1.0, 5)
"""Own times at which the shortest approach may begin: the contact lies slightly before or behind the place."""
_BOTH = (True, True)
_MAY_LEAVE: Mapping[Maneuver, tuple[bool, bool]] = {
    "crossing_centerline": (True, False), "overtaking": (True, False), "departing_road_left": (True, False),
    "departing_road_right": (False, True), "u_turn": _BOTH, "backing": _BOTH, "parked": _BOTH,
}  # fmt: skip
"""Whether a maneuver leaves the lanes of its direction to the left, and to the right."""


def is_out(role: Role, left_m: float) -> bool:
    """Whether a constant offset from its line is out of the lanes that it has to keep to."""
    return not _is_free(role) and bool(_beyond(role, np.array([left_m]))[0])


def out_of_lanes(role: Role, path: Path, clock: tuple[Floats, Floats]) -> Floats:
    """(n,) the cost of an encounter at each point of a box's path: OUT behind more than half a second on the wrong side
    of the road or off its lanes; `clock`: own times with stations."""
    cost: Floats = np.zeros(len(path.s_m))
    if _is_free(role):
        return cost
    out = _beyond(role, offsets(role.course.path, path, path.s_m)[1])
    for crossed in role.course.passages:
        if crossed.is_junction:
            out &= (path.s_m < crossed.entry_m - _INTO_M) | (path.s_m > crossed.exit_m + _OUT_OF_M)
    if not out.any():
        return cost
    if out[min(int(path.s_m.searchsorted(clock[1][0])), len(out) - 1)]:  # where it starts, or waits before it does
        return cost + OUT
    at_s = np.interp(path.s_m, clock[1], clock[0])
    spent = np.concatenate(([0.0], np.cumsum(np.diff(at_s) * out[1:])))
    late = BEFORE_S if role.told.steers else 0.0
    counted = np.interp(at_s - late, at_s, spent) - np.interp(at_s - LEAD_S[0], at_s, spent)
    cost[counted > MOST_S] = OUT
    return cost


def starts_beside(role: Role, line: Path, clock: tuple[Floats, Floats]) -> bool:
    """Whether a line is far off the road where the shortest approach may begin; `clock`: own times with stations."""
    left = offsets(role.course.path, line, np.interp(_STARTS_S, *clock))[1]
    return bool(left.max() > role.course.left_edge_m + _VERGE_M or -left.min() > role.course.right_edge_m + _VERGE_M)


def stands_out_of_lanes(role: Role, left_m: float, angle_rad: float) -> bool:
    """Whether it stands in a lane of the other direction, off the lanes, or across the own one."""
    if role.actor.maneuver != "stopped" or _is_free(role):
        return False
    return is_out(role, left_m) or abs(angle_rad) > _ASKEW_RAD


def _is_free(role: Role) -> bool:
    """Whether it need not keep to lanes: it is told to lose control, or to leave its lane and come back, is in a gore,
    no lane holds it, or nothing else is left."""
    record = role.actor.record
    lost = role.told.lost_control or (role.may_skid and not role.other_lost)
    lost = lost or departs(role.actor.maneuver, role.told.departs) or bool(role.told.moves)
    return lost or role.leaves_lanes or role.actor.gore or not record.wheeled or record.keeps_right


def _beyond(role: Role, left_m: Floats) -> NDArray[np.bool_]:
    """(n,) whether offsets from its line lie beyond the lanes of its direction, on a side that it is not told to leave
    them on."""
    course, (left, right) = role.course, _MAY_LEAVE.get(role.actor.maneuver, (False, False))
    found: NDArray[np.bool_] = (left_m > course.own_left_m + _OVER_M) & (not left)
    return found | ((-left_m > course.right_edge_m + _OVER_M) & (not right))
