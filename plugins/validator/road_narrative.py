"""Compares a network with the roads of the narrative: lanes, legs, one-way, limits, directions.

Only explicit statements of the text count, each with the readings that it allows ("four-lane" with or without turn
lanes, if a diagram may show them). They are questions, since the rules may have misread the text. Reads the compiled
network; north is up.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar

from plugins.validator._road_holds import along, carrying, ends, laid, totals
from plugins.validator._road_told import KIND, Asked, asked_control, asked_of, lane_fields, used_by
from sgcad_core.asking.schema_holds import SOME_LANES
from sgcad_core.case.records import Evidence, Finding, Hold, RoadNetwork, Scenario, Severity
from sgcad_core.errors import InvalidOutput
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.sumo.net_xml import LaneGraph, parse_net
from sgcad_core.interfaces import Validator
from sgcad_core.kinds import ALLEY, DRIVEWAY, PARKING_LOT, junction_kind, unsupported_kind
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.layout.legs_used import ahead, legs_used, turns_off
from sgcad_core.reading.layout.parted_roads import has_other_half
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
from sgcad_core.reading.text.compass import AXIS_NAMES, NAMES, angle_of, compass_of_angle, turned
from sgcad_core.records.specs import Compass
from sgcad_core.roads.compiled_facts import (
    CompiledRoad,
    compiled_roads,
    headings_agree,
    junctions_as_told,
    roads_as_told,
)
from sgcad_core.roads.lane_total_readings import allowed_totals, may_be_of_one_half, may_show_other_lanes

_finding = FindingFactory("road_narrative")

_ORDER = ("refuse", "repair", "question", "doubt", "note")


class RoadNarrative(Validator):
    """Checks a network's lanes, legs, one-way roads and directions against the narrative; limits are notes.

    A crash at a place that cannot be drawn as it is is noted. limit_tolerance_mph is the
    allowed difference of a speed limit.
    """

    stage: ClassVar[str] = "road"
    version: ClassVar[str] = "10"
    tolerance_deg: float = 35.0
    """Allowed angle between a drawn road and the compass direction that the report names."""
    limit_tolerance_mph: float = 3.0
    every: bool = True
    """Also asks about the control of the junction."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Worst first; none for a network that did not compile or a report that states nothing."""
        if not isinstance(artifact, RoadNetwork) or artifact.net_xml is None:
            return []
        try:
            graph = parse_net(artifact.net_xml)
        except InvalidOutput:
            return []
        reading, facts = evidence.report.reading, evidence.report.reading.roads
        drawn, legs = roads_as_told(compiled_roads(graph), artifact.place), junctions_as_told(graph, artifact.place)
        pictured = bool(evidence.report.diagrams)
        asked = [
            *_no_circle(facts, graph),
            *(asked_control(facts, artifact.spec) if self.every else ()),
            *self._legs(facts, len(legs[0]) if legs else 0, pictured),
            *self._paths(facts, legs, pictured), *self._directions(facts, drawn), *self._one_way(facts, drawn),
            *self._lanes(facts, drawn, pictured), *(() if pictured else self._lanes_one_way(facts, drawn)),
        ]  # fmt: skip
        questions = [asked_of(found, fields, reading) for found, fields in asked]
        found = [*_not_drawn(facts), *questions, *self._limits(facts, drawn)]
        return sorted(found, key=lambda f: _ORDER.index(f.severity))

    # -------------------------------------------------------------- junction
    def _legs(self, facts: RoadFacts, widest: int, pictured: bool) -> Iterator[Asked]:
        junction = facts.junction
        record = junction_kind(junction.kind)
        want = record.legs if record.rule and not record.round else None  # what a text names in so many words
        if want and junction.stated and widest < want:
            what = f"the report says {record.called}, but no junction of the network has {want} legs"
            remedy = f"let {want} roads meet at one node"
            holds = (Hold(items="legs", at_least=want), *laid(facts, pictured))
            yield _finding(what, "junction", f"at most {widest} roads meet", remedy, holds=holds), KIND
        elif want == 3 and junction.stated and widest > 3:
            what = f"the report says {record.called}, but the junction has a leg too many"
            remedy = "leave out the leg that the report does not name, unless the diagram shows it"
            alone = not pictured and _alone(facts)
            holds = (Hold(items="legs", at_most=want),) if alone else ()
            yield _finding(what, "junction", f"{widest} roads meet", remedy, holds=holds), KIND if alone else ()
        elif junction.kind == "none" and widest >= 3:
            remedy = "draw a plain road, unless the diagram shows the junction"
            yield _finding("the report names no junction", "junction", f"{widest} roads meet", remedy), ()

    def _paths(self, facts: RoadFacts, junctions: list[tuple[float, ...]], pictured: bool) -> Iterator[Asked]:
        """Legs that vehicles come from or turn into and that the junction lacks.

        A leg that follows only from the sides of contact gives a doubt.
        """
        drawn = [leg for legs in junctions if len(legs) > 2 for leg in legs]
        if not junction_kind(facts.junction.kind).meets:
            return
        if not drawn:
            yield from self._nowhere_to_turn(facts, junctions, pictured)
            return
        stated, missing = legs_used(facts), self._without(legs_used(facts, faced=True), drawn)
        if not missing:
            return
        told = self._without(stated, drawn)
        sides = " and ".join(NAMES[leg] for leg in missing)
        what = f"vehicles come from or turn into a road {sides} of the junction, where the network has none"
        seen = ", ".join(NAMES[compass_of_angle(at)] for at in drawn)
        remedy = f"lay a leg {sides} of the junction"
        severity: Severity = "repair" if told else "doubt"
        found = _finding(what, "junction", f"legs {seen}", remedy, severity, holds=laid(facts, pictured))
        yield found, used_by(told or missing, facts)

    def _nowhere_to_turn(self, facts: RoadFacts, junctions: list[tuple[float, ...]], pictured: bool) -> Iterator[Asked]:
        """A plain road although a vehicle leaves or enters a driveway or side road that the report names."""
        junction = facts.junction
        missing = self._without(legs_used(facts), [leg for legs in junctions for leg in legs])
        named = junction.stated if junction.kind in (DRIVEWAY, ALLEY) else junction.stem_stated and not junction.stated
        if missing != [junction.stem] or not named or not any(map(turns_off, facts.crash.vehicles)):
            return
        where = f"{NAMES[missing[0]]} of"
        what = f"a vehicle uses a {junction.kind if junction.kind in (DRIVEWAY, ALLEY) else 'road'} {where} the crash"
        holds = (Hold(items="legs", at_least=3), *laid(facts, pictured))
        severity: Severity = "doubt" if pictured else "repair"
        found = _finding(what, "junction", "no junction", f"lay a leg {where} a junction", severity, holds)
        yield found, (*KIND, "junction.stem", *used_by(missing, facts))

    def _without(self, legs: Sequence[Compass], drawn: Sequence[float]) -> list[Compass]:
        """Bearings at which no leg is drawn."""
        return [
            leg for leg in legs if not any(headings_agree(angle_of(leg), at, self.tolerance_deg + 15) for at in drawn)
        ]

    # -------------------------------------------------------------- directions of travel
    def _directions(self, facts: RoadFacts, drawn: list[CompiledRoad]) -> Iterator[Asked]:
        divided = any(road.lanes.divided for road in facts.streets)
        for v in facts.crash.vehicles:
            in_stall = v.maneuver == "backing" and facts.junction.kind == PARKING_LOT
            if not v.heading or not v.heading_stated or v.maneuver == "parked" or in_stall:
                continue
            if any(self._carries(road, v.heading, divided) for road in drawn):
                continue
            word = NAMES[v.heading]
            what = f"{v.id} travels {word}, but no road carries traffic that way"
            remedy = f"give a road lanes that head {word}; x is east, y is north"
            yield _finding(what, v.id, "no such road", remedy, holds=carrying(v.heading)), (f"vehicles.{v.id}.heading",)

    def _carries(self, road: CompiledRoad, way: Compass, divided: bool) -> bool:
        """Whether traffic may head that way; one carriageway of a divided road may stand for both."""
        tolerance = self.tolerance_deg + 15
        return bool(road.lanes_towards(way, tolerance)) or (divided and road.along(way, tolerance, either=True))

    # -------------------------------------------------------------- one-way
    def _one_way(self, facts: RoadFacts, drawn: list[CompiledRoad]) -> Iterator[Asked]:
        if any(road.lanes.one_way and len(_driven(road, facts)) > 1 for road in facts.streets):
            return  # it is not known which of the roads is meant
        for road in facts.streets:
            here, name = self._on_axis(road, drawn), AXIS_NAMES[road.axis or "N"]
            fields = lane_fields(road, facts, "one_way")
            if _both_ways(road, facts) and here and not any(d.forward and d.backward for d in here):
                what, remedy = f"the {name} road is two-way in the report", "give each direction at least one lane"
                both = ({"lanes_in": SOME_LANES, "lanes_out": SOME_LANES},)
                yield _finding(what, _ids(here), "lanes in one direction", remedy, holds=(along(road, both),)), fields
            alone = road.lanes.one_way and not has_other_half(road.lanes)
            if alone and here and all(d.forward and d.backward for d in here):
                what, remedy = f"the {name} road is one-way in the report", "set the other direction's lanes to 0"
                either = ({"lanes_in": SOME_LANES, "lanes_out": (0,)}, {"lanes_in": (0,), "lanes_out": SOME_LANES})
                found = _finding(what, _ids(here), "lanes in both directions", remedy, holds=(along(road, either),))
                yield found, fields

    def _on_axis(self, road: RoadFact, drawn: list[CompiledRoad]) -> list[CompiledRoad]:
        axis = road.axis
        return [d for d in drawn if axis and d.along(axis, self.tolerance_deg, either=True)]

    # -------------------------------------------------------------- lanes
    def _lanes(self, facts: RoadFacts, drawn: list[CompiledRoad], pictured: bool) -> Iterator[Asked]:
        for road in facts.streets:
            allowed = allowed_totals(road, pictured)
            here = self._on_axis(road, drawn)
            searched = drawn if may_show_other_lanes(road, pictured) else here
            if not allowed or not here or any(d.total in allowed for d in searched):
                continue
            if may_be_of_one_half(road, facts.crash) and any({d.forward, d.backward} & allowed for d in searched):
                continue
            low, high = min(allowed), max(allowed)
            said = str(low) if low == high else f"{low} to {high}"
            what = f"the {AXIS_NAMES[road.axis or 'N']} road has {said} lanes in both directions together in the report"
            seen = ", ".join(f"{d.id} {d.forward}+{d.backward}" for d in here[:4])
            remedy = "correct lanes_forward and lanes_backward, turn lanes counted"
            found = _finding(what, _ids(here), seen, remedy, holds=(totals(road, allowed),))
            yield found, lane_fields(road, facts, "lanes_total")

    def _lanes_one_way(self, facts: RoadFacts, drawn: list[CompiledRoad]) -> Iterator[Asked]:
        """Lanes of one direction: those that the text counts, and at least the number of a vehicle's stated lane.

        If the layout that the rules read has other lanes there, the text contradicts itself, and it is not known which
        statement is wrong: no finding.
        """
        read = {leg.bearing: leg.lanes_in for leg in layout_of_facts(facts, as_counted=True).legs}
        told = [
            (way, n, n, lane_fields(road, facts, f"lanes_{NAMES[way]}bound"))
            for road in facts.streets if _adds_up(road) for way, n in road.ways
        ]  # fmt: skip
        for road in (road for road in facts.streets if road.lanes.one_way):
            count, toward = road.lanes.total, road.lanes.one_way_toward
            flows = {toward} if toward else _driven(road, facts)
            fields = lane_fields(road, facts, "lanes_total")
            told += [(way, count, count, fields) for way in flows if count and len(flows) == 1]
        driven = [v for v in facts.crash.vehicles if v.heading_stated]
        told += [
            (v.heading, abs(v.lane), max(SOME_LANES), (f"vehicles.{v.id}.lane",))
            for v in driven
            if v.heading and v.lane
        ]
        for way, least, most, fields in told:
            approach = turned(way, 180)
            there = {d.lanes_towards(way, self.tolerance_deg) for d in drawn} - {0}
            fits = any(least <= n <= most for n in there)  # on whichever side of the junction
            if there and not fits and least <= read.get(approach, 0) <= most:
                said = f"{least}" if least == most else f"at least {least}"
                what = f"the road has {said} lanes that head {NAMES[way]} in the report"
                enough = tuple(n for n in SOME_LANES if least <= n <= most)
                holds = (Hold(items="legs", key="bearing", values=(approach,), either=({"lanes_in": enough},)),)
                remedy = f"give it {said} lanes towards the crash on the leg {NAMES[approach]} of it"
                yield _finding(what, f"leg {approach}", f"{max(there)} lanes", remedy, holds=holds), fields

    # -------------------------------------------------------------- limits
    def _limits(self, facts: RoadFacts, drawn: list[CompiledRoad]) -> Iterator[Finding]:
        for road in facts.streets:
            here = self._on_axis(road, drawn)
            limit = road.speed_limit_mph
            if limit is None or not here or any(self._at(limit, s) for d in here for s in d.speeds_mph):
                continue
            what = f"the {AXIS_NAMES[road.axis or 'N']} road's posted limit is {limit} mph in the report"
            seen = f"{here[0].speeds_mph[0]:.0f} mph"
            yield _finding(what, _ids(here), seen, f"set speed_limit_mph to {limit}", "note")

    def _at(self, limit: int, speed_mph: float) -> bool:
        return abs(limit - speed_mph) <= self.limit_tolerance_mph


