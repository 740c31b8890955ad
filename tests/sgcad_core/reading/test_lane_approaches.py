"""Lanes of single approaches: whose they are, what they are for, what leads out, and what is no list of lanes."""

from __future__ import annotations

import pytest

from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Leg

AT = "The crash was at a four-leg intersection. "


def _legs(text: str) -> dict[str, Leg]:
    return {leg.bearing: leg for leg in layout_of_facts(read(text).roads).legs}


@pytest.mark.parametrize(
    ("text", "leg", "turns", "out"),
    [
        ("The north leg has a left-turn lane and a through/right lane coming in and one lane going out.",
         "N", ("through_right", "left"), 1),
        ("From the west there are two lanes, the right one for right turns and the left one for going straight.",
         "W", ("right", "through"), None),
        ("Eastbound drivers find three lanes, right, through and left, and two lanes beyond.",
         "W", ("right", "through", "left"), 2),
        ("On the east-west road each approach has two lanes (left turn; through and right) and one leaving.",
         "E", ("through_right", "left"), 1),
    ],
)  # fmt: skip
def test_a_leg_has_the_lanes_that_are_listed_of_it(
    text: str, leg: str, turns: tuple[str, ...], out: int | None
) -> None:
    found = _legs(AT + text)[leg]
    assert found.turns_in == turns
    assert found.lanes_in == len(turns)
    assert out is None or found.lanes_out == out


def test_lanes_where_somebody_drives_are_no_list() -> None:
    legs = read(
        AT + "V1 came from the north in the left-turn lane and V2 in the second of three lanes."
    ).roads.approaches
    assert legs.named == ()


def test_listed_legs_of_two_roads_make_a_crossing() -> None:
    text = (
        "V1 was northbound and hit V2. From the north and the south two lanes come in, for through and for left turns;"
    )
    text += " from the east and the west a right-turn lane and a through lane come in."
    assert read(text).roads.junction.kind == "four_leg"


def test_a_leg_with_turn_lanes_only_is_the_stem() -> None:
    text = "At the T-intersection V1 was northbound. The west leg has a right-turn lane and a left-turn lane."
    assert read(text).roads.junction.stem == "W"


def test_a_total_is_filled_with_lanes_that_go_on() -> None:
    found = _legs(AT + "The north leg has three lanes, one for left turns, and one lane out.")["N"]
    assert found.turns_in == ("through_right", "through", "left")


def test_a_leg_by_which_nobody_comes_has_no_control() -> None:
    text = AT + "V1 was northbound on a one-way street and V2 was eastbound. All approaches have traffic signals."
    legs = _legs(text)
    assert [legs["S"].control, legs["N"].control] == ["signal", "none"]


@pytest.mark.parametrize(("south", "north", "counts"), [
    ("five", "four", {"N": 5, "S": 4}), ("two", "three", {"N": 2, "S": 3}), ("four", "four", {"N": 4, "S": 4}),
])  # fmt: skip
def test_opposite_approaches_have_the_totals_told_of_their_vehicles(
    south: str, north: str, counts: dict[str, int]
) -> None:
    text = (
        f"V1 was southbound on a {south}-lane, undivided roadway. V2 was northbound on a {north}-lane, undivided "
        "roadway. V3 was eastbound on a two-lane, undivided roadway. They entered the intersection and V1 struck V2."
    )
    legs = _legs(text)
    assert {name: legs[name].lanes_in + legs[name].lanes_out for name in counts} == counts


def test_one_total_holds_for_both_legs() -> None:
    legs = _legs(AT + "V1 was southbound on a four-lane, undivided road. V2 was westbound. V1 struck V2.")
    assert {legs[name].lanes_in + legs[name].lanes_out for name in ("N", "S")} == {4}


def test_the_side_road_of_a_left_turn_lane_lies_on_the_left():
    text = "Subject driver is in a left turn lane and the lead vehicle brakes. Subject nearly hits the lead vehicle."
    layout = layout_of_facts(read(text).roads)
    assert {leg.bearing for leg in layout.legs} == {"N", "S", "W"}
