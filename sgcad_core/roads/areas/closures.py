"""Lanes that a work zone closes: the tapers before them, and the cones.

Computed from the lane graph, so that the .xodr, the player and the planner agree. Metres; knows no crash.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import arc_lengths, offset_polyline, resample
from sgcad_core.roads.lane_graph import ROAD_WORKS, Edge, Floats, Lane, LaneGraph
from sgcad_core.units import MPS_PER_MPH

_SLOW_MPH = 45.0
_FOOT_M = 0.3048
MOST_M = 75.0
"""Longest taper: the legs of a layout are 240 m long, and the approach takes some seconds."""
CONE_M = 0.35
"""Width of a cone of 28 in."""
_ZONE_STEP_M = 12.0
"""Between cones along a closed lane (MUTCD 6F.63: about twice the limit in mph, in feet)."""


class Taper(NamedTuple):
    """The end of lanes that are closed behind the node: `lanes` of `edge` have to be left."""

    edge: str
    lanes: tuple[Lane, ...]
    onward: str
    side: int
    """Side of the closed lanes: 1 left, -1 right."""
    length_m: float


def tapers(graph: LaneGraph) -> tuple[Taper, ...]:
    """All tapers of a network, cached."""
    if "tapers" not in graph.derived:
        graph.derived["tapers"] = tuple(taper for edge in graph.edges.values() for taper in _taper(graph, edge))
    found: tuple[Taper, ...] = graph.derived["tapers"]
    return found


def taper_of(graph: LaneGraph, edge: str) -> Taper | None:
    """The taper at the end of an edge."""
    return next((taper for taper in tapers(graph) if taper.edge == edge), None)


def _taper(graph: LaneGraph, edge: Edge) -> Iterator[Taper]:
    for onward in {c.to_edge: None for c in graph.leaving(edge.id)}:
        ahead = graph.edges[onward]
        if len(ahead.laid_lanes) != len(edge.laid_lanes):
            continue
        pairs = list(zip(edge.laid_lanes, ahead.laid_lanes, strict=True))
        shut = tuple(lane for lane, beyond in pairs if lane.allows_cars and not beyond.allows_cars)
        if shut:
            side = -1 if shut[0] is edge.laid_lanes[0] else 1
            room = float(arc_lengths(shut[0].shape)[-1]) / 2
            yield Taper(edge.id, shut, onward, side, min(_length_m(shut, room), room))


def _length_m(shut: tuple[Lane, ...], room_m: float) -> float:
    """MUTCD table 6C-4: L = W S2 / 60 up to 40 mph, W S beyond (feet, mph); one taper a lane where there is room."""
    mph = shut[0].speed_mps / MPS_PER_MPH
    feet = shut[0].width_m / _FOOT_M * (mph if mph >= _SLOW_MPH else mph * mph / 60)
    return min(feet * _FOOT_M, MOST_M) * (len(shut) if room_m > MOST_M * len(shut) else 1)


def merging_line(shape: Floats, beside: Floats, taper_m: float) -> Floats:
    """(n, 2) line from a lane to the one beside it, ahead of the taper that closes the lane."""
    totals = [float(arc_lengths(line)[-1]) for line in (shape, beside)]
    share = np.linspace(0.0, 1.0, max(int(totals[0] / 4.0), 2) + 1)
    own, other = (resample(line, share * total) for line, total in zip((shape, beside), totals, strict=True))
    left_m = totals[0] * (1 - share)
    over = np.clip((1.6 * taper_m - left_m) / taper_m, 0.0, 1.0)[:, None]
    moved: Floats = own + (other - own) * over * over * (3 - 2 * over)
    return moved


def cones(graph: LaneGraph) -> Iterator[tuple[str, Floats]]:
    """(edge, (n, 2) places) of the cones along every taper, and between the closed lanes and those beside them."""
    for taper in tapers(graph):
        shape = [lane.shape for lane in taper.lanes][0 if taper.side < 0 else -1]
        total, wide = float(arc_lengths(shape)[-1]), taper.lanes[0].width_m
        count = max(round(taper.length_m / 6.0), 4)
        share = np.linspace(0.0, 1.0, count + 1)
        line = resample(shape, total - taper.length_m * (1 - share))
        from_edge = wide * len(taper.lanes) * share - wide / 2
        yield taper.edge, offset_polyline(line, -taper.side * from_edge)
    for edge in graph.edges.values():
        for lane in edge.lanes:
            yield from ((edge.id, places) for places in _along(edge, lane))


def _along(edge: Edge, lane: Lane) -> Iterator[Floats]:
    """Cones on the borders of a closed lane with open ones."""
    beside = {other.index: other for other in edge.lanes}
    for side in (1, -1):
        other = beside.get(lane.index + side)
        if lane.type == ROAD_WORKS and other is not None and other.allows_cars:
            border = offset_polyline(lane.shape, side * lane.width_m / 2)
            yield resample(border, np.arange(_ZONE_STEP_M / 2, float(arc_lengths(border)[-1]), _ZONE_STEP_M))
