"""The choices that an actor has within its maneuver: line, speed, angle of the box, each with a cost.

Costs only order the search: 0 is ordinary driving as stated, 0.1 to 0.3 unnoticeable, 0.3 to 1 an evasive or careless
driver, above that a loss of control.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from sgcad_core.planner.actor_plan import Drift, Role, along_with, comes_against, is_beside
from sgcad_core.planner.encounter.out_of_lanes import is_out
from sgcad_core.planner.encounter.pacing_choices import from_another_road
from sgcad_core.planner.encounter.ways_off_road import departures, eased
from sgcad_core.planner.lines.box_angles import SKIDS, STEERS
from sgcad_core.planner.lines.crossing import LEAVES, brushing, crossings, end_meets_flank
from sgcad_core.planner.lines.departures import DEPARTURES, GENTLY, aside_m, change_of_line, departs
from sgcad_core.planner.lines.lost_control import lost_lines
from sgcad_core.planner.lines.told_moves import last_move, with_earlier
from sgcad_core.planner.lines.turning import corner_lines, wide_lines
from sgcad_core.records.course import Move, Steering

_LANE_CHANGES = ("lane_change_left", "lane_change_right", "merge")
_NOT_EVADING, _WITHOUT_MOVES = 0.3, 1.5
"""Costs of the own line where steering aside is stated, and of a line without the moves that are told."""
_EVADED_FROM = ("straight", "negotiating_curve", "slowing", "other")
OTHER_LANE, FROM_OTHER_LANE = "takes another lane than stated", "starts from another lane"
OTHER_LANE_COST = 1.0
"""More than another speed: a told lane is taken wherever the two can meet from it."""
_SHARES = [(1.0, 0.0), (0.75, 0.1), (1.25, 0.15), (0.5, 0.2), (1.6, 0.3), (2.0, 0.4)]
"""Shares of the shift of a maneuver with their costs."""
_ABREAST_M = 12.0
"""Way in the lane beside before one that overtakes meets what it overtakes."""
_GENTLE = 0.2
"""Cost of a gentle change of line where a steep one is needed."""
_SWERVES, _OFF_COURSE = "swerves", "leaves its course"
HEAD_ON = "leaves its lane, as the told sides imply of one of the two"
PARKED_THERE = "leaves its lane, as the place of the parked vehicle implies"
UNTOLD = (STEERS, LEAVES, _SWERVES, _OFF_COURSE, SKIDS)
"""Notes on driving that a report does not tell unless it tells a swerve or a skid."""
_OVERLAPS = ((0.4, 0.0), (0.25, 0.03), (0.6, 0.05), (0.9, 0.1))  # shares of its width on a parked one, with costs


def drifts(role: Role, *, fine: bool = True) -> list[Drift]:
    """Changes of line: those of the maneuver, else the lane, lines slightly beside it, and swerves.

    Not `fine`: without those that differ by less than a metre.
    """
    if lost := lost_lines(role):
        return lost
    return _lines(role, fine=fine) if (last := last_move(role)) is None else _wandering(role, last, fine=fine)


def _wandering(role: Role, last: Move, *, fine: bool) -> list[Drift]:
    """The told moves in their order; or, dearer than those, the lines without the earlier ones."""
    if last.kind == "departs":
        lines = departures(role, fine=fine)
    elif last.kind == "crosses":
        lines = [*_shifts(role, role.course.opposite_m, _SHARES if fine else [_SHARES[0], _SHARES[3]])]
    elif last.kind == "steers":
        lines = _steering(role, "right" if last.side == "right" else "left")
    else:
        lines = [Drift(0.0), *(_in_lane(role) if fine else [])]
    plain = (line._replace(cost=line.cost + _WITHOUT_MOVES) for line in _lines(role, fine=fine))
    return [*with_earlier(role, lines), *plain]


def _lines(role: Role, *, fine: bool) -> list[Drift]:
    """The lines of its maneuver, or those of its lane."""
    if departs(role.actor.maneuver, role.told.departs):
        return departures(role, fine=fine)
    steep = _steep(role)
    if role.actor.maneuver in _LANE_CHANGES:
        joins = role.actor.maneuver == "merge" and _joins(role)
        changes = _lane_changes(role, (0.0, 0.8, -0.8) if fine else (0.0,))
        changes = [*_to_parked(role), *_behind(steep, changes)]
        return [Drift(0.0), *(d._replace(cost=d.cost + 0.2) for d in changes)] if joins else changes
    wanted = _maneuver_shift(role)
    if wanted is not None:
        shares = _SHARES
        if role.spins or role.glances:
            shares = [(0.63, 0.0), (1.37, 0.05), (1.0, 0.1), *shares[1:]]
        shares = shares if fine else [shares[0], shares[3], shares[4]]
        if role.actor.maneuver == "overtaking" and end_meets_flank(role):
            return _behind([*_passing(role, wanted)], [*steep, *_shifts(role, wanted, shares), Drift(0.8)])
        return [*_behind(steep, [*_shifts(role, wanted, shares), *_far_over(role, shares)]), Drift(0.8)]
    near = [*_to_parked(role), *brushing(role), *(_in_lane(role) if fine else [])]
    if evading := _evading(role):
        return [*evading, *(line._replace(cost=line.cost + _NOT_EVADING) for line in (Drift(0.0), *near))]
    return [Drift(0.0), *near, *corner_lines(role), *_other_lanes(role), *_swerves(role)]


def _to_parked(role: Role) -> list[Drift]:
    """Lines that leave the lane as far as a part of the width meets a parked vehicle, which is told to stand there."""
    if not role.other_parked:
        return []
    aside, touch = role.place.aside_m, (role.size[1] + role.other_width_m) / 2
    reach = [(abs(aside) - touch + share * role.size[1], cost) for share, cost in _OVERLAPS]
    lines = [
        change_of_line(role, math.copysign(left, aside), cost, 1.7, PARKED_THERE) for left, cost in reach if left > 0
    ]
    if role.actor.maneuver == "backing" and abs(math.sin(role.place.angle_rad)) < 0.5:  # it was parked in that row
        return [*(one._replace(length_m=1.0, end_m=-1e4) for one in lines), *_behind(lines, lines)]
    return lines


def _steep(role: Role) -> list[Drift]:
    """Steep crossings of a told change of line, where an end is told to meet a flank that lies along the way."""
    if not end_meets_flank(role):
        return []
    shift = _maneuver_shift(role)
    return crossings(role, _change_way(role) if shift is None else math.copysign(1.0, shift))


def _behind(first: Sequence[Drift], others: Iterable[Drift]) -> list[Drift]:
    """Some lines, and others that come behind them."""
    return [*first, *(d._replace(cost=d.cost + _GENTLE * bool(first)) for d in others)]


def _shifts(role: Role, left_m: float, shares: Sequence[tuple[float, float]]) -> Iterator[Drift]:
    """Shares of a shift with their costs: gently, and the first three also hard and sharply."""
    for share, cost, ease in eased(shares):
        yield change_of_line(role, left_m * share, cost, ease)


def _passing(role: Role, wanted: float) -> Iterator[Drift]:
    """Ways into the lane beside that are over before the place: what is overtaken is met from there."""
    for share, cost in ((1.0, 0.0), (0.85, 0.05), (1.15, 0.1)):
        line = change_of_line(role, wanted * share, cost, GENTLY)
        yield line._replace(end_m=line.end_m - _ABREAST_M)


def _far_over(role: Role, shares: Sequence[tuple[float, float]]) -> Iterator[Drift]:
    """Ways over the center line into a lane of oncoming traffic beyond the nearest one, where the other one comes."""
    aside, nearest = role.place.aside_m, role.course.opposite_m
    if (
        role.actor.maneuver == "crossing_centerline"
        and comes_against(role)
        and aside > nearest + role.course.lane_width_m / 2
    ):
        yield from _shifts(role, aside, shares)


def _evading(role: Role) -> list[Drift]:
    """Swerves to the stated side; none where no steering is stated, or where the maneuver has its own line."""
    if role.told.steers is None or role.actor.maneuver not in _EVADED_FROM:
        return []
    return _steering(role, role.told.steers)


def _steering(role: Role, told: Steering) -> list[Drift]:
    """Swerves to a side, as told."""
    hands = {"left": (1.0,), "right": (-1.0,)}.get(told, (1.0, -1.0))
    ways = ((1.2, 0.0, 1.2), (0.7, 0.02, 1.2), (1.8, 0.05, 1.2), (2.6, 0.1, 1.1), (1.2, 0.1, 0.8), (3.6, 0.2, 1.0))
    return [
        change_of_line(role, hand * left, cost, ease, f"steers {'left' if hand > 0 else 'right'}, as told")._replace(
            evades=True
        )
        for left, cost, ease in ways
        for hand in hands
    ]


def _lane_changes(role: Role, further_m: Sequence[float]) -> list[Drift]:
    """Into the lane on the stated side; where both drive in one direction, from beside the other one into its lane."""
    way = _change_way(role)
    lane = way * role.course.lane_width_m
    target = role.place.aside_m if along_with(role) and abs(role.place.aside_m) < 16 else lane
    found = []
    for ease, cost in ((1.7, 0.0), (1.0, 0.1), (0.6, 0.3), (0.4, 0.45)):
        for more in further_m:
            drift = _halfway(change_of_line(role, lane + way * more, cost + abs(more) / 8, ease))
            if abs(target - lane) > 0.5 and not is_out(role, target - lane):
                elsewhere = OTHER_LANE_COST if role.actor.lane is not None else 0.0
                found.append(drift._replace(before_m=target - lane, cost=drift.cost + elsewhere))
                drift = drift._replace(cost=drift.cost + (0.0 if elsewhere else 0.3))
            found.append(drift)
    return found


def _joins(role: Role) -> bool:
    """Whether its course leads beside the other one: out of another road, at a junction."""
    return from_another_road(role) and any(p.is_junction for p in role.course.passages)


def _halfway(drift: Drift) -> Drift:
    """A lane change that is under way, not over, when the actor beside is met."""
    return drift._replace(end_m=drift.end_m + 0.4 * drift.length_m)


def _change_way(role: Role) -> float:
    """1: to the left, -1: to the right; a merge moves towards the other actor."""
    if role.actor.maneuver in ("lane_change_left", "lane_change_right"):
        return 1.0 if role.actor.maneuver == "lane_change_left" else -1.0
    if is_beside(role.side) or is_beside(role.other_side):
        return 1.0 if role.side == "left" or role.other_side == "right" else -1.0
    if abs(role.place.aside_m) > 0.5:
        return math.copysign(1.0, role.place.aside_m)
    return -1.0 if role.course.own_left_m < role.course.lane_width_m < role.course.right_edge_m else 1.0


def _maneuver_shift(role: Role) -> float | None:
    """The lateral shift of the maneuver, metres to the left; None without one."""
    course, lane = role.course, role.course.lane_width_m
    return {
        "crossing_centerline": course.opposite_m,
        "overtaking": min(lane, course.opposite_m) if course.left_edge_m > lane else course.opposite_m,
        **{maneuver: aside_m(course, side) for maneuver, side in DEPARTURES.items()},
    }.get(role.actor.maneuver)


def _in_lane(role: Role) -> list[Drift]:
    return [
        change_of_line(role, left, cost, 1.7) for left, cost in ((0.5, 0.1), (-0.5, 0.1), (1.0, 0.25), (-1.0, 0.25))
    ]


def _other_lanes(role: Role) -> list[Drift]:
    """The lanes beside its own, driven from the start: nearly free where no lane is stated."""
    course, stated = role.course, role.actor.lane is not None
    cost, note = (OTHER_LANE_COST, OTHER_LANE) if stated else (0.03, "")
    rooms = ((1, course.own_left_m), (-1, course.right_edge_m))
    return [
        Drift(cost, sign * course.lane_width_m, 1.0, -1e4, note=note)
        for sign, room in rooms
        if room > course.lane_width_m
    ]


def _swerves(role: Role) -> list[Drift]:
    place, found = role.place, []
    if wide_lines(role):  # it leaves its lane in the turn, not before it
        return _from_beside(role)
    note = HEAD_ON if comes_against(role) and (role.side, role.other_side) == ("front", "front") else LEAVES
    if place.apart_m > 1.2 and abs(math.sin(place.angle_rad)) < 0.5 and abs(place.aside_m) < 16:
        for extra, cost in ((0.0, 0.3), (0.7, 0.33), (-0.7, 0.33), (1.4, 0.36), (-1.4, 0.36)):
            found.append(change_of_line(role, place.aside_m + extra, cost, 1.3, note))
    found += _from_beside(role)
    for left, cost in ((1.8, 0.4), (-1.8, 0.4), (3.3, 0.6), (-3.3, 0.6)):
        found.append(change_of_line(role, left, cost, 1.0, _SWERVES))
    return found


def _from_beside(role: Role) -> list[Drift]:
    """From the lane beside the other actor, on the side of the contact, into its lane."""
    sides = {("left", None): -1, ("right", None): 1, (None, "left"): 1, (None, "right"): -1}
    ways = [w for (own, other), w in sides.items() if own == role.side or (other and other == role.other_side)]
    if not along_with(role) or not ways:
        return []
    beside = ways[0] * role.course.lane_width_m
    before = role.place.aside_m + beside
    if is_out(role, before):
        return []
    elsewhere = OTHER_LANE_COST if role.actor.lane is not None else 0.35
    cost, note = (0.25, "") if abs(before) < 0.5 else (elsewhere, FROM_OTHER_LANE)
    easy = [
        change_of_line(role, -beside, cost + more, ease, note) for ease, more in ((1.7, 0.0), (0.8, 0.15), (0.5, 0.3))
    ]
    return [_halfway(drift)._replace(before_m=before) for drift in easy]


def lines_to(role: Role, lefts_m: Sequence[float]) -> list[Drift]:
    """Lines that leave the own one by some distances to the left, the nearest first."""
    return [change_of_line(role, left, abs(left) / 10, 1.3, LEAVES) for left in sorted(lefts_m, key=abs)]


def homing(role: Role) -> list[Drift]:
    """Its own line, and one bent to lead through the other's meeting place."""
    place, lines = role.place, _from_beside(role)[:2] or drifts(role)[:2]
    if place.apart_m < 0.8:
        return lines
    bent = change_of_line(role, math.hypot(place.ahead_m, place.aside_m), 0.6, 1.3, _OFF_COURSE)
    return [*lines, bent._replace(left_m=place.aside_m, ahead_m=place.ahead_m or 1e-6)]
