"""Checks whether a .net.xml and a .xodr describe the same roads. Knows both formats, no scenario."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sgcad_core.case.records import Finding
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.opendrive.checks.road_index import RoadIndex, lane_index
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads, roads_of
from sgcad_core.geometry.distances import distance_to
from sgcad_core.geometry.plane import Floats, arc_lengths, prolonged, resample
from sgcad_core.roads.lane_graph import Edge, Lane, LaneGraph

TOLERANCE_M, BESIDE_TOLERANCE_M = 0.5, 1.0
"""Of lanes for cars, and of what lies beside them: outer lanes of a bend are cut farthest from where the road ends."""
UNEVEN_M = 8.0
"""SUMO cuts the lanes of a road one by one, OpenDRIVE all at one station: the connecting road covers the rest."""
MAX_EDGES = 12
"""Edges whose lanes are compared; evenly taken from all."""
_REMEDY = "write both files in one run of netconvert"
_finding = FindingFactory("agreement", where="road network", remedy=_REMEDY)


def network_disagreements(graph: LaneGraph, xodr: str) -> list[Finding]:
    """Edges without road, roads without edge, unlike lanes, lane centers farther apart than 0.5 m.

    Raises InvalidOutput where the .xodr is none.
    """
    index = lane_index(xodr)
    return [*_unmatched(graph, index), *_apart(graph, index, roads_of(xodr))]


def _unmatched(graph: LaneGraph, index: RoadIndex) -> Iterator[Finding]:
    for missing, what in ((set(graph.edges) - index.edges, "edges without road in the .xodr"),
                          (index.edges - set(graph.edges), "roads without edge in the net.xml")):  # fmt: skip
        if missing:
            yield _finding(what, value=", ".join(sorted(missing)[:10]))


def _apart(graph: LaneGraph, index: RoadIndex, roads: XodrRoads) -> Iterator[Finding]:
    edges = list(graph.edges.values())
    for edge in edges[:: max(1, -(-len(edges) // MAX_EDGES))]:
        if edge.id not in index.edges:
            continue
        places = [index.lane(edge.id, lane.index) for lane in edge.lanes]
        if missing := [lane.id for lane, place in zip(edge.lanes, places, strict=True) if place is None]:
            yield _finding(f"lanes of edge {edge.id!r} are not in the .xodr", value=", ".join(missing))
        for lane, place in zip(edge.lanes, places, strict=True):
            if place is not None:
                yield from _lane_apart(edge, lane, roads.lane_center(place.road, place.lane))


def _lane_apart(edge: Edge, lane: Lane, center: Floats) -> Iterator[Finding]:
    probes = resample(lane.shape, np.linspace(0.0, arc_lengths(lane.shape)[-1], 5))
    away = float(distance_to(prolonged(center, UNEVEN_M), probes).max())
    backwards = bool((lane.shape[-1] - lane.shape[0]) @ (center[-1] - center[0]) < 0)
    if away > (BESIDE_TOLERANCE_M if lane.type else TOLERANCE_M) or backwards:
        said = "runs the other way" if backwards else f"{away:.2f} m apart"
        yield _finding(f"lane {lane.index} of edge {edge.id!r} lies elsewhere in the .xodr", value=said)
