"""A road spec as SUMO plain XML (nodes, edges, connections), and SUMO's schemas for such XML.

Road R becomes edge "R" forward and "-R" backward; both join the road's two nodes even where a median
parts them. A two-way left-turn lane is the innermost lane of the forward edge, closed to passenger cars.
Metres and m/s; x east, y north. Knows no OpenDRIVE and starts no program.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from lxml import etree

from sgcad_core import settings
from sgcad_core.case.records import Finding, PlainXml
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.parameters import AREA, CENTER_LINE, CONTROL, GROUND, KIND, LIMIT, MEDIAN, POSTED, USUAL
from sgcad_core.formats.xml import Element, parse_xml, schema_errors, to_text, xml_schema
from sgcad_core.geometry.globe import Plane
from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import ALLEY, DRIVEWAY, RAMP
from sgcad_core.records.specs import Beside, Node, NodeControl, Road, RoadSpec, ToldRoad
from sgcad_core.roads.areas.roadside import ground_beside
from sgcad_core.roads.connections import Link, links
from sgcad_core.roads.lane_graph import ROAD_WORKS, edge_id
from sgcad_core.roads.road_geometry import (
    Direction,
    Roadway,
    beside,
    beside_m,
    has_center_lane,
    lane_width_m,
    lanes,
    open_lanes,
    roadways,
)
from sgcad_core.roads.road_spec import spec_findings
from sgcad_core.units import MPS_PER_MPH

SPEED_MPH = {"road": 35, RAMP: 45, DRIVEWAY: 15, ALLEY: 15, "circle": 20}
"""Where the report states no limit."""
CIRCLE = "circle"
"""Of a piece of a roundabout, where others tell their kind."""
MAX_LANES = 16
"""Of one edge: the widest toll plazas have more, no road where a report tells a crash has."""
DRIVEWAY_RADIUS_M = 3.5
"""Corners of driveways; SUMO's 4 m elsewhere."""
CENTER_LANE_CLASS = "authority"
"""The vehicle class that alone may use a two-way left-turn lane, so that no one counts it as a through lane."""
CROSSWALK_M = 3.0
"""Width of a crosswalk (10 ft; MUTCD 3B.18 asks for 6 ft and more)."""


class Use(NamedTuple):
    """What a lane beside those for cars is: its type (OpenDRIVE's word) and the one vehicle class that may use it."""

    type: str
    allow: str


BESIDE: Mapping[Beside, Use] = {
    "bike_lane": Use("biking", "bicycle"), "parking": Use("parking", "custom1"),
    "shoulder": Use("shoulder", "emergency"), "sidewalk": Use("sidewalk", "pedestrian"),
}  # fmt: skip
CLOSED = Use(ROAD_WORKS, "custom2")
"""Of a lane that a work zone closes."""
_TYPES: Mapping[NodeControl, str] = {
    "none": "priority", "yield": "priority", "signal": "traffic_light", "stop": "priority_stop",
    "all_way_stop": "allway_stop", "flashing": "priority_stop",
}  # fmt: skip


def plain_xml(
    spec: RoadSpec, told: Mapping[str, ToldRoad] | None = None, origin: tuple[float, float] | None = None
) -> PlainXml:
    """Write a spec as plain XML. Raises InvalidOutput with findings where its references do not hold.

    `told`: road id -> facts of the report; a road without an entry has the limit of its spec. `origin`: latitude and
    longitude of (0, 0), degrees, where the network has a place on the globe.
    """
    if findings := spec_findings(spec):
        raise InvalidOutput.of(*findings)
    drawn = roadways(spec)
    joined = _connections(links(spec, drawn), spec)
    return PlainXml(nodes=_nodes(spec, origin), edges=_edges(drawn, told or {}), connections=joined)


