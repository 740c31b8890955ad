"""What follows for vehicles of which little is told: beside the road, in a turn lane, in lanes that one entered."""

from __future__ import annotations

import pytest

from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import BehaviorSpec
from sgcad_core.roads.layout import road_spec


def maneuvers(text: str) -> dict[str, str]:
    return {v.id: v.maneuver for v in read(text).crash.vehicles}


def headings(text: str) -> dict[str, str | None]:
    return {v.id: v.heading for v in read(text).crash.vehicles}


def behavior(text: str) -> BehaviorSpec:
    facts = read(text).roads
    return behavior_of_facts(facts.crash, road_spec(layout_of_facts(facts)))


@pytest.mark.parametrize(("more", "expected"), [
    ("", "parked"),
    (" V2 was eastbound.", "straight"),
    (" V2 was turning left.", "turn_left"),
])  # fmt: skip
def test_only_a_vehicle_without_a_word_stands_beside_the_road(more: str, expected: str) -> None:
    text = f"V1 was southbound.{more} V1 departed the roadway to the right. The front of V1 struck the left side of V2."
    assert maneuvers(text)["V2"] == expected


@pytest.mark.parametrize(("lane", "expected"), [("left", "turn_left"), ("right", "turn_right")])
def test_who_meets_another_way_from_a_turn_lane_turns(lane: str, expected: str) -> None:
    text = f"V1 was westbound in the {lane} turn lane. V2 was eastbound. The front of V2 struck the front of V1."
    assert maneuvers(text)["V1"] == expected


def test_who_is_struck_from_behind_in_a_turn_lane_does_not() -> None:
    text = "V1 was westbound in the left turn lane. V2 was westbound. The front of V2 struck the back of V1."
    assert maneuvers(text)["V1"] == "straight"


def test_a_turn_lane_of_the_road_turns_nobody() -> None:
    text = "V1 was westbound. V2 was southbound on a road with two lanes and a left turn lane. V2 struck V1."
    assert maneuvers(text)["V2"] == "straight"


def test_who_is_met_in_the_eastbound_lanes_heads_east() -> None:
    text = "V1 was southbound. V1 entered the eastbound lanes and its front contacted the right side of V2."
    assert headings(text)["V2"] == "E"


def test_a_change_of_lane_is_beside_one_that_drives_the_same_way() -> None:
    text = "V2 was southbound. V1 exited its lane to the left and the front of V1 contacted the right side of V2."
    assert headings(text)["V1"] == "S"


def test_the_ground_is_no_thing_where_another_is_struck() -> None:
    text = (
        "V1 was eastbound. V1 departed the right side of the road. The undercarriage of V1 impacted the ground. "
        "V1 then struck a tree with its left side."
    )
    made = behavior(text)
    assert [c.striker_area for c in made.contacts] == ["left"]


def test_a_thing_on_the_way_keeps_the_side_that_its_verb_has() -> None:
    text = (
        "V1 was westbound and V2 was westbound. V1 departed the road on the left and the left side of V1 contacted a "
        "barrier. V1 reentered the road and the right side of V1 contacted the left side of V2."
    )
    assert [c.striker_area for c in behavior(text).contacts] == ["left", "right"]


@pytest.mark.parametrize("words", [
    "V1 contacted its front on the back of V2.",
    "V1 impacted the front on the back of V2.",
    "V1 contacted the front the back of V2.",
    "V1 impacted its frontal plane with V2's back plane.",
])  # fmt: skip
def test_the_own_side_may_stand_behind_the_verb(words: str) -> None:
    first = read(f"V1 and V2 were northbound. {words}").crash.contacts[0]
    assert (first.striker, first.striker_area, first.struck_area) == ("V1", "front", "back")


@pytest.mark.parametrize("words", [
    "As both vehicles passed through the intersection the front of V2 struck the right side of V1.",
    "V1 was crossing the intersection as the frontal plane of V2 struck the right plane of V1.",
])  # fmt: skip
def test_a_side_is_the_subject_without_a_comma_before_it(words: str) -> None:
    first = read(f"V1 was northbound. V2 was westbound. {words}").crash.contacts[0]
    assert (first.striker, first.struck, first.struck_area) == ("V2", "V1", "right")


@pytest.mark.parametrize(("more", "expected"), [
    ("", "stopped"),
    (" V3 was turning left.", "turn_left"),
    (" V3 was traveling straight ahead.", "straight"),
])  # fmt: skip
def test_who_is_ahead_in_a_queue_stands_with_it(more: str, expected: str) -> None:
    text = f"V1 was northbound. V2 was stopped behind V3.{more} The front of V1 struck the back of V2. "
    assert maneuvers(text + "The front of V2 struck the back of V3.")["V3"] == expected


@pytest.mark.parametrize("waits", [
    "V3 was stopped facing north at the intersection. The left side of V1 struck the left side of V3.",
    "V1 went on and its left side struck the left side of V3, which was stopped facing north.",
])  # fmt: skip
def test_a_third_vehicle_waits_until_its_own_contact(waits: str) -> None:
    text = "V1 was southbound. V2 was eastbound. In the intersection the front of V2 struck the right side of V1. "
    assert (maneuvers(text + waits)["V3"], headings(text + waits)["V3"]) == ("stopped", "N")
