"""The told moves before a contact as one line: off the road and back, across the center line, in a yaw.

Puts them before the last change of line, each as long as the speed asks. Knows one actor, its course and what is told
of it; no other actor and no time.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from sgcad_core.kinds import Maneuver
from sgcad_core.planner.actor_plan import Drift, Role, Swing, usual_speed
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.planner.lines.box_angles import told_skids
from sgcad_core.planner.lines.departures import departure_sides, has_median, left_of_road_m, way_off_m
from sgcad_core.planner.lines.lost_control import skid_m
from sgcad_core.planner.lines.path import ramp_length_m
from sgcad_core.planner.long_things import runs_along
from sgcad_core.planner.motion import HARD_MPS2
from sgcad_core.records.course import Courses, CourseTold, Move, sense_of
from sgcad_core.records.specs import Actor, BehaviorSpec

_PARTLY_M = 1.0
"""Over the edge of the road: a vehicle that comes back on it."""
_ASIDE_M = 1.5
"""A swerve within the road."""
_EASE, _LEAST_M = 1.15, 8.0
"""Length of a swing over the shortest at that speed, and its least."""
_YAW_RAD, _LAST_YAW_RAD = math.radians(18.0), math.radians(38.0)
"""Angle of a yaw out of which a vehicle comes back, and of one in which it meets its end."""
_BEFORE_PLACE_M = 2.0
_BEHIND_M = 70.0
"""Of its road behind the place."""
_STILL_S, _LEAST_SHARE = 2.2, 0.6
"""Time on its undisturbed line before the first move; least share of the lengths where the road is short: it then
drives slower."""
_WANDERS: frozenset[Maneuver] = frozenset({
    "straight", "negotiating_curve", "slowing", "other", "overtaking", "crossing_centerline", "departing_road_left",
    "departing_road_right", "lane_change_left", "lane_change_right",
})  # fmt: skip
"""Maneuvers of vehicles whose line the told moves may be: the others have lines of their own."""


class _Target(NamedTuple):
    """Where a move leads: metres to the left of the line of its lane, and the angle of the box against its line."""

    left_m: float
    yaw_rad: float


def off_and_back(told: Courses, to_things: Iterable[str]) -> Courses:
    """The stated courses, where vehicles that are told to leave the road strike something there (`to_things`) before
    they meet another one: they come back from it."""
    ways = {who: (Move("departs", told[who].departs), Move("returns")) for who in to_things
            if who in told and told[who].departs and not told[who].moves}  # fmt: skip
    return {who: replace(course, moves=ways.get(who, course.moves)) for who, course in told.items()}


def _thing_met(behavior: BehaviorSpec) -> tuple[Actor, Actor] | None:
    """The vehicle that meets a thing first of all, and that thing."""
    first, actors = behavior.first_meeting, {a.id: a for a in behavior.actors}
    if first is None or not {first.striker, first.struck} <= actors.keys():
        return None
    return (actors[first.striker], actors[first.struck]) if actors[first.struck].record.thing else None


def off_on_one_side(told: Courses, behavior: BehaviorSpec) -> Courses:
    """The stated courses, where a vehicle that leaves the road on a told side, meets a thing there and comes to rest
    off the road does so on that side."""
    found, met = dict(told), _thing_met(behavior)
    for who in (actor.id for actor in (met or ())[:1] if actor.id in told):
        course = told[who]
        beside = course.rest.where in ("off_road", "shoulder") and course.rest.side is None
        side = course.departs
        if beside and not course.moves and side is not None and side != "either":
            found[who] = replace(course, rest=replace(course.rest, side=side))
    return found


def off_to_median(told: Courses, behavior: BehaviorSpec, lines: Mapping[str, Course]) -> Courses:
    """The stated courses, where a vehicle that crosses the line on its left and meets what runs along a road with a
    median leaves the road to that side: the thing lies in the median. `lines`: the actors' courses on the road."""
    actor, thing = _thing_met(behavior) or (None, None)
    if actor is None or thing is None or not runs_along(thing) or not has_median(lines[actor.id]):
        return told
    course = told.get(actor.id, CourseTold())
    crosses = actor.maneuver == "crossing_centerline" and not (course.departs or course.moves)
    return {**told, actor.id: replace(course, departs="left")} if crosses else told


def unturned(told: Courses) -> Courses:
    """The stated courses without their turns out of control."""
    return {who: replace(course, yaws=None) for who, course in told.items()}


def last_move(role: Role) -> Move | None:
    """The move in which it meets its end; None where no several moves are told, or its maneuver has a line of its
    own."""
    if not role.told.moves or role.actor.maneuver not in _WANDERS:
        return None
    last = next(move for move in reversed(role.told.moves) if move.kind != "yaws")
    return None if last.kind == "departs" and role.told.departs is None else last


def with_earlier(role: Role, lines: Sequence[Drift]) -> Iterator[Drift]:
    """Lines that end with the last move, with all earlier ones before it."""
    *earlier, last = _targets(role)
    for line in lines:
        yield _prefixed(role, line, earlier, last.yaw_rad)


