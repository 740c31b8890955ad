"""A map that exists already (.net.xml or .xodr) as plain XML under the project's ids, its main junction at (0, 0).

netconvert reads the file; roads become "R1", "R2", ..., edge "R1" one way and "-R1" the other, nodes "n1", ... Only
edges and connections for cars are kept. What netconvert leaves of an .xodr (stop and yield signs, two-way left-turn
lanes) is read here. Knows no crash.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from lxml import etree

from sgcad_core.case.records import PlainXml
from sgcad_core.errors import ConfigError, InvalidOutput
from sgcad_core.formats.opendrive.controls import imported_lanes, lane_links, signed_junctions, width_of
from sgcad_core.formats.sumo.graph_spec import CONTROLS
from sgcad_core.formats.sumo.netconvert import plain_files
from sgcad_core.formats.sumo.parameters import CONTROL
from sgcad_core.formats.sumo.plain_xml import BESIDE, CENTER_LANE_CLASS
from sgcad_core.formats.xml import Element, parse_xml, to_text
from sgcad_core.roads.junction_words import JunctionLeg
from sgcad_core.system.temp_folders import temp_folder

TIMEOUT_S = 120.0
MOST_EDGES = 110
"""What a road spec can hold; larger maps are cut with `sgcad index build` or by hand."""
OUT_M = 20.0
"""A leg's direction is taken so far from its junction."""
BESIDE_RAD = math.radians(15)
_FLAGS = ("--keep-edges.by-vclass", "passenger", "--no-turnarounds", "-X", "never")
_EDGE = ("numLanes", "speed", "priority", "shape", "spreadType", "width")
_LINK = ("fromLane", "toLane")


def read_map(file: Path) -> PlainXml:
    """Read a map. Raises ConfigError naming the file for one that netconvert cannot read or that is too large."""
    nodes, edges, links = map_parts(file)
    found = _with_junction(list(edges.iterfind("edge")))
    if not 0 < len(found) <= MOST_EDGES:
        raise ConfigError(f"{file}: {len(found)} one-way edges, a map has 1 to {MOST_EDGES}: cut it smaller")
    return _renamed(nodes, found, links)


def map_parts(file: Path, flags: Sequence[str] = _FLAGS) -> tuple[Element, Element, Element]:
    """Nodes, edges and connections as netconvert reads them, completed where it ignores parts of an .xodr.

    Raises ConfigError naming the file for one that cannot be read.
    """
    with temp_folder("map") as folder:
        parts = _converted(file, flags, folder)
    try:
        nodes, edges, links = (parse_xml(text, file.name) for text in parts)
        if file.name.endswith(".xodr"):
            _restore(parse_xml(file.read_text(encoding="utf-8"), file.name), nodes, edges, links)
    except InvalidOutput as fault:
        raise ConfigError(f"{file}: {fault}") from fault
    return nodes, edges, links


def _converted(file: Path, flags: Sequence[str], folder: Path) -> list[str]:
    kind = "--opendrive-files" if file.name.endswith(".xodr") else "--sumo-net-file"
    parts = plain_files(file, (kind, str(file.resolve()), *flags), folder, TIMEOUT_S)
    return [part.read_text(encoding="utf-8") for part in parts]


def _restore(xodr: Element, nodes: Element, edges: Element, links: Element) -> None:
    """Adds signs, two-way left-turn lanes and merging lanes of an OpenDRIVE file, which netconvert ignores."""
    known = {edge.get("id") for edge in edges.iterfind("edge")}
    there = {(c.get("from"), c.get("fromLane"), c.get("to"), c.get("toLane")) for c in links.iterfind("connection")}
    for came, lane, goes, goal in sorted(lane_links(xodr)):
        if {came, goes} <= known and (came, str(lane), goes, str(goal)) not in there:
            made = etree.SubElement(links, "connection", fromLane=str(lane), toLane=str(goal), to=goes)
            made.set("from", came)
    signed = signed_junctions(xodr)
    for node in nodes.iterfind("node"):
        if sign := signed.get(node.get("id")):
            node.set("type", sign.type)
            etree.SubElement(node, "param", key=CONTROL, value=sign.control)
    minor = {edge for sign in signed.values() for edge in sign.minor}
    drawn = imported_lanes(xodr)
    for edge in edges.iterfind("edge"):
        if edge.get("id") in minor:
            edge.set("priority", "0")
        _restore_lanes(edge, drawn.get(edge.get("id"), []))


