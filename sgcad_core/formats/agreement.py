"""Whether a .net.xml and a .xodr describe the same roads. Knows both formats, no scenario."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sgcad_core.formats.opendrive.check import RoadIndex, lane_index
from sgcad_core.formats.openscenario.roads import XodrRoads
from sgcad_core.formats.sumo.lane_graph import Edge, Lane, LaneGraph
from sgcad_core.geometry.distances import distance_to
from sgcad_core.geometry.plane import arc_lengths, resample
from sgcad_core.records import Finding

TOLERANCE_M = 0.5
MAX_EDGES = 12
"""Edges whose lanes are compared; evenly taken from all."""
_REMEDY = "write both files in one run of netconvert"


def network_disagreements(graph: LaneGraph, xodr: str) -> list[Finding]:
    """Edges without road, roads without edge, unlike lanes, lane centers farther apart than 0.5 m.

    Raises InvalidOutput where the .xodr is none.
    """
    index = lane_index(xodr)
    return [*_unmatched(graph, index), *_apart(graph, index, XodrRoads(xodr))]


def _unmatched(graph: LaneGraph, index: RoadIndex) -> Iterator[Finding]:
    roads = {road.edge for road in index.roads.values() if road.edge and not road.edge.startswith(":")}
    for missing, what in ((set(graph.edges) - roads, "edges without road in the .xodr"),
                          (roads - set(graph.edges), "roads without edge in the net.xml")):  # fmt: skip
        if missing:
            yield _finding(what, ", ".join(sorted(map(str, missing))[:10]))


def _apart(graph: LaneGraph, index: RoadIndex, roads: XodrRoads) -> Iterator[Finding]:
    edges = list(graph.edges.values())
    for edge in edges[:: max(1, -(-len(edges) // MAX_EDGES))]:
        road = index.by_edge(edge.id)
        if road is None:
            continue
        lanes = {lane.index - len(edge.lanes): lane for lane in edge.lanes}  # SUMO counts from the right, from 0
        ids = {i for _, section in road.sections for i in section}
        if ids != set(lanes):
            yield _finding(f"edge {edge.id!r} and road {road.id!r} have other lanes", f"{sorted(lanes)}, {sorted(ids)}")
            continue
        yield from _lanes_apart(edge, lanes, road.id, roads)


def _lanes_apart(edge: Edge, lanes: dict[int, Lane], road: str, roads: XodrRoads) -> Iterator[Finding]:
    for number, lane in lanes.items():
        probes = resample(lane.shape, np.linspace(0.0, arc_lengths(lane.shape)[-1], 5))
        away = distance_to(roads.lane_center(road, number), probes).max()
        if away > TOLERANCE_M:
            yield _finding(f"lane {lane.index} of edge {edge.id!r} lies elsewhere in the .xodr", f"{away:.2f} m apart")


def _finding(what: str, value: str) -> Finding:
    return Finding(source="agreement", what=what, where="road network", value=value, remedy=_REMEDY)
