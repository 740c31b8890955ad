"""Poses of objects and standing actors: beside their lane, askew, or turned to the approaching actor.

Choices of actors that do not drive; costs as in `sgcad_core.planner.encounter.maneuver_choices`. Knows one actor.
"""

from __future__ import annotations

import math

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.actor_plan import Drift, Role, Twist, facing, is_beside
from sgcad_core.planner.lines.box_angles import ASKEW, aiming
from sgcad_core.planner.lines.crossing import end_meets_flank
from sgcad_core.planner.lines.path import Path
from sgcad_core.planner.long_things import FLARES, hand_of_side, runs_along, turned_to
from sgcad_core.planner.motion import Motion

_IN_LANE = 0.9
"""Cost of standing in the lane although there is a place beside it: more than that of a way out of the lane to it."""
_OVER_A_LINE = ((0.4, 0.0), (0.5, 0.02), (0.3, 0.03), (0.6, 0.1))
"""Shares of a lane's width from its middle at which a vehicle stands over the line, and their costs."""
_NEEDED_ASKEW = ((0.3, 15), (0.3, -15), (0.4, 24), (0.4, -24))
"""Costs and degrees of standing slightly turned where an end is told to meet a flank, which takes an angle between the
two."""
_ACROSS = 1.6
"""Cost of a long thing that stands across the way, over that of one along it."""


def stand_offs(role: Role) -> list[Drift]:
    """How far beside its lane a standing actor stands."""
    width, right = role.size[1], role.course.right_edge_m
    if role.told.straddles:
        hand = 1.0 if role.told.straddles == "left" else -1.0
        return [Drift(cost, hand * share * role.course.lane_width_m) for share, cost in _OVER_A_LINE]
    if role.actor.maneuver == "parked":
        curb, shoulder = -(right - width / 2 - 0.2), -(right + width / 2 + 0.3)
        lines = [(curb, 0.0), (shoulder, 0.1), ((curb + shoulder) / 2, 0.15), (curb / 2, 0.6), (0.0, 0.9)]
        if _in_further_lane(role):
            return [Drift(0.0), Drift(0.1, 0.5), Drift(0.1, -0.5), *(Drift(cost + 1.0, left) for left, cost in lines)]
        if aside_m := parked_beside_m(role):
            near = ((0.0, 0.0),) if role.course.stalls else ((0.0, 0.0), (0.3, 0.3), (0.6, 0.5), (-0.3, 0.5))
            in_lane = 0.2 if role.course.stalls else _IN_LANE
            there = [(more - aside_m, cost) for more, cost in near]
            lines = [*there, *((left, cost + in_lane) for left, cost in lines)]
        return [Drift(cost, left) for left, cost in lines]
    return [Drift(0.0), *(Drift(0.1 + abs(left) / 5, left) for left in (0.5, -0.5, 1.0, -1.0, 1.8, -1.8))]


def parked_beside_m(role: Role) -> float:
    """How far right of the middle of its lane a parked vehicle is told to stand: where people park, else on the
    shoulder; 0 where neither is drawn, and in a lane that is not the curb's."""
    beside = role.course.beside_m
    if role.actor.maneuver != "parked" or _in_further_lane(role):
        return 0.0
    return beside.get("parking", beside.get("shoulder", 0.0))


def _in_further_lane(role: Role) -> bool:
    """Whether its lane is stated and is not the curb's: it stands in it."""
    return role.actor.lane is not None and role.course.right_edge_m > role.course.lane_width_m


def in_stall(role: Role) -> bool:
    """Whether it is parked square to its way."""
    return role.course.stalls and role.actor.maneuver == "parked"


def needs_angle(role: Role) -> bool:
    """Whether an end is told to meet a flank, which takes an angle between the two; a parked one keeps its flank in its
    row."""
    return end_meets_flank(role) and (role.actor.maneuver == "stopped" or not is_beside(role.side))


def askew(role: Role) -> list[Twist]:
    """Straight in its lane, slightly turned, or turned to the other actor; square to the aisle in a stall."""
    if in_stall(role):
        return [Twist(0.0, -math.pi / 2), Twist(0.05, math.pi / 2)]
    small = [Twist(0.2 + abs(a) / 60, math.radians(a), ASKEW) for a in (15, -15, 35, -35)]
    if needs_angle(role):
        needed = _NEEDED_ASKEW[: 4 if role.actor.maneuver == "stopped" else 2]  # a row of the parked is straighter
        small += [Twist(cost, math.radians(a), ASKEW) for cost, a in needed]
    return [Twist(0.0), *small, *aiming(role)]


def beside_the_way(role: Role) -> list[Drift]:
    """Places of an object on the line of the other actor and beside it, as far as their boxes still overlap; what runs
    along the road is met wherever the line comes to it."""
    if runs_along(role.actor):
        return [Drift(0.0)]
    reach = role.other_width_m / 2 + role.size[1] / 2 - 0.12
    offsets = (0.0, 0.3, -0.3, 0.6, -0.6, reach, -reach)
    return [Drift(0.05 * i, left) for i, left in enumerate(offsets)]


def any_angle(role: Role) -> list[Twist]:
    """An object has no heading of its own: its wanted side is turned to the actor that comes, be it tail first."""
    side = facing(role.side) if role.side else 0.0
    along = _along_the_road(role, side) if runs_along(role.actor) else []
    bearings = ((180, 0.0), (135, 0.05), (-135, 0.05), (90, 0.1), (-90, 0.1))
    from_behind = 180 if role.other_side == "back" else 0
    across = [Twist(cost + _ACROSS * bool(along), math.radians(d - from_behind) - side) for d, cost in bearings]
    return [*along, *across]


def _along_the_road(role: Role, side_rad: float) -> list[Twist]:
    """A long thing runs along the road, on the hand of the side that meets it; none where tail first is told."""
    if role.other_side == "back":
        return []
    hands = hand_of_side(role.other_side, role.other_leaves)
    return [
        Twist(cost + 0.05 * rank, turned_to(hand, math.radians(flare)) - side_rad)
        for flare, cost in FLARES
        for rank, hand in enumerate(hands)
    ]


def steps_aside() -> list[Drift]:
    """Parallel lines of a pedestrian."""
    return [Drift(abs(left) / 5, left, 1.0, -1e4) for left in (0.0, 0.7, -0.7, 1.5, -1.5, 3.0, -3.0)]


def placed_along(role: Role, drift: Drift, twist: Twist, base: Path, clock: tuple[Floats, Floats]) -> Motion:
    """The places of an object along a path, beside it by a drift and turned by a twist; `clock`: times, stations."""
    path = base.moved(np.full(len(base.s_m), drift.left_m)).turned(twist.angle_rad)
    free = np.zeros(len(path.s_m))
    return Motion(path, *clock, role.size, free, -math.inf, standing=True, fixed=True)
