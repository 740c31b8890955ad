"""A way over the ground: a smooth line with a station and a heading at each of its points.

Plane geometry only; knows neither roads nor time. The station is the arc length of the line as it was
first drawn; a line moved sideways keeps its stations, so that places on it keep their names. Metres,
radians; x east, y north.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sgcad_core.geometry.plane import Floats, arc_lengths, resample

STEP_M = 0.5
EXTENSION_M = 320.0
"""Straight run before and behind the drawn line: 9 s at 80 mph."""
_EXTENSION_STEP_M = 4.0


@dataclass(frozen=True, eq=False)
class Path:
    """Points (n, 2), their stations (n,) increasing, and headings (n,) of a box that follows, unwrapped."""

    points: Floats
    s_m: Floats
    heading_rad: Floats

    def poses(self, s_m: ArrayLike) -> Floats:
        """(m, 3) x, y, heading at stations, clamped to the ends."""
        columns = (self.points[:, 0], self.points[:, 1], self.heading_rad)
        return np.column_stack([np.interp(np.asarray(s_m, dtype=float), self.s_m, c) for c in columns])

    def lengths(self) -> Floats:
        """(n,) true distance along the line at each point, metres from its first."""
        return arc_lengths(self.points)

    def curvature(self) -> Floats:
        """(n,) curvature of the line (not of a box that skids on it), 1/m, left positive."""
        return np.gradient(self.tangents(), self.lengths())

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
        angle = _tangents(self.points)
        shifts = np.linspace(-half_m, half_m, 5)
        mean: Floats = np.mean([np.interp(self.s_m + d, self.s_m, angle) for d in shifts], axis=0)
        return mean

    def displaced(self, by_m: Floats) -> Path:
        """The line moved by (n, 2) metres east and north, point by point; stations stay."""
        points = self.points + by_m
        slip = self.heading_rad - _tangents(self.points)
        return replace(self, points=points, heading_rad=_tangents(points) + slip)

    def reversed(self) -> Path:
        """The line walked from its end; stations change sign, the box faces where it goes."""
        return Path(self.points[::-1], -self.s_m[::-1], self.heading_rad[::-1] + math.pi)

    def turned(self, angle_rad: ArrayLike) -> Path:
        """The same line with the box turned against it (backing, skidding)."""
        return replace(self, heading_rad=self.heading_rad + np.asarray(angle_rad, dtype=float))


def ramp(s_m: Floats, start_m: float, length_m: float) -> Floats:
    """Quintic step from 0 to 1 over [start, start + length]: no jump in position, slope or curvature."""
    x = np.clip((s_m - start_m) / max(length_m, 1e-6), 0.0, 1.0)
    rise: Floats = x**3 * (10 - 15 * x + 6 * x**2)
    return rise


def draw(points: Floats, smooth_m: float = 2.0) -> Path:
    """A path along a polyline (n, 2): corners rounded over about `smooth_m`, straight runs added at both ends.

    Station 0 is the first given point; the runs have negative and further stations.
    """
    length = float(arc_lengths(points)[-1])
    count = max(8, math.ceil(length / STEP_M))
    dense = _rounded(resample(points, np.linspace(0, length, count + 1)), max(1, round(smooth_m / STEP_M)))
    reach = np.arange(EXTENSION_M, 0, -_EXTENSION_STEP_M)
    first, last = _unit(dense[1] - dense[0]), _unit(dense[-1] - dense[-2])
    full = np.vstack((dense[0] - reach[:, None] * first, dense, dense[-1] + reach[::-1, None] * last))
    return Path(full, arc_lengths(full) - EXTENSION_M, _tangents(full))


def bezier(start: Floats, start_rad: float, end: Floats, end_rad: float, stretch: float = 0.42) -> Floats:
    """(m, 2) cubic arc between two points with given headings; tight U-turns swing out to stay drivable."""
    gap = float(np.hypot(*(end - start)))
    swing = abs(math.remainder(end_rad - start_rad, 2 * math.pi))
    reach = max(stretch * gap, 6.0 if swing > 2.4 else 0.0)
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


def end_heading(points: Floats, *, at_end: bool, over_m: float = 8.0) -> float:
    """Heading of the first or last few metres of a polyline."""
    length = float(arc_lengths(points)[-1])
    span = (max(length - over_m, 0.0), length) if at_end else (0.0, min(over_m, length))
    a, b = resample(points, span)
    return math.atan2(b[1] - a[1], b[0] - a[0])


def _rounded(points: Floats, half: int) -> Floats:
    """Moving mean over 2 half + 1 points, twice; the ends stay (the window narrows towards them)."""
    n = len(points)
    reach = np.minimum(half, np.minimum(np.arange(n), np.arange(n)[::-1]))
    for _ in range(2):
        total = np.vstack((np.zeros(2), np.cumsum(points, axis=0)))
        points = (total[np.arange(n) + reach + 1] - total[np.arange(n) - reach]) / (2 * reach + 1)[:, None]
    return points


def _tangents(points: Floats) -> Floats:
    """(n,) unwrapped heading of the line at each point, from the chord between its neighbors."""
    ahead = np.vstack((points[1:], 2 * points[-1] - points[-2]))
    behind = np.vstack((2 * points[0] - points[1], points[:-1]))
    unit = _unit(ahead - points) + _unit(points - behind)
    return np.unwrap(np.arctan2(unit[:, 1], unit[:, 0]))


def _unit(vectors: Floats) -> Floats:
    norm = np.hypot(vectors[..., 0], vectors[..., 1])[..., None]
    unit: Floats = vectors / np.maximum(norm, 1e-9)
    return unit