def _restore_lanes(edge: Element, drawn: list[Element]) -> None:
    """Sets widths, which netconvert omits where all lanes have one, and the vehicle class of a center lane."""
    there = {int(lane.get("index")): lane for lane in edge.iterfind("lane")}
    for index, source in enumerate(drawn[: int(edge.get("numLanes", 1))]):
        lane = there[index] if index in there else etree.SubElement(edge, "lane", index=str(index))
        if (width := width_of(source)) is not None:
            lane.set("width", f"{width:.3f}")
        if source.get("type") == "bidirectional":
            lane.attrib.pop("disallow", "")
            lane.set("allow", CENTER_LANE_CLASS)
        if source.get("type") == "parking":
            lane.attrib.pop("disallow", "")
            lane.set("allow", BESIDE["parking"].allow)
            lane.set("type", BESIDE["parking"].type)


# ------------------------------------------------------------------ ids
def _renamed(nodes: Element, edges: list[Element], links: Element) -> PlainXml:
    places = {n.get("id"): n for n in nodes.iterfind("node")}
    used = dict.fromkeys(end for e in edges for end in (e.get("from"), e.get("to")))
    names = {old: f"n{i}" for i, old in enumerate(used, 1)}
    roads = _road_names(edges)
    shift = _place(places[_hub(edges)])
    return PlainXml(
        nodes=_document("nodes", (_node(places[old], new, shift) for old, new in names.items())),
        edges=_document("edges", (_edge(e, roads, names, shift) for e in edges)),
        connections=_document("connections", _links(links, roads)),
    )


def _road_names(edges: list[Element]) -> Mapping[str, str]:
    """Edge -> new id; two edges there and back between the same nodes are one road."""
    found: dict[str, str] = {}
    waiting: dict[tuple[str, str], list[str]] = {}
    for edge in edges:
        ends = edge.get("from"), edge.get("to")
        back = waiting.get(ends[::-1], [])
        if back:
            found[edge.get("id")] = f"-{back.pop(0)}"
        else:
            found[edge.get("id")] = name = f"R{len(found) + 1}"
            waiting.setdefault(ends, []).append(name)
    return found


def _hub(edges: list[Element]) -> str:
    """The node with the most neighbors; of equals the first. A plain road's is the one with two."""
    near = _neighbors(edges)
    return max(near, key=lambda node: len(near[node]))


def _place(node: Element) -> tuple[float, float]:
    return float(node.get("x")), float(node.get("y"))


def _node(node: Element, name: str, shift: tuple[float, float]) -> Element:
    x, y = _place(node)
    made = etree.Element("node", id=name, x=f"{x - shift[0]:.3f}", y=f"{y - shift[1]:.3f}")
    made.set("type", node.get("type", "priority"))
    made.extend(list(node.iterfind("param")))
    return made


def _edge(edge: Element, roads: Mapping[str, str], names: Mapping[str, str], shift: tuple[float, float]) -> Element:
    made = etree.Element("edge", id=roads[edge.get("id")])
    made.set("from", names[edge.get("from")])
    made.set("to", names[edge.get("to")])
    for name in _EDGE:
        if edge.get(name) is not None:
            made.set(name, _moved(edge.get(name), shift) if name == "shape" else edge.get(name))
    for lane in edge.iterfind("lane"):
        kept = {k: v for k, v in lane.attrib.items() if k in ("index", "allow", "disallow", "width", "speed", "type")}
        etree.SubElement(made, "lane", kept)
    return made