def with_room(role: Role) -> Role:
    """The role with its place so far along its road that all told moves, or a way off a slippery road, have room
    before it."""
    place, course = role.place.station_m, role.course
    needed_m = max(way_off_m(role), _skid_room_m(role))
    if last_move(role) is not None:
        needed_m = sum(swing.length_m for swing in _swings(role, _targets(role), place, 1.0)) + _still_m(role)
    if not needed_m:
        return role
    further = min(course.first_m + needed_m, course.end_m - _BEHIND_M)
    return replace(role, place=role.place._replace(station_m=max(place, further)))


def _skid_room_m(role: Role) -> float:
    """The way along its road of a told skid into a contact, metres; 0 without one."""
    twist = next(iter(told_skids(role)), None)
    return 0.0 if twist is None else skid_m(role, twist.angle_rad, usual_speed(role)) + _still_m(role)


def _prefixed(role: Role, line: Drift, earlier: Sequence[_Target], yaw_rad: float) -> Drift:
    """A line with moves before it, all of them shorter where its road has too little room before the place."""
    gone, askew = earlier[-1] if earlier else _Target(0.0, 0.0)
    own = line.left_m - gone
    end_m = line.end_m if line.left_m else role.place.station_m - _BEFORE_PLACE_M
    length = max(line.length_m, _length(role, own)) if line.left_m else _length(role, own)
    needed_m = length + sum(swing.length_m for swing in _swings(role, earlier, 0.0, 1.0))
    share = min(1.0, max((end_m - role.course.first_m - _still_m(role)) / needed_m, _LEAST_SHARE))
    swings = _swings(role, earlier, end_m - share * length, share)
    return line._replace(end_m=end_m, length_m=share * length, earlier=swings, yaw_rad=yaw_rad - askew)


def _swings(role: Role, targets: Sequence[_Target], until_m: float, share: float) -> tuple[Swing, ...]:
    """One swing to each target in turn, the last of which ends at a station; `share`: of their usual lengths."""
    found: list[Swing] = []
    for before, target in reversed(list(zip([_Target(0.0, 0.0), *targets], targets, strict=False))):
        length = share * _length(role, target.left_m - before.left_m)
        found.append(Swing(target.left_m - before.left_m, length, until_m, target.yaw_rad - before.yaw_rad))
        until_m -= length
    return tuple(reversed(found))


def _still_m(role: Role) -> float:
    """Way on its undisturbed line before the first move, metres."""
    return _STILL_S * usual_speed(role)


def _length(role: Role, left_m: float) -> float:
    """The length of a swing at the usual speed, metres."""
    return ramp_length_m(left_m, _EASE * usual_speed(role), HARD_MPS2, _LEAST_M)


# ------------------------------------------------------------------ where the moves lead
def _targets(role: Role) -> list[_Target]:
    """Where each move leads; one that only begins the next one has no place of its own."""
    found: list[_Target] = []
    moves = [move for move in role.told.moves if move.kind != "yaws"]
    yaws = _yaws(role.told.moves)
    left_m = 0.0
    for number, move in enumerate(moves):
        following = moves[number + 1] if number + 1 < len(moves) else None
        if following is not None and _begins(role, move, following, left_m):
            continue
        left_m = _place(role, move, left_m)
        most = _YAW_RAD if following is not None else _LAST_YAW_RAD
        found.append(_Target(left_m, most * yaws[number]))
    return found


def _yaws(moves: Sequence[Move]) -> list[int]:
    """By move that is no yaw the sense in which it is driven: 1 counter-clockwise, -1 clockwise, 0 without a yaw."""
    senses: list[int] = []
    sense = 0
    for move in moves:
        if move.kind == "yaws":
            sense = sense_of(move.side)  # type: ignore[arg-type]
            continue
        senses.append(sense)
        sense = 0
    return [*senses[:-1], sense or senses[-1]]


def _begins(role: Role, move: Move, following: Move, left_m: float) -> bool:
    """Whether a move leads on into the next one: a swerve off the road or back to it, a crossed line on the way off."""
    way, onward = _hand(role, move), _hand(role, following)
    if move.kind == "steers":
        return onward == way or (following.kind == "returns" and left_m * way < 0)
    return move.kind == "crosses" and following.kind == "departs" and onward == way


def _hand(role: Role, move: Move) -> int:
    """To which hand a move leads: 1 left, -1 right, 0 back."""
    if move.kind == "returns":
        return 0
    if move.kind == "crosses" or move.side in ("left", "right"):
        return -1 if move.side == "right" else 1
    return departure_sides(role.course, role.place.station_m, move.side or "either")[0]  # type: ignore[arg-type]


def _place(role: Role, move: Move, left_m: float) -> float:
    """Where a move ends, metres to the left of the line of its lane."""
    course, way = role.course, _hand(role, move)
    if move.kind == "departs":
        return left_of_road_m(course) + _PARTLY_M if way > 0 else -(course.right_edge_m + _PARTLY_M)
    if move.kind == "crosses":
        return course.opposite_m
    within = max(-course.right_edge_m, min(left_m, course.left_edge_m))
    return within + way * _ASIDE_M if move.kind == "steers" else 0.0
