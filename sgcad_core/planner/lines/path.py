"""A smooth line with a station and a heading at each of its points.

Plane geometry only; knows neither roads nor time. The station is the arc length of the line as it was
first drawn; a line moved sideways keeps its stations, so that places on it keep their names. Metres,
radians; x east, y north.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgcad_core.geometry.plane import Floats, arc_lengths, resample

STEP_M = 0.5
TURN_BACK_M = 5.6
"""Radius of the rear axle in a U-turn: that of a car with a turning circle of about 11 m between curbs."""
_SWING_OUT_M = 0.8
"""How far a vehicle swings to the right within its lane before such a turn."""
EXTENSION_M = 320.0
"""Straight run before and behind the drawn line: 9 s at 80 mph."""
_EXTENSION_STEP_M = 4.0
_DENSE_M = 100.0
"""Length of the runs at both ends that is as dense as the line itself, so that lane changes there are smooth."""
_TURN_HALF_M = 20.0
_TURN_RAD = math.radians(25)
"""Over twice that length; less is a shift between lanes across a junction."""
_WINDOWS_M = (2.0, 3.0, 4.5, 6.0, 9.0, 13.0, 18.0, 25.0)
_EVEN_M = 6.0
_TAPER = 0.35
"""Metres by which a smoothing window narrows per metre of distance."""


@dataclass(frozen=True, eq=False)
class Path:
    """Points (n, 2), their stations (n,) increasing, and headings (n,) of a box that follows, unwrapped."""

    points: Floats
    s_m: Floats
    heading_rad: Floats

    def poses(self, s_m: ArrayLike) -> Floats:
        """(m, 3) x, y, heading at stations, clamped to the ends; cubic (Hermite) between points."""
        station = self.s_m
        at = np.minimum(np.maximum(np.asarray(s_m, dtype=float), station[0]), station[-1])
        i = np.minimum(np.maximum(station.searchsorted(at) - 1, 0), len(station) - 2)
        step = self._steps[i]
        t = (at - station[i]) / step
        t2 = t * t
        t3 = t2 * t
        eased = (3 * t2 - 2 * t3)[:, None]
        p, m = self._columns, self._slopes
        j = i + 1
        bent: Floats = (1 - eased) * p[i] + eased * p[j]
        bent += step[:, None] * ((t3 - 2 * t2 + t)[:, None] * m[i] + (t3 - t2)[:, None] * m[j])
        return bent

    @cached_property
    def derived(self) -> dict[Hashable, tuple[Path, Path, bool]]:
        """Results computed from this line, by their inputs."""
        return {}

    @cached_property
    def _steps(self) -> Floats:
        """(n - 1,) metres of station from each point to the next."""
        return np.diff(self.s_m)

    @cached_property
    def _columns(self) -> Floats:
        """(n, 3) x, y, heading at the points."""
        return np.column_stack((self.points, self.heading_rad))

    @cached_property
    def _slopes(self) -> Floats:
        """(n, 3) their change per metre of station."""
        slopes: Floats = np.gradient(self._columns, self.s_m, axis=0)
        return slopes

    @cached_property
    def lengths(self) -> Floats:
        """(n,) true distance along the line at each point, metres from its first."""
        return arc_lengths(self.points)

    @cached_property
    def curvature(self) -> Floats:
        """(n,) curvature of the line (not of a box that skids on it), 1/m, left positive."""
        return np.gradient(self.tangents, self.lengths)

    @cached_property
    def tangents(self) -> Floats:
        """(n,) unwrapped heading of the line (not of a box that skids on it), radians."""
        return _tangents(self.points)

    def moved(self, left_m: ArrayLike) -> Path:
        """The line moved to its left, by one number or one a point; stations stay."""
        left = np.broadcast_to(np.asarray(left_m, dtype=float), len(self.s_m))
        across = self._directions(1.5 * float(np.abs(left).max())) + math.pi / 2
        return self.displaced(left[:, None] * np.column_stack((np.cos(across), np.sin(across))))

    def _directions(self, half_m: float) -> Floats:
        """(n,) heading of the line, averaged over a stretch: a line far inside a bend must not fold."""
        angle = self.tangents
        shifts = np.linspace(-half_m, half_m, 5)
        mean: Floats = np.mean([np.interp(self.s_m + d, self.s_m, angle) for d in shifts], axis=0)
        return mean

    def displaced(self, by_m: Floats) -> Path:
        """The line moved by (n, 2) metres east and north, point by point; stations stay."""
        points = self.points + by_m
        slip = self.heading_rad - self.tangents
        return replace(self, points=points, heading_rad=_tangents(points) + slip)

    def reversed(self) -> Path:
        """The line in the opposite direction; stations change sign."""
        return Path(self.points[::-1], -self.s_m[::-1], self.heading_rad[::-1] + math.pi)

    def turned(self, angle_rad: ArrayLike) -> Path:
        """The same line with the box turned against it (backing, skidding)."""
        return replace(self, heading_rad=self.heading_rad + np.asarray(angle_rad, dtype=float))


def ramp(s_m: Floats, start_m: float, length_m: float) -> Floats:
    """Quintic step from 0 to 1 over [start, start + length]: no jump in position, slope or curvature."""
    x = np.clip((s_m - start_m) / max(length_m, 1e-6), 0.0, 1.0)
    rise: Floats = x**3 * (10 - 15 * x + 6 * x**2)
    return rise


def ramp_length_m(left_m: float, speed_mps: float, mps2: float, least_m: float = 4.0) -> float:
    """Length of a `ramp` to one side in which a speed takes no more than a lateral acceleration (5.77 is the largest
    second derivative of the step), that is no steeper than 30 degrees and no shorter than some length."""
    aside = abs(left_m)
    return max(speed_mps * math.sqrt(5.77 * aside / mps2), 3.3 * aside, least_m)


def draw(points: Floats, smooth_m: float = 3.0, speed_mps: float = 0.0) -> Path:
    """A path along a polyline (n, 2): corners rounded over about `smooth_m`, straight runs added at both ends.

    Shifts that are no turns are spread over the length that a speed asks for. Station 0 is the first given point; the
    runs have negative and further stations.
    """
    length = float(arc_lengths(points)[-1])
    count = max(8, math.ceil(length / STEP_M))
    dense = resample(points, np.linspace(0, length, count + 1))
    first, last = _unit(dense[1] - dense[0]), _unit(dense[-1] - dense[-2])
    near = np.arange(_DENSE_M, 0, -STEP_M)
    dense = np.vstack((dense[0] - near[:, None] * first, dense, dense[-1] + near[::-1, None] * last))
    dense = _rounded(dense, np.full(len(dense), smooth_m / STEP_M))
    if speed_mps:
        dense = _rounded(dense, _spread(dense, speed_mps, smooth_m))
    far = np.arange(EXTENSION_M - _DENSE_M, 0, -_EXTENSION_STEP_M)
    full = np.vstack((dense[0] - far[:, None] * first, dense, dense[-1] + far[::-1, None] * last))
    return Path(full, arc_lengths(full) - EXTENSION_M, _tangents(full))


def _spread(points: Floats, speed_mps: float, least_m: float) -> Floats:
    """(n,) half windows, in points, that turn a shift of a lane into a gentle one: narrow at turns, wide elsewhere.

    A moving mean over 2 h, taken more than once, bends a step of width d by d / (4 h^2) at most: 3.6 m at 3 m/s2 need
    h = 0.55 s * speed.
    """
    turning = np.abs(swing(_tangents(points), arc_lengths(points))) >= _TURN_RAD
    free_m = _steps_to(turning) * STEP_M
    return _even(np.minimum(least_m + _TAPER * free_m, max(0.55 * speed_mps, least_m)) / STEP_M)


def swing(angle: Floats, at: Floats) -> Floats:
    """(n,) turn of a line from _TURN_HALF_M before each point to _TURN_HALF_M behind it, radians."""
    ahead, behind = np.interp(at + _TURN_HALF_M, at, angle), np.interp(at - _TURN_HALF_M, at, angle)
    turned: Floats = ahead - behind
    return turned


def widened_bends(line: Path, most_per_m: float) -> Path:
    """The line with tighter bends than `most_per_m` (1/m) widened: a little of the corner is cut.

    As tight as before where the widest window is not enough.
    """
    points, curvature = line.points, line.curvature
    for window_m in _WINDOWS_M:
        over = np.abs(curvature) > most_per_m
        if not over.any():
            break
        half = np.clip(window_m - _TAPER * np.maximum(_steps_to(over) * STEP_M - window_m, 0.0), 0.0, None)
        points = _rounded(points, _even(half / STEP_M))
        curvature = np.gradient(_tangents(points), arc_lengths(points))
    return line if points is line.points else line.displaced(points - line.points)


def _even(half: Floats) -> Floats:
    """Windows smoothed over _EVEN_M: an abrupt window gives the line an abrupt direction."""
    n = round(_EVEN_M / STEP_M)
    for _ in range(2):
        half = np.convolve(np.pad(half, n, mode="edge"), np.ones(2 * n + 1) / (2 * n + 1), mode="valid")
    return half


def _steps_to(marked: NDArray[np.bool_]) -> Floats:
    """(n,) number of points to the nearest marked one; very many where none is."""
    at = np.flatnonzero(marked)
    if not len(at):
        return np.full(len(marked), 1e6)
    index = np.arange(len(marked))
    right = np.searchsorted(at, index)
    after = np.abs(at[np.minimum(right, len(at) - 1)] - index)
    before = np.abs(index - at[np.maximum(right - 1, 0)])
    nearest: Floats = np.minimum(after, before).astype(np.float64)
    return nearest


def bezier(start: Floats, start_rad: float, end: Floats, end_rad: float, stretch: float = 0.42) -> Floats:
    """(m, 2) cubic arc between two points with given headings; a U-turn swings out to stay drivable."""
    gap = float(np.hypot(*(end - start)))
    if abs(math.remainder(end_rad - start_rad, 2 * math.pi)) > 2.4:
        return turned_back(start, start_rad, end)
    reach = stretch * gap
    controls = [
        start,
        start + reach * np.array([math.cos(start_rad), math.sin(start_rad)]),
        end - reach * np.array([math.cos(end_rad), math.sin(end_rad)]),
        end,
    ]
    t = np.linspace(0, 1, max(6, math.ceil(gap / STEP_M)))[:, None]
    weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3)
    arc: Floats = sum((w * c for w, c in zip(weights, controls, strict=True)), np.zeros_like(t))
    return arc


def turned_back(start: Floats, start_rad: float, end: Floats, radius_m: float = TURN_BACK_M) -> Floats:
    """(m, 2) a turn by 180 degrees to the left onto a parallel line: slightly out to the right, around, and back in.

    Three arcs of one radius (L. E. Dubins, 1957): out by a, around by pi + a + b, in by b, where cos a + cos b - 1 =
    gap / (2 radius); a is no more than there is room for in a lane. One half circle where the lines lie far enough
    apart.
    """
    c, s = math.cos(start_rad), math.sin(start_rad)
    gap = max(float((end - start) @ np.array([-s, c])), 0.0)
    wide = max(radius_m, gap / 2)
    near = gap / (2 * wide)
    out = min(math.acos(min(max((near + 1) / 2, 0.0), 1.0)), math.acos(1 - _SWING_OUT_M / (2 * wide)))
    back = math.acos(min(max(near + 1 - math.cos(out), -1.0), 1.0))
    turns = np.array([-out, math.pi + out + back, -back])
    bends = [np.full(max(2, math.ceil(abs(a) * wide / STEP_M)), a) for a in turns if abs(a) > 1e-6]
    steps = np.concatenate([a / len(a) for a in bends])
    lengths = np.abs(steps) * wide
    heading = start_rad + np.cumsum(steps) - steps / 2
    way = np.cumsum(np.column_stack((np.cos(heading), np.sin(heading))) * lengths[:, None], axis=0)
    on = max(2 * wide * (math.sin(back) - math.sin(out)), 0.0) * np.array([c, s])  # it comes in as far behind
    arcs = np.vstack((start, start + on + np.vstack((np.zeros(2), way)) if on.any() else start + way))
    return np.vstack((arcs, end)) if (end - arcs[-1]) @ np.array([c, s]) < -1.0 else arcs


def end_heading(points: Floats, *, at_end: bool, over_m: float = 8.0) -> float:
    """Heading of the first or last few metres of a polyline."""
    length = float(arc_lengths(points)[-1])
    span = (max(length - over_m, 0.0), length) if at_end else (0.0, min(over_m, length))
    a, b = resample(points, span)
    return math.atan2(b[1] - a[1], b[0] - a[0])


def _rounded(points: Floats, half: Floats) -> Floats:
    """Moving mean over `half` points to either side, three times; the ends stay (the window narrows towards them).

    Windows may be broken numbers, so that one that varies along the line leaves no steps in it.
    """
    n = len(points)
    index = np.arange(n)
    reach = np.minimum(half, np.minimum(index, index[::-1]).astype(np.float64))
    whole = reach.astype(int)
    part = (reach - whole)[:, None]
    low, high = np.maximum(index - whole - 1, 0), np.minimum(index + whole + 1, n - 1)
    for _ in range(3):
        total = np.vstack((np.zeros(2), np.cumsum(points, axis=0)))
        inner = total[index + whole + 1] - total[index - whole]
        points = (inner + part * (points[low] + points[high])) / (2 * reach + 1)[:, None]
    return points


def _tangents(points: Floats) -> Floats:
    """(n,) unwrapped heading of the line at each point, from the chord between its neighbors."""
    ahead = np.vstack((points[1:], 2 * points[-1] - points[-2]))
    behind = np.vstack((2 * points[0] - points[1], points[:-1]))
    unit = _unit(ahead - points) + _unit(points - behind)
    return _unwrapped(np.arctan2(unit[:, 1], unit[:, 0]))


def _unwrapped(angle: Floats) -> Floats:
    """As np.unwrap, in a third of the time for a line that never points west."""
    return angle if (np.abs(np.diff(angle)) < math.pi).all() else np.unwrap(angle)


def _unit(vectors: Floats) -> Floats:
    norm = np.hypot(vectors[..., 0], vectors[..., 1])[..., None]
    unit: Floats = vectors / np.maximum(norm, 1e-9)
    return unit
