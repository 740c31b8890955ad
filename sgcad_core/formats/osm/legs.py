"""The legs of a junction: headings, lanes, limits and signs of the roads that leave a cluster of nodes.

Two carriageways of one street that leave side by side are one leg. Slip lanes are left out. Metres in the plane of the
junction; headings in degrees clockwise from north.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from sgcad_core.formats.osm.junctions import Cluster, StreetPoint, arms, nearest_point
from sgcad_core.formats.osm.street_map import MapWay, StreetMap, Tags, names_of
from sgcad_core.formats.osm.tags import lanes_of, limit_mph, one_way, turns_of
from sgcad_core.geometry.globe import Plane
from sgcad_core.records.place import LegControl, MapLeg, MapPlace
from sgcad_core.records.specs import Median
from sgcad_core.roads.road_geometry import LANE_M, MEDIAN_M

HEADING_M = 30.0
"""The heading of a leg is that of its first 30 m."""
_WALK_M = 90.0
"""A road that comes back to the junction within this length is a piece of it."""
_SIGN_M = 50.0
"""Signs and signals of an approach stand within this distance on its way."""
_PAIR_DEG = 35.0
"""Carriageways of one street leave within this angle."""
_PAIR_M = 45.0
_SHARP_RAD = math.radians(60.0)
"""A street that turns so much where one of its ways ends goes on another way."""
_MOST_LEGS = 8
Point = tuple[float, float]


class Stub(NamedTuple):
    """One way out of a junction: nodes from the junction outwards, and whether they stand in the way's order."""

    way: MapWay
    forward: bool
    nodes: tuple[int, ...]
    line: tuple[Point, ...]

    @property
    def outward(self) -> Point:
        """Unit vector of its first `HEADING_M`."""
        start, end = self.line[0], _along(self.line, HEADING_M)
        length = math.dist(start, end) or 1.0
        return (end[0] - start[0]) / length, (end[1] - start[1]) / length

    @property
    def lanes(self) -> tuple[int, int]:
        """Lanes towards the junction and away from it."""
        found = lanes_of(self.way)
        return (found.backward, found.forward) if self.forward else (found.forward, found.backward)

    @property
    def street(self) -> str:
        """The street's name, else its number."""
        return self.way.tags.get("name") or self.way.tags.get("ref", "")


def junction_place(made: StreetMap, cluster: Cluster, streets: tuple[str, ...]) -> MapPlace:
    """The junction with its legs; around a roundabout every leg yields."""
    plane = Plane(*cluster.place)
    legs = legs_of(made, list(_stubs(made, cluster, plane)), cluster)
    around = max((lanes_of(w).forward for w in made.ways if w.ring and set(w.nodes) & cluster.nodes), default=1)
    return MapPlace(
        source=made.source, streets=streets, latitude=cluster.place[0], longitude=cluster.place[1],
        legs=tuple(legs), circle_lanes=min(max(around, 1), 2) if cluster.ring else 0,
    )  # fmt: skip


def street_place(made: StreetMap, point: StreetPoint, streets: tuple[str, ...], where: str) -> MapPlace:
    """A point of a street with a leg to either side; the other carriageway of a divided road belongs to them."""
    plane = Plane(*point.place)
    stubs = _both_ways(made, point, plane)
    way = made.ways[point.way]
    if one_way(way):
        twins = [
            i
            for i, w in enumerate(made.ways)
            if one_way(w) and i != point.way and w.tags.get("name") == way.tags.get("name")
        ]
        if (other := nearest_point(made, twins, point.place)) and other[1] <= _PAIR_M:
            stubs += _both_ways(made, other[0], plane)
    legs = [_leg(group, "none") for group in list(_paired(stubs))[:2]]
    return MapPlace(
        source=made.source, streets=streets, latitude=point.place[0], longitude=point.place[1], legs=tuple(legs),
        where=where,
    )  # fmt: skip


def _both_ways(made: StreetMap, point: StreetPoint, plane: Plane) -> list[Stub]:
    """The ways out of a point of a way, along it and against it."""
    way = made.ways[point.way]
    ends = ((True, way.nodes[point.piece + 1 :]), (False, way.nodes[point.piece :: -1]))
    return [Stub(way, forward, nodes, _line(made, plane, nodes, plane.metres(point.place))) for forward, nodes in ends]


