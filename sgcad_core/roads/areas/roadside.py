"""Ground beside roads that a report tells: curbs, ditches, embankments. Metres; taken from the lane graph.

An edge's parameter names them (`formats/sumo/parameters.py`), so that .xodr, player, picture and account agree. They
are shapes: a vehicle drives over them. Knows no crash.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np

from sgcad_core.geometry.distances import nearest_on
from sgcad_core.geometry.plane import arc_lengths, corners_of, offset_polyline, resample
from sgcad_core.records.specs import Compass, Ground, ToldRoad
from sgcad_core.roads.lane_graph import Edge, Floats, LaneGraph
from sgcad_core.roads.layout import bearing_rad

WITHIN_M: dict[Ground, tuple[float, float]] = {"curb": (0.0, 0.15), "ditch": (1.5, 3.5), "embankment": (1.5, 5.5)}
"""Where each kind begins and ends beyond the edge of the pavement: a curb is 6 in wide."""
_KEY = "ground"
"""The parameter of an edge (`formats/sumo/parameters.py`)."""
_STEP_M = 8.0
"""Longest piece of a border."""
_SIDEWALK = "sidewalk"
"""Type of a lane that lies beyond the curb."""


class Roadside(NamedTuple):
    """A strip of ground beside an edge: its kind, and its borders, (n, 2) along the edge, the one at the road first."""

    edge: str
    kind: Ground
    inner: Floats
    outer: Floats
    side: int
    """Side of the edge on which it lies: 1 left, -1 right."""

    @property
    def corners(self) -> Floats:
        """(2n, 2) around it."""
        return np.vstack((self.inner, self.outer[::-1]))

    def is_reached(self, poses: Floats, size: tuple[float, float]) -> bool:
        """Whether a box of a length and a width in (m, 3) poses reaches over the inner border."""
        points = corners_of(poses, size).reshape(-1, 2)
        near = nearest_on(self.inner, points)
        ends = 0.0, float(arc_lengths(self.inner)[-1])
        alongside = (near.station_m > ends[0]) & (near.station_m < ends[1])
        return bool((alongside & (near.left_m * self.side > 0.0)).any())


def roadsides(graph: LaneGraph) -> tuple[Roadside, ...]:
    """All strips of ground beside the roads of a network, cached."""
    if "roadsides" not in graph.derived:
        graph.derived["roadsides"] = tuple(strip for edge in graph.edges.values() for strip in _of_edge(edge))
    found: tuple[Roadside, ...] = graph.derived["roadsides"]
    return found


def ground_beside(told: ToldRoad, line: Floats, *, apart: bool) -> str:
    """What lies beside a direction of a road, as its edge's parameter; "" where nothing is told.

    `line`: (n, 2) in travel direction. `apart`: nothing paved lies on its left (a one-way road, or a median), where
    ground then lies too. Curbs lie on every side, the rest where the report tells it.
    """
    east, north = line[-1] - line[0]
    both = (-1, 1) if apart else (-1,)
    hands = [hand for hand in both if _looks_to(told.ground_side, -hand * north, hand * east)]
    words = [f"right:{kind}" for kind in told.ground if kind == "curb" or -1 in hands]
    words += [f"left:{kind}" for kind in told.ground if apart and (kind == "curb" or 1 in hands)]
    return " ".join(words)


def _looks_to(side: Compass | Literal[""], east: float, north: float) -> bool:
    """Whether a direction lies within 60 degrees of a compass side; any does where none is told."""
    if not side:
        return True
    angle = bearing_rad(side)
    return east * math.cos(angle) + north * math.sin(angle) >= 0.5 * math.hypot(east, north)


def _of_edge(edge: Edge) -> Iterator[Roadside]:
    """The strips that the edge's parameter names; words that name none are left out."""
    paved = [lane for lane in edge.lanes if lane.type != _SIDEWALK]
    for word in edge.parameters.get(_KEY, "").split():
        where, _, kind = word.partition(":")
        if kind not in WITHIN_M or not paved:
            continue
        side = 1 if where == "left" else -1
        lane = paved[-1 if side > 0 else 0]
        total = float(arc_lengths(lane.shape)[-1])
        line = resample(lane.shape, np.linspace(0.0, total, max(int(total / _STEP_M), 1) + 1))
        inner, outer = (offset_polyline(line, side * (lane.width_m / 2 + away)) for away in WITHIN_M[kind])
        yield Roadside(edge.id, kind, inner, outer, side)
