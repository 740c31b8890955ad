"""What a network loses on the way .xodr -> netconvert -> .net.xml: lanes, connections, signals, signs.

netconvert names the edge along a road "-<road>" and the one against it "<road>". By itself it reads no signs, opens
two-way left-turn lanes to through cars, and of several lanes of a road that lead into one lane takes the first;
`existing_map` reads those as well. Phases are no part of OpenDRIVE: both make programs of their own.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Literal, NamedTuple

from sgcad_core import settings
from sgcad_core.case.records import PlainXml
from sgcad_core.errors import ConfigError
from sgcad_core.formats.opendrive.checks.road_index import RoadIndex, lane_index
from sgcad_core.formats.opendrive.controls import imported_lanes
from sgcad_core.formats.opendrive.signals import posted_mph
from sgcad_core.formats.sumo.existing_map import map_parts
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import FLAGS, TIMEOUT_S, compile_network
from sgcad_core.formats.sumo.parameters import CONTROL
from sgcad_core.formats.xml import Element, parse_xml, to_text
from sgcad_core.roads.lane_graph import Connection, Edge, LaneGraph
from sgcad_core.system.subprocess_limits import run_limited
from sgcad_core.system.temp_folders import temp_folder

ASPECTS = ("edges", "lanes", "widths", "limits", "connections", "signals", "signs")
Reader = Literal["netconvert", "sgcad"]
WIDTH_M = 0.1
"""netconvert takes a lane's greatest width."""
SPEED_MPS = 0.01
LEFT_OUT = ("biking", "shoulder", "sidewalk")
"""Lanes that netconvert leaves out unless told to import all of them."""


class Difference(NamedTuple):
    """One thing that the way back changes."""

    aspect: str
    where: str
    before: str
    after: str


class _Back(NamedTuple):
    """Both networks, and the names of the first's edges in the second."""

    graph: LaneGraph
    found: LaneGraph
    names: Mapping[str, str]
    center: Mapping[str, int]
    parking: Mapping[str, int]

    def pairs(self) -> Iterator[tuple[Edge, Edge]]:
        """Edges of both networks that are the same."""
        for name, edge in self.graph.edges.items():
            other = self.found.edges.get(self.names.get(name, ""))
            if other is not None:
                yield edge, other

    def key(self, link: Connection) -> tuple[str, int, str, int]:
        """A connection of the first network as the second counts its lanes."""
        starts = _outside(self.graph.edges[link.from_edge], link.from_lane)
        ends = _outside(self.graph.edges[link.to_edge], link.to_lane)
        counted = replace(link, from_lane=link.from_lane - starts, to_lane=link.to_lane - ends)
        return _key(counted, self.names)

    def is_read(self, link: Connection) -> bool:
        """Whether netconvert makes lanes of both that a connection joins."""
        places = (link.from_edge, link.from_lane), (link.to_edge, link.to_lane)
        return all(self.graph.edges[edge].lanes[lane].type not in LEFT_OUT for edge, lane in places)


def _outside(edge: Edge, index: int) -> int:
    """How many lanes right of a lane are left out."""
    return sum(lane.type in LEFT_OUT for lane in edge.lanes[:index])


def differences(net_xml: str, xodr: str, reader: Reader = "netconvert") -> list[Difference]:
    """All that is not as before, aspect by aspect. Raises InvalidOutput where a file is none."""
    graph, index = parse_net(net_xml), lane_index(xodr)
    net, log = _read_alone(xodr) if reader == "netconvert" else _read_as_map(xodr)
    if not net:
        return [Difference("edges", "file", "read", f"netconvert cannot: {log[:200]}")]
    root = parse_xml(xodr, "xodr")
    alone = reader == "netconvert"
    center, parking = (_lane_counts(root, "bidirectional"), _lane_counts(root, "parking")) if alone else ({}, {})
    both = _Back(graph, parse_net(net), edge_names(graph, index), center, parking)
    signs = () if reader == "netconvert" else _signs(both)
    return [*_edges(both), *_lanes(both), *_connections(both), *_signals(both), *signs]


def _read_as_map(xodr: str) -> tuple[str, str]:
    with temp_folder("back") as folder:
        file = folder / "road.xodr"
        file.write_text(xodr, encoding="utf-8")
        try:
            nodes, edges, links = map(to_text, map_parts(file, ("--no-turnarounds",)))
            network = compile_network(PlainXml(nodes=nodes, edges=edges, connections=links))
        except ConfigError as fault:
            return "", str(fault)
    return network.net_xml or "", network.log


