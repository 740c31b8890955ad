"""Roads get the lanes that their vehicles are told to be in, to change between and to turn from."""

from __future__ import annotations

import pytest

from sgcad_core.reading.layout.layout_facts import lane_notes, layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Leg

HIT = " The front of V1 struck the back of V2. It was dry and daylight."


def legs(text: str) -> dict[str, Leg]:
    return {leg.bearing: leg for leg in layout_of_facts(read(text).roads).legs}


def notes(text: str) -> tuple[str, ...]:
    return lane_notes(read(text).roads)


@pytest.mark.parametrize(("text", "lanes"), [
    ("V1 was traveling north on a road and changed lanes to the left. V2 was traveling north.", 2),
    ("V1 was traveling north on a two-lane, two-way road and changed lanes to the left. V2 was traveling north.", 2),
    ("V1 was traveling north in lane two and changed lanes to the left. V2 was traveling north.", 3),
    ("V1 was traveling north in the second lane from the left and changed lanes to the right. V2 headed north.", 3),
    ("V1 was traveling north in the left lane. V2 was traveling north.", 2),
    ("V1 was traveling north in the left lane of a two-lane, two-way road. V2 was traveling north.", 1),
    ("V1 was traveling north in the middle lane. V2 was traveling north.", 3),
    ("V1 was traveling north in lane four. V2 was traveling north.", 4),
    ("V1 was traveling north. V2 was traveling north.", 1),
    ("V1 was traveling north and changed lanes to the right. V2 was legally parked facing north.", 1),
])  # fmt: skip
def test_a_road_has_the_lanes_that_are_used(text: str, lanes: int) -> None:
    found = legs(text + HIT)
    assert (found["S"].lanes_in, found["N"].lanes_out) == (lanes, lanes)


def test_told_counts_that_leave_no_room_give_way_with_a_note() -> None:
    text = "V1 was traveling north on a two-lane, two-way road and changed lanes to the left. V2 was traveling north."
    assert notes(text + HIT) == ("the road gets 2 lanes that head north in place of 1: V1 changes lanes to the left",)
    assert legs(text + HIT)["S"].lanes_out == 1
    assert notes("V1 was traveling north. V2 was traveling north." + HIT) == ()


@pytest.mark.parametrize("text", [
    "V1 was traveling north on a two-lane, two-way road and changed lanes to the left. V2 was traveling south.",
    "V1 was traveling north in lane 1 of a two-lane, two-way road and passed V2 on the left. V2 was traveling north.",
    "V1 was traveling north on a two-lane, undivided road. V1 changed lanes to the left and struck a tree.",
])  # fmt: skip
def test_told_counts_stay_where_the_way_to_the_left_is_over_the_middle(text: str) -> None:
    hit = "" if "tree" in text else " The front of V1 struck the front of V2."
    assert (legs(text + hit)["S"].lanes_in, legs(text + hit)["S"].lanes_out) == (1, 1)
    assert notes(text + hit) == ()


CROSSING = " The crash occurred at a four-leg intersection of two-lane roads."


def test_a_told_turn_lane_is_laid_at_the_junction() -> None:
    text = "V1 was traveling north in the left-turn lane and turned left. V2 was traveling south." + CROSSING + HIT
    assert legs(text)["S"].turns_in[-1] == "left"
    assert legs(text)["S"].lanes_in == 2
    right = "V1 was traveling north in the right-turn lane and turned right. V2 was traveling south." + CROSSING + HIT
    assert legs(right)["S"].turns_in[0] == "right"


def test_a_told_center_turn_lane_runs_along_the_road() -> None:
    text = "V1 was traveling north in the center turn lane and turned left. V2 was traveling south." + CROSSING + HIT
    found = legs(text)
    assert found["S"].center_turn_lane
    assert found["N"].center_turn_lane
    assert not found["E"].center_turn_lane
    assert notes(text) in ((), ("the road gets a center turn lane: V1 is in the center turn lane",))


def test_who_overtakes_on_a_parted_road_has_a_second_lane() -> None:
    text = "V1 was traveling north on a divided highway with one lane in each direction and was passing V2."
    assert legs(text + " V2 was traveling north." + HIT)["S"].lanes_in == 2


def test_the_spare_lane_of_an_odd_count_goes_to_who_is_in_it() -> None:
    text = (
        "V1 was traveling south in lane two of a three-lane, undivided roadway. V2 was traveling north in lane one. "
        "V2 departed its lane to the left."
    )
    found = legs(text + " The front of V2 struck the left side of V1.")
    assert (found["N"].lanes_in, found["N"].lanes_out) == (2, 1)
    assert (found["S"].lanes_in, found["S"].lanes_out) == (1, 2)


def test_a_lane_beyond_half_of_a_count_makes_it_that_of_one_direction() -> None:
    found = legs("V1 was westbound in lane 4 of a 5 lane highway. V2 was westbound in lane 2." + HIT)
    assert {leg.lanes_in for leg in found.values()} == {5}


@pytest.mark.parametrize(("told", "left"), [
    ("the rightmost of two left turn lanes", 2), ("the leftmost of three left-turn-only lanes", 3),
    ("the left-turn lane", 1),
])  # fmt: skip
def test_as_many_turn_lanes_are_laid_as_are_told(told: str, left: int) -> None:
    text = f"V1 was traveling north in {told} and turned left. V2 was traveling south." + CROSSING + HIT
    assert legs(text)["S"].turns_in.count("left") == left
