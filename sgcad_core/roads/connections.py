"""The connections of a road spec: the lanes that lead into each other at every node.

Every exit of a node is reachable from every approach (a crash may need any of them): stated turns come
first, the usual U.S. lane use fills the rest. Lanes are numbered from 0 at the right curb. Knows the spec
and the lines of its roads; no XML.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from sgcad_core.kinds import RAMP
from sgcad_core.records.specs import Beside, RoadSpec, Turn
from sgcad_core.roads.lane_graph import edge_id, road_of
from sgcad_core.roads.road_geometry import Direction, Roadway, beside, has_center_lane, lanes, open_lanes

Movement = Literal["left", "through", "right"]
THROUGH_DEG = 50.0
SHARP_DEG = 155.0
"""Sharper turns are left out where there is another way: their stop lines cannot be drawn."""
RAMP_SHARP_DEG = 110.0
COLLINEAR_DEG = 12.0
_USES: dict[Turn, frozenset[Movement]] = {
    "left": frozenset({"left"}), "through": frozenset({"through"}), "right": frozenset({"right"}),
    "left_through": frozenset({"left", "through"}), "through_right": frozenset({"through", "right"}),
    "left_right": frozenset({"left", "right"}), "any": frozenset({"left", "through", "right"}),
}  # fmt: skip


class Link(NamedTuple):
    """One connection in SUMO's ids and lane indices."""

    from_edge: str
    from_lane: int
    to_edge: str
    to_lane: int


@dataclass(frozen=True)
class _Way:
    """One direction of a road as it meets a node; `heading_rad` is that of travel there."""

    road: str
    direction: Direction
    kind: str
    lanes: int
    heading_rad: float
    turns: tuple[Turn, ...] = ()
    center_lane: bool = False
    circle: bool = False
    beside: tuple[Beside, ...] = ()
    open: tuple[int, ...] = ()
    """Its lanes that no work zone closes; `lanes` counts these."""
    laid: int = 0

    @property
    def edge(self) -> str:
        return edge_id(self.road, self.direction)


class _Exit(NamedTuple):
    way: _Way
    angle_deg: float
    """Left positive, relative to the approach."""


def links(spec: RoadSpec, roadways: Mapping[str, Roadway]) -> tuple[Link, ...]:
    """All connections, node by node."""
    found: list[Link] = []
    for node in spec.nodes:
        arriving, leaving = _ways_at(node.id, spec, roadways)
        for approach in arriving:
            found += [*_approach_links(approach, arriving, leaving), *_going_on(approach, leaving)]
            found += _turning_round(approach, leaving) if node.opening else []
    return tuple(_outer_lanes_counted(dict.fromkeys(found), spec))


def _turning_round(approach: _Way, leaving: Sequence[_Way]) -> list[Link]:
    """From the innermost lane into that of the other direction of the same road, through an opening in the median."""
    back = [way for way in leaving if way.road == approach.road]
    return [Link(approach.edge, approach.lanes - 1, way.edge, way.lanes - 1) for way in back]


def _outer_lanes_counted(found: Iterable[Link], spec: RoadSpec) -> Iterator[Link]:
    """Links with SUMO's indices: lanes beside the roadway come first, and closed lanes count."""
    roads = {road.id: road for road in spec.roads}

    def counted(edge: str, lane: int) -> int:
        name, way = road_of(edge)
        road, open_ = roads[name], open_lanes(roads[name], way)
        laid = lane if lane < 0 else open_[lane] if lane < len(open_) else lanes(road, way)
        return laid + len(beside(road))

    for link in found:
        start, end = counted(link.from_edge, link.from_lane), counted(link.to_edge, link.to_lane)
        yield link._replace(from_lane=start, to_lane=end)


def _going_on(approach: _Way, leaving: Sequence[_Way]) -> list[Link]:
    """Links of the lanes beside the roadway into equal ones: bicycle lanes straight across, all where two roads meet.

    Counted from -1, next to the lanes, outwards.
    """
    exits = [_Exit(w, _angle_deg(approach, w)) for w in leaving if w.road != approach.road]
    straight = min(exits, key=lambda e: abs(e.angle_deg), default=None)
    if straight is None or abs(straight.angle_deg) > THROUGH_DEG or approach.circle:
        return []
    own, other = approach.beside, straight.way.beside
    alike = [what for what in own if what in other and (what == "bike_lane" or len(exits) == 1)]
    return [Link(approach.edge, -1 - own.index(w), straight.way.edge, -1 - other.index(w)) for w in alike]


