"""Whether a vehicle has left the road where it touches something, and on which side.

Compares its center and the middle of its front with the lanes of a network (`lane_places`). Knows no report.
"""

from __future__ import annotations

import math

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.metrics.labels.course_labels import POINT_DEG
from sgcad_core.metrics.lane_places import Place, lane_heading, lane_steps
from sgcad_core.metrics.rest_error import compass_rad
from sgcad_core.records.course import DepartureSide, Hand
from sgcad_core.roads.lane_graph import LaneGraph

_ALONG = math.sin(math.radians(20.0))
"""Sine of the angle to its way below which a compass word tells no side of it."""
_OFF: frozenset[Place] = frozenset({"off", "beside"})
_ON: frozenset[Place] = frozenset({"lane", "center_lane"})


def hand_of(side: DepartureSide, heading_rad: float) -> Hand | None:
    """The side as a hand for a vehicle on a heading (radians counter-clockwise from east).

    None where it tells none: either side, or a compass word along its way.
    """
    if side == "left" or side == "right" or side == "either":
        return None if side == "either" else side
    across = math.sin(compass_rad(POINT_DEG[side]) - heading_rad)
    return None if abs(across) <= _ALONG else "left" if across > 0 else "right"


def left_road(graph: LaneGraph, poses: Floats, length_m: float) -> Hand | None:
    """The side on which a vehicle is off the lanes at the last of its (n, 3) poses, as seen along its last lane.

    None while it is on them, or where it never was on a lane.
    """
    front = poses[-1:].copy()
    front[0, :2] += length_m / 2 * np.array([np.cos(front[0, 2]), np.sin(front[0, 2])])
    places = lane_steps(graph, poses).places
    seen = next((at for at in (poses[-1], front[0]) if lane_steps(graph, at[None]).places[0] in _OFF), None)
    last = next((k for k in range(len(places) - 1, -1, -1) if places[k] in _ON), None)
    if seen is None or last is None:
        return None
    along = lane_heading(graph, poses[last])
    way = along if along is not None else float(poses[last, 2])
    east, north = seen[:2] - poses[last, :2]
    return "left" if np.cos(way) * north - np.sin(way) * east > 0 else "right"
