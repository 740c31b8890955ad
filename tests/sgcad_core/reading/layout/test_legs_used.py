"""Legs that told paths use: where vehicles come from and where they turn to, and nothing that is only guessed."""

import pytest

from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.layout.legs_used import legs_used
from sgcad_core.reading.reading import read

SIDE = "The front of V1 struck the left side of V2."


@pytest.mark.parametrize(("text", "legs"), [
    ("V1 was northbound. V2 was westbound, approaching the T-intersection, and turned left.", "SE"),
    ("V1 was traveling north and turned right at the intersection. V2 was traveling south.", "SEN"),
    ("V1 was traveling north and V2 was traveling south.", "SN"),
    ("V1 was stopped northbound, waiting to turn right into a side street. V2 was northbound behind V1.", "SE"),
    ("V1 was traveling east on a two-lane road. V2 exited a driveway to turn left in front of V1.", "WE"),
    ("V1 was traveling east at the T-intersection. The side street intersects from the south.", "WS"),
    ("V1 struck the rear of V2 at the intersection.", ""),
    ("V1 was northbound. V2 was parked facing west.", "S"),
    ("V1 was going straight, northbound, at the four-leg intersection. V2 was going straight, westbound.", "SENW"),
    ("V1 was going straight, northbound, at the four-leg intersection. V2 was going straight, southbound.", "SN"),
    ("V1 was going straight, northbound, at the intersection. V2 was going straight, westbound.", "SE"),
    ("V1 was going straight, northbound, at the four-leg intersection. V2 was westbound and turned right.", "SEN"),
    ("V1 was going straight, northbound, at the T-intersection. V2 was going straight, westbound.", "SE"),
    ("V1 left the road. V2 was traveling west on a parking lot driveway.", "E"),
])  # fmt: skip
def test_legs_are_those_that_headings_and_turns_tell(text: str, legs: str) -> None:
    assert set(legs_used(read(f"{text} {SIDE}").roads)) == set(legs)


@pytest.mark.parametrize(("text", "legs"), [
    ("V1 was traveling east on a two-lane road. V2 exited a driveway to turn left in front of V1.", "WES"),
    ("V1 was traveling east on a two-lane road. V2 exited a driveway in front of V1.", "WE"),
    ("V1 was traveling north in lane one. V2 came out of a parking lot onto lane one, turning right.", "SEN"),
    ("V1 was traveling west. V2 was making a left turn from a side road in front of V1.", "EN"),
    ("V1 was traveling west and turned left. V2 was turning left from a side road in front of V1.", "ES"),
    ("V1 was traveling north and made a U-turn. V2 was turning left out of a driveway.", "SN"),
    ("V1 was going straight, northbound, at the intersection. V2 was going straight, westbound.", "SENW"),
    ("V1 was going straight, northbound, at the T-intersection. V2 was going straight, westbound.", "SE"),
    ("V2 was leaving a driveway and turned left across the eastbound lanes.", ""),
])  # fmt: skip
def test_a_side_that_was_struck_tells_where_a_turning_vehicle_came_from(text: str, legs: str) -> None:
    assert set(legs_used(read(f"{text} {SIDE}").roads, faced=True)) == set(legs)


@pytest.mark.parametrize(("text", "stated"), [
    ("V1 was traveling east at the T-intersection. The side street intersects from the south.", True),
    ("V1 was traveling east at the T-intersection. V2 was northbound and turned left.", False),
    ("V1 was traveling east at the four-leg intersection.", False),
])  # fmt: skip
def test_a_stem_is_stated_where_a_compass_word_says_it(text: str, stated: bool) -> None:
    assert read(f"{text} {SIDE}").roads.junction.stem_stated is stated


@pytest.mark.parametrize(("text", "legs"), [
    ("V1 was traveling south, approaching a three-leg intersection, and left the road to the south of it.", "N"),
    ("V1 was traveling south, leaving a private drive, to cross the road. V2 was traveling west on the road.", "NE"),
    ("V1 was traveling north at the T-intersection. V2 was traveling south, V3 was facing east there.", "SNW"),
])  # fmt: skip
def test_a_layout_has_the_legs_that_vehicles_use(text: str, legs: str) -> None:
    facts = read(f"{text} {SIDE}").roads
    assert set(legs_used(facts)) <= {leg.bearing for leg in layout_of_facts(facts).legs}
    assert set(legs) <= {leg.bearing for leg in layout_of_facts(facts).legs}


def test_a_leg_that_is_laid_has_the_lanes_that_are_told_of_its_road() -> None:
    text = (
        "V1 was traveling north out of a two-way parking lot and turned left to go west. V2 was traveling east on a "
        "two-way road with two lanes of travel in each direction. The left side of V1 was struck by the front of V2."
    )
    legs = {leg.bearing: (leg.lanes_in, leg.lanes_out) for leg in layout_of_facts(read(text).roads).legs}
    assert legs["W"] == (2, 2)
