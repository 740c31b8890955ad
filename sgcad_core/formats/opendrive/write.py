"""A SUMO network as OpenDRIVE 1.7: two-way streets, junctions, traffic control; the same roads in the same frame.

Everything is taken from the .net.xml, so that both files describe one thing. Metres; knows no crash.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count

import numpy as np
from lxml import etree

from sgcad_core.case.records import Finding
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.opendrive.areas import cones_of, crosswalks_of, gores_of, grounds_of, stalls_of
from sgcad_core.formats.opendrive.connecting import Connector, connecting_curve
from sgcad_core.formats.opendrive.elements import (
    add_child,
    add_connector_lanes,
    add_cubic,
    add_pieces,
    add_street_lanes,
    decimal_text,
)
from sgcad_core.formats.opendrive.furniture import add_objects, add_signals
from sgcad_core.formats.opendrive.signals import control_of, posted_mph
from sgcad_core.formats.opendrive.streets import Street, streets
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.parameters import AREA, KIND
from sgcad_core.formats.xml import Element, to_text
from sgcad_core.geometry.globe import Plane
from sgcad_core.kinds import ALLEY, DRIVEWAY
from sgcad_core.roads.lane_graph import Connection, LaneGraph

TOUCHING_M = 0.05
TRIM_M = 0.1
"""Lanes of a node that touch leave a connecting road no length: its roads are cut back by so much."""
FRAME = Plane(0, 0).proj
"""A metric plane, x east and y north, without a place on the globe: most reports name no coordinates."""
ROAD_TYPES = {"rural": "rural", "town": "town", "motorway": "motorway", DRIVEWAY: "townPrivate",
              ALLEY: "townLocal"}  # fmt: skip
"""By the stated area, else by the kind of road."""


def write_xodr(net_xml: str) -> str:
    """OpenDRIVE of a network, about 15 ms. Raises InvalidOutput where it is no network or has no drivable road."""
    graph = parse_net(net_xml)
    roads = streets(graph, _trims(graph))
    if not roads:
        what, remedy = "the network has no road that can be drawn", "give it an edge of 1 m or more"
        raise InvalidOutput.of(Finding(source="xodr", what=what, value=f"{len(graph.edges)} edges", remedy=remedy))
    return to_text(_Document(graph, roads).root())


def _trims(graph: LaneGraph) -> dict[tuple[str, bool], float]:
    """Ends of edges that touch the edge they lead into."""
    found = {}
    for link in graph.connections:
        a, b = link.via_shape[0], link.via_shape[-1]
        if abs(a[0] - b[0]) + abs(a[1] - b[1]) < TOUCHING_M:
            found[link.from_edge, True] = found[link.to_edge, False] = TRIM_M
    return found


class _Document:
    """The parts of one file; ids of roads, junctions, signals and objects are counted apart."""

    def __init__(self, graph: LaneGraph, roads: Sequence[Street]) -> None:
        self.graph, self.roads = graph, roads
        self.by_edge = {edge.id: street for street in roads for edge in street.edges}
        links = [c for c in graph.connections if c.from_edge in self.by_edge and c.to_edge in self.by_edge]
        crossed = dict.fromkeys(graph.edges[c.from_edge].to_node for c in links)
        self.junctions = {node: str(i) for i, node in enumerate(crossed, 1)}
        self.control = control_of(graph, roads)
        ids = map(str, count(len(self.control.stop_lines) + 1))
        crosswalks = crosswalks_of(graph, roads, ids)
        self.stalls = {street.id: tuple(stalls_of(street, ids)) for street in roads}
        self.cones = cones_of(graph, roads, ids)
        self.areas = (*crosswalks, *gores_of(graph, roads, ids), *grounds_of(graph, roads, ids))
        self.connectors = [self._connector(str(len(roads) + i), link) for i, link in enumerate(links, 1)]

    def _connector(self, name: str, link: Connection) -> Connector:
        came, goes = self.by_edge[link.from_edge], self.by_edge[link.to_edge]
        start = came.lane_pose(link.from_edge, link.from_lane, at_end=True)
        end = goes.lane_pose(link.to_edge, link.to_lane, at_end=False)
        lanes = came.strip_of(link.from_edge, link.from_lane), goes.strip_of(link.to_edge, link.to_lane)
        junction = self.junctions[self.graph.edges[link.from_edge].to_node]
        return Connector(name, junction, link, came, goes, *lanes, connecting_curve(start, end, link.via_shape))

    def root(self) -> Element:
        """The whole file."""
        root = etree.Element("OpenDRIVE")
        self._header(root)
        for street in self.roads:
            self._street(root, street)
        for connector in self.connectors:
            self._connecting_road(root, connector)
        for controller in self.control.controllers:
            made = add_child(root, "controller", id=controller.id, name=controller.name, sequence="0")
            for signal in controller.signals:
                add_child(made, "control", signalId=signal, type="0")
        for node, name in self.junctions.items():
            self._junction(root, node, name)
        for i, circle in enumerate(self.graph.circles, 1):
            group = add_child(root, "junctionGroup", id=str(i), name=min(circle), type="roundabout")
            for node, name in self.junctions.items():
                if node in circle:
                    add_child(group, "junctionReference", junction=name)
        return root

    def _header(self, root: Element) -> None:
        points = np.vstack([lane.shape for edge in self.graph.edges.values() for lane in edge.lanes])
        margin = max(lane.width_m for edge in self.graph.edges.values() for lane in edge.lanes) / 2
        (west, south), (east, north) = points.min(axis=0) - margin, points.max(axis=0) + margin
        header = add_child(root, "header", revMajor="1", revMinor="7", name="", version="1.00", vendor="sgcad")
        for side, value in (("north", north), ("south", south), ("east", east), ("west", west)):
            header.set(side, decimal_text(value))
        add_child(header, "geoReference").text = etree.CDATA(self.graph.projection or FRAME)

    # -------------------------------------------------------------- roads
    def _street(self, root: Element, street: Street) -> None:
        road = add_child(
            root, "road", name=street.name, length=decimal_text(street.length_m), id=street.id, junction="-1"
        )
        road.set("rule", "RHT")
        link = add_child(road, "link")
        ends = ("predecessor", street.forward.from_node), ("successor", street.forward.to_node)
        for side, node in ends:
            if node in self.junctions:
                add_child(link, side, elementType="junction", elementId=self.junctions[node])
        self._type(road, street)
        add_pieces(add_child(road, "planView"), street.line)
        add_street_lanes(add_child(road, "lanes"), street)
        lines = [line for line in self.control.stop_lines if line.road == street.id]
        areas = [area for area in self.areas if area.road == street.id]
        add_objects(road, lines, areas, self.stalls[street.id], self.cones.get(street.id, ()))
        add_signals(road, [signal for signal in self.control.signals if signal.road == street.id])

    def _type(self, road: Element, street: Street) -> None:
        told = street.forward.parameters
        kind = ROAD_TYPES.get(told.get(AREA, ""), ROAD_TYPES.get(told.get(KIND, ""), "unknown"))
        made = add_child(road, "type", s="0", type=kind)
        if (limit := posted_mph(street.forward)) is not None:
            add_child(made, "speed", max=f"{limit:g}", unit="mph")

    def _connecting_road(self, root: Element, connector: Connector) -> None:
        length, link = connector.way.length_m, connector.connection
        name = f"{connector.came.name} to {connector.goes.name}"
        road = add_child(
            root, "road", name=name, length=decimal_text(length), id=connector.id, junction=connector.junction
        )
        road.set("rule", "RHT")
        links = add_child(road, "link")
        for side, street, edge, at_end in (
            ("predecessor", connector.came, link.from_edge, True), ("successor", connector.goes, link.to_edge, False),
        ):  # fmt: skip
            contact = "end" if street.driven_end(edge, at_end) > 0 else "start"
            add_child(links, side, elementType="road", elementId=street.id, contactPoint=contact)
        add_cubic(add_child(road, "planView"), connector.way)
        add_connector_lanes(add_child(road, "lanes"), connector)

    # -------------------------------------------------------------- junctions
    def _junction(self, root: Element, node: str, name: str) -> None:
        junction = add_child(root, "junction", id=name, name=node)
        here = [c for c in self.connectors if c.junction == name]
        for i, connector in enumerate(here):
            made = add_child(junction, "connection", id=str(i), incomingRoad=connector.came.id)
            made.set("connectingRoad", connector.id)
            made.set("contactPoint", "start")
            add_child(made, "laneLink", attributes={"from": str(connector.incoming.id), "to": "-1"})
        for i, controller in enumerate(c for c in self.control.controllers if c.junction == node):
            add_child(junction, "controller", id=controller.id, type="0", sequence=str(i))
