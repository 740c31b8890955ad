"""Other lanes of the same road that run parallel to an actor's lane up to the contact.

Knows the lane graph and one motion; no report.
"""

from __future__ import annotations

import math

import numpy as np

from sgcad_core.geometry.plane import Floats, arc_lengths, resample
from sgcad_core.roads.lane_graph import Edge, LaneGraph

_EVERY_M = 4.0
_IN_LANE_M, _ALONG_RAD = 1.2, math.radians(25)
"""Largest offset from a lane's center and direction of an actor in that lane."""
_STRAIGHT_RAD = math.radians(20)
"""A larger turn before the contact excludes other lanes: they would be another turn."""
_KNOWN = 0.5
"""Share of the way on which the lane must be known (junctions have no lanes)."""
_EVEN_M = 0.6
"""Variation of the distance between parallel lanes."""


def lane_offsets(graph: LaneGraph, pose: Floats) -> dict[int, float]:
    """Other car lanes along (n, 3) poses: lanes to the left (negative: right) -> metres to the left.

    Empty where the actor turns, or is in no lane for most of the way; while it stands its place counts.
    """
    some = _sampled(pose)
    if abs(some[-1, 2] - some[0, 2]) > _STRAIGHT_RAD:
        return {}
    seen = [found for row in some if (found := _at(graph, row)) is not None]
    if len(seen) < _KNOWN * len(some):
        return {}
    common = set.intersection(*(set(found) for found in seen)) - {0}
    aside = {d: np.array([found[d] - found[0] for found in seen]) for d in sorted(common)}
    return {d: round(float(a.mean()), 3) for d, a in aside.items() if np.ptp(a) <= _EVEN_M}


def _sampled(pose: Floats) -> Floats:
    """(m, 3) poses some metres apart, headings unwrapped."""
    table = pose.copy()
    table[:, 2] = np.unwrap(table[:, 2])
    along = arc_lengths(table[:, :2])
    at = np.append(np.arange(0.0, float(along[-1]), _EVERY_M), along[-1])
    return np.column_stack([np.interp(at, along, table[:, i]) for i in range(3)])


def _at(graph: LaneGraph, row: Floats) -> dict[int, float] | None:
    """Lanes of the edge at a pose: steps to the left of the own one -> metres to the left of the actor."""
    found = [own for edge in graph.edges.values() if (own := _on(edge, row)) is not None]
    return min(found, key=lambda lanes: abs(lanes[0]), default=None)


def _on(edge: Edge, row: Floats) -> dict[int, float] | None:
    """The same for one edge; None where the actor is in none of its lanes."""
    asides = {lane.index: aside for lane in edge.car_lanes if (aside := _aside(lane.shape, row)) is not None}
    if not asides:
        return None
    own = min(asides, key=lambda index: abs(asides[index]))
    return {index - own: aside for index, aside in asides.items()} if abs(asides[own]) <= _IN_LANE_M else None


def _aside(shape: Floats, row: Floats) -> float | None:
    """Metres from the actor to a lane's center, positive: it is to the left; None where the lane does not pass here."""
    start, step = shape[:-1], np.diff(shape, axis=0)
    length = np.maximum((step**2).sum(axis=1), 1e-12)
    share = ((row[:2] - start) * step).sum(axis=1) / length
    near = np.clip(share, 0.0, 1.0)
    away = np.hypot(*(start + near[:, None] * step - row[:2]).T)
    k = int(away.argmin())
    course = math.atan2(step[k, 1], step[k, 0])
    beyond = (share[k] < -0.01 and k == 0) or (share[k] > 1.01 and k == len(step) - 1)
    if beyond or abs(math.remainder(course - float(row[2]), 2 * math.pi)) > _ALONG_RAD:
        return None
    at = resample(shape, [float(arc_lengths(shape)[k] + near[k] * math.sqrt(length[k]))])[0] - row[:2]
    return float(-at[0] * math.sin(row[2]) + at[1] * math.cos(row[2]))
