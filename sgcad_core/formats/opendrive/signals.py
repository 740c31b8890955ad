"""Traffic control of a map: signs, signal heads with their programs, stop lines. Records only, no XML.

Everything follows from the lane graph: link states give the approaches that stop (s, w), programs what signals
show, parameters of edges and nodes what SUMO has no term for (`plain_xml`). Codes: MUTCD 2009
(R1-1 stop, R1-2 yield, R1-3P all way, R2-1 speed limit) with country "US"; signal heads
1000001 of OpenDRIVE's own list. Metres; seconds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from typing import NamedTuple

from sgcad_core.formats.opendrive.streets import RoadLane, Side, Street
from sgcad_core.formats.sumo.parameters import CONTROL, LIMIT, POSTED
from sgcad_core.roads.lane_graph import Connection, Edge, LaneGraph

BESIDE_M = 1.0
"""From the edge of the pavement to a sign or a signal's pole."""
STOP_LINE_M = 0.4
LINE_BACK_M = 0.5
"""A stop line's middle lies so far before the junction."""
LIMIT_SIGN_M = 15.0
"""A speed limit sign stands so far behind the beginning of its road: the report tells the limit, not the place."""
SIGN_Z_M = 2.1
HEAD_Z_M = 5.2
PLAQUE_Z_M = 1.6
STOP, ALL_WAY, YIELD, SPEED_LIMIT = "R1-1", "R1-3P", "R1-2", "R2-1"
HEAD = "1000001"
_SHOWN = {"G": "green", "g": "green", "y": "yellow", "Y": "yellow", "r": "red", "R": "red", "u": "red-yellow",
          "o": "flashing", "O": "off", "s": "red"}  # fmt: skip


@dataclass(frozen=True)
class Signal:
    """A sign or a signal head; `lanes`: ids of the lanes it holds for, outermost last."""

    id: str
    road: str
    s_m: float
    t_m: float
    side: Side
    type: str
    name: str
    lanes: tuple[int, ...]
    country: str = "US"
    dynamic: bool = False
    z_m: float = SIGN_Z_M
    size_m: tuple[float, float] = (0.75, 0.75)
    limit_mph: float | None = None
    stop_line: str = ""
    main: str = ""
    """Id of the sign that a plaque belongs to."""


class StopLine(NamedTuple):
    """A stop line across the lanes of one approach; ids are those of objects."""

    id: str
    road: str
    s_m: float
    t_m: float
    side: Side
    width_m: float
    lanes: tuple[int, ...]


class SignalPhase(NamedTuple):
    """What the heads of a controller show for a time: signal id -> green, yellow, red, ..."""

    duration_s: float
    states: Mapping[str, str]


class Controller(NamedTuple):
    """Heads that always show the same, and what they show in turn; `program`: SUMO's name of the whole program."""

    id: str
    name: str
    junction: str
    program: str
    signals: tuple[str, ...]
    phases: tuple[SignalPhase, ...]


class Control(NamedTuple):
    """All traffic control of a map."""

    signals: tuple[Signal, ...]
    stop_lines: tuple[StopLine, ...]
    controllers: tuple[Controller, ...]


class _Approach(NamedTuple):
    """One edge where it meets its node."""

    edge: Edge
    street: Street
    links: tuple[Connection, ...]


def control_of(graph: LaneGraph, roads: Sequence[Street]) -> Control:
    """Signs, heads, stop lines and controllers of a map, ids counted through the file."""
    ids, lines = (map(str, count(1)), map(str, count(1)))
    signals: list[Signal] = []
    stop_lines: list[StopLine] = []
    heads: list[tuple[Signal, str, str]] = []
    for approach in _approaches(graph, roads):
        found = [*_heads(approach, graph, ids)]
        placed = [signal for signal, _, _ in found] or _signs(approach, graph, ids)
        if any(signal.type in (HEAD, STOP) for signal in placed):
            line = _stop_line(approach, next(lines))
            stop_lines.append(line)
            placed = [replace(s, stop_line=line.id) if s.type in (HEAD, STOP) else s for s in placed]
        signals += placed
        heads += [(signal, program, column) for signal, (_, program, column) in zip(placed, found, strict=False)]
    for street in roads:
        signals += _limits(street, ids)
    return Control(tuple(signals), tuple(stop_lines), tuple(_controllers(graph, heads)))


def _approaches(graph: LaneGraph, roads: Sequence[Street]) -> Iterator[_Approach]:
    for street in roads:
        for edge in street.edges:
            driven = {lane.index for lane in edge.lanes if not lane.type}
            if links := tuple(link for link in graph.leaving(edge.id) if link.from_lane in driven):
                yield _Approach(edge, street, links)


# ------------------------------------------------------------------ signs
def _signs(approach: _Approach, graph: LaneGraph, ids: Iterator[str]) -> list[Signal]:
    states = {link.state for link in approach.links}
    node = graph.nodes[approach.edge.to_node]
    if "w" in states:
        sign = _beside(approach, next(ids), STOP, "stop sign")
        return [sign, replace(_plaque(sign, next(ids)), main=sign.id)]
    if "s" in states:
        return [_beside(approach, next(ids), STOP, "stop sign")]
    if node.parameters.get(CONTROL) == "yield" and "m" in states and _minor(approach.edge, graph):
        return [_beside(approach, next(ids), YIELD, "yield sign")]
    return []


def _plaque(sign: Signal, name: str) -> Signal:
    return replace(sign, id=name, type=ALL_WAY, name="all way", z_m=PLAQUE_Z_M, size_m=(0.45, 0.15))