def legs_of(made: StreetMap, stubs: Sequence[Stub], cluster: Cluster) -> list[MapLeg]:
    """The legs of these ways out, eight at most, clockwise from north."""
    groups = list(_paired(stubs))
    signs = [next((sign for stub in group if (sign := _sign(made, stub))), None) for group in groups]
    whole = _of_nodes(made, cluster)
    lights = next((c for c in (whole, *signs) if c in ("signal", "flashing")), None)
    common: LegControl | None = "yield" if cluster.ring else lights or whole
    found = [_leg(group, common or sign or "none") for group, sign in zip(groups, signs, strict=True)]
    return sorted(found, key=lambda leg: leg.heading_deg)[:_MOST_LEGS]


# ------------------------------------------------------------------ ways out
def _stubs(made: StreetMap, cluster: Cluster, plane: Plane) -> Iterator[Stub]:
    for node in sorted(cluster.nodes):
        for index in made.at[node]:
            way = made.ways[index]
            if way.ring or way.link:
                continue
            for i in (i for i, one in enumerate(way.nodes) if one == node):
                for forward, rest in ((True, way.nodes[i:]), (False, way.nodes[i::-1])):
                    nodes = _outwards(made, cluster, way, rest, plane)
                    if len(nodes) > 1:
                        yield Stub(way, forward, nodes, _line(made, plane, nodes))


def _outwards(made: StreetMap, cluster: Cluster, way: MapWay, nodes: tuple[int, ...], plane: Plane) -> tuple[int, ...]:
    """The nodes of a way out as far as `_WALK_M`, into the next way of the street at need; () of an inner piece."""
    found, seen = list(nodes[:1]), {way.id}
    rest, length = list(nodes[1:]), 0.0
    while rest and length < _WALK_M:
        node = rest.pop(0)
        if node in cluster.nodes:
            return ()
        length += math.dist(plane.metres(made.places[found[-1]]), plane.metres(made.places[node]))
        found.append(node)
        if not rest and (onward := _onward(made, found, way, seen, plane)):
            seen.add(onward[0].id)
            rest = onward[1]
    return tuple(found)


def _onward(
    made: StreetMap, walked: Sequence[int], way: MapWay, seen: set[int], plane: Plane
) -> tuple[MapWay, list[int]] | None:
    """The next way of the same street behind the nodes walked, and its nodes: the straightest, no sharp turn."""
    node, before = walked[-1], _direction(made, plane, walked[-2], walked[-1])
    found = []
    for other in (made.ways[index] for index in made.at[node]):
        same = other.tags.get("name") == way.tags.get("name") and not other.link and not other.ring
        if same and other.id not in seen and node in (other.nodes[0], other.nodes[-1]):
            nodes = list(other.nodes if other.nodes[0] == node else other.nodes[::-1])
            turn = abs(math.remainder(_direction(made, plane, *nodes[:2]) - before, math.tau))
            found.append((turn, other.id, other, nodes[1:]))
    turn, _, other, rest = min(found, default=(math.pi, 0, way, []))
    return (other, rest) if turn < _SHARP_RAD else None


def _direction(made: StreetMap, plane: Plane, start: int, end: int) -> float:
    (ax, ay), (bx, by) = (plane.metres(made.places[node]) for node in (start, end))
    return math.atan2(by - ay, bx - ax)


def _line(made: StreetMap, plane: Plane, nodes: Iterable[int], start: Point | None = None) -> tuple[Point, ...]:
    points = [plane.metres(made.places[node]) for node in nodes]
    return tuple([start, *points] if start is not None else points)


# ------------------------------------------------------------------ legs
def _paired(stubs: Sequence[Stub]) -> Iterator[list[Stub]]:
    """Each way out, with the other carriageway of its street where there is one."""
    left = list(stubs)
    while left:
        stub = left.pop(0)
        if one_way(stub.way):
            mates = [other for other in left if _beside(stub, other)]
            mate = min(mates, key=lambda other: _apart_deg(stub, other), default=None)
            if mate is not None:
                left.remove(mate)
                yield [stub, mate]
                continue
        yield [stub]