def _ways_at(node: str, spec: RoadSpec, roadways: Mapping[str, Roadway]) -> tuple[list[_Way], list[_Way]]:
    arriving: list[_Way] = []
    leaving: list[_Way] = []
    for road in spec.roads:
        if node in (road.from_node, road.to_node):
            line = roadways[road.id].center
            ends = (_heading(line[0], line[1]), _heading(line[-2], line[-1]))
            inward: Direction = "forward" if road.to_node == node else "backward"
            outward: Direction = "backward" if inward == "forward" else "forward"
            h_in, h_out = (ends[1], ends[1] + math.pi) if inward == "forward" else (ends[0] + math.pi, ends[0])
            turns = road.turns_forward if inward == "forward" else road.turns_backward
            for way, heading, uses, found in ((inward, h_in, turns, arriving), (outward, h_out, (), leaving)):
                if open_ := open_lanes(road, way):
                    more = has_center_lane(road), road.circle, beside(road), open_, lanes(road, way)
                    found.append(_Way(road.id, way, road.kind, len(open_), heading, uses, *more))
    return arriving, leaving


def _heading(a: Sequence[float], b: Sequence[float]) -> float:
    return math.atan2(b[1] - a[1], b[0] - a[0])


def _angle_deg(approach: _Way, way: _Way) -> float:
    turn = way.heading_rad - approach.heading_rad
    return math.degrees((turn + math.pi) % (2 * math.pi) - math.pi)


# ------------------------------------------------------------------ one approach
def _approach_links(approach: _Way, arriving: Sequence[_Way], leaving: Sequence[_Way]) -> list[Link]:
    exits = _drivable([_Exit(w, _angle_deg(approach, w)) for w in leaving if w.road != approach.road], approach)
    if not exits:
        return []
    if approach.circle:
        return _around(approach, exits)
    if (ahead := exits[0].way) and len(exits) == 1 and approach.laid == ahead.laid and approach.open != ahead.open:
        return _past_closure(approach, ahead) + _center_lane_link(approach, {"through": exits})
    by_movement = _movements(exits)
    uses = _lane_uses(approach, by_movement)
    found = []
    for movement, targets in by_movement.items():
        serving = [i for i, use in enumerate(uses) if movement in use]
        for target in targets:
            found += _join(approach, serving, movement, target, arriving)
    return found + _center_lane_link(approach, by_movement)


def _past_closure(approach: _Way, ahead: _Way) -> list[Link]:
    """At the ends of a work zone every lane that is open on both sides goes on; the others merge."""
    both = [lane for lane in approach.open if lane in ahead.open]
    return [Link(approach.edge, approach.open.index(i), ahead.edge, ahead.open.index(i)) for i in both]


def _around(approach: _Way, exits: Sequence[_Exit]) -> list[Link]:
    """On in a roundabout, and out of it from as many outer lanes as the exit has; a wider exit widens behind it."""
    found = []
    for way, _ in exits:
        shared = min(approach.lanes, way.lanes)
        pairs = [(lane, lane) for lane in range(shared)]
        pairs += [(shared - 1, lane) for lane in range(shared, way.lanes if not way.circle else 0)]
        found += [Link(approach.edge, lane, way.edge, goal) for lane, goal in pairs]
    return found


def _drivable(exits: list[_Exit], approach: _Way) -> list[_Exit]:
    def sharp(exit_: _Exit) -> bool:
        ramp = RAMP in (approach.kind, exit_.way.kind)
        return abs(exit_.angle_deg) > (RAMP_SHARP_DEG if ramp else SHARP_DEG)

    return [e for e in exits if not sharp(e)] or exits


def _movements(exits: list[_Exit]) -> dict[Movement, list[_Exit]]:
    """Exits by movement: the straightest is through, unless two are about as straight (a fork)."""
    order = sorted(exits, key=lambda e: abs(e.angle_deg))
    straight = order[0] if abs(order[0].angle_deg) <= THROUGH_DEG else None
    if len(order) == 1:
        straight = straight or (order[0] if abs(order[0].angle_deg) < 110 else None)
    elif straight and abs(order[1].angle_deg) - abs(straight.angle_deg) < 15 and abs(order[1].angle_deg) < THROUGH_DEG:
        straight = None
    fork = len(order) > 1 and abs(order[1].angle_deg) < THROUGH_DEG
    pivot = straight.angle_deg if straight else sum(e.angle_deg for e in order[:2]) / 2 if fork else 0.0
    found: dict[Movement, list[_Exit]] = {
        "right": [e for e in exits if e is not straight and e.angle_deg < pivot],
        "through": [straight] if straight else [],
        "left": [e for e in exits if e is not straight and e.angle_deg >= pivot],
    }
    return {movement: targets for movement, targets in found.items() if targets}


