"""How a played entity moves: along timed vertices, along a course at its own speed, or straight on.

Metres, seconds, radians; poses are those of the entity's origin. Knows no XML and no storyboard.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats, arc_lengths, wrap_angle

EPSILON = 1e-9
MAX_S = 300.0
"""Longest scenario that is played."""
_BEYOND_M = 1000.0


class Pose(NamedTuple):
    """Place and heading."""

    x_m: float
    y_m: float
    heading_rad: float


class BoxShape(NamedTuple):
    """A bounding box; the center is given from the entity's origin."""

    length_m: float
    width_m: float
    center_x_m: float = 0.0
    center_y_m: float = 0.0

    def centers(self, points: Floats, headings_rad: Floats) -> Floats:
        """(n, 2) box centers of poses whose origins are `points`."""
        c, s = np.cos(headings_rad), np.sin(headings_rad)
        offset = np.column_stack((self.center_x_m * c - self.center_y_m * s, self.center_x_m * s + self.center_y_m * c))
        return np.asarray(points + offset, dtype=np.float64)


SHAPES: dict[str, Callable[[float], float]] = {
    "step": lambda u: 1.0,
    "linear": lambda u: u,
    "sinusoidal": lambda u: (1 - math.cos(math.pi * u)) / 2,
    "cubic": lambda u: u * u * (3 - 2 * u),
}
STEEPEST = {"step": 1.0, "linear": 1.0, "sinusoidal": math.pi / 2, "cubic": 1.5}
"""Largest slope of each shape over u in [0, 1]: turns a maximum rate into a duration."""


@dataclass(frozen=True)
class Transition:
    """From one value to another over a span of seconds or metres."""

    first: float
    last: float
    shape: str
    span: float
    begin: float = 0.0

    def at(self, passed: float) -> float:
        """The value there."""
        share = 1.0 if self.over(passed) else max(0.0, (passed - self.begin) / self.span)
        return self.first + (self.last - self.first) * SHAPES[self.shape](share)

    def over(self, passed: float) -> bool:
        """Whether the last value is reached."""
        return self.shape == "step" or passed - self.begin >= self.span - EPSILON


class Timed:
    """Timed vertices, evaluated once for the whole clock; exact at vertices, headings along the shortest arc."""

    def __init__(self, times_s: Floats, points: Floats, headings_rad: Floats, clock: tuple[int, float]) -> None:
        """`clock`: first step and step length. Points (n, 2), times not falling."""
        self.first_step, dt_s = clock
        self.end_s = float(times_s[-1])
        steps = max(0, math.ceil((min(self.end_s, MAX_S) - EPSILON) / dt_s) - self.first_step)
        t = np.arange(self.first_step, self.first_step + steps + 1, dtype=np.float64) * dt_s
        heading = np.unwrap(headings_rad)
        self._rows = np.column_stack([np.interp(t, times_s, v) for v in (points[:, 0], points[:, 1], heading)]).tolist()
        self._speeds = _speeds(times_s, points, t).tolist()
        self._vertices, self._clock_s = (times_s, points, heading), t
        self._of_centers: tuple[BoxShape, list[float]] | None = None

    def pose(self, step: int) -> Pose:
        """Pose at a step of the clock; before and behind the vertices, that of the nearest one."""
        return Pose(*self._rows[min(step - self.first_step, len(self._rows) - 1)])

    def speed(self, step: int) -> float:
        """Speed there, m/s, never negative."""
        return float(self._speeds[min(step - self.first_step, len(self._speeds) - 1)])

    def center_speed(self, step: int, box: BoxShape) -> float:
        """Speed of the box center there, which in a turn is not the origin's."""
        if self._of_centers is None or self._of_centers[0] != box:
            times, points, heading = self._vertices
            self._of_centers = box, _speeds(times, box.centers(points, heading), self._clock_s).tolist()
        return float(self._of_centers[1][min(step - self.first_step, len(self._speeds) - 1)])


def _speeds(times_s: Floats, points: Floats, t_s: Floats) -> Floats:
    """Speeds at times: those of the segment; at a vertex the mean of its two segments'."""
    segment = np.hypot(*np.diff(points, axis=0).T) / np.maximum(np.diff(times_s), 1e-6)
    last = len(segment) - 1
    before = np.clip(np.searchsorted(times_s, t_s - 1e-6) - 1, 0, last)
    after = np.clip(np.searchsorted(times_s, t_s + 1e-6) - 1, 0, last)
    speeds: Floats = (segment[before] + segment[after]) / 2
    return speeds


def tangents(points: Floats) -> Floats:
    """Heading of each vertex of a polyline that may stand still: that of the next real segment, else the last."""
    step = np.diff(points, axis=0)
    real = np.flatnonzero(np.hypot(step[:, 0], step[:, 1]) > 1e-6)
    if not len(real):
        return np.zeros(len(points))
    following = np.minimum(np.searchsorted(real, np.arange(len(points))), len(real) - 1)
    segment = step[real[following]]
    heading: Floats = np.arctan2(segment[:, 1], segment[:, 0])
    return heading


