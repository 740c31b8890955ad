"""A written network against what the narrative states of the roads: lanes, legs, one-way, limits, directions.

Only statements that the text makes in so many words are held against a network, and each with the readings
that it allows ("four-lane" with or without turn lanes, where a diagram may show them): a false alarm costs an
attempt. Reads the compiled network; compass is north up.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.lane_graph import LaneGraph, road_of
from sgcad_core.formats.net_xml import parse_net
from sgcad_core.holds import SOME_LANES
from sgcad_core.interfaces import Validator
from sgcad_core.narrative.compass import angle_of, turned
from sgcad_core.narrative.junction import JunctionFacts
from sgcad_core.narrative.roads import RoadFact, RoadFacts, road_facts
from sgcad_core.records import Evidence, Finding, Hold, RoadNetwork, Scenario
from sgcad_core.specs import Compass

MPS_PER_MPH = 0.44704
AXIS_WORDS = {"N": "north-south", "NE": "northeast-southwest", "E": "east-west", "SE": "northwest-southeast"}
WORDS = {
    "N": "north", "NE": "northeast", "E": "east", "SE": "southeast",
    "S": "south", "SW": "southwest", "W": "west", "NW": "northwest",
}  # fmt: skip


@dataclass(frozen=True)
class _Drawn:
    """A road as drawn: passenger lanes each way and the headings that it covers (radians, of the forward edge)."""

    id: str
    forward: int
    backward: int
    headings: tuple[float, ...]
    speeds_mph: tuple[float, ...]

    @property
    def total(self) -> int:
        return self.forward + self.backward

    def along(self, way: Compass, tolerance_deg: float, either: bool = False) -> bool:
        """Whether the forward edge somewhere heads that way (or, with `either`, the other way)."""
        return any(_near(h, angle_of(way), tolerance_deg, either) for h in self.headings)

    def lanes_towards(self, way: Compass, tolerance_deg: float) -> int:
        """Lanes of traffic that heads that way; 0 where the road runs otherwise."""
        if self.along(way, tolerance_deg):
            return self.forward
        against = any(_near(h + math.pi, angle_of(way), tolerance_deg, False) for h in self.headings)
        return self.backward if against else 0


class RoadNarrative(Validator):
    """Findings on lanes, legs, one-way roads and missing directions ask again; limits and guesses are notes."""

    stage: ClassVar[str] = "road"
    tolerance_deg: float = 35.0
    """Between a road as drawn and the compass direction that the report names."""
    limit_tolerance_mph: float = 3.0

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Worst first; a network that did not compile and a report that states nothing are passed over."""
        if not isinstance(artifact, RoadNetwork) or artifact.net_xml is None:
            return []
        try:
            graph = parse_net(artifact.net_xml)
        except InvalidOutput:
            return []
        facts = road_facts(evidence.report.narrative)
        drawn = _drawn(graph)
        found = [
            *self._legs(facts.junction, graph), *self._directions(facts, drawn), *self._one_way(facts, drawn),
            *self._lanes(facts, drawn, bool(evidence.report.diagrams)), *self._limits(facts, drawn),
        ]  # fmt: skip
        return sorted(found, key=lambda f: f.severity != "repair")

    # -------------------------------------------------------------- junction
    def _legs(self, junction: JunctionFacts, graph: LaneGraph) -> Iterator[Finding]:
        widest = max(_degrees(graph).values(), default=0)
        want = {"t": 3, "four_leg": 4}.get(junction.kind)
        if want and junction.stated and widest < want:
            said = "a T-intersection" if want == 3 else "a four-leg intersection"
            what = f"the report says {said}, but no junction of the network has {want} legs"
            remedy, holds = f"let {want} roads meet at one node", (Hold(items="legs", at_least=want),)
            yield _finding(what, "junction", f"at most {widest} roads meet", remedy, holds=holds)
        elif want == 3 and junction.stated and widest > 3:
            what = "the report says a T-intersection, but the junction has a leg too many"
            remedy = "leave out the leg that the report does not name, unless the diagram shows it"
            yield _finding(what, "junction", f"{widest} roads meet", remedy, "note")
        elif junction.kind == "none" and widest >= 3:
            remedy = "draw a plain road, unless the diagram shows the junction"
            yield _finding("the report names no junction", "junction", f"{widest} roads meet", remedy, "note")

    # -------------------------------------------------------------- directions of travel
    def _directions(self, facts: RoadFacts, drawn: list[_Drawn]) -> Iterator[Finding]:
        divided = any(road.lanes.divided for road in facts.streets)
        for v in facts.crash.vehicles:
            if not v.heading or not v.heading_stated or v.maneuver == "parked":
                continue
            if any(self._carries(road, v.heading, divided) for road in drawn):
                continue
            word = WORDS[v.heading]
            what = f"{v.id} travels {word}, but no road carries traffic that way"
            remedy = f"give a road lanes that head {word}; x is east, y is north"
            yield _finding(what, v.id, f"heading {word}", remedy, holds=_carrying(v.heading))

    def _carries(self, road: _Drawn, way: Compass, divided: bool) -> bool:
        """Whether traffic may head that way; of a divided road one carriageway may stand for both."""
        tolerance = self.tolerance_deg + 15
        return bool(road.lanes_towards(way, tolerance)) or (divided and road.along(way, tolerance, either=True))

    # -------------------------------------------------------------- one-way
    def _one_way(self, facts: RoadFacts, drawn: list[_Drawn]) -> Iterator[Finding]:
        for road in facts.streets:
            here = self._on_axis(road, drawn)
            if road.lanes.one_way and here and all(d.forward and d.backward for d in here):
                name = AXIS_WORDS[road.axis or "N"]
                what, remedy = f"the {name} road is one-way in the report", "set the other direction's lanes to 0"
                either = ({"lanes_in": SOME_LANES, "lanes_out": (0,)}, {"lanes_in": (0,), "lanes_out": SOME_LANES})
                holds = (Hold(items="legs", key="bearing", values=_ends(road), either=either),)
                yield _finding(what, _ids(here), "lanes in both directions", remedy, holds=holds)

    def _on_axis(self, road: RoadFact, drawn: list[_Drawn]) -> list[_Drawn]:
        axis = road.axis
        return [d for d in drawn if axis and d.along(axis, self.tolerance_deg, either=True)]

    # -------------------------------------------------------------- lanes
    def _lanes(self, facts: RoadFacts, drawn: list[_Drawn], pictured: bool) -> Iterator[Finding]:
        for road in facts.streets:
            allowed = allowed_totals(road, pictured)
            here = self._on_axis(road, drawn)
            searched = drawn if _vague(road, pictured) else here
            if not allowed or not here or any(d.total in allowed for d in searched):
                continue
            low, high = min(allowed), max(allowed)
            said = str(low) if low == high else f"{low} to {high}"
            what = f"the {AXIS_WORDS[road.axis or 'N']} road has {said} lanes in both directions together in the report"
            seen = ", ".join(f"{d.id} {d.forward}+{d.backward}" for d in here[:4])
            remedy = "correct lanes_forward and lanes_backward, turn lanes counted"
            yield _finding(what, _ids(here), seen, remedy, holds=(_totals(road, allowed),))

    # -------------------------------------------------------------- limits
    def _limits(self, facts: RoadFacts, drawn: list[_Drawn]) -> Iterator[Finding]:
        for road in facts.streets:
            here = self._on_axis(road, drawn)
            limit = road.speed_limit_mph
            if limit is None or not here or any(self._at(limit, s) for d in here for s in d.speeds_mph):
                continue
            what = f"the {AXIS_WORDS[road.axis or 'N']} road's posted limit is {limit} mph in the report"
            seen = f"{here[0].speeds_mph[0]:.0f} mph"
            yield _finding(what, _ids(here), seen, f"set speed_limit_mph to {limit}", "note")

    def _at(self, limit: int, speed_mph: float) -> bool:
        return abs(limit - speed_mph) <= self.limit_tolerance_mph


