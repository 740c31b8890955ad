"""Road users without a contact ahead of one with a contact: traffic that it waits for or follows, and pedestrians.

One that slows drives ahead of that vehicle on its way. A stopped vehicle in the lane of a vehicle of the contact, and a
pedestrian on its road, are placed ahead of all that drive there, as far as these come. Works on a settled scene. Knows
actors, courses and tracks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.actor_plan import BACKS_M, Role
from sgcad_core.planner.aftermath.struck_objects import standing_track
from sgcad_core.planner.encounter.motion_options import options
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.planner.lines.walkers import walking_courses
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import CLEAR_M, Scene
from sgcad_core.planner.towing import ahead_of
from sgcad_core.records.course import NOTHING_TOLD, Courses, CourseTold
from sgcad_core.records.specs import Actor, BehaviorSpec, size_m

GAP_M = 2.0
"""Between two that stand one behind the other."""
_IN_LANE_M = 2.2
"""Distance from the middle of a lane to a center that drives in it."""
_FURTHER_M = (0.0, 1.5, 3.0, 5.0, 8.0, 12.0, 18.0, 26.0)
_BEFORE_WALKER_M, _CROSSWALK_M = 2.0, 15.0
"""From the front of a waiting vehicle to the line of a pedestrian, and as far ahead at most a crosswalk is taken."""
_WALKED_S = (0.0, 0.6, -0.6, 1.2, -1.2, 2.0, -2.0, 3.0, -3.0)
"""Own times of a pedestrian at the first contact; at 0 in the middle of the lane."""
_ROLLS_ON_M = 14.0
"""Way of one that still rolls when it is struck, to where it stands behind the others."""
_PUSHED_M = 9.0
"""Way of one that stands and is struck from behind at the usual speed of a street."""
_HEADWAY_M, _EARLIER_S = 4.0, 0.7
"""From one that slows to the one behind it once both stand; time by which it does the same earlier."""
_INTO_M = 1.0
"""By which a standing front may be over the edge of a junction."""


def led_by(behavior: BehaviorSpec, actor: Actor) -> Actor | None:
    """The actor of the first contact that another one stands ahead of; None for others."""
    first = behavior.first_meeting
    touching = {who for c in behavior.contacts for who in (c.striker, c.struck)}
    if first is None or actor.id in touching or actor.id in (first.striker, first.struck):
        return None
    waits = actor.maneuver in ("stopped", "slowing") and actor.record.drives and not actor.gore
    if not (waits or (actor.record.walks and actor.maneuver == "straight")):
        return None
    pair = [a for name in (first.struck, first.striker) for a in behavior.actors if a.id == name]
    driving = [a for a in pair if a.record.drives and a.maneuver not in ("parked", "backing")]
    ahead = [a for a in driving if (a.road, a.direction) == (actor.road, actor.direction)]
    same = [a for a in ahead if actor.record.walks or a.lane == actor.lane]
    waiting = [a for a in same if a.maneuver in ("stopped", "slowing")]
    return next(iter([*waiting, *same]), None)


def with_company(
    behavior: BehaviorSpec, courses: Mapping[str, Course], told: Courses = NOTHING_TOLD
) -> dict[str, Course]:
    """The courses, with the room that vehicles need which stand ahead in the lane, and of the push to them."""
    found = dict(courses)
    if waits := _behind_one_that_backs(behavior):
        found[waits[0]] = replace(found[waits[0]], queued_m=found[waits[0]].queued_m + waits[1])
    for name, queued_m in _room_of_queue(behavior):
        found[name] = replace(found[name], queued_m=found[name].queued_m + queued_m)
    for actor in behavior.actors:
        leader = None if actor.record.walks or actor.maneuver == "slowing" else led_by(behavior, actor)
        if leader is None:
            continue
        for other in _lane_of(behavior, leader):
            rolls_m = _ROLLS_ON_M if leader.maneuver == "slowing" else _pushed_m(behavior, told, leader)
            queued_m = found[other.id].queued_m or rolls_m
            found[other.id] = replace(found[other.id], queued_m=queued_m + size_m(actor)[0] + GAP_M)
    return found


def _pushed_m(behavior: BehaviorSpec, told: Courses, leader: Actor) -> float:
    """The way by which a standing one is pushed on by a blow from behind that is not told to be slight."""
    first = behavior.first_meeting
    hit = first is not None and (first.struck, first.struck_area) == (leader.id, "back")
    slight = any(told.get(who, CourseTold()).slight for who in (leader.id, first.striker if first else ""))
    return 0.0 if slight or not hit else _PUSHED_M


def _behind_one_that_backs(behavior: BehaviorSpec) -> tuple[str, float] | None:
    """The one that stands behind one that backs into it in its lane, and the room that this one needs ahead of it."""
    first = behavior.first_meeting
    pair = [a for a in behavior.actors if first and a.id in (first.striker, first.struck)]
    backs = next((a for a in pair if a.maneuver == "backing" and a.record.drives), None)
    stands = next((a for a in pair if a.maneuver == "stopped" and a.record.drives), None)
    if first is None or backs is None or stands is None:
        return None
    areas = {first.striker: first.striker_area, first.struck: first.struck_area}
    one_lane = (backs.road, backs.direction) == (stands.road, stands.direction)
    ahead = one_lane and (areas[backs.id], areas[stands.id]) == ("back", "front")
    return (stands.id, size_m(backs)[0] + BACKS_M) if ahead else None


def _room_of_queue(behavior: BehaviorSpec) -> Iterator[tuple[str, float]]:
    """The two of the first contact and the room of those that stand ahead of the struck one in its lane, into which it
    is pushed one after the other."""
    first, actors = behavior.first_meeting, {a.id: a for a in behavior.actors}
    last = actors.get(first.struck) if first else None
    if first is None or last is None or last.maneuver != "stopped":
        return
    room_m, there = 0.0, (last.road, last.direction, last.lane)
    for c in behavior.contacts:
        ahead = actors.get(c.struck)
        bumper = (c.striker, c.striker_area, c.struck_area) == (last.id, "front", "back")
        if ahead is None or not bumper or ahead.maneuver != "stopped" or not ahead.record.drives:
            continue
        if (ahead.road, ahead.direction, ahead.lane) == there:
            room_m, last = room_m + size_m(ahead)[0] + GAP_M, ahead
    for name in (first.struck, first.striker) if room_m else ():
        if name in actors and actors[name].road == there[0]:
            yield name, room_m


def _lane_of(behavior: BehaviorSpec, leader: Actor) -> list[Actor]:
    there = leader.road, leader.direction, leader.lane
    return [other for other in behavior.actors if (other.road, other.direction, other.lane) == there]


def stand_ahead(scene: Scene, actor: Actor, behavior: BehaviorSpec, courses: Mapping[str, Course]) -> bool:
    """Places an actor ahead of the one that waits for it, clear of all; whether that is its place and it is free."""
    leader = led_by(behavior, actor)
    if leader is None or leader.id not in scene.tracks:
        return False
    if actor.maneuver == "slowing" and _drives(scene, actor, leader.id):
        return True
    course = courses[leader.id]
    front = _front_m(scene, behavior, leader, course)
    place = _walks if actor.record.walks else _stands
    return place(scene, actor, course, front)


def _drives(scene: Scene, actor: Actor, leader: str) -> bool:
    """Whether an actor that drives on the way of the one behind it, slowing first, is clear of all."""
    track = scene.tracks[leader]
    if track.motion.standing:
        return False
    size, own_s = size_m(actor), track.own_s + scene.contact * STEP_S
    for more in _FURTHER_M:
        motion = ahead_of(track.motion, (track.size[0] + size[0]) / 2 + _HEADWAY_M + more, size)
        poses = scene.poses(motion, own_s + _EARLIER_S, brakes=False)
        if scene.clear_until(poses, size, CLEAR_M) == scene.count:
            scene.add(actor.id, actor.kind, motion, own_s + _EARLIER_S, brakes=False)
            return True
    return False


def _stands(scene: Scene, actor: Actor, course: Course, front_m: float) -> bool:
    length = size_m(actor)[0]
    for more in _FURTHER_M:
        station = _off_junctions(course, front_m + GAP_M + length / 2 + more, length)
        track = standing_track(scene, actor, course.path.poses([station])[0])
        if scene.clear_until(track.poses, track.size, CLEAR_M) == scene.count:
            scene.tracks[actor.id] = track
            return True
    return False


def _walks(scene: Scene, actor: Actor, course: Course, front_m: float) -> bool:
    near = [s for s in course.crosswalks if front_m + _BEFORE_WALKER_M / 2 < s < front_m + _CROSSWALK_M]
    station = min(near, default=front_m + _BEFORE_WALKER_M)
    for _, line, place in walking_courses(course, station, None):
        role = Role(actor, line, size_m(actor), place, surface=scene.surface)
        motion = options(role)[0].motion
        for own in _WALKED_S:
            poses = scene.poses(motion, own, brakes=False)
            if scene.clear_until(poses, motion.size, CLEAR_M) == scene.count:
                scene.add(actor.id, actor.kind, motion, own, brakes=False)
                return True
    return False


def _front_m(scene: Scene, behavior: BehaviorSpec, leader: Actor, course: Course) -> float:
    """The furthest station that those come to who drive or stand in the lane of the leader."""
    return max(_reach_m(scene, name, course) for name in _in_line(scene, behavior, leader))


def _in_line(scene: Scene, behavior: BehaviorSpec, leader: Actor) -> Iterator[str]:
    yield leader.id
    for other in behavior.actors:
        if other.id in scene.tracks and (other.road, other.direction) == (leader.road, leader.direction):
            yield other.id


def _reach_m(scene: Scene, name: str, course: Course) -> float:
    """The furthest station of the front of a box while it is in the lane of a course; -inf if it never is."""
    track, path = scene.tracks[name], course.path
    away: Floats = np.hypot(*(track.poses[:, None, :2] - path.points[None]).transpose(2, 0, 1))
    inside = away.min(axis=1) < _IN_LANE_M
    return float(path.s_m[away.argmin(axis=1)[inside].max()]) + track.size[0] / 2 if inside.any() else -math.inf


def _off_junctions(course: Course, station_m: float, length_m: float) -> float:
    """The station, or the first one behind the junction that a box there would block."""
    for crossed in course.passages:
        blocks = station_m + length_m / 2 > crossed.entry_m + _INTO_M and station_m - length_m / 2 < crossed.exit_m
        if crossed.is_junction and not crossed.around and blocks:
            station_m = crossed.exit_m + length_m / 2 + _INTO_M
    return station_m
