"""A road network as SUMO drives it: edges, lanes, connections, nodes, and what can be counted in it.

Metres and m/s in the network's frame (x east, y north). Ids written by this project: road R is edge "R"
in its forward and edge "-R" in its backward direction. Knows no file format.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Direction = Literal["left", "through", "right", "u_turn"]
ROAD_WORKS = "roadWorks"
"""Type of a lane that a work zone closes (OpenDRIVE's word)."""
NOTHING: Mapping[str, str] = MappingProxyType({})


class NetNode(NamedTuple):
    """A SUMO node: place in metres and type ("priority", "traffic_light", "dead_end", ...)."""

    x_m: float
    y_m: float
    type: str
    parameters: Mapping[str, str] = NOTHING
    """Parameters of the file beyond the type (`plain_xml`)."""


@dataclass(frozen=True, eq=False)
class Lane:
    """One lane; index 0 is the rightmost. `shape` is its center line, (n, 2) metres, in travel direction."""

    id: str
    index: int
    shape: Floats
    width_m: float
    length_m: float
    speed_mps: float
    allows_cars: bool
    type: str = ""
    """Of a lane that is not for cars: biking, parking, shoulder, sidewalk, roadWorks; "" where the file names none."""


@dataclass(frozen=True, eq=False)
class Edge:
    """One direction of a road; lanes from right to left."""

    id: str
    from_node: str
    to_node: str
    lanes: tuple[Lane, ...]
    priority: int = -1
    parameters: Mapping[str, str] = field(default_factory=dict)
    """Parameters of the file beyond the lanes (`plain_xml`)."""

    @property
    def car_lanes(self) -> tuple[Lane, ...]:
        """Lanes that passenger cars may use, from right to left."""
        return tuple(lane for lane in self.lanes if lane.allows_cars)

    @property
    def laid_lanes(self) -> tuple[Lane, ...]:
        """Lanes that were laid for cars, those that a work zone closes among them, from right to left."""
        return tuple(lane for lane in self.lanes if lane.allows_cars or lane.type == ROAD_WORKS)

    @property
    def center_lane(self) -> Lane | None:
        """The two-way left-turn lane: the innermost lane, of no type and not for cars that go straight on."""
        last = self.lanes[-1] if self.lanes else None
        return last if last and not last.allows_cars and not last.type and self.car_lanes else None


@dataclass(frozen=True, eq=False)
class Connection:
    """A way across a node from lane to lane (indices as in Lane).

    `via_shape`: (n, 2) metres, the internal lanes joined, from the end of the first lane to the start of
    the second (two equal or near points where the network has no internal lanes).
    """

    from_edge: str
    from_lane: int
    to_edge: str
    to_lane: int
    via_shape: Floats
    direction: Direction
    state: str = ""
    """SUMO's link state: M and m (has or lacks the right of way), s stop, w all-way stop, o by a signal, ..."""
    light: str = ""
    """Program that controls it, "" for none, and the place of its letter in the program's states."""
    link: int = -1


class Crossing(NamedTuple):
    """A crosswalk over edges where they meet a node; `shape`: its center line, (n, 2) metres, as one walks."""

    node: str
    edges: tuple[str, ...]
    shape: Floats
    width_m: float


class Phase(NamedTuple):
    """One phase of a signal program: a letter a controlled connection (G g green, y yellow, r red, ...)."""

    duration_s: float
    states: str


class Program(NamedTuple):
    """What a traffic signal shows in turn."""

    offset_s: float
    phases: tuple[Phase, ...]


@dataclass(frozen=True, eq=False)
class LaneGraph:
    """A road network as SUMO drives it; internal edges stand in the connections."""

    edges: Mapping[str, Edge]
    connections: tuple[Connection, ...]
    nodes: Mapping[str, NetNode]
    programs: Mapping[str, Program] = field(default_factory=dict)
    circles: tuple[frozenset[str], ...] = ()
    """Nodes of each roundabout."""
    crossings: tuple[Crossing, ...] = ()
    projection: str = ""
    """The frame's place on the globe, in PROJ's words; "" where it has none."""

    @cached_property
    def derived(self) -> dict[Hashable, Any]:
        """Results computed from this network, by their inputs."""
        return {}

    @cached_property
    def center_of(self) -> Mapping[str, str]:
        """Node of a roundabout -> the one node that stands for all of it."""
        return {node: min(circle) for circle in self.circles for node in circle}

    def is_around(self, edge: Edge) -> bool:
        """Whether an edge is a piece of a roundabout."""
        start = self.center_of.get(edge.from_node)
        return start is not None and start == self.center_of.get(edge.to_node)

    @cached_property
    def openings(self) -> tuple[str, ...]:
        """Nodes with a connection back into the other direction of a road."""
        back = (c for c in self.connections if road_of(c.from_edge)[0] == road_of(c.to_edge)[0])
        return tuple({self.edges[c.from_edge].to_node: None for c in back if c.from_edge != c.to_edge})

    def leaving(self, edge: str, lane: int | None = None) -> tuple[Connection, ...]:
        """Connections out of an edge (or of one of its lanes)."""
        return tuple(c for c in self.connections if c.from_edge == edge and lane in (None, c.from_lane))


class NetworkFigures(NamedTuple):
    """What the road metrics compare; nodes of degree 2 are contracted, only lanes for passenger cars count."""

    intersections: int
    components: int
    mean_lanes: float
    segments: int


class RoadCounts(NamedTuple):
    """A network in numbers: its figures, lanes there and back of each contracted segment, legs of the largest node."""

    figures: NetworkFigures
    chains: tuple[tuple[int, int], ...]
    max_degree: int


def edge_id(road: str, direction: str) -> str:
    """Edge of a road in "forward" or "backward" direction."""
    return road if direction == "forward" else f"-{road}"


def road_of(edge: str) -> tuple[str, Literal["forward", "backward"]]:
    """Road and direction that an edge id means."""
    return (edge[1:], "backward") if edge.startswith("-") else (edge, "forward")


def edge_of(lane: str) -> str:
    """The edge of a lane's id."""
    return lane.rpartition("_")[0]


# ------------------------------------------------------------------ counting
def segments(graph: LaneGraph) -> list[dict[str, str | int]]:
    """Roads with their passenger lanes: [{"id", "lanes_forward", "lanes_backward"}], in the network's order.

    A roundabout is a junction, and its pieces are no roads.
    """
    roads = {road_of(edge.id)[0]: None for edge in graph.edges.values() if not graph.is_around(edge)}
    return [
        {"id": road, "lanes_forward": _car_lanes(graph, road), "lanes_backward": _car_lanes(graph, f"-{road}")}
        for road in roads
    ]


def _car_lanes(graph: LaneGraph, edge: str) -> int:
    return len(graph.edges[edge].car_lanes) if edge in graph.edges else 0


def network_figures(graph: LaneGraph) -> NetworkFigures:
    """Intersections (nodes with three or more neighbors; a roundabout is one), parts, mean lanes, contracted segments.

    `mean_lanes` is the mean over contracted segments and directions of the lanes of the widest piece; a
    direction that is interrupted on the way does not count.
    """
    return road_counts(contracted(_lanes_between(graph.edges.values()), graph.center_of)).figures


def contracted(lanes: Mapping[tuple[str, str], int], center_of: Mapping[str, str]) -> dict[tuple[str, str], int]:
    """Lanes by the two nodes of an edge, the nodes of a roundabout as one and its own lanes left out."""
    found: dict[tuple[str, str], int] = {}
    for (a, b), count in lanes.items():
        ends = center_of.get(a, a), center_of.get(b, b)
        if ends[0] != ends[1]:
            found[ends] = found.get(ends, 0) + count
    return found


def road_counts(lanes: Mapping[tuple[str, str], int]) -> RoadCounts:
    """All counts of roads given as (from, to): lanes for passenger cars, both directions apart."""
    near = _neighbors(lanes)
    chains = tuple((_widest(lanes, path), _widest(lanes, path[::-1])) for path in _paths(near))
    counts = [n for both in chains for n in both if n]
    figures = NetworkFigures(
        intersections=sum(len(others) >= 3 for others in near.values()),
        components=_components(near),
        mean_lanes=sum(counts) / len(counts) if counts else 0.0,
        segments=len(chains),
    )
    return RoadCounts(figures, chains, max((len(others) for others in near.values()), default=0))


def _lanes_between(edges: Iterable[Edge]) -> dict[tuple[str, str], int]:
    found: dict[tuple[str, str], int] = {}
    for edge in edges:
        if edge.car_lanes and edge.from_node != edge.to_node:
            ends = (edge.from_node, edge.to_node)
            found[ends] = found.get(ends, 0) + len(edge.car_lanes)
    return found


def _neighbors(lanes: Iterable[tuple[str, str]]) -> dict[str, dict[str, None]]:
    near: dict[str, dict[str, None]] = {}
    for a, b in lanes:
        near.setdefault(a, {})[b] = None
        near.setdefault(b, {})[a] = None
    return near


def _components(near: Mapping[str, Mapping[str, None]]) -> int:
    seen: set[str] = set()
    count = 0
    for node in near:
        count += node not in seen
        stack = [node]
        while stack:
            if (here := stack.pop()) not in seen:
                seen.add(here)
                stack += near[here]
    return count


def _paths(near: Mapping[str, Mapping[str, None]]) -> Iterator[list[str]]:
    """Maximal paths through nodes of degree 2; a network that is one ring is one path from any node to itself."""
    ends = [n for n in near if len(near[n]) != 2] or list(near)[:1]
    used: set[frozenset[str]] = set()
    for end in ends:
        for step in near[end]:
            if frozenset((end, step)) not in used:
                yield _walk(near, end, step, set(ends), used)


def _walk(
    near: Mapping[str, Mapping[str, None]], end: str, step: str, ends: set[str], used: set[frozenset[str]]
) -> list[str]:
    path = [end, step]
    used.add(frozenset(path))
    while path[-1] not in ends:
        onward = [n for n in near[path[-1]] if n != path[-2]]
        used.add(frozenset((path[-1], onward[0])))
        path.append(onward[0])
    return path


def _widest(lanes: Mapping[tuple[str, str], int], path: list[str]) -> int:
    steps = [lanes.get(step, 0) for step in pairwise(path)]
    return max(steps) if min(steps) > 0 else 0