def _alone(facts: RoadFacts) -> bool:
    """Whether no statement needs a fourth leg: no driveway beside the roads, no vehicle from off the road."""
    vehicles = facts.crash.vehicles
    through = {*legs_used(facts), *ahead(vehicles)}
    return len(through) <= 3 and len(facts.streets) == len(facts.roads) and not any(v.origin for v in vehicles)


def _both_ways(road: RoadFact, facts: RoadFacts) -> bool:
    """Whether the text tells two-way traffic of a street at a junction, both of whose carriageways are then drawn."""
    lanes = road.lanes
    told = lanes.one_way is False or lanes.each_way or len(lanes.toward) == 2
    crossing = road.kind == "road" and junction_kind(facts.junction.kind).meets
    return bool(told and road.axis and crossing) and not lanes.divided and not lanes.one_way


def _driven(road: RoadFact, facts: RoadFacts) -> set[Compass]:
    """Stated headings of vehicles that drive along a road's axis."""
    return {v.heading for v in facts.crash.vehicles if v.heading and v.heading_stated and v.heading in ends(road)}


def _adds_up(road: RoadFact) -> bool:
    """Whether the lanes stated for each direction add up to the stated total, with or without a center lane."""
    named, total = sum(road.lanes.toward.values()), road.lanes.total
    return total is None or (total - named in (0, 1) if len(road.lanes.toward) > 1 else named < total)


def _ids(roads: list[CompiledRoad]) -> str:
    return "roads " + ", ".join(d.id for d in roads[:6])


def _not_drawn(facts: RoadFacts) -> Iterator[Finding]:
    """A note for every place of the crash that cannot be drawn as it is."""
    for kind in facts.junction.unsupported:
        record = unsupported_kind(kind)
        what = f"the crash happened at {record.called}, which cannot be drawn as it is"
        yield _finding(what, "junction", record.called, record.remedy, "note")


def _no_circle(facts: RoadFacts, graph: LaneGraph) -> Iterator[Asked]:
    """A finding if the report tells a roundabout and the network has none."""
    record = junction_kind(facts.junction.kind)
    if record.round and facts.junction.stated and not graph.circles:
        what = f"the crash happened at {record.called}, and the network has none"
        remedy = "draw its circle: one-way pieces around, counterclockwise (circle), every leg yields"
        yield _finding(what, "junction", "no roundabout", remedy), KIND
