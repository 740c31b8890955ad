"""What the ground does to a body that slides on it: friction against its way and against its turning.

Plain floats, one step of time after another. Knows one body; no touches, no clock but the time that is left. SI units.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sgcad_core.planner.boxes import radius
from sgcad_core.planner.impact import Body

_SLIP_LEVER = 0.25
"""Mean lever of ground friction against turning, as a share of the box's diagonal."""


class Drag(NamedTuple):
    """Deceleration along and across the box by tires, brakes and ground, m/s2."""

    along: float
    across: float


def slow(one: Body, drag: Drag, step: float, left_s: float) -> None:
    """Ground friction over a step; more of it where the body would not stand in the time that is left."""
    speed = one.speed
    if speed > 0.0:
        c, s = math.cos(one.heading), math.sin(one.heading)
        along, across = (one.vx * c + one.vy * s) / speed, (one.vy * c - one.vx * s) / speed
        brake = math.hypot(drag.along * along, drag.across * across)
        more = max(1.0, speed / (left_s * max(brake, 1e-6)))
        if brake * more * step >= speed:
            one.vx = one.vy = 0.0
        else:
            ahead, left = drag.along * along * more * step, drag.across * across * more * step
            one.vx -= ahead * c - left * s
            one.vy -= ahead * s + left * c
    turning = one.inverse_inertia / one.inverse_mass * _SLIP_LEVER * 2 * radius(one) * drag.across
    turning = max(turning, abs(one.spin) / left_s) * step
    one.spin = 0.0 if abs(one.spin) <= turning else one.spin - math.copysign(turning, one.spin)
