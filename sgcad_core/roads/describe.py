"""A road network in words for a prompt: roads by id, where each direction heads, its lanes and its ways on.

From a road spec (control, medians, limits) or, where a writer left none, from SUMO's lane graph. Knows no
prompt and no crash.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import ALLEY
from sgcad_core.records.specs import Node, Road, RoadSpec, centers
from sgcad_core.roads.lane_graph import LaneGraph, road_of

Direction = Literal["forward", "backward"]
_COMPASS = ("east", "northeast", "north", "northwest", "west", "southwest", "south", "southeast")
_STRAIGHT_RAD = math.radians(40)
_BACK_RAD = math.radians(150)
_TURNS = ("left", "straight", "right", "sharply back")
_CURVED_RAD = math.radians(15)
ROUNDABOUT = "roundabout, who enters yields"


@dataclass
class _Way:
    """One direction of a road; headings are those of travel at its start and end."""

    road: str
    direction: Direction
    lanes: int
    from_node: str
    to_node: str
    headings_rad: tuple[float, float]
    uses: Sequence[str] = ()
    exits: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))


def describe_network(source: RoadSpec | LaneGraph) -> str:
    """One line a road: its kind, then each direction with heading, lanes and where they lead."""
    if isinstance(source, LaneGraph):
        return _text(_ways_of_graph(source), {}, {})
    ways = _ways_of_spec(source)
    for way in ways:
        _add_exits(way, ways)
    controls = {n.id: _control(n) for n in source.nodes} | dict.fromkeys(centers(source).values(), ROUNDABOUT)
    return _text(ways, {r.id: _features(r) for r in source.roads}, controls)


def road_ids(source: RoadSpec | LaneGraph) -> list[str]:
    """Ids that a behavior may name, in order."""
    if isinstance(source, RoadSpec):
        return [road.id for road in source.roads if not road.circle]
    return list(dict.fromkeys(road_of(edge)[0] for edge in source.edges))


def compass(heading_rad: float) -> str:
    """The nearest of eight compass words of a heading."""
    return _COMPASS[round(heading_rad / (math.pi / 4)) % 8]


# ------------------------------------------------------------------ reading
def _ways_of_spec(spec: RoadSpec) -> list[_Way]:
    nodes = {node.id: node for node in spec.nodes}
    center = centers(spec)
    found = [way for road in spec.roads if not road.circle for way in _both(road, _line(road, nodes))]
    for way in found:
        way.from_node, way.to_node = (center.get(node, node) for node in (way.from_node, way.to_node))
    return found


def _line(road: Road, nodes: Mapping[str, Node]) -> Floats:
    points = [nodes[road.from_node], *road.via, nodes[road.to_node]]
    return np.array([(p.x_m, p.y_m) for p in points])


def _both(road: Road, line: Floats) -> Iterable[_Way]:
    if road.lanes_forward:
        ends = road.from_node, road.to_node
        yield _Way(road.id, "forward", road.lanes_forward, *ends, _headings(line), road.turns_forward)
    if road.lanes_backward:
        ends = road.to_node, road.from_node
        yield _Way(road.id, "backward", road.lanes_backward, *ends, _headings(line[::-1]), road.turns_backward)


def _ways_of_graph(graph: LaneGraph) -> list[_Way]:
    ways = {}
    for edge in graph.edges.values():
        if lanes := edge.car_lanes:
            road, direction = road_of(edge.id)
            ways[edge.id] = _Way(road, direction, len(lanes), edge.from_node, edge.to_node, _headings(lanes[0].shape))
    for link in graph.connections:
        if link.from_edge in ways and link.to_edge in ways:
            word = {"through": "straight", "u_turn": "sharply back"}.get(link.direction, link.direction)
            exits = ways[link.from_edge].exits[word]
            exits += [] if ways[link.to_edge].road in exits else [ways[link.to_edge].road]
    return list(ways.values())


def _headings(line: Floats) -> tuple[float, float]:
    first, last = line[1] - line[0], line[-1] - line[-2]
    return math.atan2(first[1], first[0]), math.atan2(last[1], last[0])


def _add_exits(way: _Way, ways: Sequence[_Way]) -> None:
    for other in ways:
        if other.from_node == way.to_node and other.road != way.road:
            way.exits[_turn(way.headings_rad[1], other.headings_rad[0])].append(other.road)


def _turn(before_rad: float, after_rad: float) -> str:
    angle = math.remainder(after_rad - before_rad, math.tau)
    if abs(angle) > _BACK_RAD:
        return "sharply back"
    return "straight" if abs(angle) <= _STRAIGHT_RAD else "left" if angle > 0 else "right"


# ------------------------------------------------------------------ words
def _features(road: Road) -> str:
    found: list[str] = [ALLEY] if road.alley else [] if road.kind == "road" else [road.kind]
    found += ["one-way"] if 0 in (road.lanes_forward, road.lanes_backward) else []
    found += ["two-way left-turn lane in the middle"] if road.center_turn_lane else []
    found += [f"{road.median} median"] if road.median != "none" else []
    found += ["minor"] if road.minor else []
    return ", ".join([*found, *([f"{road.speed_limit_mph} mph limit"] if road.speed_limit_mph else [])])


def _control(node: Node) -> str:
    return {"none": "", "signal": "traffic signal", "flashing": "flashing light", "stop": "stop sign on minor roads",
            "all_way_stop": "all-way stop", "yield": "yield sign on minor roads"}[node.control]  # fmt: skip


def _text(ways: Sequence[_Way], features: Mapping[str, str], controls: Mapping[str, str]) -> str:
    by_road: dict[str, list[_Way]] = defaultdict(list)
    for way in ways:
        by_road[way.road].append(way)
    lines = []
    for road, both in by_road.items():
        extra = f" ({features[road]})" if features.get(road) else ""
        both.sort(key=lambda way: way.direction != "forward")
        lines.append("\n".join([f"- road {road}{extra}:", *(_way(way, controls) for way in both)]))
    return "\n".join(lines)


def _way(way: _Way, controls: Mapping[str, str]) -> str:
    start, end = (compass(h) for h in way.headings_rad)
    bend = math.remainder(way.headings_rad[1] - way.headings_rad[0], math.tau)
    curve = f", curving {'left' if bend > 0 else 'right'} to {end}" if abs(bend) > _CURVED_RAD else ""
    lanes = f"{way.lanes} lane{'s' if way.lanes > 1 else ''}"
    uses = "; ".join(f"lane {i} {use.replace('_', ' or ')}" for i, use in enumerate(way.uses, 1))
    lanes += f" ({uses})" if uses else ""
    return f"  - {way.direction}: traffic heads {start}{curve}, {lanes}; {_ends(way, controls)}"


def _ends(way: _Way, controls: Mapping[str, str]) -> str:
    exits = ", ".join(f"{word} to {' or '.join(way.exits[word])}" for word in _TURNS if way.exits.get(word))
    control = controls.get(way.to_node, "")
    if not exits:
        return f"ends at {way.to_node}"
    return f"at {way.to_node}{f' ({control})' if control else ''}: {exits}"
