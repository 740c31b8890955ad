"""The lane into which a vehicle changes, and the one from which it then comes."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read


@pytest.mark.parametrize(("told", "to_lane", "lane"), [
    ("V1 changed lanes to the left into lane 2.", 2, 1),
    ("V1 began to change lanes to the right into lane 1.", 1, 2),
    ("V1 changed lanes to the left into the left lane.", "left", -2),
    ("V1 was in lane 3 and changed lanes to the right into lane 2.", 2, 3),
    ("V1 entered lane 1.", 1, None),
    ("V1 changed lanes to the right into lane 9.", None, None),
    ("V1 changed lanes to the left.", None, None),
])  # fmt: skip
def test_the_lane_behind_a_change_tells_the_one_before_it(told: str, to_lane: object, lane: int | None) -> None:
    vehicle = read(f"V1 and V2 were northbound on a road. {told} The front of V2 struck V1.").crash.vehicle("V1")
    assert vehicle is not None
    assert (vehicle.to_lane, vehicle.lane) == (to_lane, lane)


@pytest.mark.parametrize(("order", "to_lane"), [("{moves} {hit}", 1), ("{hit} {moves}", None)])
def test_a_lane_that_is_entered_behind_the_contact_is_no_change_before_it(order: str, to_lane: int | None) -> None:
    told = order.format(moves="V1 moved into lane one.", hit="The front of V1 struck the back of V2.")
    text = f"V1 was traveling north in lane two of a three-lane road. V2 was traveling north ahead of V1. {told}"
    assert read(text).crash.vehicles[0].to_lane == to_lane
