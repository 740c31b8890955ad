"""What the place of a touch along the sides of two bodies costs: its lever about them, and the told part of a side.

Knows motions; no roads and no maneuvers.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import SIDES, Floats, overlap_centers
from sgcad_core.planner.aftermath.impact import FRICTION
from sgcad_core.planner.motion import STEP_S, WINDOW_S, Motion
from sgcad_core.records.specs import Area

Ints = NDArray[np.int_]
Parts = tuple[Area | None, Area | None]
"""Of two sides the ends at which they touch; None: anywhere."""
_SPIN_COST, _GLANCE_COST, _CLEAR_LEVER_M = 0.4, 0.15, 0.6
"""Lever at which an impact in the stated sense of rotation costs nothing, and in the opposite sense the full cost."""
PART_COST, _OUTER = 0.6, 0.5
"""Cost of a contact at the other half of a side than told, and the share of half the side from which on it is there."""


class Touches(NamedTuple):
    """First overlaps, one a shift: grid indices (fractional) of both motions where they are DEPTH_M deep."""

    key: Ints
    first: Floats
    second: Floats


def own_s(index: Floats) -> Floats:
    """Own times at fractional indices of the window's grid."""
    return index * STEP_S + WINDOW_S[0]


def against_spin(levers: tuple[Floats, Floats], spins: tuple[float, float], glances: bool) -> Floats:
    """Cost of impacts that turn a body in another sense than stated, by their lever about its center."""
    found = np.zeros(len(levers[0]))
    for lever, spin in zip(levers, spins, strict=True):
        found += abs(spin) * _SPIN_COST * np.clip((_CLEAR_LEVER_M - spin * lever) / (2 * _CLEAR_LEVER_M), 0.0, 1.0)
        if glances and not spin:
            found += _GLANCE_COST * np.clip(1 - np.abs(lever) / _CLEAR_LEVER_M, 0.0, 1.0)
    return found


def off_part(motions: tuple[Motion, Motion], touches: Touches, parts: Parts) -> Floats:
    """Cost of contacts away from the told parts of the sides: none in the outer quarter of a side there."""
    first, second = motions
    p, q = first.poses(own_s(touches.first)), second.poses(own_s(touches.second))
    center = overlap_centers(p, first.size, q, second.size)
    found = np.zeros(len(center))
    for part, poses, size in zip(parts, (p, q), (first.size, second.size), strict=True):
        if part is not None:
            out = poses[:, 2] + SIDES.index(part) * math.pi / 2
            arm = center - poses[:, :2]
            half_m = size[SIDES.index(part) % 2] / 2
            share = (arm[:, 0] * np.cos(out) + arm[:, 1] * np.sin(out)) / half_m
            found += PART_COST * np.clip(_OUTER - share, 0.0, 1.0)
    return found


def blow_levers(first: Motion, second: Motion, touches: Touches, sides: tuple[Ints, Ints]) -> tuple[Floats, Floats]:
    """Levers of the impact about both centers, metres, counter-clockwise positive: friction bounds its direction."""
    i, j = own_s(touches.first), own_s(touches.second)
    p, q = first.poses(i), second.poses(j)
    center = overlap_centers(p, first.size, q, second.size)
    push = _velocity(first, i) - _velocity(second, j)
    flank_of_second = (sides[1] % 2 == 1) & (sides[0] % 2 == 0)
    out = np.where(flank_of_second, q[:, 2] + sides[1] * math.pi / 2 + math.pi, p[:, 2] + sides[0] * math.pi / 2)
    way = np.arctan2(push[:, 1], push[:, 0])
    most = math.atan(FRICTION)
    way = out + np.clip(np.mod(way - out + math.pi, 2 * math.pi) - math.pi, -most, most)
    arms = [center - pose[:, :2] for pose in (p, q)]
    turning = [arm[:, 0] * np.sin(way) - arm[:, 1] * np.cos(way) for arm in arms]
    return -turning[0], turning[1]


def _velocity(motion: Motion, own_s: Floats) -> Floats:
    """(n, 2) m/s at own times."""
    if motion.standing:
        return np.zeros((len(own_s), 2))
    velocity: Floats = (motion.poses(own_s)[:, :2] - motion.poses(own_s - STEP_S)[:, :2]) / STEP_S
    return velocity
