"""Turning a road network so that its legs lie as a report tells them: a junction found elsewhere faces anywhere.

Angles in radians, counter-clockwise from east; a turn changes neither lengths nor angles between legs. Knows
plain XML's coordinates; no OpenStreetMap and no crash.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from sgcad_core.case.records import PlainXml
from sgcad_core.formats.xml import Element, parse_xml, to_text
from sgcad_core.roads.junction_words import JunctionLeg

LANE_RAD = 0.2
"""A lane too many or too few weighs like a leg that lies 11 degrees off."""


def best_turn(legs: Sequence[JunctionLeg], wanted: Sequence[JunctionLeg], step_rad: float = 0.0) -> tuple[float, float]:
    """The turn in (-pi, pi] after which legs lie nearest to the wanted ones, and what is still off (radians a leg).

    Every wanted leg counts with the nearest one that is left. `step_rad` allows only multiples of it.
    """
    if not legs or not wanted:
        return 0.0, 0.0
    turns = {_rounded(w.angle_rad - leg.angle_rad, step_rad) for w in wanted for leg in legs}
    off = {turn: _misfit(legs, wanted, turn) for turn in turns}
    best = min(off, key=lambda turn: (round(off[turn], 6), abs(turn), turn))
    return best, off[best]


def _rounded(turn_rad: float, step_rad: float) -> float:
    turn = round(turn_rad / step_rad) * step_rad if step_rad else turn_rad
    return round(math.remainder(turn, math.tau), 9)


def _misfit(legs: Sequence[JunctionLeg], wanted: Sequence[JunctionLeg], turn_rad: float) -> float:
    """Mean over wanted legs of the angle and lanes by which the nearest free leg misses them."""
    pairs = sorted((_apart(leg, w, turn_rad), i, k) for i, leg in enumerate(legs) for k, w in enumerate(wanted))
    taken: set[int] = set()
    matched: dict[int, float] = {}
    for apart, i, k in pairs:
        if i not in taken and k not in matched:
            taken.add(i)
            matched[k] = apart
    return (sum(matched.values()) + math.pi * (len(wanted) - len(matched))) / len(wanted)


def _apart(leg: JunctionLeg, wanted: JunctionLeg, turn_rad: float) -> float:
    lanes = abs(leg.lanes_in - wanted.lanes_in) + abs(leg.lanes_out - wanted.lanes_out)
    return abs(math.remainder(leg.angle_rad + turn_rad - wanted.angle_rad, math.tau)) + LANE_RAD * lanes


def turned_network(plain: PlainXml, turn_rad: float) -> PlainXml:
    """The same network turned about (0, 0). Raises InvalidOutput for XML that cannot be read."""
    if not turn_rad:
        return plain
    return PlainXml(
        nodes=_turned(plain.nodes, "nodes", turn_rad),
        edges=_turned(plain.edges, "edges", turn_rad),
        connections=_turned(plain.connections, "connections", turn_rad) if plain.connections else "",
    )


def with_longer_ends(plain: PlainXml, least_m: float) -> PlainXml:
    """The network with its dead ends moved straight outwards until the roads to them have a length.

    A cut ends at the next junction, often too near for an approach at speed. Raises InvalidOutput as `turned_network`.
    """
    nodes, edges = parse_xml(plain.nodes, "plain_xml nodes"), parse_xml(plain.edges, "plain_xml edges")
    for node in nodes.iterfind("node[@type='dead_end']"):
        touching = [e for e in edges if node.get("id") in (e.get("from"), e.get("to")) and e.get("shape")]
        if touching:
            _prolong(node, touching, least_m)
    return plain.model_copy(update={"nodes": to_text(nodes), "edges": to_text(edges)})


def _prolong(node: Element, touching: Sequence[Element], least_m: float) -> None:
    outward = [_outward(edge, node.get("id")) for edge in touching]
    lacking = least_m - min(sum(math.dist(a, b) for a, b in pairwise(line)) for line in outward)
    (ax, ay), (bx, by) = outward[0][-2:]
    if lacking <= 0 or (ax, ay) == (bx, by):
        return
    share = lacking / math.dist((ax, ay), (bx, by))
    dx, dy = (bx - ax) * share, (by - ay) * share
    node.set("x", f"{float(node.get('x')) + dx:.3f}")
    node.set("y", f"{float(node.get('y')) + dy:.3f}")
    for edge, line in zip(touching, outward, strict=True):
        longer = [*line, (line[-1][0] + dx, line[-1][1] + dy)]
        points = longer if edge.get("to") == node.get("id") else longer[::-1]
        edge.set("shape", " ".join(f"{x:.3f},{y:.3f}" for x, y in points))


def _outward(edge: Element, end: str) -> list[tuple[float, float]]:
    """The edge's line towards the node `end`."""
    line = [(float(x), float(y)) for x, y in (point.split(",")[:2] for point in edge.get("shape").split())]
    return line if edge.get("to") == end else line[::-1]


def _turned(text: str, what: str, turn_rad: float) -> str:
    root = parse_xml(text, f"plain_xml {what}")
    for element in root.iter():
        _turn(element, turn_rad)
    return to_text(root)


def _turn(element: Element, turn_rad: float) -> None:
    if element.get("x") is not None and element.get("y") is not None:
        x, y = _about_origin(float(element.get("x")), float(element.get("y")), turn_rad)
        element.set("x", f"{x:.3f}")
        element.set("y", f"{y:.3f}")
    if element.get("shape"):
        points = (point.split(",")[:2] for point in element.get("shape").split())
        moved = (_about_origin(float(x), float(y), turn_rad) for x, y in points)
        element.set("shape", " ".join(f"{x:.3f},{y:.3f}" for x, y in moved))


def _about_origin(x: float, y: float, turn_rad: float) -> tuple[float, float]:
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    return c * x - s * y, s * x + c * y
