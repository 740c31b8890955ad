"""A polyline that an entity travels at its own speed, with a lateral offset that may change on the way.

Metres, radians. The distance counts where the entity is, not on the polyline: beside a bend it is scaled by the
curvature, and what goes sideways does not go ahead. Knows no XML and no storyboard.
"""

from __future__ import annotations

import math
from array import array
from bisect import bisect_right
from functools import cached_property

import numpy as np

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.timed_motion import EPSILON, Transition
from sgcad_core.formats.openscenario.roads.way import LanePlace, Way
from sgcad_core.geometry.plane import Floats, arc_lengths

_BEYOND_M = 1000.0
_BEND_M = 2.0
"""Curvature is measured over twice this length: shorter ones see the corners of the polyline."""


class OffsetCourse:
    """Points (n, 2), n >= 2, no two alike in a row; `shift`: metres to the left, over time or over distance."""

    def __init__(
        self,
        points: Floats,
        s_m: float = 0.0,
        shift: Transition | None = None,
        by_time: bool = True,
        way: Way | None = None,
        closed: bool | None = None,
        aside_counts: bool = True,
    ) -> None:
        """`way`: the lanes that the points lie in; `closed` stands for a trajectory: behind its end, begin again?

        `aside_counts`: whether the speed is that of the slanting way, or that along the lane.
        """
        self.points, self.along = points, arc_lengths(points)
        self._stations = array("d", self.along.tobytes())  # asked at every step, where numpy's scalars are slow
        self._places = array("d", np.ascontiguousarray(points).tobytes())
        self.s_m, self.shift, self.by_time = s_m, shift or Transition(0.0, 0.0, "step", 0.0), by_time
        self.way, self.closed, self.fixed, self.reverse = way, bool(closed), closed is not None, False
        self.headings: Floats | None = None
        """Stated heading of each point; else the line's own counts."""
        self._aside_counts = aside_counts
        self.offset_m = self.shift.first
        self.passed_m = 0.0

    def take_over(self, before: OffsetCourse) -> None:
        """Go on with another course's shift."""
        self.shift, self.by_time, self.passed_m = before.shift, before.by_time, before.passed_m
        self._aside_counts = before._aside_counts

    @property
    def rest_m(self) -> float:
        """Distance to the end."""
        return math.inf if self.closed else self._stations[-1] - self.s_m

    @property
    def pose(self) -> Pose:
        """Where it is now."""
        return self._beside(self.s_m, 0.0)

    def advance(self, distance_m: float, t_s: float, dt_s: float) -> Pose:
        """Move on to a time. Behind the end it goes straight on."""
        before, ahead, drift = self.offset_m, distance_m, 0.0
        if self.by_time:
            self.offset_m = self.shift.at(t_s)
            aside = self.shift.slope(t_s - dt_s) * dt_s or self.offset_m - before
            if self.shift.shape != "step":
                ahead = math.sqrt(max(distance_m**2 - aside**2, 0.0)) if self._aside_counts else distance_m
                drift = math.atan2(aside, ahead) if distance_m > EPSILON else 0.0
        else:
            slope = self.shift.slope(self.passed_m)
            ahead, drift = distance_m / math.hypot(1.0, slope), math.atan(slope)
            self.passed_m += ahead
            self.offset_m = self.shift.at(self.passed_m)
        if self.shift.over(t_s if self.by_time else self.passed_m):
            drift = 0.0
        self.s_m += ahead / max(1.0 - self.offset_m * self._curvature(self.s_m), 0.1)
        if self.closed:
            self.s_m %= self._stations[-1]
        return self._beside(self.s_m, drift)

    def move(self, distance_m: float) -> Pose:
        """Set forward or back along the course at once."""
        self.s_m += distance_m
        return self.pose

    def place(self) -> tuple[LanePlace, int] | None:
        """The lane place now and the sense of driving; None off the roads."""
        if self.way is None or self.s_m > self._stations[-1] + EPSILON:
            return None
        i = self._index(self.s_m)
        before, behind = self._stations[i : i + 2]
        share = (self.s_m - before) / max(behind - before, EPSILON)
        return self.way.place(i, min(max(share, 0.0), 1.0), self.offset_m)

    def _beside(self, s_m: float, drift_rad: float) -> Pose:
        i = self._index(s_m)
        x, y, x2, y2 = self._places[2 * i : 2 * i + 4]
        heading, over = math.atan2(y2 - y, x2 - x), s_m - self._stations[i]
        side = heading + math.pi / 2
        x, y = x + over * math.cos(heading), y + over * math.sin(heading)
        turned = heading + drift_rad + (math.pi if self.reverse else 0.0)
        if self.headings is not None:
            turned = float(np.interp(s_m, self.along, self.headings))
        return Pose(x + self.offset_m * math.cos(side), y + self.offset_m * math.sin(side), turned)

    def _index(self, s_m: float) -> int:
        return min(max(bisect_right(self._stations, s_m) - 1, 0), len(self._stations) - 2)

    def _curvature(self, s_m: float) -> float:
        if not self.offset_m:
            return 0.0
        low, high = np.interp([s_m - _BEND_M, s_m + _BEND_M], self.along, self._headings)
        return float((high - low) / (2 * _BEND_M))

    @cached_property
    def _headings(self) -> Floats:
        step = np.diff(self.points, axis=0)
        heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
        smooth: Floats = np.concatenate((heading[:1], (heading[1:] + heading[:-1]) / 2, heading[-1:]))
        return smooth


def straight(pose: Pose) -> OffsetCourse:
    """The course straight ahead."""
    ahead = np.array([math.cos(pose.heading_rad), math.sin(pose.heading_rad)]) * _BEYOND_M
    here = np.array(pose[:2])
    return OffsetCourse(np.array([here, here + ahead]))


def beside(points: Floats, pose: Pose) -> tuple[float, float]:
    """How far a pose lies along a polyline's first segment from its first point, and to its left, metres."""
    (x, y), (x2, y2) = points[0], points[1]
    length = max(math.hypot(x2 - x, y2 - y), 1e-9)
    c, s, dx, dy = (x2 - x) / length, (y2 - y) / length, pose.x_m - x, pose.y_m - y
    return float(c * dx + s * dy), float(c * dy - s * dx)
