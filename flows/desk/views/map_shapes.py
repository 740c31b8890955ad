"""A case's map for the page: lanes that can be picked, paths and starts of all actors, the contact; plain numbers.

Metres, x east, y down as SVG has it (north stays up). Reads a case's folder; knows no page and no pixels.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from flows.desk.views.folder_files import LARGEST_TEXT, content_of, is_there
from flows.player.player_highlights import road_along, road_axes
from flows.player.road_shapes import drawing_of
from flows.results.reading import FinishedCase
from flows.results.report.scene import Scene, scene_of
from sgcad_core.errors import BadInput, InvalidOutput
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.roads.lane_graph import Edge, Floats, Lane, LaneGraph, road_of

MARGIN_M = 12.0
LEAST_HALF_M, MOST_HALF_M = 30.0, 160.0
NETWORK_HALF_M = 70.0
"""Half the side of the shown square of a network without trajectories."""
BESIDE_M = 5.0
"""From the edge of a road to the middle of its name."""
COLORS = 8
"""Colors of vehicles; the stylesheet names them c0 to c7, in the player's order."""


@dataclass(frozen=True)
class Strip:
    """A lane. `edge`, `road`, `direction`, `lane` (1 at the right curb): whose; `thing`: what it lights up with."""

    points: str
    width: float
    cars: bool
    edge: str = ""
    road: str = ""
    direction: str = ""
    lane: int = 0
    thing: str = ""


@dataclass(frozen=True)
class Vehicle:
    """An actor where it starts: centre, turned clockwise by `turn_deg` from east, and its path."""

    id: str
    color: int
    kind: str
    x: float
    y: float
    turn_deg: float
    length: float
    width: float
    path: str
    label: str


@dataclass(frozen=True)
class RoadMap:
    """Everything on the map. `box`: x, y, width, height to look at at first."""

    box: tuple[float, float, float, float]
    areas: tuple[str, ...] = ()
    strips: tuple[Strip, ...] = ()
    lines: tuple[tuple[str, str], ...] = ()
    vehicles: tuple[Vehicle, ...] = ()
    contact: tuple[float, float] | None = None
    names: tuple[tuple[str, float, float], ...] = field(default=())
    """Roads' names and where to write them."""

    @property
    def view(self) -> str:
        """The box as an SVG view."""
        return " ".join(f"{v:.1f}" for v in self.box)


def map_of(folder: Path, result: Mapping[str, Any]) -> RoadMap | None:
    """The map of a case; None where there is no network, or none that can be read."""
    try:
        net_xml = content_of(folder, "road.net.xml", LARGEST_TEXT).decode("utf-8")
        graph, drawing = parse_net(net_xml), drawing_of(net_xml)
    except (ValueError, BadInput, InvalidOutput):
        return None
    moved = is_there(folder, "trajectories.csv")
    scene = scene_of(FinishedCase(folder.parent.name, folder.name, folder, result, {})) if moved else None
    axes = road_axes(result.get("facts") or ())
    count = sum(len(edge.lanes) for edge in graph.edges.values())  # a drawing has the lanes first, then the ways across
    own = [(edge, lane) for edge in graph.edges.values() for lane in edge.lanes]
    lanes = [_lane(*place, road_along(strip, axes)) for place, strip in zip(own, drawing.strips, strict=False)]
    across = [Strip(_points(s.points), round(s.width_m, 2), s.cars) for s in drawing.strips[count:]]
    box = _box(scene, graph)
    return RoadMap(
        box=box, areas=tuple(_points(area) for area in drawing.areas), strips=(*across, *lanes),
        lines=tuple((line.style, _points(line.points)) for line in drawing.lines),
        vehicles=tuple(_vehicles(scene, result)) if scene else (),
        contact=_flipped(scene.contact_at) if scene and scene.contact_s is not None else None,
        names=tuple(_names(graph, box)),
    )  # fmt: skip


def _lane(edge: Edge, lane: Lane, thing: str) -> Strip:
    road, direction = road_of(edge.id)
    number = edge.car_lanes.index(lane) + 1 if lane in edge.car_lanes else 0
    return Strip(_points(lane.shape), round(lane.width_m, 2), lane.allows_cars, edge.id, road, direction, number, thing)


def _vehicles(scene: Scene, result: Mapping[str, Any]) -> Iterable[Vehicle]:
    actors = {actor["id"]: actor for actor in result.get("actors") or ()}
    for k, (name, path) in enumerate(scene.paths.items()):
        x, y, heading = (float(v) for v in path.pose[0])
        actor = actors.get(name, {})
        kind, maneuver = str(actor.get("type", "")), str(actor.get("maneuver", "")).replace("_", " ")
        yield Vehicle(
            name, k % COLORS, kind, round(x, 2), round(-y, 2), round(-float(np.degrees(heading)), 1), *path.size,
            _points(path.pose[:: max(1, len(path.pose) // 60), :2]), f"{name}, {kind}, {maneuver}",
        )  # fmt: skip


def _names(graph: LaneGraph, box: tuple[float, float, float, float]) -> Iterable[tuple[str, float, float]]:
    """Each road's name beside its lanes, where the road enters what is looked at."""
    x, y, wide, high = box
    seen: set[str] = set()
    for edge in graph.edges.values():
        road, _ = road_of(edge.id)
        if road in seen or graph.is_around(edge):
            continue
        shape = edge.lanes[0].shape
        inside = [p for p in _dense(shape) if x + 4 < p[0] < x + wide - 4 and y + 4 < -p[1] < y + high - 4]
        if inside:
            seen.add(road)
            hub = np.array([x + wide / 2, -(y + high / 2)])
            far = max(inside, key=lambda p: float(np.hypot(*(p - hub))))
            along = shape[-1] - shape[0]
            aside = np.array([along[1], -along[0]]) / max(float(np.hypot(*along)), 1e-6)
            far = far + (edge.lanes[0].width_m / 2 + BESIDE_M) * aside  # to the right of its outer lane
            inner = (np.clip(far[0], x + 4, x + wide - 4), np.clip(far[1], -(y + high - 4), -(y + 4)))
            yield road, round(float(inner[0]), 1), round(-float(inner[1]), 1)


def _dense(shape: Floats) -> Floats:
    """Points of a polyline, 30 from vertex to vertex."""
    steps = np.linspace(0, 1, 30)[:, None]
    return np.vstack([a + (b - a) * steps for a, b in pairwise(shape)])


def _box(scene: Scene | None, graph: LaneGraph) -> tuple[float, float, float, float]:
    """A square that holds all paths from their starts; without actors the middle of the network."""
    if scene is not None:
        points = np.vstack([path.pose[:, :2] for path in scene.paths.values()])
        low, high = points.min(axis=0), points.max(axis=0)
        half = float(min(max((high - low).max() / 2 + MARGIN_M, LEAST_HALF_M), MOST_HALF_M))
    else:
        points = np.vstack([lane.shape for edge in graph.edges.values() for lane in edge.lanes])
        low, high, half = points.min(axis=0), points.max(axis=0), NETWORK_HALF_M
    x, y = (float(v) for v in (low + high) / 2)
    return round(x - half, 1), round(-y - half, 1), round(2 * half, 1), round(2 * half, 1)


def _points(points: Floats) -> str:
    """A polyline as SVG has it."""
    return " ".join(f"{x:.2f},{-y:.2f}" for x, y in np.asarray(points)[:, :2].tolist())


def _flipped(point: tuple[float, float]) -> tuple[float, float]:
    return round(point[0], 2), round(-point[1], 2)