def _moved(shape: str, shift: tuple[float, float]) -> str:
    points = (point.split(",")[:2] for point in shape.split())
    return " ".join(f"{float(x) - shift[0]:.3f},{float(y) - shift[1]:.3f}" for x, y in points)


def _links(links: Element, roads: Mapping[str, str]) -> Iterator[Element]:
    for link in links.iterfind("connection"):
        if link.get("from") in roads and link.get("to") in roads and all(link.get(k) for k in _LINK):
            made = etree.Element("connection")
            made.set("from", roads[link.get("from")])
            made.set("to", roads[link.get("to")])
            for name in _LINK:
                made.set(name, link.get(name))
            yield made


def _document(name: str, children: Iterable[Element]) -> str:
    root = etree.Element(name)
    root.extend(list(children))
    return to_text(root)


def _with_junction(edges: list[Element]) -> list[Element]:
    """Without roads that are joined to no junction, where the map has one.

    (netconvert's --remove-edges.isolated removes a map that is one plain road as well.)
    """
    near = _neighbors(edges)
    kept: set[str] = set()
    stack = [node for node, others in near.items() if len(others) > 2]
    while stack:
        if (node := stack.pop()) not in kept:
            kept.add(node)
            stack += near[node]
    return [edge for edge in edges if edge.get("from") in kept] if kept else edges


def _neighbors(edges: list[Element]) -> dict[str, set[str]]:
    near: dict[str, set[str]] = {}
    for edge in edges:
        near.setdefault(edge.get("from"), set()).add(edge.get("to"))
        near.setdefault(edge.get("to"), set()).add(edge.get("from"))
    return near


# ------------------------------------------------------------------ the main junction
def hub_legs(plain: PlainXml) -> tuple[tuple[JunctionLeg, ...], str]:
    """Legs of the node with the most neighbors, and its control in the words of specs."""
    edges = list(parse_xml(plain.edges, "edges").iterfind("edge"))
    nodes = {n.get("id"): n for n in parse_xml(plain.nodes, "nodes").iterfind("node")}
    hub = _hub(edges)
    legs: dict[str, JunctionLeg] = {}
    for edge in edges:
        inward = edge.get("to") == hub
        if hub in (edge.get("from"), edge.get("to")):
            other = edge.get("from") if inward else edge.get("to")
            known = legs.get(other) or JunctionLeg(_direction(edge, inward, nodes[hub], nodes[other]), 0, 0)
            count = int(edge.get("numLanes", 1)) - len(edge.findall("lane[@allow]"))
            legs[other] = known._replace(
                lanes_in=known.lanes_in + count * inward, lanes_out=known.lanes_out + count * (not inward)
            )
    joined = tuple(_joined(list(legs.values())))
    return joined, CONTROLS.get(nodes[hub].get("type", ""), "none") if len(joined) > 2 else "none"


def _joined(legs: list[JunctionLeg]) -> Iterator[JunctionLeg]:
    """A way in and a way out that lie side by side are one leg: OpenDRIVE may draw a road a direction."""
    while legs:
        leg = legs.pop(0)
        for other in legs:
            near = abs(math.remainder(other.angle_rad - leg.angle_rad, math.tau)) < BESIDE_RAD
            if near and not (leg.lanes_in and other.lanes_in) and not (leg.lanes_out and other.lanes_out):
                legs.remove(other)
                leg = leg._replace(lanes_in=leg.lanes_in + other.lanes_in, lanes_out=leg.lanes_out + other.lanes_out)
                break
        yield leg


def _direction(edge: Element, inward: bool, hub: Element, other: Element) -> float:
    line = [tuple(map(float, p.split(",")[:2])) for p in edge.get("shape", "").split()] or [_place(hub), _place(other)]
    here = _place(hub)
    outward = line[::-1] if inward else line
    x, y = next((p for p in outward if math.dist(p, here) >= OUT_M), outward[-1])
    return math.atan2(y - here[1], x - here[0])
