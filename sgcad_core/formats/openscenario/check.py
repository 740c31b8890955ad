"""Checks of an OpenSCENARIO file: schema, references, places, boxes, times, and whether it plays.

Players accept much of this in silence (a missing lane, an s beyond the road), so it is said here. Schemas 1.0
to 1.3 come with scenariogeneration. Knows the .xodr through its index of roads and lanes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np
from lxml import etree

from sgcad_core.case.records import Finding
from sgcad_core.errors import InvalidOutput
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.opendrive.checks.road_index import RoadIndex, lane_index
from sgcad_core.formats.opendrive.geometry import end_pose, geometries, start_pose
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.reading.elements import XmlNode, read_root
from sgcad_core.formats.openscenario.reading.file_context import SOURCE
from sgcad_core.formats.xml import asam_schema, parse_xml, schema_errors
from sgcad_core.geometry.plane import Floats

_finding = FindingFactory(SOURCE)

MARGIN_M = 150.0
"""Farther than this outside the network's bounding box nothing can have to do with the crash."""
MAX_SPEED_MPS = 90.0
MAX_BOX_M = 40.0
ORIGIN_M = 1e-3
"""A rear axle nearer than this to the origin is there."""
MAX_FINDINGS = 20
_SCHEMAS = {"0": "1_0", "1": "1_1", "2": "1_2", "3": "1_3_1"}
_NAMED = ("Story", "Act", "ManeuverGroup", "Maneuver", "Event", "Action")
_ON_A_MAP = ("LanePosition", "RelativeLanePosition", "RoadPosition", "RelativeRoadPosition")


def xosc_findings(xosc: str, xodr: str | None, road_file: str = "road.xodr") -> list[Finding]:
    """Everything wrong, worst first, at most 20; an empty list is a pass.

    Schema faults stand alone; then references, places and sizes; what holds so far is played, unless it needs a map
    and none is given. Raises MissingTool without scenariogeneration's schemas.
    """
    try:
        root = read_root(xosc)
        broken = [
            _finding(message, f"line {line}", remedy="follow the OpenSCENARIO schema")
            for line, message in schema_errors(_schema_of(root), root.element)
        ]
        found = broken or list(islice(_content(root, xodr, road_file), MAX_FINDINGS))
        if not found and (xodr is not None or not _on_a_map(root)):
            play(xosc, xodr)
    except InvalidOutput as fault:
        return list(fault.findings)[:MAX_FINDINGS] or [_finding(str(fault))]
    return found[:MAX_FINDINGS]


def _on_a_map(root: XmlNode) -> bool:
    """Whether some place of the file is known on a map only."""
    return any(next(root.element.iter(name), None) is not None for name in _ON_A_MAP)


def _content(root: XmlNode, xodr: str | None, road_file: str) -> Iterator[Finding]:
    yield from _blamed(_entities, root)
    yield from _blamed(_entity_references, root)
    yield from _blamed(_doubles, root)
    yield from _blamed(_trajectories, root)
    yield from _logic_file(root, road_file)
    if xodr is not None:
        index, extent = lane_index(xodr), _extent(xodr)
        yield from _blamed(lambda r: _lane_places(r, index), root)
        yield from _blamed(lambda r: _world_places(r, extent), root)


def _blamed(check: Callable[[XmlNode], Iterator[Finding]], root: XmlNode) -> Iterator[Finding]:
    """A check's findings, and the fault that ended it."""
    try:
        yield from check(root)
    except InvalidOutput as fault:
        yield from fault.findings


# ------------------------------------------------------------------ schema
def _schema_of(root: XmlNode) -> etree.XMLSchema:
    header = root.need("FileHeader")
    minor = header.text("revMinor")
    if header.text("revMajor") != "1" or minor not in _SCHEMAS:
        raise header.fault("unknown OpenSCENARIO version", f"{header.text('revMajor')}.{minor}", "write revMinor 2")
    return asam_schema(f"OpenSCENARIO_{_SCHEMAS[minor]}")


# ------------------------------------------------------------------ entities
def _entities(root: XmlNode) -> Iterator[Finding]:
    objects = root.need("Entities").children("ScenarioObject")
    for name, count in Counter(o.text("name") for o in objects).items():
        if count > 1:
            yield _finding(f"{count} scenario objects have one name", "Entities", name, "rename them")
    limit = f"must be above 0 and at most {MAX_BOX_M:g} m"
    for box in _all(root, "Dimensions"):
        for side in ("length", "width", "height"):
            if not 0 < (value := box.number(side)) <= MAX_BOX_M:
                yield _finding(f"box {side} {limit}", _place(box), f"{value:g}", "give the size in metres")
    for axle in _all(root, "RearAxle"):
        if not _local(axle) and abs(x := axle.number("positionX")) > ORIGIN_M:
            what = "the entity's origin is the center of its rear axle, so that positionX must be 0"
            remedy = "give BoundingBox Center and FrontAxle positionX from the rear axle, and poses of the rear axle"
            yield _finding(what, _place(axle), f"{x:g}", remedy)


