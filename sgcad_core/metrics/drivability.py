"""Whether a vehicle can drive a motion: lateral acceleration, yaw rate, slip angle, and overlaps of boxes.

Pure functions on trajectories. Knows sizes and the surface; no declared contact and no report.

The box of a vehicle rolls without slip at its rear axle (the kinematic bicycle model: R. Rajamani, Vehicle Dynamics and
Control, ch. 2.2), which lies `REAR_AXLE` of its length behind its center, as in the .xosc.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from sgcad_core.case.records import Record, Trajectory
from sgcad_core.geometry.plane import Floats, Size, box_gaps, first_overlap, wrap_angle
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.records.specs import Surface

STEP_S = 0.05
REAR_AXLE = 0.3
"""From the center of a box to its rear axle, as a share of its length."""
_MOVING_MPS = 1.0
"""A slower box has no direction of travel."""


class DrivingPeaks(Record):
    """The peaks of one motion: lateral acceleration (m/s2), yaw rate (rad/s) and slip at the rear axle (rad)."""

    lateral_mps2: float
    yaw_radps: float
    slip_rad: float

    def excesses(self, surface: Surface | None) -> tuple[str, ...]:
        """The exceeded limits, in words with value and limit; empty where a vehicle can drive it."""
        friction = DRIVING.friction_mps2(surface)
        rows = (
            ("lateral acceleration", self.lateral_mps2, friction, "m/s2"),
            ("yaw rate", self.yaw_radps, DRIVING.yaw_radps, "rad/s"),
            ("slip angle", float(np.degrees(self.slip_rad)), DRIVING.slip_deg, "degrees"),
        )
        return tuple(f"{what} {value:.1f} of {most:g} {unit}" for what, value, most, unit in rows if value > most)


def driving_peaks(
    motion: Trajectory, length_m: float, until: int | None = None, *, backing: bool = False
) -> DrivingPeaks:
    """The peaks before the sample `until` (the first touch, which falls between that sample and the one before).

    `backing`: the box travels against its heading, which the slip allows for.
    """
    x, y, heading = (np.asarray(c, dtype=float)[:until] for c in (motion.x_m, motion.y_m, motion.heading_rad))
    if len(x) < 3:
        return DrivingPeaks(lateral_mps2=0.0, yaw_radps=0.0, slip_rad=0.0)
    heading = np.unwrap(heading)
    center = np.column_stack((x, y))
    ahead = np.column_stack((np.cos(heading), np.sin(heading)))
    yaw = float(np.abs(np.diff(heading)).max()) / STEP_S
    slip = _slip(center - REAR_AXLE * length_m * ahead, heading, backing=backing)
    return DrivingPeaks(lateral_mps2=_lateral(center), yaw_radps=yaw, slip_rad=slip)


def _lateral(center: Floats) -> float:
    """Peak acceleration across the direction of travel, from second differences of the positions."""
    along = center[2:] - center[:-2]
    gained = (center[2:] - 2 * center[1:-1] + center[:-2]) / STEP_S**2
    way = np.hypot(*along.T)
    across = np.abs(along[:, 0] * gained[:, 1] - along[:, 1] * gained[:, 0]) / np.maximum(way, 1e-9)
    return float(np.where(way > 2 * STEP_S * 0.1, across, 0.0).max())


def _slip(axle: Floats, heading: Floats, *, backing: bool) -> float:
    step = np.diff(axle, axis=0)
    middle = (heading[1:] + heading[:-1]) / 2 + (np.pi if backing else 0.0)
    slip = np.abs(wrap_angle(np.arctan2(step[:, 1], step[:, 0]) - middle))
    return float(np.where(np.hypot(*step.T) > _MOVING_MPS * STEP_S, slip, 0.0).max())


# ------------------------------------------------------------------ overlaps
def first_touches(motions: Sequence[Trajectory], sizes: Mapping[str, Size], *, at_start: bool = True) -> dict[str, int]:
    """Actor -> the sample of its first overlap with any other; without one it is left out, and a pair that overlaps
    from the start too unless `at_start`."""
    found: dict[str, int] = {}
    for a, b in combinations(motions, 2):
        hit = first_overlap(a.pose, sizes[a.actor], b.pose, sizes[b.actor])
        if hit is not None and (hit > 0 or at_start):
            found |= {name: min(found.get(name, hit), hit) for name in (a.actor, b.actor)}
    return found


def deepest_overlap(
    motions: Sequence[Trajectory], sizes: Mapping[str, Size], *, at_rest: bool = False
) -> tuple[float, str]:
    """Deepest overlap of any two boxes over all samples (`at_rest`: in the last one), metres, and their names.

    The depth is the least distance that separates the boxes. Pairs that overlap in the first sample are skipped: parts
    of one object.
    """
    worst, who = 0.0, ""
    for a, b in combinations(motions, 2):
        gap = gaps(a, b, sizes)
        depth = 0.0 if gap[0] <= 0 else -float(gap[-1] if at_rest else gap.min())
        worst, who = (depth, f"{a.actor} and {b.actor}") if depth > worst else (worst, who)
    return worst, who


def gaps(a: Trajectory, b: Trajectory, sizes: Mapping[str, Size]) -> Floats:
    """Separation of two moving boxes at each sample, metres; negative where they overlap."""
    return box_gaps(a.pose, sizes[a.actor], b.pose, sizes[b.actor])
