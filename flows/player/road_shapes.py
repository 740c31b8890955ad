"""Shapes of a road network to draw: asphalt, lane lines, stop lines; for the player and the picture.

Read from SUMO's .net.xml; meters, x east, y north; no pixels and no colors.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.parameters import KIND
from sgcad_core.formats.xml import parse_xml
from sgcad_core.geometry.plane import offset_polyline
from sgcad_core.kinds import UNPAINTED
from sgcad_core.records.specs import Ground
from sgcad_core.roads.areas.closures import cones
from sgcad_core.roads.areas.gores import gores
from sgcad_core.roads.areas.roadside import roadsides
from sgcad_core.roads.lane_graph import ROAD_WORKS, Edge, Lane, LaneGraph

Floats = NDArray[np.float64]
Style = Literal["edge", "lane", "center", "stop"]
SIDEWALK = "sidewalk"
"""Type of a lane that has a curb and no edge line."""
HELD = set("sZw")
"""SUMO's connection states that make traffic stop: stop, zipper excluded by its node, all-way stop."""


@dataclass(frozen=True)
class Strip:
    """A lane's asphalt: center line (n, 2) and width."""

    points: Floats
    width_m: float
    cars: bool


@dataclass(frozen=True)
class Line:
    """A painted line, (n, 2)."""

    points: Floats
    style: Style


@dataclass(frozen=True)
class Mark:
    """A sign or an arrow at a lane's end: where, which way traffic goes there (radians), an arrow's directions."""

    kind: Literal["signal", "stop", "arrow"]
    x_m: float
    y_m: float
    heading_rad: float
    directions: str = ""
    edge: str = ""
    """The approach that a signal or a sign stands at."""


@dataclass(frozen=True)
class Drawing:
    """All shapes from the ground up, and signs; `crossings` are crosswalks."""

    areas: tuple[Floats, ...]
    strips: tuple[Strip, ...]
    lines: tuple[Line, ...]
    crossings: tuple[Strip, ...] = ()
    marks: tuple[Mark, ...] = ()
    cones: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    """(n, 2) places of traffic cones."""
    gores: tuple[Floats, ...] = ()
    """Corners of the painted gores at ramps, (n, 2) each."""
    grounds: tuple[tuple[Ground, Floats], ...] = ()
    """Ground beside the roads: its kind, and its corners, (n, 2)."""


def drawing_of(net_xml: str) -> Drawing:
    """The shapes of a network. Raises InvalidOutput where it cannot be read."""
    graph, root = parse_net(net_xml), parse_xml(net_xml, "net_xml")
    try:
        return _drawing(graph, root)
    except (ValueError, LookupError) as fault:
        raise InvalidOutput(
            f"net_xml: a place, a width or a lane that is none ({fault!s:.200}); make it anew"
        ) from fault


def _drawing(graph: LaneGraph, root: Any) -> Drawing:
    strips = [Strip(ln.shape, ln.width_m, ln.allows_cars) for e in graph.edges.values() for ln in e.lanes]
    strips += [Strip(c.via_shape, _width(graph, c.from_edge, c.from_lane), True) for c in graph.connections]
    lines = [line for edge in graph.edges.values() for line in _edge_lines(edge, graph)]
    lines += _stop_lines(root, graph)
    return Drawing(
        tuple(_areas(root)), tuple(strips), tuple(lines), tuple(_crossings(root)), tuple(_marks(root, graph)),
        np.vstack([np.zeros((0, 2)), *(places for _, places in cones(graph))]),
        tuple(gore.corners for gore in gores(graph)),
        tuple((strip.kind, strip.corners) for strip in roadsides(graph)),
    )  # fmt: skip


def _areas(root: Any) -> list[Floats]:
    """Polygons of the junctions (dead ends have none)."""
    shapes = [j.get("shape", "") for j in root.iterfind("junction") if j.get("type") not in ("internal", "dead_end")]
    points = [[[float(v) for v in p.split(",")[:2]] for p in shape.split()] for shape in shapes]
    return [np.array(p) for p in points if len(p) > 2]


def _width(graph: LaneGraph, edge: str, lane: int) -> float:
    return next((ln.width_m for ln in graph.edges[edge].lanes if ln.index == lane), 3.2)


