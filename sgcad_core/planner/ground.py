"""What the ground does to a body that slides or rolls on it: friction against its way and against its turning.

Plain floats, one step of time after another; `run_out` does the same for many ways of running out at once. Knows one
body; no touches, no clock but the time that is left. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.impact import Body

_SLIP_LEVER = 0.25
"""Mean lever of ground friction against turning, as a share of the box's diagonal."""
_STIFF_RAD = 0.14
"""Slip at which rolling tires give all their side force (R. Rajamani, Vehicle Dynamics and Control, ch. 2)."""
_STEERED_SHARE = 0.7
"""Of the side force, for a steered bend; the rest is for what it slides besides."""
_STEERS_MPS = 1.0
"""Slower wheels steer nothing worth telling."""


class Drag(NamedTuple):
    """Deceleration along and across the box by tires, brakes and ground, m/s2."""

    along: float
    across: float


class RunOut(NamedTuple):
    """What wheels and driver do once a body runs out from a blow: all within what a damaged car can do."""

    from_s: float
    """World time from which on it counts; before that the body slides with its drag."""
    along_mps2: float
    bend_per_m: float = 0.0
    """Curvature of the steered way, left positive."""
    turning: float = 1.0
    """Resistance to turning, as a share of that of four locked wheels."""


class Released(NamedTuple):
    """A body at the moment from which its ways of running out are told: place, heading, velocity, spin; its mass."""

    body: Body
    at_s: float


def slow(one: Body, drag: Drag, step: float, left_s: float, run: RunOut | None = None) -> None:
    """Ground friction over a step; more of it where the body would not stand in the time that is left."""
    if one.stands:
        return
    speed = one.speed
    target = 0.0
    if speed > 0.0:
        c, s = math.cos(one.heading), math.sin(one.heading)
        along, across = (one.vx * c + one.vy * s) / speed, (one.vy * c - one.vx * s) / speed
        way = run.along_mps2 if run else drag.along
        side = across if run is None else max(-1.0, min(1.0, across / _STIFF_RAD))
        brake = math.hypot(way * along, drag.across * across)
        more = max(1.0, speed / (left_s * max(brake, 1e-6)))
        if brake * more * step >= speed:
            one.vx = one.vy = 0.0
        else:
            ahead, left = way * along * more * step, drag.across * side * (more if run is None else 1.0) * step
            if run:
                left = math.copysign(min(abs(left), abs(across) * speed), left)
            one.vx -= ahead * c - left * s
            one.vy -= ahead * s + left * c
            if run and speed > _STEERS_MPS:
                target = _steered(run.bend_per_m, speed, drag.across) * along * speed
    turning = _turning_mps2(one, drag) * (run.turning if run else 1.0)
    turning = max(turning, abs(one.spin - target) / left_s) * step
    off = one.spin - target
    one.spin = target if abs(off) <= turning else one.spin - math.copysign(turning, off)


def _steered(bend: float, speed: float, across_mps2: float) -> float:
    """The curvature that tires can give at a speed."""
    most = _STEERED_SHARE * across_mps2 / max(speed, 1.0) ** 2
    return max(-most, min(most, bend))


def _turning_mps2(one: Body, drag: Drag) -> float:
    """Angular deceleration of a body on locked wheels, rad/s2."""
    return one.inverse_inertia / one.inverse_mass * _SLIP_LEVER * 2 * one.radius * drag.across


def run_out(released: Released, drag: Drag, runs: Sequence[RunOut], end_s: float, step: float) -> Floats:
    """(m, n, 3) poses of a body that runs out in n ways, a step apart, from its release to rest at `end_s`."""
    one = released.body
    way, bend, turning = (np.array([getattr(r, name) for r in runs]) for name in RunOut._fields[1:])
    turning = _turning_mps2(one, drag) * turning
    x, y, heading, vx, vy, spin = (np.full(len(runs), v) for v in (one.x, one.y, one.heading, one.vx, one.vy, one.spin))
    found = []
    for k in range(max(round((end_s - released.at_s) / step), 1)):
        left_s = max(end_s - released.at_s - k * step, 0.1)
        x, y, heading = x + vx * step, y + vy * step, heading + spin * step
        c, s, speed = np.cos(heading), np.sin(heading), np.hypot(vx, vy)
        moving = np.maximum(speed, 1e-9)
        along, across = (vx * c + vy * s) / moving, (vy * c - vx * s) / moving
        side = np.clip(across / _STIFF_RAD, -1.0, 1.0)
        brake = np.hypot(way * along, drag.across * across)
        more = np.maximum(1.0, speed / (left_s * np.maximum(brake, 1e-6)))
        stands = brake * more * step >= speed
        ahead = way * along * more * step
        left = np.sign(side) * np.minimum(np.abs(drag.across * side * step), np.abs(across) * speed)
        vx = np.where(stands, 0.0, vx - ahead * c + left * s)
        vy = np.where(stands, 0.0, vy - ahead * s - left * c)
        most = _STEERED_SHARE * drag.across / np.maximum(speed, 1.0) ** 2
        steers = ~stands & (speed > _STEERS_MPS)
        target = np.where(steers, np.clip(bend, -most, most) * along * speed, 0.0)
        off = spin - target
        by = np.maximum(turning, np.abs(off) / left_s) * step
        spin = np.where(np.abs(off) <= by, target, spin - np.sign(off) * by)
        found.append(np.column_stack((x, y, heading)))
    return np.array(found)
