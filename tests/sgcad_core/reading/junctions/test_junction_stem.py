"""Which leg of a T ends there, and what is no leg."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read


@pytest.mark.parametrize("told", [
    "V1 departed the roadway on the southeast corner of the intersection facing east.",
    "V1 departed the road to the north and struck a tree.", "V1 came to rest off road to the east.",
    "V1 came to rest on the road to the northeast.",
])  # fmt: skip
def test_the_side_on_which_a_road_is_left_is_no_side_road(told: str) -> None:
    text = (
        "V1 was traveling southbound on a two-lane road approaching an intersection. V2 was traveling eastbound "
        f"approaching the same intersection. The front of V2 struck the right side of V1. {told}"
    )
    junction = read(text).roads.junction
    assert (junction.kind, junction.stem) == ("four_leg", None)
