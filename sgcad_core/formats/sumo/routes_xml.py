"""SUMO route files (.rou.xml) written by a model: their vehicles, and their faults on a network.

Knows SUMO's schema and the lane graph; starts no program and knows no crash.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from sgcad_core.case.records import Finding
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.sumo.plain_xml import sumo_findings
from sgcad_core.formats.xml import Element, parse_xml
from sgcad_core.roads.lane_graph import LaneGraph

SOURCE = "sumo_routes"
_finding = FindingFactory(SOURCE)
MOVERS = ("vehicle", "person")
_OUTWARD = ("trip", "flow", "personFlow", "container", "include")
"""Elements for which SUMO generates vehicles or routes, so that traffic differs from the file."""


class RouteActor(NamedTuple):
    """A vehicle or person of a route file; sizes in metres, None where its type states none."""

    id: str
    depart: str
    edges: tuple[str, ...]
    length_m: float | None
    width_m: float | None


def route_actors(routes_xml: str) -> tuple[RouteActor, ...]:
    """Vehicles and persons in order. Raises InvalidOutput for what is no XML."""
    root = parse_xml(routes_xml, "routes")
    types = {t.get("id"): t for t in root.iterfind("vType")}
    routes = {r.get("id"): r.get("edges", "") for r in root.iterfind("route")}
    return tuple(_mover(e, types, routes) for e in root if e.tag in MOVERS)


def _mover(element: Element, types: dict[str, Element], routes: dict[str, str]) -> RouteActor:
    inner = element.find("route")
    edges = inner.get("edges", "") if inner is not None else routes.get(element.get("route"), "")
    if element.tag == "person":
        edges = " ".join(walk.get("edges", "") for walk in element.iterfind("walk"))
    kind = types.get(element.get("type"))
    return RouteActor(
        element.get("id", ""),
        element.get("depart", ""),
        tuple(edges.split()),
        _size(kind, "length"),
        _size(kind, "width"),
    )


def _size(kind: Element | None, name: str) -> float | None:
    try:
        value = float(kind.get(name)) if kind is not None and kind.get(name) is not None else None
    except ValueError:
        return None
    return value if value is not None and 0 < value < 60 else None


def routes_findings(routes_xml: str, graph: LaneGraph, actors: Sequence[str]) -> list[Finding]:
    """Schema faults, else references that do not hold: edges, ways between them, ids, departures."""
    if faults := sumo_findings("routes", routes_xml):
        return faults
    root = parse_xml(routes_xml, "routes")
    return [*_elements(root), *_ids(route_actors(routes_xml), actors), *_ways(route_actors(routes_xml), graph)]


def _elements(root: Element) -> Iterator[Finding]:
    for name in _OUTWARD:
        if root.find(name) is not None:
            yield _finding(f"<{name}> is not read", name, "", "write each actor as a <vehicle> with its own <route>")


def _ids(found: Sequence[RouteActor], actors: Sequence[str]) -> Iterator[Finding]:
    ids = [m.id for m in found]
    for name in sorted({n for n in ids if ids.count(n) > 1}):
        yield _finding("two vehicles have one id", "vehicle", name, "give each actor one vehicle")
    if lacking := [a for a in actors if a not in ids]:
        yield _finding("declared actors are not in the file", "vehicle", ", ".join(lacking), "add a <vehicle> for each")
    if spare := [i for i in ids if i not in actors]:
        yield _finding("vehicles are not declared", "vehicle", ", ".join(spare), "declare them, or leave them out")
    for m in found:
        if m.depart not in ("0", "0.0", "0.00"):
            yield _finding("an actor departs late", f"{m.id}.depart", m.depart, 'let all depart at "0"')
        if m.length_m is None or m.width_m is None:
            yield _finding("the actor's size is not told", m.id, "", "give its <vType> length and width in meters")


def _ways(found: Sequence[RouteActor], graph: LaneGraph) -> Iterator[Finding]:
    onward = {(c.from_edge, c.to_edge) for c in graph.connections}
    known = ", ".join(graph.edges)
    for m in found:
        if not m.edges:
            yield _finding("the actor has no route", m.id, "", f'write <route edges="..."/> with edges of {known}')
        missing = [e for e in m.edges if e not in graph.edges]
        if missing:
            yield _finding("edges that are not there", f"{m.id}.route", ", ".join(missing), f"edges are {known}")
            continue
        for a, b in zip(m.edges, m.edges[1:], strict=False):
            if (a, b) not in onward:
                ways = ", ".join(sorted({y for x, y in onward if x == a})) or "nothing"
                yield _finding("no way leads from edge to edge", f"{m.id}.route", f"{a} to {b}", f"{a} leads to {ways}")