def _minor(edge: Edge, graph: LaneGraph) -> bool:
    """Whether another road that meets the node goes before this one."""
    return any(e.to_node == edge.to_node and e.priority > edge.priority for e in graph.edges.values())


def _beside(approach: _Approach, name: str, kind: str, words: str) -> Signal:
    """A sign at the right curb where an approach ends."""
    edge, street = approach.edge, approach.street
    side = street.side_of(edge.id)
    s = street.driven_end(edge.id, at_end=True)
    lanes = tuple(strip.id for strip in _driven(street, side))
    return Signal(name, street.id, s, _curb_t(street, side, s), side, kind, words, lanes)


def _curb_t(street: Street, side: Side, s_m: float) -> float:
    t = street.border_t(street.strips(side)[-1], s_m)
    return t + (BESIDE_M if side == "left" else -BESIDE_M)


def _driven(street: Street, side: Side) -> list[RoadLane]:
    return [strip for strip in street.strips(side) if strip.type == "driving"]


def _limits(street: Street, ids: Iterator[str]) -> Iterator[Signal]:
    """A speed limit sign for each direction whose limit the report tells."""
    for edge in street.edges:
        if (limit := posted_mph(edge)) is None or not (lanes := _driven(street, street.side_of(edge.id))):
            continue
        side = street.side_of(edge.id)
        behind = min(LIMIT_SIGN_M, street.length_m / 4)
        s = behind if side == "right" else street.length_m - behind
        yield Signal(
            next(ids), street.id, s, _curb_t(street, side, s), side, SPEED_LIMIT, f"speed limit {limit:g}",
            tuple(strip.id for strip in lanes), size_m=(0.6, 0.75), limit_mph=limit,
        )  # fmt: skip


def posted_mph(edge: Edge) -> float | None:
    """The speed limit that the report tells of a road, mph; None where it tells none."""
    told = edge.parameters.get(LIMIT, "")
    return float(told.removeprefix(POSTED)) if told.startswith(POSTED) else None


def _stop_line(approach: _Approach, name: str) -> StopLine:
    street, side = approach.street, approach.street.side_of(approach.edge.id)
    end = street.driven_end(approach.edge.id, at_end=True)
    back = min(LINE_BACK_M, street.length_m / 2)
    s = end - back if side == "right" else back
    lanes = _driven(street, side)
    inner, outer = street.border_t(lanes[0], s, inner=True), street.border_t(lanes[-1], s)
    ids = tuple(strip.id for strip in lanes)
    return StopLine(name, street.id, s, (inner + outer) / 2, side, abs(outer - inner), ids)


# ------------------------------------------------------------------ signals
def _heads(approach: _Approach, graph: LaneGraph, ids: Iterator[str]) -> Iterator[tuple[Signal, str, str]]:
    """One head for all links of an approach that always show the same: (head, program, what it shows in turn)."""
    groups: dict[tuple[str, str], list[Connection]] = {}
    for link in approach.links:
        if program := graph.programs.get(link.light):
            column = "".join(p.states[link.link].replace("g", "G") for p in program.phases if link.link < len(p.states))
            groups.setdefault((link.light, column), []).append(link)
    for place, ((program_id, column), links) in enumerate(groups.items()):
        sign = _beside(approach, next(ids), HEAD, _head_name(links, len(groups)))
        used = {link.from_lane for link in links}
        lanes = [s for s in approach.street.strips(sign.side) if s.lane is not None and s.lane.index in used]
        t = sign.t_m + place * (0.5 if sign.side == "left" else -0.5)
        head = replace(
            sign, t_m=t, country="OpenDRIVE", dynamic=True, z_m=HEAD_Z_M, size_m=(0.35, 1.05),
            lanes=tuple(s.id for s in lanes),
        )  # fmt: skip
        yield head, program_id, column


def _head_name(links: Sequence[Connection], groups: int) -> str:
    ways = list(dict.fromkeys(link.direction for link in links))
    return "traffic signal" + (f" ({', '.join(ways)})" if groups > 1 else "")


def _controllers(graph: LaneGraph, heads: Sequence[tuple[Signal, str, str]]) -> Iterator[Controller]:
    """One controller for all heads of a program that show the same in turn."""
    groups: dict[tuple[str, str], list[Signal]] = {}
    for signal, program, column in heads:
        groups.setdefault((program, column), []).append(signal)
    for number, ((program, column), signals) in enumerate(groups.items(), 1):
        names = tuple(signal.id for signal in signals)
        durations = [phase.duration_s for phase in graph.programs[program].phases]
        phases = tuple(
            SignalPhase(duration, dict.fromkeys(names, _SHOWN.get(letter, "off")))
            for duration, letter in zip(durations, column, strict=False)
        )
        node = next((link_node(graph, link) for link in graph.connections if link.light == program), program)
        yield Controller(str(number), f"{program} {number}", node, program, names, phases)


def shown_in_turn(graph: LaneGraph, link: Connection) -> tuple[str, ...]:
    """What the signal of a connection shows in each phase of the map's own program; empty without a program."""
    program = graph.programs.get(link.light)
    phases = program.phases if program else ()
    return tuple(_SHOWN.get(p.states[link.link], "off") for p in phases if 0 <= link.link < len(p.states))


def link_node(graph: LaneGraph, link: Connection) -> str:
    """The node that a connection crosses."""
    return graph.edges[link.from_edge].to_node