def _lane_uses(approach: _Way, exits: Mapping[Movement, list[_Exit]]) -> list[set[Movement]]:
    """Movements of each lane: as stated, else the usual ones; no lane and no exit is left without."""
    stated = approach.turns if len(approach.turns) == approach.lanes else ()
    usual = _usual_uses(approach.lanes, exits)
    uses = [set(_USES[turn]) & set(exits) for turn in stated] if stated else usual
    for use, other in zip(uses, usual, strict=True):
        use |= set() if use else other
    for movement, lane in (("right", 0), ("left", -1)):
        if movement in exits and not any(movement in use for use in uses):
            uses[lane].add(movement)  # type: ignore[arg-type]
    if "through" in exits and not any("through" in use for use in uses):
        uses[0 if "right" not in uses[0] else -1].add("through")
    return uses


def _usual_uses(count: int, exits: Mapping[Movement, list[_Exit]]) -> list[set[Movement]]:
    """Turns from the outer lanes; lanes that do not fit the through road turn only, left ones first."""
    if "through" not in exits:
        return _shared_out(count, [m for m in ("right", "left") if m in exits])
    first, last = 0, count - 1
    fit = exits["through"][0].way.lanes
    if "left" in exits and last - first + 1 > fit:
        last -= 1
    if "right" in exits and last - first + 1 > fit:
        first += 1
    uses: list[set[Movement]] = [{"through"} if first <= i <= last else set() for i in range(count)]
    if "right" in exits:
        uses[0].add("right")
    if "left" in exits:
        uses[-1].add("left")
    return uses


def _shared_out(count: int, movements: Sequence[Movement]) -> list[set[Movement]]:
    """Lanes of a road that ends: the right half turns right, the left half left, a single lane both."""
    if len(movements) == 1 or count == 1:
        return [set(movements) for _ in range(count)]
    half = count // 2
    return [{movements[0]} if i < half else {movements[1]} for i in range(count)]


# ------------------------------------------------------------------ one movement
def _join(
    approach: _Way, serving: Sequence[int], movement: Movement, target: _Exit, arriving: Sequence[_Way]
) -> list[Link]:
    """Lanes side by side into the exit: right turns and merges from the right keep right, others keep left."""
    room, count = target.way.lanes, len(serving)
    if movement == "through":
        count = max(count - _left_alone(approach, serving), 1)
    keeps_right = movement == "right" or _merges_from_right(approach, target, arriving)
    pairs = []
    for k, lane in enumerate(serving):
        goal = k if keeps_right else room - count + k
        pairs.append((lane, min(max(goal, 0), room - 1)))
    if movement == "through" and count < room and len(arriving) <= 2:
        pairs += _widening(serving, room, keeps_right, approach, arriving)
    return [Link(approach.edge, lane, target.way.edge, goal) for lane, goal in pairs]


def _left_alone(approach: _Way, serving: Sequence[int]) -> int:
    """Left-turn lanes that go straight on since no road lies to the left: behind the node they end in the next lane."""
    stated = approach.turns if len(approach.turns) == approach.lanes else ()
    return sum(bool(stated) and stated[lane] == "left" for lane in serving)


def _widening(
    serving: Sequence[int], room: int, keeps_right: bool, approach: _Way, arriving: Sequence[_Way]
) -> list[tuple[int, int]]:
    """On a plain road that widens, the outer lane leads into the new lanes as well."""
    if any(w.road != approach.road and abs(_angle_deg(approach, w)) < 90 for w in arriving):
        return []
    spare = range(len(serving), room) if keeps_right else range(room - len(serving))
    return [(serving[-1] if keeps_right else serving[0], goal) for goal in spare]


def _merges_from_right(approach: _Way, target: _Exit, arriving: Sequence[_Way]) -> bool:
    """Whether a straighter road leads into the same exit and this one comes from its right."""
    straighter = [
        w for w in arriving
        if w.road not in (approach.road, target.way.road)
        and abs(_angle_deg(w, target.way)) < min(abs(target.angle_deg), THROUGH_DEG)
    ]  # fmt: skip
    return bool(straighter) and -THROUGH_DEG < target.angle_deg < -COLLINEAR_DEG


def _center_lane_link(approach: _Way, exits: Mapping[Movement, list[_Exit]]) -> list[Link]:
    """The two-way left-turn lane goes on into that of the road ahead, and turns left; it belongs to the forward
    edges."""
    if not approach.center_lane or approach.direction != "forward":
        return []
    ahead = [t.way for t in exits.get("through", []) if t.way.direction == "forward" and t.way.center_lane]
    left = [t.way for t in exits.get("left", []) if t.angle_deg > THROUGH_DEG]
    found = [Link(approach.edge, approach.lanes, way.edge, way.lanes) for way in ahead[:1]]
    return found + [Link(approach.edge, approach.lanes, way.edge, way.lanes - 1) for way in left]
