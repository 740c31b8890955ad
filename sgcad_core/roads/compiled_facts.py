"""Facts of a compiled network: roads with lanes each way, headings, limits, legs of junctions.

Reads the lane graph; compass is north up. Knows no narrative.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from sgcad_core.geometry.plane import Floats, arc_lengths, resample
from sgcad_core.reading.text.compass import angle_of
from sgcad_core.records.place import LaidLeg, Place
from sgcad_core.records.specs import Compass
from sgcad_core.roads.lane_graph import LaneGraph, road_of
from sgcad_core.units import MPS_PER_MPH

BEHIND_SPLITTER_M = 60.0
SAME_DEG = 3.0
"""Between a leg as drawn and its heading on the map, which is drawn in whole degrees."""


@dataclass(frozen=True)
class CompiledRoad:
    """A compiled road: passenger lanes each way and its headings (radians, of the forward edge)."""

    id: str
    forward: int
    backward: int
    headings: tuple[float, ...]
    speeds_mph: tuple[float, ...]

    @property
    def total(self) -> int:
        """Lanes of both directions."""
        return self.forward + self.backward

    def along(self, way: Compass, tolerance_deg: float, either: bool = False) -> bool:
        """Whether the forward edge has that heading somewhere (or, with `either`, the opposite one)."""
        return any(headings_agree(h, angle_of(way), tolerance_deg, either) for h in self.headings)

    def lanes_towards(self, way: Compass, tolerance_deg: float) -> int:
        """Lanes of traffic with that heading; 0 where the road runs otherwise."""
        if self.along(way, tolerance_deg):
            return self.forward
        against = any(headings_agree(h + math.pi, angle_of(way), tolerance_deg, False) for h in self.headings)
        return self.backward if against else 0


def headings_agree(heading_rad: float, way_rad: float, tolerance_deg: float, either: bool = False) -> bool:
    """Whether a heading lies within the tolerance of another or, with `either`, of the opposite."""
    turn = abs((heading_rad - way_rad + math.pi) % (2 * math.pi) - math.pi)
    turn = min(turn, math.pi - turn) if either else turn
    return math.degrees(turn) <= tolerance_deg


def compiled_roads(graph: LaneGraph) -> list[CompiledRoad]:
    """Roads with their headings at both ends and in between; the geometry of one edge represents both."""
    found = []
    for road in dict.fromkeys(road_of(edge.id)[0] for edge in graph.edges.values() if not graph.is_around(edge)):
        forward, backward = graph.edges.get(road), graph.edges.get(f"-{road}")
        edge = forward or backward
        if edge is None:
            continue
        flip = 0.0 if forward is not None else math.pi
        shape = edge.lanes[0].shape
        steps = shape[1:] - shape[:-1]
        headings = {round(math.atan2(y, x) + flip, 3) for x, y in steps}
        overall = shape[-1] - shape[0]
        headings.add(round(math.atan2(overall[1], overall[0]) + flip, 3))
        speeds = tuple(lane.speed_mps / MPS_PER_MPH for lane in edge.car_lanes[:1])
        lanes = [len(e.car_lanes) if e else 0 for e in (forward, backward)]
        found.append(CompiledRoad(road, lanes[0], lanes[1], tuple(sorted(headings)), speeds))
    return [d for d in found if d.total and d.speeds_mph]


def junctions(graph: LaneGraph) -> list[tuple[float, ...]]:
    """Bearings of the legs of every node, seen from it (radians), over edges that cars may use; most legs first.

    A roundabout is one node.
    """
    legs: dict[str, dict[str, float]] = {}
    for edge in graph.edges.values():
        ends = [graph.center_of.get(node, node) for node in (edge.from_node, edge.to_node)]
        if edge.car_lanes and ends[0] != ends[1]:
            shape = edge.lanes[0].shape
            dx, dy = _leads(shape, edge.from_node in graph.center_of)
            ex, ey = _leads(shape[::-1], edge.to_node in graph.center_of)
            legs.setdefault(ends[0], {})[ends[1]] = math.atan2(dy, dx)
            legs.setdefault(ends[1], {})[ends[0]] = math.atan2(ey, ex)
    return sorted((tuple(found.values()) for found in legs.values()), key=len, reverse=True)


# ------------------------------------------------------------------ on a real place
def roads_as_told(roads: list[CompiledRoad], place: Place | None) -> list[CompiledRoad]:
    """The roads with those of a real place turned to the bearings by which the report knows them."""
    turns = {one.road: _turn_rad(one) for one in place.legs} if place and place.found else {}
    return [
        replace(road, headings=tuple(h + turns[road.id] for h in road.headings)) if road.id in turns else road
        for road in roads
    ]


def junctions_as_told(graph: LaneGraph, place: Place | None) -> list[tuple[float, ...]]:
    """`junctions`, with the legs of a real place at the bearings by which the report knows them."""
    laid = place.legs if place and place.found else ()
    real = [(angle_of(one.bearing) - _turn_rad(one), angle_of(one.bearing)) for one in laid]
    return [
        tuple(next((told for at, told in real if headings_agree(leg, at, SAME_DEG)), leg) for leg in legs)
        for legs in junctions(graph)
    ]


def _turn_rad(one: LaidLeg) -> float:
    """From a leg's heading on the map to its told bearing, counter-clockwise."""
    return math.remainder(angle_of(one.bearing) - math.radians(90.0 - one.leg.heading_deg), math.tau)


def _leads(line: Floats, opens: bool) -> Floats:
    """Direction of a leg from its junction; at a roundabout it is taken behind the splitter island."""
    ahead: Floats = line[1] - line[0]
    if opens:
        ahead = resample(line, [min(BEHIND_SPLITTER_M, arc_lengths(line)[-1])])[0] - line[0]
    return ahead