def _beside(stub: Stub, other: Stub) -> bool:
    """Whether they are the two carriageways of one street."""
    opposite = bool(one_way(other.way)) and (stub.lanes[0] > 0) != (other.lanes[0] > 0)
    near = math.dist(stub.line[0], other.line[0]) <= _PAIR_M
    return opposite and near and stub.street == other.street and _apart_deg(stub, other) <= _PAIR_DEG


def _apart_deg(stub: Stub, other: Stub) -> float:
    (ax, ay), (bx, by) = stub.outward, other.outward
    return math.degrees(math.acos(min(max(ax * bx + ay * by, -1.0), 1.0)))


def _leg(group: Sequence[Stub], control: LegControl) -> MapLeg:
    stub = group[0]
    lanes_in, lanes_out = (sum(one.lanes[side] for one in group) for side in (0, 1))
    coming = next((one for one in group if one.lanes[0]), stub)
    east, north = (sum(one.outward[axis] for one in group) for axis in (0, 1))
    limits = [limit for one in group if (limit := limit_mph(one.way, not one.forward)) is not None]
    found = lanes_of(coming.way)
    return MapLeg(
        street=stub.street, names=names_of(stub.way.tags),
        heading_deg=round(math.degrees(math.atan2(east, north)) % 360, 2), lanes_in=min(lanes_in, 8),
        lanes_out=min(lanes_out, 8), lanes_known=all(lanes_of(one.way).known for one in group),
        turns_in=turns_of(coming.way, not coming.forward, lanes_in) if lanes_in else (), control=control,
        limit_mph=max(limits, default=None), center_turn_lane=bool(found.both),
        median=_median(group),
    )  # fmt: skip


def _median(group: Sequence[Stub]) -> Median:
    """Of two carriageways: grass where the room between their lanes is wider than a raised median, 4 m as drawn."""
    if len(group) < 2:
        return "none"
    (ax, ay), (bx, by), (dx, dy) = group[0].line[0], group[1].line[0], group[0].outward
    between = abs((bx - ax) * dy - (by - ay) * dx) - LANE_M * sum(sum(one.lanes) for one in group) / 2
    return "grass" if between >= MEDIAN_M["grass"] else "raised"


def _along(line: Sequence[Point], way_m: float) -> Point:
    """The point so far along a line; its end where it is shorter."""
    for a, b in pairwise(line):
        step = math.dist(a, b)
        if step >= way_m and step:
            return a[0] + way_m / step * (b[0] - a[0]), a[1] + way_m / step * (b[1] - a[1])
        way_m -= step
    return line[-1]


# ------------------------------------------------------------------ signs
def _of_nodes(made: StreetMap, cluster: Cluster) -> LegControl | None:
    """What the nodes of the junction themselves tell: lights, or stop signs for all."""
    for tags in (made.tags[node] for node in sorted(cluster.nodes) if node in made.tags):
        if tags.get("highway") == "traffic_signals":
            return _lights(tags)
        if tags.get("highway") == "stop" and tags.get("stop") == "all":
            return "stop"
    return None


def _lights(tags: Tags) -> LegControl:
    return "flashing" if tags.get("traffic_signals") in ("blinker", "blink_mode") else "signal"


def _sign(made: StreetMap, stub: Stub) -> LegControl | None:
    """The sign or light on an approach, within `_SIGN_M` and before the next junction, for those who drive in."""
    length = 0.0
    for (a, b), node in zip(pairwise(stub.line), stub.nodes[1:], strict=False):
        length += math.dist(a, b)
        if length > _SIGN_M or arms(made, node) > 2 or not stub.lanes[0]:
            return None
        tags = made.tags.get(node, {})
        facing = tags.get("direction") or tags.get("traffic_signals:direction")
        away = facing in ("forward", "backward") and (facing == "forward") == stub.forward
        what = tags.get("highway")
        if what == "traffic_signals" and not away:
            return _lights(tags)
        if what in ("stop", "give_way") and not away:
            return "stop" if what == "stop" else "yield"
    return None