class Course:
    """A polyline travelled at the entity's own speed, with a lateral offset that may change."""

    def __init__(self, points: Floats, s_m: float = 0.0, shift: Transition | None = None, by_time: bool = True) -> None:
        """Points (n, 2), n >= 2, no two alike in a row; `shift`: metres to the left."""
        self.points, self.along = points, arc_lengths(points)
        self.s_m, self.shift, self.by_time = s_m, shift or Transition(0.0, 0.0, "step", 0.0), by_time
        self.offset_m = self.shift.first

    @property
    def rest_m(self) -> float:
        """Distance to the end."""
        return float(self.along[-1] - self.s_m)

    def advance(self, distance_m: float, passed: float) -> Pose:
        """Move on; `passed`: seconds or metres for the offset's transition. Behind the end it goes straight on."""
        before = self.offset_m
        self.s_m += distance_m
        self.offset_m = self.shift.at(passed)
        x, y, heading = self._at(self.s_m)
        drift = math.atan2(self.offset_m - before, distance_m) if distance_m > EPSILON else 0.0
        side = heading + math.pi / 2
        return Pose(x + self.offset_m * math.cos(side), y + self.offset_m * math.sin(side), heading + drift)

    def _at(self, s_m: float) -> Pose:
        i = int(np.clip(np.searchsorted(self.along, s_m, side="right") - 1, 0, len(self.points) - 2))
        (x, y), (x2, y2) = self.points[i], self.points[i + 1]
        heading, over = math.atan2(y2 - y, x2 - x), s_m - self.along[i]
        return Pose(x + over * math.cos(heading), y + over * math.sin(heading), heading)


def straight(pose: Pose) -> Course:
    """The course straight ahead."""
    ahead = np.array([math.cos(pose.heading_rad), math.sin(pose.heading_rad)]) * _BEYOND_M
    here = np.array(pose[:2])
    return Course(np.array([here, here + ahead]))


@dataclass(eq=False)
class Body:
    """A moving entity. The player advances it; actions set its course and speed."""

    name: str
    box: BoxShape
    pose: Pose | None = None
    speed_mps: float = 0.0
    travelled_m: float = 0.0
    timed: Timed | None = None
    course: Course | None = None
    pace: Transition | None = None
    owners: dict[str, object] = field(default_factory=dict)
    """Who controls "path" and "speed": the newest action wins, older ones are over."""

    def place(self, pose: Pose) -> None:
        """Teleport; the way does not count as travelled."""
        self.pose, self.course, self.timed = pose, None, None

    def release(self, domain: str) -> None:
        """Nothing controls the path or the speed any more: the entity keeps its lane or its speed."""
        if domain == "path":
            self.course = self.timed = None
        else:
            self.pace = None

    def advance(self, step: int, dt_s: float, course_from: Callable[[Pose], Course]) -> None:
        """Move to a step of the clock."""
        assert self.pose is not None  # noqa: S101 - the player checks it before the first step
        before = self.pose
        if self.timed:
            self.pose, self.speed_mps = self.timed.pose(step), self.timed.speed(step)
        else:
            self.pose = self._cruise(step * dt_s, dt_s, course_from)
        self.travelled_m += math.hypot(self.pose.x_m - before.x_m, self.pose.y_m - before.y_m)

    def _cruise(self, t_s: float, dt_s: float, course_from: Callable[[Pose], Course]) -> Pose:
        assert self.pose is not None  # noqa: S101 - as above
        before = self.speed_mps
        if self.pace:
            self.speed_mps = self.pace.at(t_s)
        distance = (before + self.speed_mps) / 2 * dt_s
        if abs(distance) < EPSILON:
            return self.pose
        self.course = self.course or course_from(self.pose)
        return self.course.advance(distance, t_s if self.course.by_time else self.travelled_m + distance)

    def center(self) -> Pose:
        """Pose of the box center."""
        assert self.pose is not None  # noqa: S101 - as above
        x, y, h = self.pose
        dx, dy, c, s = self.box.center_x_m, self.box.center_y_m, math.cos(h), math.sin(h)
        return Pose(x + dx * c - dy * s, y + dx * s + dy * c, h)

    def center_speed(self, step: int) -> float:
        """Speed of the box center on timed vertices, else the entity's own; m/s, never negative."""
        return self.timed.center_speed(step, self.box) if self.timed else abs(self.speed_mps)


def angle_between(first_rad: float, second_rad: float) -> float:
    """Absolute difference of two headings, radians in [0, pi]."""
    return abs(float(wrap_angle(first_rad - second_rad)))
