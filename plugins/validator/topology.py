"""Faults of a network that netconvert accepts without a warning: crossings without a node, short rests, loose parts.

Judges the compiled network (and the spec's turn lists where there is a spec), not the report.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import ClassVar, get_args

import numpy as np

from sgcad_core.asking.schema_holds import SOME_LANES
from sgcad_core.case.records import Evidence, Finding, Hold, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.sumo.net_xml import Edge, Floats, LaneGraph, parse_net, road_of
from sgcad_core.geometry.plane import arc_lengths, resample
from sgcad_core.interfaces import Validator
from sgcad_core.records.specs import Compass, RoadSpec
from sgcad_core.roads.road_spec import turn_findings

_finding = FindingFactory("topology")


class Topology(Validator):
    """Finds faults of a network that netconvert accepts: loose parts, nodes or roads on each other, dead directions."""

    stage: ClassVar[str] = "road"
    min_edge_m: float = 5.0
    """Shortest road between two junctions."""
    min_node_gap_m: float = 6.0
    """Least distance of two nodes."""
    min_angle_deg: float = 8.0
    """Least angle between two roads that leave a node; below it they lie on each other."""
    max_findings: int = 20

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Worst first; none for a network that did not compile."""
        if not isinstance(artifact, RoadNetwork) or artifact.net_xml is None:
            return []
        try:
            graph = parse_net(artifact.net_xml)
        except InvalidOutput as fault:
            return list(fault.findings)
        lines = _lines(graph)
        found = [
            *_parts(graph), *self._close_nodes(graph), *_crossings(graph, lines), *self._overlaps(graph, lines),
            *self._short_edges(graph), *_dead_ways(graph), *_spec_faults(artifact.spec),
        ]  # fmt: skip
        return found[: self.max_findings]

    def _close_nodes(self, graph: LaneGraph) -> Iterator[Finding]:
        for (a, p), (b, q) in combinations(graph.nodes.items(), 2):
            gap = math.dist(p[:2], q[:2])
            if gap < self.min_node_gap_m:
                remedy = "make them one node, or move them apart"
                yield _finding("two nodes are in one place", f"nodes {a} and {b}", f"{gap:.1f} m apart", remedy)

    def _short_edges(self, graph: LaneGraph) -> Iterator[Finding]:
        for road, edges in _roads(graph).items():
            length = min(lane.length_m for edge in edges for lane in edge.lanes)
            if length < self.min_edge_m:
                what = f"less than {self.min_edge_m:g} m are left of a road between its junctions"
                remedy = "move its nodes apart, or make them one junction"
                yield _finding(what, f"road {road}", f"{length:.1f} m", remedy)

    def _overlaps(self, graph: LaneGraph, lines: Mapping[str, Floats]) -> Iterator[Finding]:
        """Roads that leave a node in nearly the same direction."""
        for node, ends in _ends_at(graph, lines).items():
            for (a, h), (b, k) in combinations(ends, 2):
                angle = abs(math.degrees((h - k + math.pi) % (2 * math.pi) - math.pi))
                if angle < self.min_angle_deg and not _twins(graph, a, b):
                    remedy = "draw them apart, or let one of them leave the other at a node of its own further on"
                    where = f"roads {a} and {b} at node {node}"
                    yield _finding("two roads lie on each other", where, f"{angle:.0f} degrees apart", remedy)


# ------------------------------------------------------------------ parts and ways
def _parts(graph: LaneGraph) -> Iterator[Finding]:
    parts = _components(graph)
    if len(parts) > 1:
        names = "; ".join(", ".join(part) for part in parts[:6])
        remedy = "join them at shared nodes, or leave out what has nothing to do with the crash"
        yield _finding(f"the network falls into {len(parts)} parts that are not joined", "roads", names, remedy)


def _components(graph: LaneGraph) -> list[list[str]]:
    """Road ids of each connected part, largest first."""
    root = {node: node for node in graph.nodes}

    def find(node: str) -> str:
        while root[node] != node:
            node = root[node]
        return node

    for edge in graph.edges.values():
        root[find(edge.from_node)] = find(edge.to_node)
    parts: dict[str, dict[str, None]] = {}
    for edge in graph.edges.values():
        parts.setdefault(find(edge.from_node), {})[road_of(edge.id)[0]] = None
    return sorted(map(list, parts.values()), key=len, reverse=True)


def _dead_ways(graph: LaneGraph) -> Iterator[Finding]:
    """Directions that cannot be left or reached though their node has other roads."""
    leads, led = {c.from_edge for c in graph.connections}, {c.to_edge for c in graph.connections}
    roads, roads_at = _roads(graph), dict[str, set[str]]()
    for edge in graph.edges.values():
        for node in (edge.from_node, edge.to_node):
            roads_at.setdefault(node, set()).add(road_of(edge.id)[0])
    for edge in graph.edges.values():
        if not edge.car_lanes:
            continue
        for node, known, how in ((edge.to_node, leads, "leads nowhere"), (edge.from_node, led, "is led to by no road")):
            if edge.id not in known and len(roads_at[node]) > 1:
                road, way = road_of(edge.id)
                remedy = "turn a one-way road round, or give a road at that node lanes in the direction that lacks"
                holds = _turned(road, way, alone=len(roads[road]) == 1)
                yield _finding(f"the {way} direction {how}", f"road {road} at node {node}", "", remedy, holds=holds)


