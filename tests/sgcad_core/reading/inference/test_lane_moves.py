"""The hand of a lane change whose own words leave it open."""

import pytest

from sgcad_core.reading.reading import read


@pytest.mark.parametrize("hand", ["left", "right"])
def test_a_lane_that_is_entered_tells_the_hand_of_a_change(hand: str) -> None:
    text = (
        "The AV was stopped. An SUV that was stopped directly behind the AV proceeded to change lanes to the "
        f"{hand} lane. The right side of the SUV made contact with the rear left side of the AV."
    )
    assert {v.id: v.maneuver for v in read(text).crash.vehicles}["V2"] == f"lane_change_{hand}"


@pytest.mark.parametrize(("side", "hand"), [("right", "left"), ("left", "right")])
def test_a_lane_of_the_other_one_is_entered_from_its_flank(side: str, hand: str) -> None:
    text = f"The subject vehicle brakes because of a truck encroaching into his lane from the {side}."
    assert {v.id: v.maneuver for v in read(text).crash.vehicles}["V2"] == f"lane_change_{hand}"