def _entity_references(root: XmlNode) -> Iterator[Finding]:
    known = {o.text("name") for o in root.need("Entities").children("ScenarioObject", "EntitySelection")}
    for element in root.element.iterfind(".//*[@entityRef]"):
        node = XmlNode(element, root.scope)
        if not _local(node) and (name := node.text("entityRef")) not in known:
            yield _finding("no such entity", _place(node), name, f"one of {', '.join(sorted(known))}")


def _doubles(root: XmlNode) -> Iterator[Finding]:
    """Equal names on one level of the storyboard."""
    for tag in _NAMED:
        names = Counter((e.getparent(), e.get("name")) for e in root.element.iterfind(f"Storyboard//{tag}"))
        for (parent, name), count in names.items():
            if count > 1:
                where = _place(XmlNode(parent, root.scope))
                yield _finding(f"{count} <{tag}> here have one name", where, name or "", "rename them")


# ------------------------------------------------------------------ places
def _logic_file(root: XmlNode, road_file: str) -> Iterator[Finding]:
    logic = root.need("RoadNetwork").find("LogicFile")
    found = logic.text("filepath") if logic else ""
    if found != road_file:
        what = "the scenario refers to another road network"
        yield _finding(what, "RoadNetwork/LogicFile", found, f"write {road_file!r}")


def _lane_places(root: XmlNode, index: RoadIndex) -> Iterator[Finding]:
    for node in (*_all(root, "LanePosition"), *_all(root, "RoadPosition")):
        if _local(node):
            continue
        lane = int(node.number("laneId")) if node.tag == "LanePosition" else None
        if fault := index.fault(node.text("roadId"), lane, node.number("s")):
            yield _finding(fault, _place(node), remedy="use a road, lane and s of the .xodr")


def _world_places(root: XmlNode, extent: Floats) -> Iterator[Finding]:
    """The first place of every trajectory and action that lies outside."""
    (x_low, y_low), (x_high, y_high) = extent[0] - MARGIN_M, extent[1] + MARGIN_M
    told = set()
    for place in _all(root, "WorldPosition"):
        if _local(place):
            continue
        x, y = place.number("x"), place.number("y")
        if x_low <= x <= x_high and y_low <= y <= y_high:
            continue
        holder = place.element.getparent().getparent()
        owner = holder.getparent() if holder.tag == "Vertex" else holder
        if owner not in told:
            told.add(owner)
            where = _place(XmlNode(owner, root.scope))
            yield _finding("far outside the road network", where, f"x = {x:g}, y = {y:g}", _remedy(extent))


def _remedy(extent: Floats) -> str:
    (x, y), (x2, y2) = extent
    return f"stay within {MARGIN_M:g} m of x {x:.0f} to {x2:.0f}, y {y:.0f} to {y2:.0f}"


def _extent(xodr: str) -> Floats:
    """(2, 2) lowest and highest x, y of the reference lines' ends."""
    poses = []
    for road in parse_xml(xodr, "xodr").iterfind("road"):
        for geometry in geometries(road):
            poses += [start_pose(geometry), end_pose(geometry) or start_pose(geometry)]
    points = np.array([pose[:2] for pose in poses] or [(-np.inf, -np.inf), (np.inf, np.inf)])
    return np.array([points.min(axis=0), points.max(axis=0)])


# ------------------------------------------------------------------ trajectories
def _trajectories(root: XmlNode) -> Iterator[Finding]:
    for line in _all(root, "Polyline"):
        vertices = line.children("Vertex")
        if any(v.element.get("time") is None or _local(v) for v in vertices):
            continue
        times = np.array([v.number("time") for v in vertices])
        if not len(falls := np.flatnonzero(np.diff(times) <= 0)):
            yield from _jumps(line, times)
            continue
        k = int(falls[0])
        remedy = "order the vertices by time, each time once"
        yield _finding("vertex times do not rise", _place(vertices[k + 1]), f"{times[k]:g}, {times[k + 1]:g} s", remedy)


def _jumps(line: XmlNode, times: Floats) -> Iterator[Finding]:
    places = [p for p in _all(line, "WorldPosition") if not _local(p)]
    if len(places) != len(times):
        return
    points = np.array([(p.number("x"), p.number("y")) for p in places])
    speed = np.hypot(*np.diff(points, axis=0).T) / np.diff(times)
    if (worst := float(speed.max())) > MAX_SPEED_MPS:
        where = _place(places[int(speed.argmax()) + 1])
        yield _finding("the actor jumps", where, f"{worst:.0f} m/s", f"stay below {MAX_SPEED_MPS:g} m/s")


# ------------------------------------------------------------------ shared
def _all(node: XmlNode, tag: str) -> Iterator[XmlNode]:
    return (XmlNode(e, node.scope) for e in node.element.iterfind(f".//{tag}"))


def _local(node: XmlNode) -> bool:
    """Whether it uses a parameter of a story, maneuver or trajectory, which only playing resolves."""
    return any("$" in v and v.lstrip("$") not in node.scope for v in node.element.attrib.values())


def _place(node: XmlNode) -> str:
    name = node.element.get("name")
    return f"<{node.tag}{f' name={name!r}' if name else ''}> in line {node.element.sourceline}"