# ------------------------------------------------------------------ nodes
def _nodes(spec: RoadSpec, origin: tuple[float, float] | None) -> str:
    root = etree.Element("nodes")
    if origin:
        _location(root, spec, origin)
    meeting: dict[str, list[Road]] = {node.id: [] for node in spec.nodes}
    for road in spec.roads:
        meeting[road.from_node].append(road)
        meeting[road.to_node].append(road)
    for node in spec.nodes:
        if roads := meeting[node.id]:
            kind = _node_type(node, roads)
            place = etree.SubElement(root, "node", id=node.id, x=_m(node.x_m), y=_m(node.y_m), type=kind)
            if len(roads) > 2 and sum(road.kind != DRIVEWAY for road in roads) < 3:
                place.set("radius", f"{DRIVEWAY_RADIUS_M:g}")
            _tell(place, {CONTROL: node.control})
    return to_text(root)


def _location(root: Element, spec: RoadSpec, origin: tuple[float, float]) -> None:
    """The frame's place on the globe: SUMO and its tools turn metres into degrees by it."""
    west, south = (min(getattr(node, axis) for node in spec.nodes) for axis in ("x_m", "y_m"))
    east, north = (max(getattr(node, axis) for node in spec.nodes) for axis in ("x_m", "y_m"))
    plane = Plane(*origin)
    low, high = plane.spot(west, south), plane.spot(east, north)
    etree.SubElement(
        root, "location", netOffset="0.00,0.00", convBoundary=f"{west:.2f},{south:.2f},{east:.2f},{north:.2f}",
        origBoundary=f"{low[1]:.6f},{low[0]:.6f},{high[1]:.6f},{high[0]:.6f}", projParameter=plane.proj,
    )  # fmt: skip


def _node_type(node: Node, roads: Sequence[Road]) -> str:
    """Signs need a junction; flashing lights without a minor road flash red all round."""
    if len(roads) < 3 and node.control != "signal":
        return "priority"
    if node.control == "flashing" and not any(_yields(road) for road in roads):
        return "allway_stop"
    return _TYPES[node.control]


def _yields(road: Road) -> bool:
    return road.minor or road.kind == DRIVEWAY


# ------------------------------------------------------------------ edges
def _edges(drawn: Mapping[str, Roadway], told: Mapping[str, ToldRoad]) -> str:
    root = etree.Element("edges")
    for way in drawn.values():
        directions: tuple[Direction, ...] = ("forward", "backward")
        for direction in directions:
            if lanes(way.road, direction):
                _edge(root, way, direction, told.get(way.road.id, ToldRoad()))
    for nodes, edges in roundabouts(drawn[name].road for name in drawn):
        etree.SubElement(root, "roundabout", nodes=" ".join(nodes), edges=" ".join(edges))
    return to_text(root)


def roundabouts(roads: Iterable[Road]) -> list[tuple[list[str], list[str]]]:
    """Nodes and edges of each closed circle."""
    onward = {road.from_node: road for road in roads if road.circle}
    found = []
    while onward:
        road, ring = next(iter(onward.values())), list[Road]()
        while road.from_node in onward:
            ring.append(onward.pop(road.from_node))
            road = onward.get(road.to_node, road)
        if ring[-1].to_node == ring[0].from_node:
            found.append(([r.from_node for r in ring], [r.id for r in ring]))
    return found


