"""SUMO plain XML read into nodes, edges and connections, element by element.

Reads what `junction_cut` needs; lanes closed to cars are not counted. Knows no OpenStreetMap.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from lxml import etree

Point = tuple[float, float]


@dataclass(frozen=True)
class PlainEdge:
    """One direction of a road; `line` runs from its first to its last node, metres."""

    id: str
    start: str
    end: str
    lanes: int
    all_lanes: int
    speed_mps: float
    priority: str
    kind: str
    name: str
    line: tuple[Point, ...]


@dataclass
class PlainGraph:
    """A whole network; some 500 bytes an edge."""

    places: dict[str, Point] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)
    edges: dict[str, PlainEdge] = field(default_factory=dict)
    touching: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    """Node -> edges that start or end there."""
    links: dict[str, list[tuple[str, int, int]]] = field(default_factory=lambda: defaultdict(list))
    """Edge -> (edge behind, lane before, lane behind)."""

    def neighbors(self, node: str) -> list[str]:
        """Nodes that are one edge away, in order, each once."""
        found: dict[str, None] = {}
        for name in self.touching[node]:
            edge = self.edges[name]
            other = edge.end if edge.start == node else edge.start
            if other != node:
                found[other] = None
        return list(found)


def read_plain(nodes: Path, edges: Path, connections: Path) -> PlainGraph:
    """Reads the three files that netconvert wrote."""
    graph = PlainGraph()
    for node in _elements(nodes, "node"):
        name = node.get("id", "")
        graph.places[name] = (float(node.get("x", 0)), float(node.get("y", 0)))
        graph.types[name] = node.get("type", "priority")
    for element in _elements(edges, "edge"):
        edge = _edge(element, graph.places)
        if edge.lanes:
            graph.edges[edge.id] = edge
            graph.touching[edge.start].append(edge.id)
            graph.touching[edge.end].append(edge.id)
    for link in _elements(connections, "connection"):
        lanes = link.get("fromLane"), link.get("toLane")
        if link.get("to") and None not in lanes:
            graph.links[link.get("from", "")].append((link.get("to", ""), int(lanes[0] or 0), int(lanes[1] or 0)))
    return graph


def _elements(file: Path, tag: str) -> Iterator[etree._Element]:
    for _, element in etree.iterparse(file, tag=tag):
        yield element
        element.clear()
        while element.getprevious() is not None:
            del element.getparent()[0]


def _edge(element: etree._Element, places: dict[str, Point]) -> PlainEdge:
    start, end, count = element.get("from", ""), element.get("to", ""), int(element.get("numLanes", 1))
    return PlainEdge(
        element.get("id", ""), start, end, count - _closed(element), count, float(element.get("speed", 13.9)),
        element.get("priority", "-1"), element.get("type", "").partition(".")[2], element.get("name", ""),
        _line(element.get("shape", ""), places[start], places[end]),
    )  # fmt: skip


def _closed(element: etree._Element) -> int:
    """Lanes that passenger cars may not use."""
    if not _open(element):
        return 0  # the edge's own permissions hold for lanes that say nothing; such edges were filtered out
    return sum(not _open(lane) for lane in element.iterfind("lane"))


def _open(element: etree._Element) -> bool:
    cars, allow = {"passenger", "all"}, element.get("allow")
    return (allow is None or bool(cars & set(allow.split()))) and not cars & set(element.get("disallow", "").split())


def _line(shape: str, start: Point, end: Point) -> tuple[Point, ...]:
    if not shape:
        return start, end
    points = [tuple(float(v) for v in point.split(",")[:2]) for point in shape.split()]
    return tuple((p[0], p[1]) for p in points)
