"""People without a number come from the side that is told, also where two vehicles are numbered."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read


@pytest.mark.parametrize(("told", "side"), [
    ("A pedestrian crossed Main Street from west to east.", "right"),
    ("A pedestrian crossed Main Street from east to west.", "left"),
    ("A pedestrian stepped off the right curb.", "left"),
    ("A pedestrian ran into the road from the left.", "right"),
    ("A pedestrian was walking northbound in the lane.", "back"),
    ("A pedestrian was walking south in the lane.", "front"),
    ("A pedestrian came from the east side of the road.", "left"),
    ("A pedestrian was in the road.", "left"),
])  # fmt: skip
def test_a_pedestrian_is_met_on_the_side_from_which_the_driver_comes(told: str, side: str) -> None:
    facts = read(f"V1 was northbound on Main Street. {told} The front of V1 struck the pedestrian.").crash
    assert [(c.striker, c.struck, c.struck_area) for c in facts.contacts] == [("V1", "P1", side)]


def test_a_pedestrian_beside_two_numbered_vehicles_is_struck_and_they_do_not_touch() -> None:
    text = ("V1 was eastbound and V2 was eastbound behind V1. A pedestrian stepped off the curb from the right before "
            "V1. The front of V1 struck the pedestrian.")  # fmt: skip
    facts = read(text).crash
    assert [(c.striker, c.struck, c.struck_area) for c in facts.contacts] == [("V1", "P1", "left")]
    assert [v.id for v in facts.vehicles] == ["V1", "V2"]
