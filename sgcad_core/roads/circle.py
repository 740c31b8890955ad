"""The circle of a roundabout: its junctions with the legs, and the one-way roads between them, counterclockwise.

Sizes are those of NCHRP 672: 41 m across for one lane, 61 m for two (inscribed circle), more where wide legs need
room. Metres; x east, y north; the middle of the circle is the hub at (0, 0). Knows no legs but their names.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from sgcad_core.records.specs import Node, Point, Road

RADIUS_M = {1: 18.0, 2: 26.0}
"""Radius of the middle of the circulating lanes."""
SPLITTER_M = 8.0
"""Between entry and exit of a leg at the rim: the base of its splitter island."""
BETWEEN_M = 13.0
"""Least length of the rim between the lanes of two legs: a car and its gap to both."""
LONGEST_RAD = math.radians(100)
"""A longer piece of the rim is cut by a node of its own."""
STEP_RAD = math.radians(12)


class Rim(NamedTuple):
    """The circle of the circulating lanes' middle."""

    radius_m: float
    lanes: int
    walked: bool = False
    """Whether a sidewalk runs around outside."""

    def at(self, angle_rad: float) -> tuple[float, float]:
        """A point of the rim."""
        return self.radius_m * math.cos(angle_rad), self.radius_m * math.sin(angle_rad)


class Mouth(NamedTuple):
    """Junction of a leg with the circle: its name, its bearing (radians) and the width of its lanes, metres."""

    name: str
    angle_rad: float
    width_m: float
    walked: bool = False


def rim_of(lanes: int, mouths: Sequence[Mouth]) -> Rim:
    """The smallest circle with room for the lanes and the legs."""
    needed = [
        (BETWEEN_M + SPLITTER_M + (a.width_m + b.width_m) / 2) / max(_gap(a, b), 1e-3) for a, b in _around(mouths)
    ]
    return Rim(max(RADIUS_M[lanes], *needed), lanes, any(m.walked for m in mouths))


def node_of(leg: str) -> str:
    """The node of a leg on the circle."""
    return f"hub_{leg}"


def circle_roads(rim: Rim, mouths: Sequence[Mouth]) -> tuple[list[Node], list[Road]]:
    """Nodes between the legs (long pieces are cut), and all pieces of the circle."""
    nodes: list[Node] = []
    roads: list[Road] = []
    for a, b in _around(mouths):
        gap = _gap(a, b)
        count = math.ceil(gap / LONGEST_RAD)
        stops = [(f"{node_of(a.name)}_{i}", a.angle_rad + gap * i / count) for i in range(1, count)]
        nodes += [_node(name, rim.at(angle)) for name, angle in stops]
        places = [(node_of(a.name), a.angle_rad), *stops, (node_of(b.name), a.angle_rad + gap)]
        roads += [_piece(rim, f"circle_{a.name}", i, *step) for i, step in enumerate(pairwise(places))]
    return nodes, roads


def _piece(rim: Rim, name: str, index: int, start: tuple[str, float], end: tuple[str, float]) -> Road:
    return Road(
        id=f"{name}_{index}" if index else name, from_node=start[0], to_node=end[0],
        lanes_forward=rim.lanes, lanes_backward=0, via=tuple(_inner(rim, start[1], end[1])), circle=True,
        beside=("sidewalk",) if rim.walked else (),
    )  # fmt: skip


def _inner(rim: Rim, start_rad: float, end_rad: float) -> Iterator[Point]:
    count = max(2, round((end_rad - start_rad) / STEP_RAD))
    for i in range(1, count):
        x, y = rim.at(start_rad + (end_rad - start_rad) * i / count)
        yield Point(x_m=round(x, 3), y_m=round(y, 3))


def _node(name: str, place: tuple[float, float]) -> Node:
    return Node(id=name, x_m=round(place[0], 2), y_m=round(place[1], 2))


def _around(mouths: Sequence[Mouth]) -> list[tuple[Mouth, Mouth]]:
    """Neighbors counterclockwise; the last one's is the first."""
    ordered = sorted(mouths, key=lambda m: m.angle_rad % math.tau)
    return list(zip(ordered, [*ordered[1:], ordered[0]], strict=True))


def _gap(a: Mouth, b: Mouth) -> float:
    """From one to the next counterclockwise, radians in (0, 2 pi]."""
    return (b.angle_rad - a.angle_rad) % math.tau or math.tau