def _edge(root: Element, way: Roadway, direction: Direction, told: ToldRoad) -> None:
    road, forward = way.road, direction == "forward"
    ends = (road.from_node, road.to_node) if forward else (road.to_node, road.from_node)
    center = forward and has_center_lane(road)
    outer = beside(road)[::-1]
    count = lanes(road, direction) + len(outer)
    edge = etree.SubElement(root, "edge", id=road.id if forward else f"-{road.id}")
    edge.set("from", ends[0])
    edge.set("to", ends[1])
    edge.set("priority", str(_priority(road)))
    edge.set("numLanes", str(count + center))
    kind = CIRCLE if road.circle else ALLEY if road.alley else road.kind
    edge.set("speed", f"{(road.speed_limit_mph or SPEED_MPH[kind]) * MPS_PER_MPH:.3f}")
    edge.set("width", f"{lane_width_m(road):g}")
    edge.set("spreadType", "right")
    edge.set("shape", _shape(way.left_border(direction)))
    for index, what in enumerate(outer):
        use = BESIDE[what]
        lane = etree.SubElement(edge, "lane", index=str(index), width=f"{beside_m(road, what):g}", type=use.type)
        lane.set("allow", use.allow)
    open_ = {i + len(outer) for i in open_lanes(road, direction)}
    for index in range(len(outer), count):
        if index not in open_:
            etree.SubElement(edge, "lane", index=str(index), type=CLOSED.type, allow=CLOSED.allow)
        elif "sidewalk" in outer:
            etree.SubElement(edge, "lane", index=str(index), disallow=BESIDE["sidewalk"].allow)
    if center:
        etree.SubElement(edge, "lane", index=str(count), allow=CENTER_LANE_CLASS)
    limit = f"{POSTED}{road.speed_limit_mph}" if road.speed_limit_mph and told.posted else USUAL
    other: Direction = "backward" if forward else "forward"
    apart = not lanes(road, other) or road.median not in ("none", "painted")
    ground = ground_beside(told, way.left_border(direction), apart=apart)
    known = {AREA: told.area, CENTER_LINE: told.center_line, GROUND: ground}
    _tell(edge, {KIND: kind, MEDIAN: road.median, LIMIT: limit} | {key: word for key, word in known.items() if word})


def _tell(element: Element, told: Mapping[str, str]) -> None:
    for key, value in told.items():
        etree.SubElement(element, "param", key=key, value=value)


def _priority(road: Road) -> int:
    return 6 if road.circle else 1 if _yields(road) else {"road": 4, RAMP: 2}[road.kind]


def _shape(points: Floats) -> str:
    return " ".join(f"{_m(x)},{_m(y)}" for x, y in points)


def _m(value: float) -> str:
    return f"{value + 0.0:.3f}"


# ------------------------------------------------------------------ connections
def _connections(found: tuple[Link, ...], spec: RoadSpec) -> str:
    root = etree.Element("connections")
    for link in found:
        connection = etree.SubElement(root, "connection")
        connection.set("from", link.from_edge)
        connection.set("to", link.to_edge)
        connection.set("fromLane", str(link.from_lane))
        connection.set("toLane", str(link.to_lane))
    for road in spec.roads:
        for node in dict.fromkeys(road.crosswalks):
            ways: tuple[Direction, ...] = ("forward", "backward")
            edges = " ".join(edge_id(road.id, way) for way in ways if lanes(road, way))
            etree.SubElement(root, "crossing", node=node, edges=edges, width=f"{CROSSWALK_M:g}", priority="1")
    return to_text(root)


# ------------------------------------------------------------------ schema
def xsd_findings(plain: PlainXml) -> list[Finding]:
    """What SUMO's own schemas say against plain XML (netconvert itself lets most of it pass, or crashes)."""
    parts = {"nodes": plain.nodes, "edges": plain.edges, "connections": plain.connections}
    return [f for part, text in parts.items() if text or part != "connections" for f in sumo_findings(part, text)]


def sumo_findings(kind: str, text: str) -> list[Finding]:
    """What SUMO's schema of a kind of file ("nodes", "edges", "connections", "net", "routes") says against it."""
    try:
        root = parse_xml(text, f"sumo_xsd {kind}")
    except InvalidOutput as fault:
        return list(fault.findings)
    remedy = f"follow SUMO's schema of {kind} files"
    schema = xml_schema(settings.sumo_home() / "data" / "xsd" / f"{kind}_file.xsd")
    return [
        Finding(source="sumo_xsd", what=message, where=f"{kind}, line {line}", remedy=remedy)
        for line, message in schema_errors(schema, root)
    ] or list(_too_wide(kind, root))


def _too_wide(kind: str, root: Element) -> Iterator[Finding]:
    """Edges of more lanes than any road has: SUMO's schema takes a million, and netconvert then all memory."""
    for edge in root.iter("edge", "type"):
        if int(edge.get("numLanes") or 1) > MAX_LANES:
            yield Finding(
                source="sumo_xsd",
                what=f"an edge has at most {MAX_LANES} lanes",
                where=f"{kind}, line {edge.sourceline}",
                value=edge.get("numLanes"),
                remedy="give the lanes of one direction, as the report tells them",
            )
