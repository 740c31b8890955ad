"""One to three junctions cut out of a network as plain XML of their own, the middle one at (0, 0).

Ids follow the project: road R is edge "R" towards its junction and "-R" away from it. Knows no
OpenStreetMap.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

from plugins.retriever.knowledge.plain_graph import PlainEdge, PlainGraph, Point
from sgcad_core.case.records import PlainXml
from sgcad_core.errors import InvalidOutput

NEAR_M = 60.0
REACH_M = 150.0
SHORTEST_M = 5.0
MOST = 3
_XSD = 'xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://sumo.dlr.de/xsd'
_SPEED_MPS = (2.0, 60.0)


class Cut(NamedTuple):
    """A cut-out network and how many junctions of three or more legs it has."""

    plain: PlainXml
    junctions: int


def cut(graph: PlainGraph, node: str) -> Cut:
    """Cuts out a junction and its near neighbors. Raises InvalidOutput with the reason if that is not possible."""
    inner = _cluster(graph, node)
    names = {name: "hub" if i == 0 else f"hub{i + 1}" for i, name in enumerate(inner)}
    drawing = _Drawing(graph, names, graph.places[node])
    for name in inner:
        for other in graph.neighbors(name):
            drawing.road(name, other)
    return Cut(drawing.plain(), len(inner))


def _cluster(graph: PlainGraph, node: str) -> list[str]:
    """The junction first, then those nearer than 60 m, nearest first."""
    here = graph.places[node]
    near = [
        (math.dist(graph.places[other], here), other)
        for other in graph.neighbors(node)
        if len(graph.neighbors(other)) >= 3
    ]
    return [node, *(other for distance, other in sorted(near) if distance < NEAR_M)][:MOST]


class _Drawing:
    """Collects nodes, edges and connections of one cut."""

    def __init__(self, graph: PlainGraph, names: dict[str, str], origin: Point) -> None:
        self.graph, self.names, self.origin = graph, names, origin
        self.nodes = [self._node(name, graph.places[old], graph.types[old]) for old, name in names.items()]
        self.edges: list[str] = []
        self.made: dict[str, str] = {}
        """Edge of the graph -> edge of the cut."""
        self.roads = 0

    def road(self, node: str, other: str) -> None:
        """Draws both directions between a junction of the cut and a neighbor, once."""
        pair = [
            e for n in self.graph.touching[node]
            if {(e := self.graph.edges[n]).start, e.end} == {node, other} and n not in self.made
        ]  # fmt: skip
        if not pair:
            return
        self.roads += 1
        end = self.names.get(other) or f"end{self.roads}"
        lines = {e.id: self._line(e, node, whole=other in self.names) for e in pair}
        if end.startswith("end"):
            outer = lines[pair[0].id][0] if pair[0].end == node else lines[pair[0].id][-1]
            self.nodes.append(self._node(end, (outer[0] + self.origin[0], outer[1] + self.origin[1]), "dead_end"))
        for number, edge in enumerate(pair):
            self._edge(edge, node, end, lines[edge.id], number)

    def _edge(self, edge: PlainEdge, node: str, end: str, line: Sequence[Point], number: int) -> None:
        inward = edge.end == node
        twin = f"_{number // 2 + 1}" if number > 1 else ""
        name = f"{'' if inward else '-'}R{self.roads}{twin}"
        if name in self.made.values():
            name = f"{name}b"
        ends = (end, self.names[node]) if inward else (self.names[node], end)
        speed = min(max(edge.speed_mps, _SPEED_MPS[0]), _SPEED_MPS[1])
        shape = " ".join(f"{x:.2f},{y:.2f}" for x, y in line)
        self.made[edge.id] = name
        self.edges.append(
            f'<edge id="{name}" from="{ends[0]}" to="{ends[1]}" numLanes="{edge.lanes}" speed="{speed:.2f}" '
            f'priority={quoteattr(edge.priority)} shape="{shape}"/>'
        )

    def _line(self, edge: PlainEdge, node: str, whole: bool) -> list[Point]:
        """The edge's line about the origin, as far as 150 m from the junction."""
        outward = edge.line if edge.start == node else edge.line[::-1]
        kept = list(outward) if whole else list(_first(outward, REACH_M))
        length = sum(math.dist(a, b) for a, b in pairwise(kept))
        if length < SHORTEST_M:
            raise InvalidOutput(f"a road of {length:.1f} m, at least {SHORTEST_M:g} m are needed")
        moved = [(x - self.origin[0], y - self.origin[1]) for x, y in kept]
        return moved if edge.start == node else moved[::-1]

    def _node(self, name: str, place: Point, kind: str) -> str:
        x, y = place[0] - self.origin[0], place[1] - self.origin[1]
        return f'<node id="{name}" x="{x:.2f}" y="{y:.2f}" type={quoteattr(kind)}/>'

    def plain(self) -> PlainXml:
        """The three documents of the cut."""
        return PlainXml(
            nodes=f'<nodes {_XSD}/nodes_file.xsd">{"".join(self.nodes)}</nodes>',
            edges=f'<edges {_XSD}/edges_file.xsd">{"".join(self.edges)}</edges>',
            connections=f'<connections {_XSD}/connections_file.xsd">{"".join(self._links())}</connections>',
        )

    def _links(self) -> Iterator[str]:
        """Connections between edges whose lanes are all for cars; netconvert guesses the rest."""
        for old, name in self.made.items():
            for to, from_lane, to_lane in self.graph.links.get(old, ()):
                edges = [self.graph.edges[e] for e in (old, to) if e in self.made]
                inside = edges[0].end in self.names  # at the cut's rim the roads no longer meet
                if len(edges) == 2 and inside and all(e.lanes == e.all_lanes for e in edges):
                    yield (
                        f'<connection from="{name}" to="{self.made[to]}" fromLane="{from_lane}" toLane="{to_lane}"/>'
                    )


def _first(line: Sequence[Point], reach_m: float) -> Iterator[Point]:
    """The line's points as far as reach_m along it, the last one interpolated."""
    yield line[0]
    walked = 0.0
    for a, b in pairwise(line):
        step = math.dist(a, b)
        if walked + step >= reach_m:
            share = (reach_m - walked) / step
            yield (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))
            return
        walked += step
        yield b
