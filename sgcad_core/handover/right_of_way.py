"""Right of way and speed limit on the way of the ego.

Right of way is the SUMO link state of the connection that the way takes (M, m: has or lacks it; s: stop; w: all-way
stop; =: equal). A net has no signal phases; at signals the report's driver is assumed to have had no red. Knows the
lane graph and a way.
"""

from __future__ import annotations

import numpy as np

from sgcad_core.case.driver_io import Way
from sgcad_core.geometry.distances import distance_to
from sgcad_core.geometry.plane import Floats
from sgcad_core.roads.lane_graph import Connection, LaneGraph

_NEAR_M = 2.5
_GIVES_WAY = frozenset("msw=")
_LINE_M = 1.0
"""From the front to the end of the lane."""
_STEP_M = 1.0


def give_way_station(graph: LaneGraph, way: Way, length_m: float) -> float | None:
    """Station of the box center before the first connection of the way that lacks the right of way; None: all have it.

    A way that begins inside or behind the junction has none before it.
    """
    points = way.poses_at(np.arange(0.0, float(way.s_m[-1]) + _STEP_M, _STEP_M))[:, :2]
    found = [at for c in graph.connections if c.state in _GIVES_WAY and (at := _entered(c, points)) is not None]
    return max(min(found) * _STEP_M - length_m / 2 - _LINE_M, 0.0) if found else None


def _entered(connection: Connection, points: Floats) -> int | None:
    """The sample at which the way enters a connection; None where it does not follow it."""
    line = connection.via_shape
    if len(line) < 2 or float(np.hypot(*(line[-1] - line[0]))) < 2.0:
        return None
    start, end = (np.hypot(*(points - line[i]).T) for i in (0, -1))
    first, last = int(start.argmin()), int(end.argmin())
    if start[first] > _NEAR_M or end[last] > _NEAR_M or last <= first:
        return None
    followed = distance_to(line, points[first : last + 1]).max() <= _NEAR_M
    return first if followed else None


def limit_mps(graph: LaneGraph, way: Way) -> float | None:
    """The speed limit of the lane at the start of the way, m/s; None without a lane."""
    here = way.pose[:1, :2]
    lanes = [lane for edge in graph.edges.values() for lane in edge.lanes]
    found = [(float(distance_to(lane.shape, here)[0]), lane.speed_mps) for lane in lanes]
    return min(found)[1] if found else None
