"""How ill a place on a path fits an actor's maneuver: what the search for an encounter pays for it.

Knows one actor, its path and its drift; no time and no other actor.
"""

from __future__ import annotations

import math

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.path import Path
from sgcad_core.planner.place import TURNING
from sgcad_core.planner.role import Drift, Role, line_m

_ZONE_M = 12.0
_DRIFTING = {"crossing_centerline", "overtaking", "lane_change_left", "lane_change_right", "merge",
             "departing_road_left", "departing_road_right"}  # fmt: skip


def misfit(role: Role, path: Path, drift: Drift, begins_m: float) -> Floats:
    """(n,) how ill an encounter at each point of a path shows the maneuver and fits the meeting place."""
    place = role.place.station_m
    penalty = outside(path.s_m, place - _ZONE_M, place + _ZONE_M, 0.02)
    turned = path.heading_rad - np.interp(begins_m - 5.0, path.s_m, path.heading_rad)
    maneuver = role.actor.maneuver
    if maneuver in TURNING:
        way = -1.0 if maneuver == "turn_right" else 1.0
        penalty = penalty + 2.0 * (way * turned < math.radians(16))
    elif maneuver == "straight":
        penalty = penalty + 2.0 * (np.abs(turned) > math.radians(28))
    if maneuver in _DRIFTING and drift.left_m:
        penalty = penalty + 0.5 * (path.s_m < drift.end_m - 0.8 * drift.length_m)
    return penalty


def outside(s_m: Floats, low: float, high: float, per_m: float) -> Floats:
    """(n,) a cost per metre outside a span of stations."""
    return per_m * (np.maximum(low - s_m, 0.0) + np.maximum(s_m - high, 0.0))


def waiting_zone(role: Role) -> tuple[float, float]:
    """Stations between which a standing actor plausibly waits."""
    line, place = line_m(role), role.place.station_m
    return (line - 10.0, line + 0.5) if role.course.passages else (place - 20.0, place + 20.0)
