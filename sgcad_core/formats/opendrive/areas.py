"""Areas and things on the ground: crosswalks, which are SUMO's crossings, stalls, cones. Metres; knows no XML."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.opendrive.reference import pose_at
from sgcad_core.formats.opendrive.streets import Street
from sgcad_core.formats.sumo.parameters import KIND
from sgcad_core.geometry.plane import Floats, parallel_polyline
from sgcad_core.kinds import DRIVEWAY
from sgcad_core.roads.areas.closures import cones
from sgcad_core.roads.areas.gores import gores
from sgcad_core.roads.areas.roadside import roadsides
from sgcad_core.roads.lane_graph import LaneGraph

_CROSSWALK, _GORE = ("crosswalk", "zebra", "crosswalk"), ("roadMark", "gore", "gore")
STALL_WIDTH_M = 2.7
"""Of a parking space (9 ft)."""


class GroundArea(NamedTuple):
    """A crosswalk over a street, or a gore or ground beside one; ids are those of objects.

    `corners`: (n, 2) around it, along and to the left of the street's reference line where that ends (`s_m`).
    `called`: type, subtype and name of the object.
    """

    id: str
    road: str
    s_m: float
    corners: Floats
    called: tuple[str, str, str]


def crosswalks_of(graph: LaneGraph, roads: Sequence[Street], ids: Iterator[str]) -> tuple[GroundArea, ...]:
    """All crosswalks, with the next ids."""
    return tuple(walk for street in roads for walk in _over(street, graph, ids))


def gores_of(graph: LaneGraph, roads: Sequence[Street], ids: Iterator[str]) -> tuple[GroundArea, ...]:
    """The painted gores at ramps, as areas of the streets that the ramps leave or join, with the next ids."""
    by_edge = {edge.id: street for street in roads for edge in street.edges}
    found = []
    for gore in gores(graph):
        if street := by_edge.get(gore.road):
            s_m = street.driven_end(gore.road, at_end=not gore.leaves)
            found.append(GroundArea(next(ids), street.id, s_m, _local(street, s_m, gore.corners), _GORE))
    return tuple(found)


def grounds_of(graph: LaneGraph, roads: Sequence[Street], ids: Iterator[str]) -> tuple[GroundArea, ...]:
    """The ground beside the streets, with the next ids."""
    by_edge = {edge.id: street for street in roads for edge in street.edges}
    return tuple(
        GroundArea(next(ids), street.id, 0.0, _local(street, 0.0, strip.corners), ("none", strip.kind, strip.kind))
        for strip in roadsides(graph) if (street := by_edge.get(strip.edge))
    )  # fmt: skip


class Stall(NamedTuple):
    """A parking space square to an aisle; ids are those of objects. `hdg_rad`: into the stall, from the road's."""

    id: str
    s_m: float
    t_m: float
    hdg_rad: float
    length_m: float


def stalls_of(street: Street, ids: Iterator[str]) -> Iterator[Stall]:
    """The stalls along an aisle of a parking lot; none along other roads."""
    if street.forward.parameters.get(KIND) != DRIVEWAY:
        return
    for strip in (*street.right, *street.left):
        if strip.type == "parking":
            side = 1.0 if strip.id > 0 else -1.0
            for i in range(int(street.length_m / STALL_WIDTH_M)):
                s_m = (i + 0.5) * STALL_WIDTH_M
                t_m = (street.border_t(strip, s_m) + street.border_t(strip, s_m, inner=True)) / 2
                yield Stall(next(ids), s_m, t_m, side * math.pi / 2, strip.width_at(s_m))


class Cone(NamedTuple):
    """A traffic cone; ids are those of objects."""

    id: str
    s_m: float
    t_m: float


def cones_of(graph: LaneGraph, roads: Sequence[Street], ids: Iterator[str]) -> Mapping[str, tuple[Cone, ...]]:
    """The cones of work zones, by the id of the street on which they stand, with the next ids."""
    by_edge = {edge.id: street for street in roads for edge in street.edges}
    found: dict[str, tuple[Cone, ...]] = {}
    for edge, places in cones(graph):
        if street := by_edge.get(edge):
            made = (Cone(next(ids), *station(street, place)) for place in places)
            found[street.id] = (*found.get(street.id, ()), *made)
    return found


def station(street: Street, point: Floats) -> tuple[float, float]:
    """s and t of a point beside a street's reference line, to a centimetre on bends that roads have."""
    tried = np.linspace(0.0, street.length_m, max(int(street.length_m), 1) + 1)
    poses = np.array([pose_at(street.line, s) for s in tried])
    near = int(np.hypot(*(poses[:, :2] - point).T).argmin())
    x, y, heading = poses[near]
    dx, dy = point[0] - x, point[1] - y
    s_m = float(np.clip(tried[near] + dx * math.cos(heading) + dy * math.sin(heading), 0.0, street.length_m))
    x, y, heading = pose_at(street.line, s_m)
    return s_m, float((point[1] - y) * math.cos(heading) - (point[0] - x) * math.sin(heading))


def _over(street: Street, graph: LaneGraph, ids: Iterator[str]) -> Iterator[GroundArea]:
    edges = {edge.id for edge in street.edges}
    for crossing in graph.crossings:
        if edges & set(crossing.edges):
            s_m = street.length_m if crossing.node == street.forward.to_node else 0.0
            half = crossing.width_m / 2
            left, right = (parallel_polyline(crossing.shape, side) for side in (half, -half))
            yield GroundArea(next(ids), street.id, s_m, _local(street, s_m, np.vstack((left, right[::-1]))), _CROSSWALK)


def _local(street: Street, s_m: float, points: Floats) -> Floats:
    """Points seen from the reference line at a station: along it and to its left."""
    x, y, heading = pose_at(street.line, s_m)
    c, s = math.cos(heading), math.sin(heading)
    off = points - np.array([x, y])
    seen: Floats = np.column_stack((off[:, 0] * c + off[:, 1] * s, off[:, 1] * c - off[:, 0] * s))
    return seen
