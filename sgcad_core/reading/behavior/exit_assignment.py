"""Which way each vehicle drives on: the cheapest joint choice for the pair in contact, then for the others.

Costs are in rough units of "a quarter turn off": a stated heading missed by 90 degrees costs 2, a relative
heading 3, a turn that the network lacks 1.5. Knows no text.
"""

from __future__ import annotations

import math
from itertools import product
from typing import NamedTuple

from sgcad_core.kinds import DRIVEWAY, RAMP
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.layout.road_ways import Way, apart, degree, exits, turn_of, ways_of, wrapped
from sgcad_core.reading.motion.motion_record import DRIVES
from sgcad_core.reading.text.compass import angle_of
from sgcad_core.records.specs import Maneuver, RoadSpec, is_aisle

TURN_RAD: dict[Maneuver, float] = {"turn_left": math.pi / 2, "turn_right": -math.pi / 2}
_QUARTER = math.pi / 2
_IN_STALLS: tuple[Maneuver, ...] = ("parked", "backing")


class Placed(NamedTuple):
    """A vehicle's way and the one that it takes (or means to take) behind the junction."""

    way: Way
    exit: Way | None


class _Option(NamedTuple):
    placed: Placed
    cost: float


def assign(facts: CrashFacts, spec: RoadSpec) -> dict[str, Placed]:
    """A way for every vehicle of the facts."""
    return _Assignment(facts, spec).run()


