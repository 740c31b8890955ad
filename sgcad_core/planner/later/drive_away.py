"""Vehicles that leave the scene, as told: behind their contact they drive on along their road, round what stands there.

One that brushes another one slightly as it passes drives on as well, and stops further on in its lane.

One that still rolls drives on; one that stands waits, backs where it is too near to go round, and goes. Replaces poses
when all else is settled, and only by a way that is clear of all others and on the road. Knows scenes and courses.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sgcad_core.geometry.plane import Floats, gaps_where_near, wrap_angle
from sgcad_core.planner.actor_plan import is_beside
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.planner.lines.path import ramp
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import Scene, Track, sample_speeds
from sgcad_core.records.course import Courses, CourseTold
from sgcad_core.records.specs import Contact

LEAVES_S = 7.0
"""Additional time after the first contact in which a vehicle drives away."""
_PARTS_S, _WAITS_S = 0.4, 0.8
"""From the first touch to driving on; of one that stands to its start."""
_ROLLS_MPS, _STANDS_MPS = 3.0, 0.15
_GOES_MPS, _GAINS_MPS2 = 9.0, 2.2
"""Speed of one that drives away, and its acceleration."""
_STOPS_M, _STOPS_MPS2 = 16.0, (1.2, 3.0)
"""Way to its stop of one that drives on a little, and the least and the most that it brakes."""
_BACKS_M, _BACKS_MPS, _BACKS_MPS2 = (4.0, 7.0), 2.4, 1.6
"""Ways, speed and acceleration of one that first backs away from what it struck."""
_BLEND_M, _BLENDS = 11.0, 3.2
"""Way on which it comes into its line, at least; and by how much it exceeds the distance to that line."""
_RETURNS_M = 20.0
"""Way on which it comes back into its lane."""
_ASKEW_RAD = math.radians(50.0)
"""One that has turned further from its road does not simply drive on."""
_CLEAR_M, _NEAR_M, _SUNK_M = 0.2, 4.0, -0.06
"""Distance to others, from some metres behind the start on; there it may still touch as it did."""
_ALONG_M = 16.0
"""The same of one that goes on along another one: both lengths."""
_AWAY_M = 10.0


@dataclass(frozen=True)
class _Start:
    """A sample with the pose and the speed at it, as station and distance to the left on the course."""

    sample: int
    station_m: float
    left_m: float
    askew_rad: float
    """Of the box against the course."""
    slope: float
    """Of the way against the course: where it rolls that of its velocity, else that of the box."""
    mps: float


def drive_away(
    scene: Scene, courses: Mapping[str, Course], told: Courses, contacts: Sequence[Contact]
) -> Iterator[str]:
    """Lets vehicles drive away that are told to leave; a note on each one that cannot. One that brushes the flank of
    another one in the only contact, a slight one, drives on a little."""
    brushed = {v for c in contacts if len(contacts) == 1 and is_beside(c.striker_area) and is_beside(c.struck_area)
               for v in (c.striker, c.struck)}  # fmt: skip
    for name, track in scene.tracks.items():
        its = told.get(name, CourseTold())
        stops = name in brushed and its.slight and its.rest.empty and not its.leaves
        if not (its.leaves or stops) or name not in courses or track.hit is None:
            continue
        if any(name in coupled[:2] for coupled in scene.hitches):
            if its.leaves:
                yield f"{name} stays at the scene, which it leaves as told: it tows a trailer"
            continue
        way = next(_ways(scene, track, _as_faced(track, courses[name]), stops=stops), None)
        if way is None and not stops:
            yield f"{name} stays at the scene, which it leaves as told: no way leads past the others"
        elif way is not None:
            way[:, 2] = np.unwrap(way[:, 2])  # one that has spun, or that faces about, goes on from its own angle
            track.poses = way


def _as_faced(track: Track, course: Course) -> Course:
    """The course in the direction in which the box faces: the other one of a vehicle that backed."""
    pose = track.poses[track.hit or 0]
    at = int(np.hypot(*(course.path.points - pose[:2]).T).argmin())
    if math.cos(float(pose[2] - course.path.heading_rad[at])) > -math.cos(_ASKEW_RAD):
        return course
    return replace(
        course, path=course.path.reversed(), left_edge_m=course.right_edge_m, right_edge_m=course.left_edge_m,
        own_left_m=course.right_edge_m,
    )  # fmt: skip


def _ways(scene: Scene, track: Track, course: Course, *, stops: bool) -> Iterator[Floats]:
    """Poses of the whole track with each possible way, the plainest first; `stops`: of one that still rolls, in its
    lane, to a stop."""
    for start in _starts(track, course):
        if stops and start.mps > _ROLLS_MPS:
            poses = track.poses.copy()
            poses[start.sample :] = _driven(start, (0.0, math.inf, 0.0), course, len(poses) - start.sample, stops=True)
            if _is_free(scene, track, poses, start, near_m=_ALONG_M):
                yield poses
        if stops:
            continue
        for left_m in _lines(track, course, start):
            past_m = _past(scene, track, course, start) if left_m > course.own_left_m - track.size[1] / 2 else math.inf
            for backs_m in (0.0,) if start.mps > _ROLLS_MPS else (0.0, *_BACKS_M):
                poses = track.poses.copy()
                behind = _driven(start, (left_m, past_m, backs_m), course, len(poses) - start.sample)
                poses[start.sample :] = behind
                if _is_free(scene, track, poses, start) and _is_away(poses, start):
                    yield poses


def _starts(track: Track, course: Course) -> Iterator[_Start]:
    speeds = sample_speeds(track.poses)
    parted = (track.hit or 0) + round(_PARTS_S / STEP_S)
    slow = np.flatnonzero(speeds[parted:] < _STANDS_MPS)
    stands = parted + int(slow[0]) + round(_WAITS_S / STEP_S) if len(slow) else len(speeds)
    for sample, rolls in ((parted, True), (stands, False)):
        if sample < len(speeds) - 1 and (speeds[sample] > _ROLLS_MPS) == rolls:
            start = _start(track.poses, float(speeds[sample]), sample, course)
            if abs(start.askew_rad) < _ASKEW_RAD:
                yield start


def _start(poses: Floats, mps: float, sample: int, course: Course) -> _Start:
    path, pose = course.path, poses[sample]
    station = float(path.s_m[np.hypot(*(path.points - pose[:2]).T).argmin()])
    x, y, heading = path.poses([station])[0]
    left = -(pose[0] - x) * math.sin(heading) + (pose[1] - y) * math.cos(heading)
    askew = float(wrap_angle(np.array([pose[2] - heading]))[0])
    went = math.atan2(*(pose[:2] - poses[sample - 1, :2])[::-1]) if mps > _ROLLS_MPS else float(pose[2])
    way = float(wrap_angle(np.array([went - heading]))[0])
    return _Start(sample, station, float(left), askew, math.tan(max(-_ASKEW_RAD, min(way, _ASKEW_RAD))), mps)


def _lines(track: Track, course: Course, start: _Start) -> Iterator[float]:
    """Distances to the left of the lane at which it may drive on: as it is, in its lane, in the lanes beside it."""
    room_m = course.lane_width_m + track.size[1] / 2
    edges_m = {1: course.left_edge_m, -1: course.right_edge_m}
    sides = (1, -1) if course.own_left_m > room_m else (-1, 1)  # the other direction's lane is the last choice
    yield from (0.0, start.left_m)
    yield from (side * course.lane_width_m for side in sides if edges_m[side] > room_m)


def _past(scene: Scene, track: Track, course: Course, start: _Start) -> float:
    """The station from which the own lane is free again."""
    ends = [start.station_m]
    for other in scene.everybody.values():
        there = _start(other.poses, 0.0, len(other.poses) - 1, course)
        if other.actor != track.actor and abs(there.left_m) < course.lane_width_m:
            ends.append(there.station_m + (other.size[0] + track.size[0]) / 2)
    return max(ends) + _NEAR_M


def _driven(
    start: _Start, line: tuple[float, float, float], course: Course, count: int, *, stops: bool = False
) -> Floats:
    """(count, 3) poses from a start on: back, if it is to, then forward into a line beside the middle of its lane, and
    into its lane again or to a stop; `line`: how far to the left, to which station, and how far it first backs."""
    left_m, past_m, backs_m = line
    time = np.arange(count) * STEP_S
    back, since = _backed(time.astype(float), backs_m)
    ahead = _gone(np.maximum(time - since, 0.0), start.mps if not backs_m else 0.0)
    if stops:
        slows = min(max(start.mps**2 / (2 * _STOPS_M), _STOPS_MPS2[0]), _STOPS_MPS2[1])
        braked = np.minimum(time, start.mps / slows)
        ahead = start.mps * braked - slows * braked**2 / 2
    turn_m = start.left_m - back * start.slope  # the line from which it goes forward
    begins = start.station_m - back
    length = max(_BLEND_M, _BLENDS * abs(left_m - float(turn_m[-1])))
    u = np.clip(ahead / length, 0.0, 1.0)
    bend = (2 * u**3 - 3 * u**2 + 1, u**3 - 2 * u**2 + u, 3 * u**2 - 2 * u**3)
    left = bend[0] * turn_m + bend[1] * start.slope * length + bend[2] * left_m
    steep = ((6 * u**2 - 6 * u) * (turn_m - left_m) / length + (3 * u**2 - 4 * u + 1) * start.slope) * (u < 1.0)
    if past_m < math.inf:
        again_m = max(past_m, float(begins[-1]) + length)
        x = np.clip((begins + ahead - again_m) / _RETURNS_M, 0.0, 1.0)
        steep = steep - left * 30.0 * x**2 * (1.0 - x) ** 2 / _RETURNS_M  # the slope of `ramp`
        left = left * (1.0 - ramp(begins + ahead, again_m, _RETURNS_M))
    skids = (start.askew_rad - math.atan(start.slope)) * (1.0 - bend[2])
    x, y, heading = course.path.poses(begins + ahead).T
    turned = heading + np.arctan(steep) + skids
    return np.column_stack((x - left * np.sin(heading), y + left * np.cos(heading), turned))


def _backed(time: Floats, backs_m: float) -> tuple[Floats, float]:
    """Way backwards at each time, and when it ends: up to a speed, and evenly down again."""
    if not backs_m:
        return np.zeros(len(time)), 0.0
    gains_s = _BACKS_MPS / _BACKS_MPS2
    whole_s = gains_s + backs_m / _BACKS_MPS
    begins = _BACKS_MPS2 * np.minimum(time, gains_s) ** 2 / 2
    goes = _BACKS_MPS * np.clip(time - gains_s, 0.0, whole_s - 2 * gains_s)
    ends_s = np.clip(time - (whole_s - gains_s), 0.0, gains_s)
    return begins + goes + _BACKS_MPS * ends_s - _BACKS_MPS2 * ends_s**2 / 2, whole_s


def _gone(time: Floats, from_mps: float) -> Floats:
    """Way forward at each time, up to the speed of one that drives away."""
    goes = max(_GOES_MPS, from_mps)
    gains_s = (goes - from_mps) / _GAINS_MPS2
    since = np.minimum(time, gains_s)
    way: Floats = from_mps * since + _GAINS_MPS2 * since**2 / 2 + goes * np.maximum(time - gains_s, 0.0)
    return way


def _is_free(scene: Scene, track: Track, poses: Floats, start: _Start, near_m: float = _NEAR_M) -> bool:
    """Whether a way comes near no other; at its start it may be as near as it stands there."""
    after = poses[start.sample :]
    moved = np.hypot(*(after[:, :2] - after[0, :2]).T)
    wanted = np.where(np.maximum.accumulate(moved) > near_m, _CLEAR_M, _SUNK_M)
    for other in scene.everybody.values():
        if other.actor != track.actor and not other.flat:
            gaps = gaps_where_near(after, track.size, other.poses[start.sample :], other.size, _CLEAR_M)
            if (gaps < np.where(wanted < 0.0, np.minimum(wanted, gaps[0] + _SUNK_M / 2), wanted)).any():
                return False
    return True


def _is_away(poses: Floats, start: _Start) -> bool:
    return math.dist(poses[start.sample, :2], poses[-1, :2]) > _AWAY_M
