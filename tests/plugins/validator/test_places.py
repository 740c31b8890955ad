"""Vehicles out of the lanes of their direction are doubted, with the lanes that they are on in turn."""

from __future__ import annotations

from plugins.validator.places import Places
from sgcad_core.case.records import CrashReport, Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

TEXT = "V1 was traveling north. V2 was traveling south. The front of V1 struck the front of V2."


def straight() -> RoadNetwork:
    legs = tuple(Leg.model_validate({"bearing": b, "lanes_in": 1, "lanes_out": 1}) for b in "SN")
    spec = road_spec(RoadLayout(legs=legs))
    return compile_network(plain_xml(spec), spec)


ROAD = straight()


def scenario(maneuver: str) -> Scenario:
    actors = tuple(
        Actor.model_validate({"id": name, "kind": "car", "road": road, "direction": "forward", "maneuver": does})
        for name, road, does in (("V1", "S", maneuver), ("V2", "N", "straight"))
    )
    contact = Contact(striker="V1", struck="V2", striker_area="front", struck_area="front")
    return compile_scenario(BehaviorSpec(actors=actors, contacts=(contact,)), ROAD)


def judged(made: Scenario | RoadNetwork, text: str = TEXT, odd: str = "doubt") -> list[Finding]:
    evidence = Evidence(report=CrashReport(case="c", narrative=text), network=ROAD)
    return Places.model_validate({"odd": odd}).findings(made, evidence)


def test_a_told_crossing_of_the_center_line_is_no_finding() -> None:
    assert judged(scenario("crossing_centerline")) == []


def test_the_wrong_side_is_doubted_once_a_vehicle_with_its_lanes() -> None:
    made = scenario("crossing_centerline")
    told_other = made.model_copy(update={
        "actors": tuple(a.model_copy(update={"maneuver": "straight"}) for a in made.actors)})  # fmt: skip
    open_sides = "V1 was traveling north. V2 was traveling south. V1 and V2 collided."
    (found,) = judged(told_other, open_sides)
    assert (found.source, found.severity, found.where) == ("places", "doubt", "actor V1")
    assert " s on the wrong side of the road before its contact: S_0 " in str(found.value)
    assert ", opposing -" in str(found.value)
    assert [one.severity for one in judged(told_other, open_sides, odd="note")] == ["note"]


def test_networks_and_scenarios_without_motion_are_not_judged() -> None:
    assert judged(ROAD) == []
    assert judged(scenario("crossing_centerline").model_copy(update={"planned": ()})) == []