def _edge_lines(edge: Edge, graph: LaneGraph) -> list[Line]:
    """Right edge, lines between lanes, left edge: yellow where traffic comes the other way or must not go.

    Driveways and alleys carry no paint.
    """
    if edge.parameters.get(KIND) in UNPAINTED:
        return []
    right, left = edge.lanes[0], edge.lanes[-1]
    lines = [] if right.type == SIDEWALK else [Line(_side(right, -1), "edge")]
    lines.append(Line(_side(left, +1), "center"))
    return lines + [Line(_side(a, +1), _between(a, b)) for a, b in pairwise(edge.lanes)]


def _between(right: Lane, left: Lane) -> Style:
    """The line between two lanes: dashed between lanes for cars, whole beside a shoulder, a sidewalk and the like."""
    return "edge" if {right.type, left.type} - {"", ROAD_WORKS} else "lane"


def _side(lane: Lane, side: int) -> Floats:
    """The lane's left (+1) or right (-1) border, drawn 0.12 m inside of it."""
    return offset_polyline(lane.shape, side * (lane.width_m / 2 - 0.12))


def _stop_lines(root: Any, graph: LaneGraph) -> list[Line]:
    held = {
        (c.get("from", ""), int(c.get("fromLane", "0")))
        for c in root.iterfind("connection")
        if c.get("tl") or c.get("state") in HELD
    }
    return [
        Line(_across(lane), "stop")
        for edge in graph.edges.values()
        for lane in edge.car_lanes
        if (edge.id, lane.index) in held
    ]


def _across(lane: Lane) -> Floats:
    """A line across the lane, 0.5 m before its end."""
    end, before = lane.shape[-1], lane.shape[-2]
    along = (end - before) / max(float(np.hypot(*(end - before))), 1e-9)
    half = np.array([-along[1], along[0]]) * (lane.width_m / 2 - 0.2)
    place = end - along * 0.5
    return np.array([place - half, place + half])


# ------------------------------------------------------------------ signs, arrows, crosswalks
ARROW_M, ARROW_LANES = 7.0, 2
"""Distance of an arrow from the end of its lane, and the number of car lanes one way from which arrows are drawn."""
BESIDE_M = 1.2
"""Distance of a sign to the right of the outermost lane."""
STOPPED = set("sw")
"""SUMO's states of connections behind a stop sign: one way, all ways."""


def _crossings(root: Any) -> Iterator[Strip]:
    for edge in root.iterfind("edge[@function='crossing']"):
        for lane in edge.iterfind("lane"):
            points = np.array([[float(v) for v in p.split(",")[:2]] for p in lane.get("shape", "").split()])
            if len(points) > 1:
                yield Strip(points, float(lane.get("width", "3")), False)


def _marks(root: Any, graph: LaneGraph) -> Iterator[Mark]:
    """A signal or a stop sign a road's end, as its connections are controlled; an arrow a lane."""
    ways: dict[str, dict[int, set[str]]] = {}
    control: dict[str, Literal["signal", "stop"]] = {}
    for c in root.iterfind("connection"):
        source = c.get("from", "")
        if source in graph.edges:
            ways.setdefault(source, {}).setdefault(int(c.get("fromLane", "0")), set()).add(c.get("dir", "").lower())
            if c.get("tl"):
                control[source] = "signal"
            elif c.get("state") in STOPPED:
                control[source] = "stop"
    for source, lanes in ways.items():
        edge = graph.edges[source]
        if source in control and edge.car_lanes:
            beside = edge.car_lanes[0].width_m / 2 + BESIDE_M
            yield replace(_mark(control[source], edge.car_lanes[0], 0.5, beside), edge=source)
        cars = [lane for lane in edge.car_lanes if len(edge.car_lanes) >= ARROW_LANES and lane.index in lanes]
        if set().union(*lanes.values()) - {"s"}:
            yield from (_mark("arrow", lane, ARROW_M, 0.0, "".join(sorted(lanes[lane.index]))) for lane in cars)


def _mark(
    kind: Literal["signal", "stop", "arrow"], lane: Lane, before_m: float, right_m: float, directions: str = ""
) -> Mark:
    end, before = lane.shape[-1], lane.shape[-2]
    along = (end - before) / max(float(np.hypot(*(end - before))), 1e-9)
    x, y = end - along * before_m + np.array([along[1], -along[0]]) * right_m
    return Mark(kind, float(x), float(y), float(np.arctan2(along[1], along[0])), directions)
