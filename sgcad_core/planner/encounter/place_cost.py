"""The cost of a place on a path for an encounter, by the maneuver of an actor.

Knows one actor, its path and its drift; no time and no other actor.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import ACROSS_LANES
from sgcad_core.planner.actor_plan import Drift, Role, along_with, line_m
from sgcad_core.planner.encounter.meeting_place import TURNING, stop_m, turns_off
from sgcad_core.planner.lines.axle_to_box import offsets
from sgcad_core.planner.lines.departures import departs, departure_sides, has_median, in_a_mouth, on_the_road
from sgcad_core.planner.lines.path import Path

_ZONE_M = 12.0
_ON_THE_ROAD = 4.0
"""Cost of an encounter on the road for one that is told to leave it: more than `try_elsewhere` gives up for a rest."""
_DRIFTING = ACROSS_LANES | {"crossing_centerline", "departing_road_left", "departing_road_right"}
_NOT_SHOWN = 2.0
"""Cost of a turn that has hardly begun, and of a straight maneuver that has turned."""
_UNMOVED, _MOVED_SHARE = 1.2, 0.7
"""Cost of a lane change that has not begun; none from this share of a body width to the side on, where the bodies still
overlap by a third."""
_OUT_OF_GORE, _INTO_GORE_M = 0.5, 8.0
"""Cost of each metre between the encounter and the gore of one actor, and the distance into the gore."""
_BEFORE_TURN_M = 12.0
"""Distance before a turn at which the box still points along the road: it starts to turn before the junction."""
_OVER_MEDIAN, _CLEARLY_OFF_M = 1.5, 0.4
"""Cost of meeting what stands in the median in the lanes beyond it; by which the front of a vehicle that meets it is
off its lanes at least."""
_IN_MOUTH = 0.6
"""Cost of an encounter beside the road where another road joins, for one that leaves the road."""
_WAITS_BEFORE_M = 8.0
"""As near before the stop line of a junction one that stands in the road waits at that line."""
_QUEUED_M, _MOVED_UP_M = 10.0, 1.5
"""Distance before that line at which it may stand in a queue; the same of one that moved up to the line."""
_OUT_OF_ZONE, _UP_TO_LINE = 0.03, 0.15
"""Cost of each metre away from there."""
_IN_JUNCTION = 0.8
"""Cost of standing in a junction where a stop is told: drivers wait before it."""
_SLOWED_IN_JUNCTION = 0.4
"""Cost of an encounter in a junction for one that goes straight on and is told to slow, for what waits before it, and
for two in a row of which none is told to have driven into it."""
_UNSTEERED, _STEERED_M = 0.3, 0.4
"""Cost of a stated evasion of which less is visible before the contact."""


def misfit(role: Role, path: Path, drift: Drift, begins_m: float) -> Floats:
    """(n,) the cost of an encounter at each point of a path, by the visible maneuver and the meeting place."""
    place = role.place.station_m
    penalty = cost_outside(path.s_m, place - _ZONE_M, place + _ZONE_M, 0.02)
    if role.actor.gore and role.course.passages:
        crossed = role.course.passages[0]
        penalty = penalty + cost_outside(path.s_m, crossed.entry_m + _INTO_GORE_M, crossed.exit_m, _OUT_OF_GORE)
    turned = path.heading_rad - np.interp(begins_m - _BEFORE_TURN_M, path.s_m, path.heading_rad)
    maneuver = role.actor.maneuver
    if maneuver in TURNING:
        way = -1.0 if maneuver == "turn_right" else 1.0
        penalty = penalty + _NOT_SHOWN * (way * turned < math.radians(16))
    elif maneuver == "straight":
        penalty = penalty + _NOT_SHOWN * (np.abs(turned) > math.radians(28)) * (not role.skids_as_told)
        if not role.told.inside and _in_a_row(role):
            penalty = penalty + _SLOWED_IN_JUNCTION * _in_junctions(role, path.s_m)
    elif maneuver == "slowing" and not turns_off(role.course) and not role.actor.gore:
        penalty = penalty + _SLOWED_IN_JUNCTION * _in_junctions(role, path.s_m)
    if maneuver in _DRIFTING and drift.left_m:
        penalty = penalty + 0.5 * (path.s_m < drift.end_m - 0.8 * drift.length_m)
    if maneuver in ACROSS_LANES and drift.left_m:
        penalty = penalty + _UNMOVED * _unmoved(role, path, drift)
    if departs(maneuver, role.told.departs):
        aside = drift.profile(path.s_m)
        if role.other_long_m:
            aside, over = _front_and_rail(role, path)
            penalty = penalty + _OVER_MEDIAN * over
        penalty = penalty + _ON_THE_ROAD * on_the_road(role.course, aside)
        penalty = penalty + _IN_MOUTH * in_a_mouth(role.course, path.s_m, aside)
    if drift.evades:
        penalty = penalty + _UNSTEERED * (np.abs(drift.profile(path.s_m) - drift.before_m) < _STEERED_M)
    return penalty


def _front_and_rail(role: Role, path: Path) -> tuple[Floats, NDArray[np.bool_]]:
    """(n,) how far to the left of its line the front of a vehicle is that meets what runs along the road, and whether
    that lies beyond the median."""
    course = role.course
    angle = path.heading_rad - np.interp(path.s_m, course.path.s_m, course.path.heading_rad)
    left, (long, wide) = offsets(course.path, path, path.s_m)[1], role.size
    hand = np.sign(angle) if not role.skids_as_told else np.full(len(left), _hand(role))
    front = left + hand * np.maximum(hand * long / 2 * np.sin(angle), 0.0)
    met = left + hand * (long * np.abs(np.sin(angle)) + wide * np.abs(np.cos(angle))) / 2
    room = course.own_left_m + max(course.median_m - role.other_long_m, course.median_m / 2)
    return front - hand * _CLEARLY_OFF_M, (met > room) & has_median(course) & (met < course.left_edge_m)


def _hand(role: Role) -> int:
    """The hand on which it leaves the road, likeliest: 1 left, -1 right."""
    return departure_sides(role.course, role.place.station_m, role.told.departs or "either")[0]


def _unmoved(role: Role, path: Path, drift: Drift) -> Floats:
    """(n,) the share of a visible lane change that is still to come: 1 all of it, 0 none."""
    wanted = min(_MOVED_SHARE * (role.size[1] + role.other_width_m) / 2, abs(drift.left_m))
    moved = np.abs(drift.profile(path.s_m) - drift.before_m)
    left: Floats = np.clip(1.0 - moved / wanted, 0.0, 1.0)
    return left


def cost_outside(s_m: Floats, low: float, high: float, per_m: float) -> Floats:
    """(n,) a cost per metre outside a span of stations."""
    return per_m * (np.maximum(low - s_m, 0.0) + np.maximum(s_m - high, 0.0))


def in_junction(role: Role, s_m: Floats) -> Floats:
    """(n,) the cost of standing in a junction of three roads or more, for one that is told to have stopped."""
    cost: Floats = np.zeros(len(s_m))
    if role.actor.maneuver != "stopped" or role.actor.gore:
        return cost
    return cost + _IN_JUNCTION * _in_junctions(role, s_m)


def _in_junctions(role: Role, s_m: Floats) -> Floats:
    """(n,) 1 where its box is in a junction of three roads or more that is no roundabout, else 0."""
    found: Floats = np.zeros(len(s_m))
    half = role.size[0] / 2
    for crossed in role.course.passages:
        if crossed.is_junction and not crossed.around:
            found += (s_m > crossed.entry_m - half) & (s_m < crossed.exit_m + half)
    return found


def _in_a_row(role: Role) -> bool:
    """Whether it meets one that drives ahead of it or behind it."""
    return along_with(role) and {role.side, role.other_side} == {"front", "back"}


def out_of_zone(role: Role) -> float:
    """Cost of each metre outside the zone in which a standing actor waits."""
    return _OUT_OF_GORE if role.actor.gore else _UP_TO_LINE if role.told.comes == "moves_up" else _OUT_OF_ZONE


def waiting_zone(role: Role) -> tuple[float, float]:
    """Stations between which a standing actor plausibly waits; in a gore, those of the gore."""
    if role.actor.gore:
        return role.course.start_m, role.course.end_m
    place = role.place.station_m
    ahead = [p.entry_m - role.course.queued_m for p in role.course.passages if p.is_junction and p.entry_m > place]
    near = stop_m(min(ahead, default=math.inf), role.size[0])
    line = near if near - place < _WAITS_BEFORE_M else line_m(role)
    room_m = _MOVED_UP_M if role.told.comes == "moves_up" else _QUEUED_M
    return (line - room_m, line + 0.5) if role.course.passages else (place - 20.0, place + 20.0)
