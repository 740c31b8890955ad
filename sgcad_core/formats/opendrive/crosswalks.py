"""Crosswalks of a map: the areas of SUMO's crossings, told by the streets that they lead over. Metres; no XML."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import count
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.opendrive.reference import pose_at
from sgcad_core.formats.opendrive.streets import Street
from sgcad_core.geometry.plane import Floats, parallel_polyline
from sgcad_core.roads.lane_graph import LaneGraph


class Crosswalk(NamedTuple):
    """A crosswalk over a street; ids are those of objects.

    `corners`: (n, 2) around it, along and to the left of the street's reference line where that ends (`s_m`).
    """

    id: str
    road: str
    s_m: float
    corners: Floats


def crosswalks_of(graph: LaneGraph, roads: Sequence[Street], first_id: int) -> tuple[Crosswalk, ...]:
    """All crosswalks, ids counted from `first_id`."""
    ids = map(str, count(first_id))
    return tuple(walk for street in roads for walk in _over(street, graph, ids))


def _over(street: Street, graph: LaneGraph, ids: Iterator[str]) -> Iterator[Crosswalk]:
    edges = {edge.id for edge in street.edges}
    for crossing in graph.crossings:
        if edges & set(crossing.edges):
            s_m = street.length_m if crossing.node == street.forward.to_node else 0.0
            half = crossing.width_m / 2
            left, right = (parallel_polyline(crossing.shape, side) for side in (half, -half))
            yield Crosswalk(next(ids), street.id, s_m, _local(street, s_m, np.vstack((left, right[::-1]))))


def _local(street: Street, s_m: float, points: Floats) -> Floats:
    """Points seen from the reference line at a station: along it and to its left."""
    x, y, heading = pose_at(street.line, s_m)
    c, s = math.cos(heading), math.sin(heading)
    off = points - np.array([x, y])
    seen: Floats = np.column_stack((off[:, 0] * c + off[:, 1] * s, off[:, 1] * c - off[:, 0] * s))
    return seen
