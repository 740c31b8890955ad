"""Near misses of things beside the lanes: the vehicle drifts to their side, passes or stops close to them.

Its line leads to the edge of its lanes on the told hand and back; the thing stands along the road where the vehicle
comes nearest to it, at the declared clearance. Who is told to spin slides there and stops. Knows this pair.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.distances import box_distances, nearest_on
from sgcad_core.geometry.plane import Floats, corners_of
from sgcad_core.planner.actor_plan import Drift, Pacing, Role, Swing, Twist, usual_speed
from sgcad_core.planner.encounter.encounter_search import Meeting
from sgcad_core.planner.encounter.motion_options import Option
from sgcad_core.planner.encounter.pairing import Encounter
from sgcad_core.planner.lines.departures import DEPARTURES, GENTLY, departure_sides, left_of_road_m, shift_length_m
from sgcad_core.planner.lines.lost_control import sense, slide_m, spinning, spins_out
from sgcad_core.planner.long_things import beside
from sgcad_core.planner.motion import LEAD_S, STEP_S, Motion, clock, standing_at
from sgcad_core.planner.near_crash.evasion import Reaction, reacted
from sgcad_core.records.specs import NearCrash

_WITHIN_M, _BEYOND_M = 0.15, 0.6
"""From the flank of a vehicle that stays on the road to its edge; from the edge to the middle of one that leaves it."""
_HOLDS_S = 0.4
_YAW_RAD = math.radians(14.0)
"""Angle against its line of one that has lost control, where it comes nearest."""
_BRAKES_S, _BRAKES = 1.2, 0.7
"""Time before it comes nearest from which on it brakes where that is told; share of the usual braking."""
_SLOWED = 0.35
_STEPS_BEHIND, _CLEAR_M = 100, 25.0
"""Samples behind the nearest approach; least distance from its place to a junction, metres."""
_REACH_M, _HALVINGS = 4.0, 30


def is_beside_lanes(driver: Role, thing: Role) -> bool:
    """Whether a near miss is one of a thing beside the lanes: the driver drifts off its lane or loses control there."""
    off = driver.told.departs is not None or driver.told.lost_control
    return thing.actor.record.thing and driver.actor.record.wheeled and not driver.actor.record.thing and off


def near_thing(driver: Role, thing: Role, near: NearCrash) -> tuple[Encounter, tuple[str, ...]]:
    """The encounter with a thing beside the lanes that is passed at the declared clearance, and notes on it."""
    driver = _behind_junctions(driver)
    hand = departure_sides(driver.course, driver.place.station_m, driver.told.departs or "either")[0]
    option = Option(driver, _line(driver, hand), Pacing(0.0), Twist(0.0))
    motion, own_s = _paced(option, near)
    poses = motion.poses(own_s + clock(-round(LEAD_S[1] / STEP_S), _STEPS_BEHIND))
    place = _place(driver, thing, poses, hand, near.closest_m)
    stands = standing_at(place, thing.size, fixed=True)
    other = Option(thing, Drift(0.0), Pacing(0.0), Twist(0.0))
    sides = (near.conflict.striker_area, near.conflict.struck_area)
    meeting = Meeting(0.0, motion, stands, own_s, 0.0, sides, 1.0)
    words = f"{driver.actor.id} drifts to the {'left' if hand > 0 else 'right'}, close to {thing.actor.id}"
    return Encounter(option, other, meeting), (words,)


def _behind_junctions(role: Role) -> Role:
    """The role with its place on the road behind a junction that it crosses, where things stand beside the lanes."""
    ways = (p for p in role.course.passages if p.is_junction and p.entry_m - _CLEAR_M < role.place.station_m)
    behind = max((p.exit_m + _CLEAR_M for p in ways), default=role.place.station_m)
    return replace(role, place=role.place._replace(station_m=max(behind, role.place.station_m)))


def _line(role: Role, hand: int) -> Drift:
    """To the edge of the lanes on a hand and back; a slide where it spins."""
    edge = left_of_road_m(role.course) if hand > 0 else role.course.right_edge_m
    leaves = role.actor.maneuver in DEPARTURES
    reach = hand * (edge + _BEYOND_M if leaves else max(edge - role.size[1] / 2 - _WITHIN_M, 0.3))
    if spins_out(role):
        return spinning(role, hand * max(edge - role.size[0] / 2, 0.5), role.place.station_m, slide_m(role))
    length, at = shift_length_m(role, reach, GENTLY), role.place.station_m
    if not role.told.lost_control:  # one that leaves the road is not told to come back
        return Drift(0.0, reach, length, at, back=not leaves, holds_m=_HOLDS_S * usual_speed(role))
    yaw = sense(role) * _YAW_RAD
    return Drift(0.0, 0.0, length, at + length, earlier=(Swing(reach, length, at, yaw),), yaw_rad=-yaw)


def _paced(option: Option, near: NearCrash) -> tuple[Motion, float]:
    """The motion with the braking that is told or that a slide takes, and its own time where it comes nearest."""
    role, motion = option.role, option.motion
    own_s = motion.time_at(role.place.station_m)
    if spins_out(role):
        return reacted(option, motion, Reaction(own_s, braking=1.0)), own_s
    brakes = any(e.actor == role.actor.id and "braking" in e.maneuver for e in near.evasions)
    slow = Reaction(own_s - _BRAKES_S, braking=_BRAKES, down_to_mps=_SLOWED * usual_speed(role))
    return reacted(option, motion, slow) if brakes else motion, own_s


def _place(role: Role, thing: Role, poses: Floats, hand: int, clearance_m: float) -> Floats:
    """(3,) where the thing stands along the road, at a clearance from the box at its nearest."""
    line = role.course.path.points
    corners = corners_of(poses, role.size)
    away = hand * nearest_on(line, corners.reshape(-1, 2)).left_m.reshape(len(poses), -1)  # (n, 4)
    nearest = int(away.max(axis=1).argmax())
    station = float(nearest_on(line, poses[nearest : nearest + 1, :2]).station_m[0] + role.course.path.s_m[0])
    heading = float(role.course.path.poses([station])[0, 2]) - hand * math.pi / 2
    first = beside(poses[nearest], role.size, thing.size, heading, -clearance_m)
    out = -np.array([math.cos(heading), math.sin(heading), 0.0])
    low, high = -_REACH_M, _REACH_M
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        there = np.repeat((first + middle * out)[None], len(poses), axis=0)
        far = float(box_distances(poses, role.size, there, thing.size).min()) >= clearance_m
        low, high = (low, middle) if far else (middle, high)
    return first + high * out