def allowed_totals(road: RoadFact, pictured: bool = True) -> set[int]:
    """Totals of both directions that agree with the text; empty where it does not state one for sure.

    A divided or one-way road is passed over (one carriageway may be drawn); a center lane may be counted or
    not, and turn lanes at the junction may stand beside the lanes named. Without a diagram nobody knows of turn lanes
    but those that the text names, and lanes told way by way leave no center lane open.
    """
    lanes = road.lanes
    if road.kind != "road" or lanes.one_way or lanes.divided or lanes.one_way_toward:
        return set()
    named = lanes.total or (2 * lanes.each_way if lanes.each_way else None)
    named = named or (sum(lanes.toward.values()) if len(lanes.toward) == 2 else None)
    if not named:
        return set()
    extra = sum(len(turns) for turns in lanes.turns.values()) + pictured
    fewer = lanes.center_turn_lane or (_vague(road, pictured) and named % 2)
    return set(range(max(1, named - fewer), named + extra + 1))


def _vague(road: RoadFact, pictured: bool) -> bool:
    """Whether a diagram may show other lanes than the text counts; told way by way they are all there."""
    return pictured and len(road.lanes.toward) < 2


def _carrying(way: Compass) -> tuple[Hold, ...]:
    """Lanes that way on both legs that may lie along it."""
    return (
        Hold(items="legs", key="bearing", values=(turned(way, 180),), either=({"lanes_in": SOME_LANES},)),
        Hold(items="legs", key="bearing", values=(way,), either=({"lanes_out": SOME_LANES},)),
    )