def _turned(road: str, way: str, alone: bool) -> tuple[Hold, ...]:
    """Holds a layout's leg to no lanes in the dead direction; a one-way leg to the other direction."""
    if road not in get_args(Compass):
        return ()
    gone, other = ("lanes_in", "lanes_out") if way == "forward" else ("lanes_out", "lanes_in")
    choice = {gone: (0,)} | ({other: SOME_LANES} if alone else {})
    return (Hold(items="legs", key="bearing", values=(road,), either=(choice,)),)


def _spec_faults(spec: RoadSpec | None) -> Iterator[Finding]:
    if spec is None:
        return
    yield from turn_findings(spec)
    used = {end for road in spec.roads for end in (road.from_node, road.to_node)}
    for i, node in enumerate(spec.nodes):
        if node.id not in used:
            yield _finding("no road joins this node", f"nodes[{i}]", node.id, "leave it out, or add its road")


# ------------------------------------------------------------------ lines
def _roads(graph: LaneGraph) -> dict[str, list[Edge]]:
    found: dict[str, list[Edge]] = {}
    for edge in graph.edges.values():
        found.setdefault(road_of(edge.id)[0], []).append(edge)
    return found


def _lines(graph: LaneGraph) -> dict[str, Floats]:
    """A line a road, forward, from node to node: between its innermost lanes, the nodes themselves at the ends."""
    lines = {}
    for road, edges in _roads(graph).items():
        edge = edges[0]
        inner = [e.lanes[-1].shape if e is edge else e.lanes[-1].shape[::-1] for e in edges]
        samples = [resample(shape, np.linspace(0, arc_lengths(shape)[-1], 24)) for shape in inner]
        ends = graph.nodes[edge.from_node], graph.nodes[edge.to_node]
        lines[road] = np.vstack([ends[0][:2], np.mean(samples, axis=0), ends[1][:2]])
    return lines


def _crossings(graph: LaneGraph, lines: Mapping[str, Floats]) -> Iterator[Finding]:
    nodes = {road: {edges[0].from_node, edges[0].to_node} for road, edges in _roads(graph).items()}
    for a, b in combinations(lines, 2):
        shared = [graph.nodes[n] for n in nodes[a] & nodes[b]]
        for x, y in _meetings(lines[a], lines[b]):
            if all(math.dist((x, y), node[:2]) > 25.0 for node in shared):  # junctions reach that far
                remedy = "put a node there and end four roads at it (no bridges can be drawn)"
                place = f"at ({round(x)}, {round(y)})"
                yield _finding("two roads cross without a node", f"roads {a} and {b}", place, remedy)
                break


def _meetings(first: Floats, second: Floats) -> Floats:
    """(n, 2) points where two polylines properly cross."""
    p, r = first[:-1, None, :], np.diff(first, axis=0)[:, None, :]
    q, s = second[None, :-1, :], np.diff(second, axis=0)[None, :, :]
    cross = r[..., 0] * s[..., 1] - r[..., 1] * s[..., 0]
    gap = q - p
    parallel = np.abs(cross) < 1e-9
    cross = np.where(parallel, 1.0, cross)
    t = (gap[..., 0] * s[..., 1] - gap[..., 1] * s[..., 0]) / cross
    u = (gap[..., 0] * r[..., 1] - gap[..., 1] * r[..., 0]) / cross
    hit = ~parallel & (t > 0) & (t < 1) & (u > 0) & (u < 1)
    points: Floats = (p + t[..., None] * r)[hit]
    return points


def _ends_at(graph: LaneGraph, lines: Mapping[str, Floats]) -> dict[str, list[tuple[str, float]]]:
    """Node -> (road, heading in which it leaves the node, over its first 30 m)."""
    found: dict[str, list[tuple[str, float]]] = {}
    for road, edges in _roads(graph).items():
        for node, line in ((edges[0].from_node, lines[road]), (edges[0].to_node, lines[road][::-1])):
            ahead = resample(line, [min(30.0, arc_lengths(line)[-1])])[0] - line[0]
            found.setdefault(node, []).append((road, math.atan2(ahead[1], ahead[0])))
    return found


def _twins(graph: LaneGraph, a: str, b: str) -> bool:
    """Two one-way roads between the same nodes, there and back: a divided road."""
    one, two = _roads(graph)[a], _roads(graph)[b]
    if len(one) > 1 or len(two) > 1:
        return False
    return (one[0].from_node, one[0].to_node) == (two[0].to_node, two[0].from_node)