def _read_alone(xodr: str) -> tuple[str, str]:
    """(.net.xml, netconvert's messages) as netconvert itself reads an OpenDRIVE file; "" where it cannot."""
    with temp_folder("back") as folder:
        source, net = folder / "road.xodr", folder / "road.net.xml"
        source.write_text(xodr, encoding="utf-8")
        command = [str(settings.netconvert()), "--opendrive-files", source.name, *FLAGS, "-o", net.name]
        done = run_limited(command, folder, settings.subprocess_environment(), TIMEOUT_S)
        text = net.read_text(encoding="utf-8") if done.returncode == 0 and net.exists() else ""
    return text, (done.stderr + done.stdout).decode("utf-8", "replace").strip()


def _lane_counts(root: Element, kind: str) -> dict[str, int]:
    """Edge -> the number of its lanes of a type that netconvert opens to through cars."""
    counts = {edge: sum(lane.get("type") == kind for lane in lanes) for edge, lanes in imported_lanes(root).items()}
    return {edge: count for edge, count in counts.items() if count}


def edge_names(graph: LaneGraph, index: RoadIndex) -> dict[str, str]:
    """SUMO edge -> the name that netconvert gives it when it reads the .xodr."""
    found = {}
    for edge in graph.edges.values():
        if place := index.lane(edge.id, 0):
            found[edge.id] = f"-{place.road}" if place.lane < 0 else place.road
    return found


# ------------------------------------------------------------------ roads
def _edges(both: _Back) -> Iterator[Difference]:
    there = {both.names.get(edge, f"no road for {edge}") for edge in both.graph.edges}
    for missing in sorted(there - set(both.found.edges)):
        yield Difference("edges", missing, "edge", "none")
    for spare in sorted(set(both.found.edges) - there):
        yield Difference("edges", spare, "none", "edge")


def _lanes(both: _Back) -> Iterator[Difference]:
    for edge, other in both.pairs():
        driven = range(both.parking.get(other.id, 0), len(other.lanes) - both.center.get(other.id, 0))
        after = [lane.allows_cars and i in driven for i, lane in enumerate(other.lanes)]
        kept = [lane for lane in edge.lanes if lane.type not in LEFT_OUT]
        before = [lane.allows_cars for lane in kept]
        if before != after:
            yield Difference("lanes", edge.id, str(before), str(after))
            continue
        for lane, found in zip(kept, other.lanes, strict=True):
            if abs(lane.width_m - found.width_m) > WIDTH_M:
                yield Difference("widths", lane.id, f"{lane.width_m:.2f} m", f"{found.width_m:.2f} m")
            if posted_mph(edge) is not None and abs(lane.speed_mps - found.speed_mps) > SPEED_MPS:
                yield Difference("limits", lane.id, f"{lane.speed_mps:.2f} m/s", f"{found.speed_mps:.2f} m/s")


# ------------------------------------------------------------------ connections
def _connections(both: _Back) -> Iterator[Difference]:
    before = Counter(both.key(link) for link in both.graph.connections if both.is_read(link))
    after = Counter(_key(link, {}) for link in both.found.connections)
    for link in sorted(before - after):
        yield Difference("connections", " ".join(map(str, link)), "connection", "none")
    for link in sorted(after - before):
        yield Difference("connections", " ".join(map(str, link)), "none", "connection")


def _key(link: Connection, names: Mapping[str, str]) -> tuple[str, int, str, int]:
    return (
        names.get(link.from_edge, link.from_edge),
        link.from_lane,
        names.get(link.to_edge, link.to_edge),
        link.to_lane,
    )


# ------------------------------------------------------------------ signals and signs
def _signals(both: _Back) -> Iterator[Difference]:
    """Connections that a signal controls, among those that both networks have."""
    there = {_key(link, {}) for link in both.found.connections}
    before = {both.key(link) for link in both.graph.connections if link.light and both.is_read(link)} & there
    after = {_key(link, {}) for link in both.found.connections if link.light}
    for link in sorted(before ^ after):
        was, now = ("signal", "none") if link in before else ("none", "signal")
        yield Difference("signals", " ".join(map(str, link)), was, now)


def _signs(both: _Back) -> Iterator[Difference]:
    """Stop and yield signs of every approach."""
    before = {both.names[edge]: sign for edge, sign in signs_of(both.graph).items() if edge in both.names}
    after = signs_of(both.found)
    for edge in sorted(set(before) | set(after)):
        if before.get(edge) != after.get(edge):
            yield Difference("signs", edge, before.get(edge, "none"), after.get(edge, "none"))


def signs_of(graph: LaneGraph) -> dict[str, str]:
    """Approach -> "stop" or "yield", as SUMO's link states and the node's told control have it."""
    found = {}
    for edge in graph.edges.values():
        states = {link.state for link in graph.leaving(edge.id)}
        node = graph.nodes[edge.to_node]
        lower = any(e.to_node == edge.to_node and e.priority > edge.priority for e in graph.edges.values())
        if states & {"s", "w"}:
            found[edge.id] = "stop"
        elif node.parameters.get(CONTROL) == "yield" and "m" in states and lower:
            found[edge.id] = "yield"
    return found
