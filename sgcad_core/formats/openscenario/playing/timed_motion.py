"""Boxes, transitions and timed vertices: the parts of played motion.

Metres, seconds, radians; poses are those of the entity's origin. Knows no XML, no road and no storyboard.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.geometry.plane import Floats, wrap_angle

EPSILON = 1e-9
MAX_S = 300.0
"""Longest scenario that is played."""
BLOW_MPS2 = 15.0
"""More than any vehicle brakes: the vertex is that of a blow."""
_STANDS_MPS = 0.02


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
SLOPES: dict[str, Callable[[float], float]] = {
    "step": lambda u: 0.0,
    "linear": lambda u: 1.0,
    "sinusoidal": lambda u: math.pi / 2 * math.sin(math.pi * u),
    "cubic": lambda u: 6 * u * (1 - u),
}
"""Derivatives of the shapes."""
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

    def slope(self, passed: float) -> float:
        """The change a second or a metre there."""
        if self.over(passed) or passed < self.begin:
            return 0.0
        return (self.last - self.first) / self.span * SLOPES[self.shape]((passed - self.begin) / self.span)

    def over(self, passed: float) -> bool:
        """Whether the last value is reached."""
        return self.shape == "step" or passed - self.begin >= self.span - EPSILON


class TimedMotion:
    """Timed vertices, evaluated once for the whole clock; exact at vertices, headings along the shortest arc."""

    def __init__(
        self, times_s: Floats, points: Floats, headings_rad: Floats, clock: tuple[int, float],
        rolls_rad: Floats | None = None,
    ) -> None:  # fmt: skip
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
        self._rolls = None if rolls_rad is None else np.interp(t, times_s, np.unwrap(rolls_rad)).tolist()

    def eased(self, first_mps: float, dt_s: float) -> TimedMotion:
        """The same places at the same times, but the speed changes evenly between them, from `first_mps` on.

        Where the speed would become negative within a piece, the entity brakes evenly to its end and waits.
        """
        times, points, headings = self._vertices
        vertices, speed = np.column_stack((times, points, headings)), first_mps
        rows = [vertices[:1]]
        for i in range(len(times) - 1):
            piece, speed = _eased_piece(vertices[i : i + 2], speed, dt_s)
            rows.append(piece)
        t, x, y, heading = np.vstack(rows).T
        return TimedMotion(t, np.column_stack((x, y)), heading, (self.first_step, dt_s))

    def pose(self, step: int) -> Pose:
        """Pose at a step of the clock; before and behind the vertices, that of the nearest one."""
        return Pose(*self._rows[min(step - self.first_step, len(self._rows) - 1)])

    def roll(self, step: int) -> float:
        """Roll there, radians."""
        return 0.0 if self._rolls is None else float(self._rolls[min(step - self.first_step, len(self._rolls) - 1)])

    def speed(self, step: int) -> float:
        """Speed there, m/s, never negative."""
        return float(self._speeds[min(step - self.first_step, len(self._speeds) - 1)])

    def center_speed(self, step: int, box: BoxShape) -> float:
        """Speed of the box center there, which in a turn is not the origin's."""
        if self._of_centers is None or self._of_centers[0] != box:
            times, points, heading = self._vertices
            self._of_centers = box, _speeds(times, box.centers(points, heading), self._clock_s).tolist()
        return float(self._of_centers[1][min(step - self.first_step, len(self._speeds) - 1)])


def _eased_piece(ends: Floats, speed_mps: float, dt_s: float) -> tuple[Floats, float]:
    """(n, 4) time, x, y, heading behind the first end (2, 4), at even acceleration, and the speed at the last."""
    first, last = ends
    span, way = float(last[0] - first[0]), math.hypot(*(last[1:3] - first[1:3]))
    if span <= EPSILON or way <= EPSILON:
        return ends[1:], 0.0
    acceleration = 2 * (way - speed_mps * span) / span**2
    if (final := speed_mps + acceleration * span) < 0:
        acceleration, final = -(speed_mps**2) / (2 * way), 0.0
        drives = 2 * way / speed_mps
    else:
        drives = span
    seen = max(0.0, -float(first[0])), min(drives, MAX_S + dt_s - float(first[0]))  # what the clock sees of it
    if seen[1] <= seen[0]:
        return ends[1:], final
    t = np.linspace(*seen, max(2, math.ceil((seen[1] - seen[0]) / dt_s) + 1))[0 if seen[0] else 1 :]
    share = (speed_mps * t + acceleration * t**2 / 2) / way
    rows = first + share[:, None] * (last - first)
    rows[:, 0] = first[0] + t
    return (np.vstack((rows, last)) if seen[1] < span - EPSILON else rows), final


def _speeds(times_s: Floats, points: Floats, t_s: Floats) -> Floats:
    """Speeds at times: those of the segment; at a vertex the mean of its two segments', in a blow and behind a stop
    that before it."""
    lasts = np.maximum(np.diff(times_s), 1e-6)
    segment = np.hypot(*np.diff(points, axis=0).T) / lasts
    last = len(segment) - 1
    before = np.clip(np.searchsorted(times_s, t_s - 1e-6) - 1, 0, last)
    after = np.clip(np.searchsorted(times_s, t_s + 1e-6) - 1, 0, last)
    blow = np.abs(segment[after] - segment[before]) > BLOW_MPS2 * np.minimum(lasts[after], lasts[before])
    stood = segment[before] < _STANDS_MPS
    speeds: Floats = np.where(blow | stood, segment[before], (segment[before] + segment[after]) / 2)
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


def angle_between(first_rad: float, second_rad: float) -> float:
    """Absolute difference of two headings, radians in [0, pi]."""
    return abs(float(wrap_angle(first_rad - second_rad)))
