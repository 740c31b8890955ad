"""Vehicles start in the lane that is told; one that changes lanes starts beside the other one's lane."""

from __future__ import annotations

import pytest

from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.roads.layout import road_spec

SIDES = " The left side of V1 struck the right side of V2. It was dry and daylight."
ROAD = " The road had three lanes in each direction."


def lanes(text: str) -> tuple[int | None, ...]:
    reading = read(text)
    behavior = behavior_of_facts(reading.crash, road_spec(layout_of_facts(reading.roads)))
    return tuple(actor.lane for actor in behavior.actors)


@pytest.mark.parametrize(("text", "found"), [
    ("V1 was traveling north in the right lane. V2 was traveling north in the left lane.", (1, 3)),
    ("V1 was traveling north in lane two. V2 was traveling north in the middle lane.", (2, 2)),
    ("V1 was northbound and changed lanes to the left. V2 was northbound in the middle lane.", (1, 2)),
    ("V1 was northbound and changed lanes to the left. V2 was northbound.", (1, 2)),
    ("V1 was northbound in the middle lane and changed lanes to the left. V2 was northbound.", (2, 3)),
    ("V1 was northbound on I-5 in the number 1 lane. V2 was northbound in the number 3 lane.", (3, 1)),
    ("V1 was northbound in the number 1 lane. V2 was northbound in the number 3 lane.", (1, 3)),
])  # fmt: skip
def test_lanes_are_as_told(text: str, found: tuple[int, ...]) -> None:
    assert lanes(text + ROAD + SIDES) == found


def test_a_number_counts_from_the_median_where_no_investigator_writes() -> None:
    text = "V1 was northbound in the number 1 lane. V2 was northbound in the number 3 lane." + ROAD
    assert lanes(text + " V1 sideswiped V2. It was dry and daylight.") == (3, 1)
    assert lanes(text + " V1 contacted V2. It was dry and daylight.") == (1, 3)


def test_one_that_pulls_out_behind_another_one_starts_in_its_lane() -> None:
    rear = " The front of V1 struck the back of V2. It was dry and daylight."
    text = "V1 was northbound and changed lanes to the left. V2 was northbound and stopped." + ROAD + rear
    assert lanes(text) == (1, 1)
    told = "V1 was northbound and changed lanes to the left. V2 was northbound in the left lane." + ROAD + rear
    assert lanes(told) == (2, 3)


def test_one_that_overtakes_has_a_lane_to_its_left() -> None:
    text = "V1 was northbound in the middle lane. V2 was northbound and was passing V1." + ROAD + SIDES
    assert lanes(text) == (2, 2)


def test_the_center_turn_lane_is_one_more_than_the_road_has_in_its_direction() -> None:
    text = (
        "V1 was traveling north in the center left turn lane of a five-lane road and intended to turn left at a "
        "T-intersection. V2 was traveling south. The front of V2 struck the right side of V1."
    )
    assert lanes(text)[0] == 3


def test_one_that_cuts_in_starts_beside_the_lane_of_the_one_that_runs_into_it() -> None:
    rear = " The front of V2 struck the back of V1. It was dry and daylight."
    text = "V1 was northbound and changed lanes to the left. V2 was northbound." + ROAD + rear
    assert lanes(text) == (1, 2)
    told = "V1 was northbound in the left lane and changed lanes to the right. V2 was northbound." + ROAD + rear
    assert lanes(told) == (3, 2)


def test_a_row_drives_in_the_lane_that_is_told_of_one_of_it() -> None:
    row = (
        "V3 was traveling west in lane 3. V1 and V2 were traveling behind V3. The front of V1 struck the back of V2. "
        "The front of V1 then struck the back of V3."
    )
    assert lanes(row + ROAD) == (3, 3, 3)


def test_two_come_into_the_middle_lane_from_both_sides() -> None:
    near = (
        "Subject driver has just changed from the far left lane into the middle lane. Then a car in the far right lane "
        "changes into the middle lane as well, almost side swiping the subject's vehicle."
    )
    assert lanes(near + ROAD) == (3, 1)


def test_the_rightmost_lane_of_a_report_without_numbers_is_one_of_two() -> None:
    text = "The AV was proceeding north in the rightmost lane. A car behind the AV struck the rear of the AV."
    legs = layout_of_facts(read(text).roads).legs
    assert {leg.bearing: leg.lanes_in for leg in legs}["S"] == 2
    same = "V1 was northbound in the right lane. V2 was northbound. The front of V2 struck the back of V1."
    numbered = layout_of_facts(read(same).roads).legs
    assert {leg.bearing: leg.lanes_in for leg in numbered}["S"] == 1
