"""OpenDRIVE elements of roads: geometry, lanes, widths, markings, speeds. Knows lxml and the records of streets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lxml import etree

from sgcad_core.formats.opendrive.connecting import ConnectingCurve, Connector
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.opendrive.marks import LINE_M, NONE, Mark, center_mark, outer_mark
from sgcad_core.formats.opendrive.reference import Piece
from sgcad_core.formats.opendrive.signals import posted_mph
from sgcad_core.formats.opendrive.streets import BESIDE_TYPES, RoadLane, Street
from sgcad_core.formats.opendrive.widths import Width
from sgcad_core.formats.sumo.parameters import LIMIT, MEDIAN, USUAL
from sgcad_core.formats.xml import Element
from sgcad_core.roads.lane_graph import ROAD_WORKS, Edge

LANE_CODE = "sumoLane"
"""`<userData>` of a lane: the SUMO lane that it is."""
_CUBIC = ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV")


def add_child(parent: Element, tag: str, /, attributes: Mapping[str, str] | None = None, **more: str) -> Element:
    """A new last child; `attributes` for names that Python keeps for itself."""
    return etree.SubElement(parent, tag, {**(attributes or {}), **more})


def decimal_text(value: float) -> str:
    """A length or coordinate with 0.01 micrometres."""
    return f"{value + 0.0:.8f}"


# ------------------------------------------------------------------ geometry
def add_pieces(plan: Element, line: Sequence[Piece]) -> None:
    """Lines and arcs of a reference line."""
    s = 0.0
    for piece in line:
        geometry = _geometry(plan, s, piece.start, piece.length_m)
        if piece.curvature:
            add_child(geometry, "arc", curvature=f"{piece.curvature:.12g}")
        else:
            add_child(geometry, "line")
        s += piece.length_m


def add_cubic(plan: Element, way: ConnectingCurve) -> None:
    """The one curve (or line) of a connecting road."""
    geometry = _geometry(plan, 0.0, way.start, way.length_m)
    if way.cubic is None:
        add_child(geometry, "line")
        return
    poly = add_child(geometry, "paramPoly3", pRange="normalized")
    for name, value in zip(_CUBIC, way.cubic, strict=True):
        poly.set(name, decimal_text(value))


def _geometry(plan: Element, s: float, start: Pose, length: float) -> Element:
    made = add_child(plan, "geometry", s=decimal_text(s), x=decimal_text(start.x_m), y=decimal_text(start.y_m))
    made.set("hdg", f"{start.heading_rad:.10f}")
    made.set("length", decimal_text(length))
    return made


# ------------------------------------------------------------------ lanes
def add_street_lanes(lanes: Element, street: Street) -> None:
    """The one lane section of a street."""
    section = add_child(lanes, "laneSection", s="0")
    if street.left:
        left = add_child(section, "left")
        for strip in reversed(street.left):
            _lane(left, street, strip, street.backward)
    _center(section, center_mark(street))
    right = add_child(section, "right")
    for strip in street.right:
        _lane(right, street, strip, street.forward)


def _center(section: Element, mark: Mark) -> None:
    _mark(add_child(add_child(section, "center"), "lane", id="0", type="none", level="false"), mark)


def _lane(side: Element, street: Street, strip: RoadLane, edge: Edge | None) -> None:
    lane = add_child(side, "lane", id=str(strip.id), type=strip.type, level="false")
    for width in strip.widths:
        _width(lane, width)
    _mark(lane, outer_mark(street, strip))
    if strip.lane is not None and edge is not None:
        if strip.type not in BESIDE_TYPES or strip.type == ROAD_WORKS:
            _speed(lane, edge, strip.lane.speed_mps)
        add_child(lane, "userData", code=LANE_CODE, value=strip.lane.id)
    elif strip.type == "median" and MEDIAN in street.forward.parameters:
        add_child(lane, "userData", code=MEDIAN, value=street.forward.parameters[MEDIAN])


def _width(lane: Element, width: Width) -> None:
    add_child(
        lane, "width", sOffset=decimal_text(width.s_m), a=decimal_text(width.a), b=decimal_text(width.b), c="0", d="0"
    )


def _mark(lane: Element, mark: Mark) -> None:
    made = add_child(lane, "roadMark", sOffset="0", type=mark.type, weight="standard", color=mark.color)
    if mark != NONE:
        made.set("width", f"{LINE_M:g}")
    made.set("laneChange", mark.lane_change)


def _speed(lane: Element, edge: Edge, speed_mps: float) -> None:
    """A posted limit as posted, a map's speed as it stands; an assumed one is no limit and stays out."""
    if (limit := posted_mph(edge)) is not None:
        add_child(lane, "speed", sOffset="0", max=f"{limit:g}", unit="mph")
    elif edge.parameters.get(LIMIT) != USUAL:
        add_child(lane, "speed", sOffset="0", max=f"{speed_mps:.6g}", unit="m/s")


def add_connector_lanes(lanes: Element, connector: Connector) -> None:
    """One lane around the reference line, as wide as the lanes it joins."""
    first, last = connector.widths
    slope = (last - first) / connector.way.length_m
    add_child(lanes, "laneOffset", s="0", a=decimal_text(first / 2), b=decimal_text(slope / 2), c="0", d="0")
    section = add_child(lanes, "laneSection", s="0")
    _center(section, NONE)
    kind = "driving" if connector.incoming.type == "driving" else connector.incoming.type
    lane = add_child(add_child(section, "right"), "lane", id="-1", type=kind, level="false")
    link = add_child(lane, "link")
    add_child(link, "predecessor", id=str(connector.incoming.id))
    add_child(link, "successor", id=str(connector.outgoing.id))
    _width(lane, Width(0.0, first, slope))
    _mark(lane, NONE)