class _Assignment:
    """One crash on one network."""

    def __init__(self, facts: CrashFacts, spec: RoadSpec) -> None:
        self.facts = facts
        self.spec = spec
        self.ways = ways_of(spec)
        self.plain = all(degree(n.id, spec) < 3 for n in spec.nodes)
        self.options = {v.id: self._options(v) for v in facts.vehicles}

    def run(self) -> dict[str, Placed]:
        """Places the first contact's pair together, then every other vehicle beside them."""
        first = self._first_pair()
        placed: dict[str, Placed] = {}
        if first:
            a, b = first
            best = min(product(self.options[a.id], self.options[b.id]), key=lambda two: self._pair_cost(a, b, *two))
            placed = {a.id: best[0].placed, b.id: best[1].placed}
        for v in self.facts.vehicles:
            if v.id not in placed:
                placed[v.id] = min(self.options[v.id], key=lambda o, v=v: self._cost_beside(v, o, placed)).placed  # type: ignore[misc]
        return placed

    def _first_pair(self) -> tuple[VehicleFacts, VehicleFacts] | None:
        for c in self.facts.contacts:
            a, b = self.facts.vehicle(c.striker), self.facts.vehicle(c.struck)
            if a and b:
                return a, b
        return (self.facts.vehicles[0], self.facts.vehicles[1]) if len(self.facts.vehicles) > 1 else None

    # -------------------------------------------------------------- one vehicle
    def _options(self, v: VehicleFacts) -> list[_Option]:
        found = []
        for way in self.ways:
            onward, odd = self._exit(v, way)
            cost = odd + self._heading_cost(v, way) + self._kind_cost(v, way) + self._place_cost(way)
            found.append(_Option(Placed(way, onward), cost))
        return found

    def _heading_cost(self, v: VehicleFacts, way: Way) -> float:
        if v.heading is None or not self.facts.oriented:
            return 0.0
        along, wanted = (self._flow_rad(way), way.heading_rad), self._travel_rad(v, way) - square_rad(v, way)
        off = min(*(apart(h, wanted) for h in along), apart(way.start_rad, wanted) + 0.2)
        return (2.0 if v.heading_stated else 0.8) * off / _QUARTER

    def _travel_rad(self, v: VehicleFacts, way: Way) -> float:
        """The travel heading of a vehicle on a way.

        A vehicle that backs across a junction moves tail first, away from its facing; without a junction it faces along
        its way and rolls back in it. Stalls have a rule of their own.
        """
        tail_first = goes_tail_first(v) and not is_aisle(way.road) and not self.plain and bool(exits(way, self.ways))
        return angle_of(v.heading or "N") + (math.pi if tail_first else 0.0)

    def _kind_cost(self, v: VehicleFacts, way: Way) -> float:
        """Cost of a driveway for a vehicle that comes from none, and of a street for one that does; ramps likewise."""
        from_access, from_ramp = v.origin in DRIVES, v.origin == RAMP
        cost = 0.0
        if (way.road.kind == DRIVEWAY) != from_access:
            cost += 1.5 if way.road.kind == DRIVEWAY else 0.6
        if (way.road.kind == RAMP) != from_ramp:
            cost += 0.8
        return cost

    def _flow_rad(self, way: Way) -> float:
        """Heading of a way; reports give a vehicle on a ramp the heading of the road that it joins."""
        onward = exits(way, self.ways) if way.road.kind == RAMP else ()
        return min(onward, key=lambda w: abs(turn_of(way, w))).heading_rad if onward else way.heading_rad

    def _place_cost(self, way: Way) -> float:
        """Approaches to a junction are where crashes are told from; on a plain road, the ways to its middle."""
        leads = degree(way.to_node, self.spec)
        if self.plain:
            return 0.0 if leads == 2 else 0.3
        return {1: 1.0, 2: 0.5}.get(leads, 0.0)

    def _exit(self, v: VehicleFacts, way: Way) -> tuple[Way | None, float]:
        """The way taken behind this one and how ill it fits the maneuver."""
        ways = exits(way, self.ways)
        wanted = TURN_RAD.get(_meant(v), 0.0)
        if v.maneuver == "u_turn" or (v.standing and not ways) or self._backs_up(v, way):
            return None, 0.0
        fitting = [(self._exit_misfit(v, way, w, wanted), w) for w in ways]
        if not fitting:
            return None, 1.5 if wanted else 0.0
        misfit, best = min(fitting, key=lambda f: f[0])
        if misfit > 0.75:
            return None, 1.5 if wanted else 0.4
        return best, misfit

    def _backs_up(self, v: VehicleFacts, way: Way) -> bool:
        """Whether it faces along its lane and rolls back in it; the direction told of a backing vehicle is its travel,
        unless it faces there on a road without a junction."""
        on_street = v.origin not in DRIVES and way.road.kind != DRIVEWAY
        return v.maneuver == "backing" and on_street and (not v.heading_stated or (self.plain and v.faces))

    def _exit_misfit(self, v: VehicleFacts, way: Way, onward: Way, wanted: float) -> float:
        off = apart(turn_of(way, onward), wanted) / _QUARTER
        if wanted and v.exit_heading and apart(onward.start_rad, angle_of(v.exit_heading)) < math.radians(50):
            off -= 0.1
        if wanted and v.target in DRIVES and onward.road.kind == DRIVEWAY:
            off -= 0.3
        if onward.road.kind == DRIVEWAY and v.target not in DRIVES:
            off += 0.2
        if not wanted and onward.road.kind == RAMP:
            off += 0.1
        return max(off, 0.0)

    # -------------------------------------------------------------- two vehicles
    def _pair_cost(self, a: VehicleFacts, b: VehicleFacts, one: _Option, other: _Option) -> float:
        return one.cost + other.cost + self._together(a, b, one.placed.way, other.placed.way)

    def _together(self, a: VehicleFacts, b: VehicleFacts, one: Way, other: Way) -> float:
        """Relative heading, and whether the two ways bring the vehicles to one place."""
        cost = 0.0
        if a.heading and b.heading:
            square = square_rad(a, one) - square_rad(b, other)
            told = not square or (a.heading_stated and b.heading_stated)
            wanted = self._travel_rad(b, other) - self._travel_rad(a, one) + square if told else 0.0
            cost += 3.0 * abs(wrapped(self._flow_rad(other) - self._flow_rad(one) - wanted)) / _QUARTER
        same = (one.road.id, one.direction) == (other.road.id, other.direction)
        if one.to_node != other.to_node and not (one.road.id == other.road.id and not same and self.plain):
            cost += 1.2
        merge = RAMP in (one.road.kind, other.road.kind)
        if not same and not merge and apart(one.heading_rad, other.heading_rad) < math.radians(30):
            cost += 0.8
        return cost

    def _cost_beside(self, v: VehicleFacts, option: _Option, placed: dict[str, Placed]) -> float:
        """Cost of a further vehicle beside those that stand already, its contact partner before all."""
        partners = [
            c.struck if c.striker == v.id else c.striker for c in self.facts.contacts if v.id in (c.striker, c.struck)
        ]
        near = [p for p in partners if p in placed] or list(placed)[:1]
        cost = option.cost
        for name in near[:1]:
            partner = self.facts.vehicle(name)
            if partner:
                cost += self._together(v, partner, option.placed.way, placed[name].way)
        return cost


def _meant(v: VehicleFacts) -> Maneuver:
    """The maneuver, or the turn for which one that stands in a turn lane waits."""
    waits: dict[str, Maneuver] = {"left_turn": "turn_left", "right_turn": "turn_right"}
    return waits.get(v.lane_word or "", v.maneuver) if v.maneuver == "stopped" and v.lane is None else v.maneuver


def goes_tail_first(v: VehicleFacts) -> bool:
    """Whether it backs away from where it is told to face, not to where it is told to go."""
    return v.maneuver == "backing" and v.heading_stated and v.faces


def square_rad(v: VehicleFacts, way: Way) -> float:
    """How a vehicle that is told to face across an aisle stands to it: nose in, in a stall to its right; else 0."""
    if not is_aisle(way.road) or not v.heading or not v.heading_stated or v.maneuver not in _IN_STALLS:
        return 0.0
    across = abs(apart(way.heading_rad, angle_of(v.heading)) - _QUARTER) < _QUARTER / 2
    return -_QUARTER if across else 0.0
