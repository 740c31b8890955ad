"""Junctions of two named streets, and points of one street: clusters of nodes in an extract.

Carriageways of a divided road meet a street in several nodes, a roundabout has a ring of them: nodes nearer than 45 m
are one junction. Knows no lanes.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from sgcad_core.formats.osm.street_map import StreetMap
from sgcad_core.geometry.globe import Plane, Spot

MERGE_M = 45.0
_RING_M = 60.0
"""A ring whose nodes lie farther apart is no roundabout but a circular street."""


class Cluster(NamedTuple):
    """The nodes of one junction, and its middle."""

    nodes: frozenset[int]
    place: Spot
    ring: bool = False


def junctions_of(made: StreetMap, first: Collection[int], second: Collection[int]) -> list[Cluster]:
    """Where ways of one street meet those of another; ways that are both are left out."""
    only, other = set(first) - set(second), set(second) - set(first)
    on_first = {node for way in only for node in made.ways[way].nodes}
    on_second = {node for way in other for node in made.ways[way].nodes}
    rings = [ring for ring in _rings(made) if ring & on_first and ring & on_second]
    around = {node for ring in rings for node in ring}
    shared = sorted((on_first & on_second) - around)
    found = [Cluster(nodes, _middle(made, nodes)) for nodes in _near(made, shared)]
    return [Cluster(ring, _middle(made, ring), True) for ring in rings] + found


def junction_at(made: StreetMap, place: Spot, within_m: float) -> Cluster | None:
    """The junction of three roads or more nearest to a place; None where none is within so many metres."""
    plane = Plane(*place)
    for ring in _rings(made):
        if math.hypot(*plane.metres(_middle(made, ring))) <= within_m:
            return Cluster(ring, _middle(made, ring), True)
    near = {n: d for n, p in made.places.items() if (d := math.hypot(*plane.metres(p))) <= within_m + MERGE_M}
    meeting = [node for node in near if arms(made, node) > 2]
    nearest = min(meeting, key=lambda node: near[node], default=None)
    if nearest is None or near[nearest] > within_m:
        return None
    group = next(nodes for nodes in _near(made, sorted(meeting)) if nearest in nodes)
    return Cluster(group, _middle(made, group))


def arms(made: StreetMap, node: int) -> int:
    """Pieces of ways that end at a node."""
    return sum(
        (i > 0) + (i < len(way.nodes) - 1)
        for way in (made.ways[index] for index in made.at[node])
        for i, one in enumerate(way.nodes) if one == node
    )  # fmt: skip


def _rings(made: StreetMap) -> list[frozenset[int]]:
    """The nodes of each roundabout."""
    left = [frozenset(way.nodes) for way in made.ways if way.ring]
    found: list[frozenset[int]] = []
    while left:
        ring = left.pop()
        while joined := [other for other in left if other & ring]:
            ring = ring.union(*joined)
            left = [other for other in left if other not in joined]
        plane = Plane(*_middle(made, ring))
        if all(math.hypot(*plane.metres(made.places[node])) <= _RING_M for node in ring):
            found.append(ring)
    return found


def _middle(made: StreetMap, nodes: Iterable[int]) -> Spot:
    places = [made.places[node] for node in nodes]
    return sum(p[0] for p in places) / len(places), sum(p[1] for p in places) / len(places)


def _near(made: StreetMap, nodes: Sequence[int]) -> Iterator[frozenset[int]]:
    """Groups of nodes in which each is nearer than `MERGE_M` to another one."""
    left = list(nodes)
    while left:
        group = [left.pop(0)]
        for one in group:
            plane = Plane(*made.places[one])
            close = [n for n in left if math.hypot(*plane.metres(made.places[n])) < MERGE_M]
            group += close
            left = [n for n in left if n not in close]
        yield frozenset(group)


# ------------------------------------------------------------------ along one street
class StreetPoint(NamedTuple):
    """A point of a way, between two of its nodes."""

    way: int
    piece: int
    place: Spot


def nearest_point(made: StreetMap, ways: Iterable[int], place: Spot) -> tuple[StreetPoint, float] | None:
    """The point of these ways nearest to a place, and how far it is, metres; None without ways."""
    plane, best = Plane(*place), None
    for index in ways:
        line = [plane.metres(made.places[node]) for node in made.ways[index].nodes]
        for piece, (a, b) in enumerate(pairwise(line)):
            share = _share(a, b)
            x, y = a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])
            if best is None or math.hypot(x, y) < best[1]:
                best = StreetPoint(index, piece, plane.spot(x, y)), math.hypot(x, y)
    return best


def _share(a: tuple[float, float], b: tuple[float, float]) -> float:
    """How far along a piece its point nearest to (0, 0) lies, 0 to 1."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    return min(max(-(a[0] * dx + a[1] * dy) / square, 0.0), 1.0) if square else 0.0


def blocks_of(made: StreetMap, ways: Collection[int]) -> list[tuple[Spot, float]]:
    """The middle and length of each block of a street: a stretch of one way without a junction on it; longest first."""
    found = []
    for index in ways:
        nodes = made.ways[index].nodes
        cuts = [0, *(i for i in range(1, len(nodes) - 1) if arms(made, nodes[i]) > 2), len(nodes) - 1]
        for start, end in pairwise(cuts):
            places = [made.places[node] for node in nodes[start : end + 1]]
            length = sum(_apart_m(a, b) for a, b in pairwise(places))
            found.append((_halfway(places, length / 2), length))
    return sorted(found, key=lambda block: -block[1])


def _apart_m(a: Spot, b: Spot) -> float:
    return math.hypot(*Plane(*a).metres(b))


def _halfway(places: Sequence[Spot], way_m: float) -> Spot:
    for a, b in pairwise(places):
        step = _apart_m(a, b)
        if step >= way_m and step:
            share = way_m / step
            return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])
        way_m -= step
    return places[-1]
