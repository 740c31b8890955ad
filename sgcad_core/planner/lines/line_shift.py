"""Changes of line laid on the line of a course. Knows drifts and paths; no actor, no time."""

from __future__ import annotations

import math

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.actor_plan import Drift
from sgcad_core.planner.lines.path import Path, ramp


def line_of(base: Path, drift: Drift, place_m: float) -> Path:
    """The line of a course with a drift on it; `place_m`: the station at which one along the heading is meant."""
    if drift.ahead_m:
        heading = float(base.poses([place_m])[0, 2])
        c, s = math.cos(heading), math.sin(heading)
        by = np.array([drift.ahead_m * c - drift.left_m * s, drift.ahead_m * s + drift.left_m * c])
        return base.displaced(ramp(base.s_m, drift.end_m - drift.length_m, drift.length_m)[:, None] * by)
    return base.moved(profile(base.s_m, drift)) if drift.left_m or drift.before_m else base


def profile(s_m: Floats, drift: Drift) -> Floats:
    """(n,) metres to the left of its line that a drift has at stations."""
    rise = ramp(s_m, drift.end_m - drift.length_m, drift.length_m)
    if drift.back:
        rise = rise - ramp(s_m, drift.end_m, drift.length_m)
    profile: Floats = drift.before_m + drift.left_m * rise
    return profile
