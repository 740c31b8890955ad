"""Where background vehicles begin and where they go: evenly spread over the lanes of a network, with chance.

A lane's vehicles have the spacing of the density, a common random start and each a jitter; upstream of the roads' ends
they go on, and come in as time goes by. Their ways follow the lanes' connections. Knows a lane graph and a random
generator; no crash and no simulator.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sgcad_core.case.density import PER_KM, Density
from sgcad_core.case.traffic import Entrant
from sgcad_core.geometry.plane import resample
from sgcad_core.kinds import ACTORS, ALLEY, DRIVEWAY
from sgcad_core.roads.lane_graph import Connection, Edge, Lane, LaneGraph

KINDS = tuple(record.id for record in ACTORS.values() if record.usual)
"""Cars, SUVs, pickups and vans, drawn evenly."""
QUIET_KINDS = (DRIVEWAY, ALLEY)
"""Kinds of roads without through traffic."""
LEAST_LANE_M = 15.0
JITTER = 0.25
"""Each vehicle is off its even place by up to this share of the spacing."""
_STRAIGHT_ON = 3.0
"""A way straight on is drawn so many times as often as a turn."""
_MOST_EDGES = 8


@dataclass(frozen=True, eq=False)
class Seed:
    """One vehicle of the demand: its lane, its place on it (negative: upstream of the network) and the spacing."""

    entrant: Entrant
    edge: Edge
    lane: Lane
    spacing_m: float

    def place(self) -> tuple[float, float]:
        """Where its front is on the roads for the first time."""
        x, y = resample(self.lane.shape, [max(self.entrant.at_m, 0.0)])[0]
        return float(x), float(y)

    def behind(self, name: str) -> Seed | None:
        """The same vehicle half a spacing further back, under a name; None where the lane has no room for it."""
        at = self.entrant.at_m - self.spacing_m / 2
        if self.entrant.depart_s or at < self.entrant.length_m:
            return None
        return Seed(self.entrant._replace(id=name, at_m=round(at, 3)), self.edge, self.lane, self.spacing_m)


def open_lanes(graph: LaneGraph) -> list[tuple[Edge, Lane]]:
    """Lanes for traffic: for cars, long enough, of roads with through traffic, and leading somewhere."""
    return [
        (edge, lane)
        for edge in graph.edges.values()
        for lane in edge.car_lanes
        if edge.parameters.get("kind") not in QUIET_KINDS
        and lane.length_m >= LEAST_LANE_M
        and (graph.leaving(edge.id, lane.index) or not graph.leaving(edge.id))
    ]


def demand(graph: LaneGraph, density: Density, until_s: float, chance: np.random.Generator) -> list[Seed]:
    """The vehicles on all open lanes and those that come in before a time, in the order of the lanes."""
    spacing, found = 1000.0 / PER_KM[density], list[Seed]()
    for edge, lane in open_lanes(graph):
        enters = not any(c.to_edge == edge.id for c in graph.connections)
        upstream = lane.speed_mps * until_s if enters else 0.0
        for at in _places(lane.length_m, upstream, spacing, chance):
            route = _route(graph, edge, lane, chance)
            found.append(_seed(f"{lane.id} {len(found)}", edge, lane, at, route, spacing, chance))
    return found


def _places(length_m: float, upstream_m: float, spacing_m: float, chance: np.random.Generator) -> Iterator[float]:
    """Fronts along a lane, from its end backwards; negative: upstream."""
    at = length_m - 1.0 - float(chance.uniform(0.0, spacing_m))
    while at > -upstream_m:
        moved = at + float(chance.uniform(-JITTER, JITTER)) * spacing_m
        if moved <= length_m - 1.0:
            yield moved
        at -= spacing_m


def _seed(
    name: str, edge: Edge, lane: Lane, at_m: float, route: tuple[str, ...], spacing_m: float,
    chance: np.random.Generator,
) -> Seed:  # fmt: skip
    kind = ACTORS[str(chance.choice(KINDS))]
    depart_s = max(-at_m, 0.0) / lane.speed_mps
    front = min(max(at_m, kind.length_m + 0.1), lane.length_m - 0.5)
    size = kind.length_m, kind.width_m
    entrant = Entrant(name, kind.id, *size, route, lane.index, round(front, 3), round(depart_s, 2))
    return Seed(entrant, edge, lane, spacing_m)


def _route(graph: LaneGraph, edge: Edge, lane: Lane, chance: np.random.Generator) -> tuple[str, ...]:
    """Edges from a lane on, as its connections lead; a way that comes back to an edge ends there."""
    route, index = [edge.id], lane.index
    while len(route) < _MOST_EDGES:
        ways = [c for c in graph.leaving(route[-1], index) if c.direction != "u_turn" and c.to_edge not in route]
        if not ways:
            break
        weights = np.array([_weight(way) for way in ways])
        way = ways[int(chance.choice(len(ways), p=weights / weights.sum()))]
        route.append(way.to_edge)
        index = way.to_lane
    return tuple(route)


def _weight(way: Connection) -> float:
    return _STRAIGHT_ON if way.direction == "through" else 1.0


def nearest_to(seeds: list[Seed], place: tuple[float, float], most: int) -> list[Seed]:
    """At most so many of the seeds, those that begin nearest to a place, in their order."""

    def away(seed: Seed) -> float:
        upstream = seed.entrant.depart_s * seed.lane.speed_mps
        return math.dist(seed.place(), place) + upstream

    kept = sorted(seeds, key=away)[:most]
    return [seed for seed in seeds if seed in kept]
