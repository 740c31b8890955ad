"""Whether a vehicle has left the road where it touches something, and on which side.

Compares its center and the middle of its front with the lanes of a network (`lane_places`). Knows no report.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.metrics.lane_places import Place, lane_heading, lane_steps
from sgcad_core.roads.lane_graph import LaneGraph

_OFF: frozenset[Place] = frozenset({"off", "beside"})
_ON: frozenset[Place] = frozenset({"lane", "center_lane"})


def left_road(graph: LaneGraph, poses: Floats, length_m: float) -> Literal["left", "right"] | None:
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
