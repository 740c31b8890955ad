"""Headings that nothing tells, from what is told of the other vehicle."""

import pytest

from sgcad_core.reading.reading import read


@pytest.mark.parametrize(
    ("side", "struck", "heading", "area"),
    [
        ("left", "V2", "S", "front"),
        ("left", "the left side of V2", "S", "left"),
        ("left", "the back of V2", "N", "back"),
        ("right", "V2", "N", "back"),
        ("right", "the left side of V2", "N", "left"),
    ],
)
def test_a_parked_vehicle_heads_as_the_traffic_on_its_side_of_the_road(
    side: str, struck: str, heading: str, area: str
) -> None:
    told = (
        f"V1 was traveling north on a road. V1 departed the roadway to the {side} and the front of V1 struck {struck}"
    )
    crash = read(f"{told}, which was legally parked.").crash
    assert crash.vehicles[1].heading == heading
    assert crash.contacts[0].struck_area == area


def test_the_street_on_which_one_stands_tells_where_it_heads() -> None:
    for place in (
        "stopped in traffic for a red light on eastbound Oak Street",
        "traveling in the second lane in the eastbound direction of Oak Street",
    ):
        crash = read(f"The AV was {place} when a car made contact with the rear of the AV.").crash
        assert {v.heading for v in crash.vehicles} == {"E"}


def test_one_that_runs_into_the_rear_of_a_turning_vehicle_comes_up_behind_it() -> None:
    crash = read("The AV was turning left from northbound Elm Street when it was rear-ended by a van.").crash
    assert [v.heading for v in crash.vehicles] == ["N", "N"]