def _totals(road: RoadFact, allowed: set[int]) -> Hold:
    """Lanes of a leg, both ways, that add up to what the text allows."""
    pairs = [(n, tuple(total - n for total in sorted(allowed) if total - n in SOME_LANES)) for n in SOME_LANES]
    either = tuple({"lanes_in": (n,), "lanes_out": away} for n, away in pairs if away)
    return Hold(items="legs", key="bearing", values=_ends(road), either=either)


def _ends(road: RoadFact) -> tuple[str, ...]:
    """Bearings of the legs that a road may have."""
    axis = road.axis or "N"
    return axis, turned(axis, 180)


def _near(heading_rad: float, way_rad: float, tolerance_deg: float, either: bool) -> bool:
    turn = abs((heading_rad - way_rad + math.pi) % (2 * math.pi) - math.pi)
    turn = min(turn, math.pi - turn) if either else turn
    return math.degrees(turn) <= tolerance_deg


def _drawn(graph: LaneGraph) -> list[_Drawn]:
    """Roads with their directions at both ends and in between; the geometry of one edge stands for both."""
    found = []
    for road in dict.fromkeys(road_of(edge)[0] for edge in graph.edges):
        forward, backward = graph.edges.get(road), graph.edges.get(f"-{road}")
        edge = forward or backward
        if edge is None:
            continue
        flip = 0.0 if forward is not None else math.pi
        shape = edge.lanes[0].shape
        steps = shape[1:] - shape[:-1]
        headings = {round(math.atan2(y, x) + flip, 3) for x, y in steps}
        overall = shape[-1] - shape[0]
        headings.add(round(math.atan2(overall[1], overall[0]) + flip, 3))
        speeds = tuple(lane.speed_mps / MPS_PER_MPH for lane in edge.car_lanes[:1])
        lanes = [len(e.car_lanes) if e else 0 for e in (forward, backward)]
        found.append(_Drawn(road, lanes[0], lanes[1], tuple(sorted(headings)), speeds))
    return [d for d in found if d.total and d.speeds_mph]


def _degrees(graph: LaneGraph) -> dict[str, int]:
    """Neighbors of every node, over edges that cars may use."""
    near: dict[str, set[str]] = {}
    for edge in graph.edges.values():
        if edge.car_lanes and edge.from_node != edge.to_node:
            near.setdefault(edge.from_node, set()).add(edge.to_node)
            near.setdefault(edge.to_node, set()).add(edge.from_node)
    return {node: len(others) for node, others in near.items()}


def _ids(roads: list[_Drawn]) -> str:
    return "roads " + ", ".join(d.id for d in roads[:6])


def _finding(
    what: str, where: str, value: str, remedy: str, severity: str = "repair", holds: tuple[Hold, ...] = ()
) -> Finding:
    return Finding(
        source="road_narrative", severity="note" if severity == "note" else "repair",
        what=what, where=where, value=value, remedy=remedy, holds=holds,
    )  # fmt: skip
