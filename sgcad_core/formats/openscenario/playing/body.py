"""A played entity: its box, where it is and how fast, and what moves it.

The player advances it; actions set its course, its timing and its pace. Knows no XML and no storyboard.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.offset_course import OffsetCourse
from sgcad_core.formats.openscenario.playing.timed_motion import EPSILON, BoxShape, TimedMotion
from sgcad_core.formats.openscenario.roads.way import LanePlace, Route

STILL_MPS = 1e-3


@dataclass(frozen=True)
class Limits:
    """Performance limits of an entity, m/s and m/s²."""

    speed_mps: float = math.inf
    acceleration: float = math.inf
    deceleration: float = math.inf


@dataclass(eq=False)
class Body:
    """A moving entity. Points: the pose is that of the origin; `lead_m`: how far ahead the point lies that is led."""

    name: str
    box: BoxShape
    kind: str = "Vehicle"
    category: str = "car"
    limits: Limits = field(default_factory=Limits)
    lead_m: float = 0.0
    hitch_m: float | None = None
    coupler_m: float | None = None
    """Where a trailer is hitched on (from the origin, ahead positive), and where this one hitches on as a trailer."""
    pose: Pose | None = None
    speed_mps: float = 0.0
    roll_rad: float = 0.0
    """Roll about the long axis, positive to the right: that of timed vertices, kept after the last."""
    travelled_m: float = 0.0
    present: bool = True
    timed: TimedMotion | None = None
    course: OffsetCourse | None = None
    pace: Callable[[float], float] | None = None
    """Speed at a time, while something sets it."""
    next_mps: float | None = None
    """Speed at the end of this step, set by what controls it step by step."""
    place: LanePlace | None = None
    """The lane that it drives in, where that is known from what put it there."""
    route: Route | None = None
    tow: Body | None = None
    """What pulls it."""
    at_end: bool = False
    """Whether the road ended under it."""
    acceleration: tuple[float, float] = (0.0, 0.0)
    """Along its heading and to its left, m/s²."""
    velocity: tuple[float, float] = (0.0, 0.0)
    owners: dict[str, object] = field(default_factory=dict)
    """The action that controls "path" and "speed": the newest one; older ones have ended."""

    def put(self, pose: Pose, place: LanePlace | None = None) -> None:
        """Teleport; the way does not count as travelled."""
        self.pose, self.place = pose, place
        self.course = self.timed = None
        self.present, self.at_end = True, False

    def release(self, domain: str) -> None:
        """Nothing controls the path or the speed any more: the entity keeps its lane or its speed."""
        if domain == "path":
            self.course = self.timed = None
        else:
            self.pace = self.next_mps = None

    def advance(self, step: int, dt_s: float, course_for: Callable[[Body, bool], OffsetCourse]) -> None:
        """Move to a step of the clock."""
        if self.pose is None or not self.present:
            return
        before, velocity = self.pose, self.velocity
        if self.timed:
            self.pose, self.speed_mps, self.place = self._led(self.timed.pose(step)), self.timed.speed(step), None
            self.roll_rad = self.timed.roll(step)
        else:
            self.pose = self._cruise(step * dt_s, dt_s, course_for)
        moved = self.pose.x_m - before.x_m, self.pose.y_m - before.y_m
        self.travelled_m += math.hypot(*moved)
        self.velocity = moved[0] / dt_s, moved[1] / dt_s
        c, s = math.cos(self.pose.heading_rad), math.sin(self.pose.heading_rad)
        ax, ay = ((now - then) / dt_s for now, then in zip(self.velocity, velocity, strict=True))
        self.acceleration = ax * c + ay * s, ay * c - ax * s

    def _cruise(self, t_s: float, dt_s: float, course_for: Callable[[Body, bool], OffsetCourse]) -> Pose:
        assert self.pose is not None  # noqa: S101 - as above
        before = self.speed_mps
        if self.next_mps is not None:
            self.speed_mps, self.next_mps = self.next_mps, None
        elif self.pace:
            self.speed_mps = self.pace(t_s)
        distance = (before + self.speed_mps) / 2 * dt_s
        if abs(distance) < EPSILON:
            return self.pose
        course = self._course(distance, course_for)
        signed = distance if course.fixed and not course.reverse else abs(distance)
        if course.way and course.way.dead_end and signed >= course.rest_m:
            self.at_end, self.speed_mps, signed = True, 0.0, max(course.rest_m, 0.0)
        pose = course.advance(signed, t_s, dt_s)
        found = course.place()
        self.place = found[0] if found else None
        return self._led(pose) if course.fixed else pose

    def _course(self, distance_m: float, course_for: Callable[[Body, bool], OffsetCourse]) -> OffsetCourse:
        """The course it is on; a new one in the other sense, and where a long way was cut."""
        course, backwards = self.course, distance_m < 0
        if course is None:
            self.course = course = course_for(self, backwards)
        elif not course.fixed and (course.reverse != backwards or self._used_up(course, distance_m)):
            self.course = new = course_for(self, backwards)
            if course.way and new.way and not course.shift.over(math.inf if course.by_time else course.passed_m):
                new.take_over(course)
            course = new
        return course

    @staticmethod
    def _used_up(course: OffsetCourse, distance_m: float) -> bool:
        return course.way is not None and not course.way.dead_end and course.rest_m < abs(distance_m) + 1.0

    def seated(self, pose: Pose) -> Pose:
        """Where the origin is when the led point begins at a pose, facing as the pose does."""
        c, s = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
        return Pose(pose.x_m - self.lead_m * c, pose.y_m - self.lead_m * s, pose.heading_rad)

    def _led(self, pose: Pose) -> Pose:
        """The origin's pose when the point `lead_m` ahead of it is led to a pose: the rear is drawn behind."""
        if not self.lead_m or self.pose is None:
            return pose
        heading = math.atan2(pose.y_m - self.pose.y_m, pose.x_m - self.pose.x_m)
        c, s = math.cos(heading), math.sin(heading)
        return Pose(pose.x_m - self.lead_m * c, pose.y_m - self.lead_m * s, heading)

    def drawn(self) -> None:
        """Follow what pulls it: the coupler stays on the hitch, the rear rolls towards it."""
        if self.tow is None or self.tow.pose is None:
            return
        x, y, h = self.tow.pose
        reach, bar = self.tow.hitch_m or 0.0, self.coupler_m or self.box.length_m / 2
        hitch = x + reach * math.cos(h), y + reach * math.sin(h)
        back = self.pose or Pose(hitch[0] - bar * math.cos(h), hitch[1] - bar * math.sin(h), h)
        heading = math.atan2(hitch[1] - back.y_m, hitch[0] - back.x_m)
        pose = Pose(hitch[0] - bar * math.cos(heading), hitch[1] - bar * math.sin(heading), heading)
        self.travelled_m += math.hypot(pose.x_m - back.x_m, pose.y_m - back.y_m)
        self.pose, self.speed_mps, self.place, self.present = pose, self.tow.speed_mps, None, self.tow.present

    def center(self) -> Pose:
        """Pose of the box center; the origin's before it was placed."""
        x, y, h = self.pose or Pose(0.0, 0.0, 0.0)
        dx, dy, c, s = self.box.center_x_m, self.box.center_y_m, math.cos(h), math.sin(h)
        return Pose(x + dx * c - dy * s, y + dx * s + dy * c, h)

    def center_speed(self, step: int) -> float:
        """Speed of the box center on timed vertices, else the entity's own; m/s, never negative."""
        return self.timed.center_speed(step, self.box) if self.timed else abs(self.speed_mps)


def place_trailers(bodies: Mapping[str, Body], anew: bool = False) -> None:
    """Move trailers behind what pulls them, from the front of each train on; `anew`: in line, wherever they were."""
    waiting = [body for body in bodies.values() if body.tow is not None]
    while waiting:
        ready = [body for body in waiting if body.tow not in waiting] or waiting  # a ring has no front
        for body in ready:
            body.pose = None if anew and body.tow and body.tow.pose else body.pose
            body.drawn()
        waiting = [body for body in waiting if body not in ready]
