"""Contacts that only skids, spins or made-up ways bring about are doubted; what meets in ordinary driving is not."""

from __future__ import annotations

from typing import Any

import pytest

from plugins.validator.meeting import Meeting
from sgcad_core.case.records import CrashReport, Evidence, Finding, RoadNetwork
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

PULLED_OUT = (
    "V1 was traveling north. V2 came out of a parking lot and turned right. The front of V1 struck the left side of V2."
)
CROSSED = (
    "V1 was traveling west. V2 was traveling south. The front of V2 struck the right side of V1 at the intersection."
)


def network(bearings: str) -> RoadNetwork:
    legs = [Leg.model_validate({"bearing": b, "lanes_in": 1, "lanes_out": 1}) for b in bearings]
    spec = road_spec(RoadLayout(legs=tuple(legs)))
    return compile_network(plain_xml(spec), spec)


TEE, CROSS = network("NES"), network("NESW")


def actor(name: str, road: str, maneuver: str, exit_road: str | None) -> Actor:
    return Actor.model_validate({
        "id": name, "kind": "car", "road": road, "direction": "forward", "maneuver": maneuver, "exit_road": exit_road,
    })  # fmt: skip


def found(text: str, roads: RoadNetwork, actors: tuple[Actor, ...], contact: str, **fields: Any) -> list[Finding]:
    striker, striker_area, struck, struck_area = contact.split()
    said = Contact.model_validate(
        {"striker": striker, "struck": struck, "striker_area": striker_area, "struck_area": struck_area}
    )
    scenario = compile_scenario(BehaviorSpec(actors=actors, contacts=(said,)), roads)
    evidence = Evidence(report=CrashReport(case="c", narrative=text), network=roads)
    return Meeting(**{"try_others": True} | fields).findings(scenario, evidence)


def compile_wide() -> RoadNetwork:
    legs = tuple(Leg.model_validate({"bearing": b, "lanes_in": 3, "lanes_out": 3}) for b in "NS")
    spec = road_spec(RoadLayout(legs=legs))
    return compile_network(plain_xml(spec), spec)


FROM_BEHIND = (actor("V1", "S", "straight", "N"), actor("V2", "S", "turn_right", "E"))
FROM_THE_SIDE = (FROM_BEHIND[0], actor("V2", "E", "turn_right", "N"))


def test_who_meets_in_ordinary_driving_is_not_doubted() -> None:
    assert found(PULLED_OUT, TEE, FROM_THE_SIDE, "V1 front V2 left") == []


def test_an_open_start_is_held_to_those_from_which_the_sides_meet() -> None:
    (doubt,) = found(PULLED_OUT, TEE, FROM_BEHIND, "V1 front V2 left")
    assert doubt.severity == "doubt"
    assert "V2" in doubt.value
    (hold,) = doubt.holds
    assert hold.values == ("V2",)
    assert [dict(choice) for choice in hold.either] == [
        {"road": ("E",), "direction": ("forward",), "exit_road": ("N",), "maneuver": ("turn_right",)}
    ]


def test_a_turn_that_nobody_tells_is_held_to_driving_straight_on() -> None:
    actors = (actor("V1", "E", "turn_right", "N"), actor("V2", "N", "straight", "S"))
    (doubt,) = found(CROSSED, CROSS, actors, "V2 front V1 right")
    (hold,) = doubt.holds
    assert hold.values == ("V1",)
    assert [dict(choice) for choice in hold.either] == [
        {"road": ("E",), "direction": ("forward",), "exit_road": ("W",), "maneuver": ("straight",)}
    ]


def test_a_way_that_the_network_does_not_have_is_doubted() -> None:
    actors = (actor("V1", "S", "straight", "N"), actor("V2", "N", "turn_right", None))
    text = "V1 was traveling north. V2 was traveling south and turned right. The front of V1 struck the front of V2."
    (doubt,) = found(text, TEE, actors, "V1 front V2 front")
    assert "offers no such turn" in doubt.value
    assert doubt.holds == ()


@pytest.mark.parametrize("denied", ["There were no skid marks.", "The sliding door of V2 was open."])
def test_words_that_tell_no_loss_of_control_excuse_nothing(denied: str) -> None:
    assert len(found(f"{PULLED_OUT} {denied}", TEE, FROM_BEHIND, "V1 front V2 left")) == 1


def test_another_lane_than_told_is_not_doubted() -> None:
    told = "V1 and V2 were traveling north. The front of V1 struck the rear of V2."
    lanes = {"V1": 1, "V2": 2}
    actors = tuple(actor(v, "S", "straight", "N").model_copy(update={"lane": n}) for v, n in lanes.items())
    assert found(told, compile_wide(), actors, "V1 front V2 back") == []


@pytest.mark.parametrize("lost", [
    "V2 lost control.", "V2 skidded on the ice.", "V2 was out of control.", "V2 slid.",
    "V2 lost all directional control.",
])  # fmt: skip
def test_lost_control_explains_what_is_odd(lost: str) -> None:
    assert found(f"{PULLED_OUT} {lost}", TEE, FROM_BEHIND, "V1 front V2 left") == []


def test_doubts_can_be_notes_and_come_later() -> None:
    (note,) = found(PULLED_OUT, TEE, FROM_BEHIND, "V1 front V2 left", odd="note", try_others=False)
    assert (note.severity, note.holds) == ("note", ())
    assert found(PULLED_OUT, TEE, FROM_BEHIND, "V1 front V2 left", odd_from=9.0) == []


def test_roads_are_none_of_its_business() -> None:
    assert Meeting().findings(TEE, Evidence(report=CrashReport(case="c", narrative=PULLED_OUT))) == []
