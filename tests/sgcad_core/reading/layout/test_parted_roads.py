"""Freeways, highways and roads with a struck barrier have their carriageways apart, told or not."""

from __future__ import annotations

import pytest

from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Leg


def approach(text: str) -> Leg:
    return next(leg for leg in layout_of_facts(read(text).roads).legs if leg.bearing == "N")


@pytest.mark.parametrize(("text", "median"), [
    ("V1 was traveling south on a major highway. The front of V1 struck the back of V2, which also headed south.",
     "raised"),
    ("V1 was southbound on an interstate. The front of V1 struck the back of V2, which also headed south.", "grass"),
    ("V1 was southbound on a road. V1 departed the road to the left. The front of V1 struck a concrete barrier.",
     "barrier"),
    ("V1 and V2 were southbound in lane two of a two-lane highway. The front of V1 struck the back of V2.", "raised"),
])  # fmt: skip
def test_the_carriageways_stand_apart(text: str, median: str) -> None:
    assert approach(text).median == median
    assert approach(text).lanes_in >= 2


@pytest.mark.parametrize(("text", "lanes"), [
    ("V1 and V2 were southbound on a three-lane, one-way road with a positive median barrier.", (3, 3)),
    ("V1 and V2 were southbound on a two-lane one-way road divided by a grass median.", (2, 2)),
    ("V1 and V2 were southbound on a three-lane, one-way road.", (3, 0)),
])  # fmt: skip
def test_of_a_one_way_road_with_a_median_the_other_carriageway_is_drawn_too(text: str, lanes: tuple[int, int]) -> None:
    leg = approach(f"{text} The front of V1 struck the back of V2.")
    assert (leg.lanes_in, leg.lanes_out) == lanes
    assert (leg.median != "none") == (lanes[1] > 0)


@pytest.mark.parametrize("text", [
    "V1 was traveling south on a street. The front of V1 struck the back of V2, which also headed south.",
    "V1 was southbound on a two-lane highway. The front of V1 struck the back of V2, which also headed south.",
    "V1 was southbound on an undivided highway. The front of V1 struck the back of V2, which also headed south.",
    "V1 was southbound on a highway with two-way traffic. The front of V1 struck the back of V2, which headed south.",
    "V1 was southbound and V2 was northbound on a road. The front of V1 struck the front of V2. V2 struck a barrier.",
    "V1 was southbound on a road. V1 departed the road to the left. The front of V1 struck a tree.",
])  # fmt: skip
def test_other_roads_are_not_divided(text: str) -> None:
    assert approach(text).median == "none"


def test_a_highway_may_cross_another_road() -> None:
    text = (
        "V1 was southbound on a highway. V2 was westbound and entered the intersection. The front of V1 struck the "
        "left side of V2."
    )
    assert approach(text).median == "none"
