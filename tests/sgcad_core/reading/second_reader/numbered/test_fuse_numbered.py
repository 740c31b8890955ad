"""Readings with answers of the learned reader: what changes with a value, and what is not taken."""

from __future__ import annotations

from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import Reading, read
from sgcad_core.reading.second_reader.numbered.fuse_numbered import RULE, fused_with_guesses
from sgcad_core.reading.second_reader.numbered.numbered_answers import lanes_of, relative
from sgcad_core.records.facts import Fact
from sgcad_core.records.second_reader import Guess

TEXT = (
    "V1 was traveling east on a two lane road and turned right onto the side street. V2 was on the same road. "
    "The front of V2 struck the back of V1."
)
PLAIN = "V1 was traveling east on a road. V2 was traveling east behind it. The front of V2 struck the back of V1."


def fused(text: str, sentence: int | None = 0, **answers: str) -> Reading:
    guesses = {key.replace("_", ".", 1): Guess(value=value, p=0.9, sentence=sentence) for key, value in answers.items()}
    return fused_with_guesses(read(text), guesses)


def fact(reading: Reading, field: str) -> Fact:
    return next(one for one in reading.facts if one.field == field)


def test_a_maneuver_that_is_taken_leaves_no_way_out_of_the_one_before() -> None:
    assert read(TEXT).crash.vehicles[0].maneuver == "turn_right"
    found = fused(TEXT, maneuver_V1="straight")
    vehicle = found.crash.vehicles[0]
    assert (vehicle.maneuver, vehicle.exit_heading, vehicle.meant) == ("straight", None, None)
    assert not any(one.field in ("vehicles.V1.exit_heading", "vehicles.V1.meant_maneuver") for one in found.facts)
    assert found.roads.crash is found.crash


def test_a_value_that_is_taken_is_a_fact_of_the_model_with_the_sentence_that_speaks_for_it() -> None:
    found = fact(fused(TEXT, maneuver_V1="stopped"), "vehicles.V1.maneuver")
    assert (found.value, found.basis, found.rule, found.confidence) == ("stopped", "model", RULE, 0.9)
    assert TEXT[found.start : found.end].startswith("V1 was traveling east")
    assert fact(fused(TEXT, sentence=None, maneuver_V1="stopped"), "vehicles.V1.maneuver").start is None


def test_a_turn_that_is_taken_has_a_junction() -> None:
    assert read(PLAIN).roads.junction.kind == "none"
    assert len(layout_of_facts(fused(PLAIN, maneuver_V1="turn_left").roads).legs) > 2


def test_a_lone_vehicle_passes_nothing() -> None:
    alone = "V1 was traveling east on a road. The front of V1 struck a pole."
    assert fused(alone, maneuver_V1="overtaking").crash.vehicles[0].maneuver == "straight"
    assert fused(PLAIN, maneuver_V1="overtaking").crash.vehicles[0].maneuver == "overtaking"


def test_a_lane_change_into_one_that_comes_the_other_way_crosses_the_middle_of_the_road() -> None:
    against = "V1 was traveling east on a road. V2 was traveling west on it. The front of V1 struck the left of V2."
    assert fused(against, maneuver_V1="lane_change_left").crash.vehicles[0].maneuver == "crossing_centerline"
    assert fused(against, maneuver_V1="lane_change_right").crash.vehicles[0].maneuver == "lane_change_right"
    assert fused(PLAIN, maneuver_V1="lane_change_left").crash.vehicles[0].maneuver == "lane_change_left"


def test_a_vehicle_outside_the_first_contact_is_given_no_turn() -> None:
    three = f"{PLAIN} V3 was traveling west on the same road."
    assert fused(three, maneuver_V3="turn_left").crash.vehicles[2].maneuver == "straight"
    assert fused(three, maneuver_V3="stopped").crash.vehicles[2].maneuver == "stopped"
    assert fused(three, maneuver_V1="turn_left").crash.vehicles[0].maneuver == "turn_left"


def test_lanes_show_in_the_layout_of_the_road() -> None:
    for answer, want in (("own3", "own3+both6"), ("both4", "own2+both4")):
        found = fused(PLAIN, lanes_V1=answer)
        assert lanes_of(found.crash.vehicles[0], layout_of_facts(found.roads)) == want


def test_the_lanes_that_the_text_counts_for_a_direction_stand() -> None:
    told = PLAIN.replace("traveling east on a road", "traveling east in lane 1 of 2")
    assert read(told).roads.roads[0].lanes.toward == {"E": 2}
    assert fused(told, lanes_V1="own4").roads.roads[0].lanes.toward == {"E": 2}
    assert fused(PLAIN, lanes_V1="own4").roads.roads[0].lanes.toward == {"E": 4}


def test_of_two_vehicles_on_a_road_the_surer_one_has_its_lanes() -> None:
    guesses = {"lanes.V1": Guess(value="own3", p=0.7), "lanes.V2": Guess(value="own2", p=0.9)}
    found = fused_with_guesses(read(PLAIN), guesses)
    assert lanes_of(found.crash.vehicles[0], layout_of_facts(found.roads)) == "own2+both4"


def test_no_junction_is_taken_where_ways_need_one() -> None:
    assert fused(TEXT, junction="no").roads.junction.kind == read(TEXT).roads.junction.kind
    assert fused(PLAIN, junction="yes").roads.junction.kind == "four_leg"


def test_only_an_untold_heading_follows_the_turn_between_the_two() -> None:
    text = "V1 was traveling north on a road. V2 was on the road as well. The front of V1 struck V2."
    found = fused(text, turned_V2="180")
    assert relative(*found.crash.vehicles[:2]) == "180"
    assert found.crash.vehicles[0].heading == "N"
    assert fused(PLAIN, turned_V2="180").crash.vehicles == read(PLAIN).crash.vehicles


def test_a_side_is_the_only_one_that_is_then_allowed() -> None:
    contact = fused(TEXT, area_V1="left").crash.contacts[0]
    assert (contact.struck, contact.struck_area, contact.struck_may) == ("V1", "left", ("left",))
    assert contact.striker_area == "front"


def test_nothing_changes_without_an_answer_or_a_crash() -> None:
    reading = read(TEXT)
    assert fused_with_guesses(reading, {"maneuver.V1": Guess(p=0.9)}) is reading
    empty = read("V1 was traveling east.")
    assert fused_with_guesses(empty, {"maneuver.V1": Guess(value="stopped", p=0.9)}) is empty
