"""SUMO's .net.xml read into a lane graph.

Reading only; netconvert writes. Knows no OpenDRIVE.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache

import numpy as np

from sgcad_core.case.records import Finding
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.xml import Element, parse_xml
from sgcad_core.roads.lane_graph import (
    Connection,
    Crossing,
    Direction,
    Edge,
    Floats,
    Lane,
    LaneGraph,
    NetNode,
    NetworkFigures,
    Phase,
    Program,
    contracted,
    edge_id,
    network_figures,
    road_of,
    segments,
)

__all__ = [
    "Connection", "Direction", "Edge", "Floats", "Lane", "LaneGraph", "NetNode", "NetworkFigures", "edge_id",
    "network_figures", "parse_net", "road_of", "segments",
]  # fmt: skip

_NO_OFFSET = ("0.00,0.00", "0.000000,0.000000")
DEFAULT_WIDTH_M = 3.2  # SUMO's own, where a lane names none
_DIRECTIONS: dict[str, Direction] = {"l": "left", "L": "left", "r": "right", "R": "right", "t": "u_turn"}


@lru_cache(maxsize=8)
def parse_net(net_xml: str) -> LaneGraph:
    """Read a .net.xml; the last ones are kept, since every stage of a case asks for its own network's graph.

    Raises InvalidOutput where it is no network or misses what it refers to.
    """
    root = parse_xml(net_xml, "net_xml")
    if root.tag != "net":
        raise _invalid("no SUMO network", "/", f"<{root.tag}>", "the root element is <net>")
    inner = {lane.get("id", ""): _shape(lane) for e in root.iterfind("edge[@function]") for lane in e.iterfind("lane")}
    edges = {e.get("id", ""): _edge(e) for e in root.iterfind("edge") if e.get("function", "normal") == "normal"}
    nodes = {j.get("id", ""): _node(j) for j in root.iterfind("junction") if j.get("type") != "internal"}
    _check_ends(edges, nodes)
    links = tuple(_connections(root, edges, inner))
    return LaneGraph(edges, links, nodes, _programs(root), _circles(root), tuple(_crossings(root)), _projection(root))


def _projection(root: Element) -> str:
    """Of a frame without an offset, such as every network that is drawn here has; "" elsewhere."""
    location = root.find("location")
    told = "" if location is None else location.get("projParameter", "")
    return told if told.startswith("+proj") and location.get("netOffset") in _NO_OFFSET else ""


def lanes_between(net_xml: str) -> dict[tuple[str, str], int]:
    """Passenger lanes by the two nodes of an edge: all that counting needs, at a tenth of `parse_net`'s cost.

    Raises InvalidOutput where it is no XML.
    """
    found: dict[tuple[str, str], int] = {}
    root = parse_xml(net_xml, "net_xml")
    for edge in root.iterfind("edge"):
        ends = edge.get("from", ""), edge.get("to", "")
        lanes = sum(map(_allows_cars, edge.iterfind("lane")))
        if edge.get("function", "normal") == "normal" and lanes and ends[0] != ends[1]:
            found[ends] = found.get(ends, 0) + lanes
    return contracted(found, {node: min(circle) for circle in _circles(root) for node in circle})


def _circles(root: Element) -> tuple[frozenset[str], ...]:
    """Nodes of every roundabout that has some."""
    found = (frozenset(circle.get("nodes", "").split()) for circle in root.iterfind("roundabout"))
    return tuple(circle for circle in found if circle)


def _crossings(root: Element) -> Iterator[Crossing]:
    """Crosswalks, each an internal edge named ":<node>_c<number>"."""
    for edge in root.iterfind("edge[@function='crossing']"):
        for lane in edge.iterfind("lane"):
            node = edge.get("id", "").removeprefix(":").rpartition("_")[0]
            over = tuple(edge.get("crossingEdges", "").split())
            yield Crossing(node, over, _shape(lane), _number(lane, "width", DEFAULT_WIDTH_M))


def _edge(element: Element) -> Edge:
    lanes = tuple(sorted((_lane(lane) for lane in element.iterfind("lane")), key=lambda lane: lane.index))
    ends = element.get("from", ""), element.get("to", "")
    return Edge(element.get("id", ""), *ends, lanes, int(_number(element, "priority", -1)), _parameters(element))


def _parameters(element: Element) -> dict[str, str]:
    return {param.get("key", ""): param.get("value", "") for param in element.iterfind("param")}


def _lane(element: Element) -> Lane:
    return Lane(
        id=element.get("id", ""),
        index=int(_number(element, "index")),
        shape=_shape(element),
        width_m=_number(element, "width", DEFAULT_WIDTH_M),
        length_m=_number(element, "length"),
        speed_mps=_number(element, "speed"),
        allows_cars=_allows_cars(element),
        type=element.get("type", ""),
    )


def _allows_cars(lane: Element) -> bool:
    allow, disallow = lane.get("allow", "").split(), lane.get("disallow", "").split()
    return (not allow or bool({"passenger", "all"} & set(allow))) and not {"passenger", "all"} & set(disallow)


def _node(element: Element) -> NetNode:
    return NetNode(_number(element, "x"), _number(element, "y"), element.get("type", ""), _parameters(element))


def _number(element: Element, name: str, default: float | None = None) -> float:
    text = element.get(name)
    if text is None and default is not None:
        return default
    try:
        value = float(text)
    except (TypeError, ValueError):
        value = np.nan
    if not np.isfinite(value):
        raise _invalid(f"{name} is no finite number", _path(element), repr(text), f"give {name} a number")
    return float(value)


def _shape(element: Element) -> Floats:
    text = element.get("shape", "")
    try:
        points = np.array([[float(v) for v in p.split(",")[:2]] for p in text.split()], dtype=float)
    except ValueError:
        points = np.empty((0,))
    if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 2 or not np.isfinite(points).all():
        raise _invalid("a lane needs a shape of two or more points", _path(element), text[:60], 'write "x,y x,y"')
    points.setflags(write=False)  # graphs are shared, see `parse_net`
    return points


def _connections(root: Element, edges: Mapping[str, Edge], inner: Mapping[str, Floats]) -> Iterator[Connection]:
    """Connections between normal edges; an internal lane split by an internal junction is followed to its end."""
    raw = list(root.iterfind("connection"))
    onward = {f"{c.get('from')}_{c.get('fromLane')}": c.get("via") for c in raw if c.get("from", "").startswith(":")}
    for c in raw:
        if ":" in (c.get("from", "")[:1], c.get("to", "")[:1]):  # within junctions, and over walking areas
            continue
        start, end = _lane_at(c, "from", edges), _lane_at(c, "to", edges)
        pieces = [start.shape[-1:], *(inner[v] for v in _chain(c.get("via"), onward) if v in inner), end.shape[:1]]
        direction = _DIRECTIONS.get(c.get("dir"), "through")
        control = c.get("state", ""), c.get("tl", ""), int(_number(c, "linkIndex", -1))
        yield Connection(c.get("from"), start.index, c.get("to"), end.index, _joined(pieces), direction, *control)


def _programs(root: Element) -> dict[str, Program]:
    """The first program of every signal, as netconvert writes them."""
    found: dict[str, Program] = {}
    for logic in root.iterfind("tlLogic"):
        phases = [Phase(_number(p, "duration"), p.get("state", "")) for p in logic.iterfind("phase")]
        found.setdefault(logic.get("id", ""), Program(_number(logic, "offset", 0.0), tuple(phases)))
    return found


def _chain(via: str | None, onward: Mapping[str, str | None]) -> Iterator[str]:
    seen: set[str] = set()
    while via and via not in seen:
        seen.add(via)
        yield via
        via = onward.get(via)


def _joined(pieces: list[Floats]) -> Floats:
    """Polyline of the pieces without repeated points; a straight line where start and end coincide."""
    points = np.vstack(pieces)
    keep = np.append(True, np.hypot(*np.diff(points, axis=0).T) > 1e-3)
    return points[keep] if keep.sum() > 1 else points[[0, -1]]


def _lane_at(connection: Element, end: str, edges: Mapping[str, Edge]) -> Lane:
    edge, index = edges.get(connection.get(end, "")), connection.get(f"{end}Lane", "")
    for lane in edge.lanes if edge else ():
        if str(lane.index) == index:
            return lane
    name = f"{connection.get(end)}_{index}"
    raise _invalid("connection to a lane that is not there", _path(connection), name, "name a lane of the network")


def _check_ends(edges: Mapping[str, Edge], nodes: Mapping[str, NetNode]) -> None:
    for edge in edges.values():
        if not edge.lanes:
            raise _invalid("an edge needs a lane", f"edge {edge.id}", "no <lane>", "give it one")
        for node in (edge.from_node, edge.to_node):
            if node not in nodes:
                raise _invalid("an edge ends at a node that is not there", f"edge {edge.id}", node, "add the node")


def _path(element: Element) -> str:
    return f"<{element.tag} id={element.get('id')!r}> in line {element.sourceline}"


def _invalid(what: str, where: str, value: str, remedy: str) -> InvalidOutput:
    return InvalidOutput.of(Finding(source="net_xml", what=what, where=where, value=value, remedy=remedy))
