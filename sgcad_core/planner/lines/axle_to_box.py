"""From the line of a rear axle to the box of a vehicle, and lines that steer aside before a contact.

The kinematic bicycle model (R. Rajamani, Vehicle Dynamics and Control, ch. 2.2): the rear axle moves where the vehicle
points, so heading and yaw follow from its line alone. Knows paths; no time, no roads.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.metrics.drivability import REAR_AXLE
from sgcad_core.planner.lines.path import Path

_SLIP_RAD = math.radians(9.3)
"""Slip allowed at the center of the box, and at most at the rear axle: under the 10 degrees that count as slip."""
_TIGHTEST_M = 5.0
"""Radius of the rear axle's line in the tightest turn of a short vehicle."""
_EASY_M = 9.0
"""Radius beyond which turns are not widened."""
_RISE = 0.25
"""Share of a bend over which it grows, and over which it ends."""


def tightest(length_m: float) -> float:
    """The tightest bend (1/m) of the rear axle's line: long boxes need room.

    A rigid box represents vehicles that bend in the middle or have several rear axles: slip up to `_SLIP_RAD` at its
    rear axle is allowed for those.
    """
    return min(1 / _TIGHTEST_M, 2 * math.tan(_SLIP_RAD) / (REAR_AXLE * length_m))


def easiest(length_m: float) -> float:
    """The tightest bend (1/m) without visible slip at rear axle and center; no wider than needed."""
    return min(max(math.tan(_SLIP_RAD) / (REAR_AXLE * length_m), 1 / _EASY_M), tightest(length_m))


def box_path(line: Path, length_m: float, *, backing: bool = False) -> Path:
    """The path of the box's center where its rear axle follows a line; stations are those of the center.

    On a bend that is too tight for the box the point that does not slip lies between center and rear axle.
    """
    bend = float(np.abs(line.curvature).max())
    behind = min(REAR_AXLE * length_m, math.tan(_SLIP_RAD) / max(bend, 1e-6))
    way = -1.0 if backing else 1.0
    angle = line.tangents
    ahead = np.column_stack((np.cos(angle), np.sin(angle)))
    center = line.points + way * behind * ahead
    return Path(center, line.s_m + way * behind, angle + (math.pi if backing else 0.0))


def bent_before(line: Path, angle_rad: float, place_m: float, radius_m: float) -> Path:
    """The line bent by an angle before a place, and straight on from there in the new direction."""
    at = line.lengths
    long = abs(angle_rad) * radius_m / (1 - _RISE)
    end = float(np.interp(place_m, line.s_m, at)) - 1.5
    x = np.clip((at - end + long) / max(long, 1e-6), 0.0, 1.0)
    turned = angle_rad * eased(x, _RISE)
    step = np.diff(line.points, axis=0)
    middle = (turned[1:] + turned[:-1]) / 2
    c, s = np.cos(middle), np.sin(middle)
    way = np.column_stack((step[:, 0] * c - step[:, 1] * s, step[:, 0] * s + step[:, 1] * c))
    points = np.vstack((line.points[0], line.points[0] + np.cumsum(way, axis=0)))
    return replace(line, points=points, heading_rad=line.heading_rad + turned)


def offset(line: Path, other: Path, place_m: float) -> tuple[float, float]:
    """Offset of another line ahead and to the left at the same station, metres."""
    ahead, left = offsets(line, other, np.array([place_m]))
    return float(ahead[0]), float(left[0])


def offsets(line: Path, other: Path, places_m: Floats) -> tuple[Floats, Floats]:
    """As `offset`, at (n,) stations."""
    pose = line.poses(places_m)
    dx, dy = (other.poses(places_m)[:, :2] - pose[:, :2]).T
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    return dx * c + dy * s, dy * c - dx * s


def eased(x: Floats, rise: float) -> Floats:
    """The integral of a trapezoid over [0, 1] at (n,) shares: a rate that grows over a share `rise`, holds, and falls
    over the same share; 0 before, 1 behind."""
    at, hold = np.clip(x, 0.0, 1.0), 1 - 2 * rise
    first = np.minimum(at, rise)
    middle = np.clip(at - rise, 0.0, hold)
    last = np.clip(at - rise - hold, 0.0, rise)
    grown: Floats = (first**2 / (2 * rise) + middle + last - last**2 / (2 * rise)) / (1 - rise)
    return grown
