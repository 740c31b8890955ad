"""The hand of a turn that is told by its end alone."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.reading.reading import read
from sgcad_core.reading.text.compass import NAMES, turned
from sgcad_core.records.specs import Compass

_MAIN: list[Compass] = ["N", "E", "S", "W"]


def _of(text: str, vehicle: str) -> tuple[str | None, str, bool]:
    v = next(v for v in read(text).crash.vehicles if v.id == vehicle)
    return v.heading, v.maneuver, v.maneuver_stated


@given(way=st.sampled_from(_MAIN), angle=st.sampled_from([90, 270]))
def test_the_hand_follows_from_both_ways(way: Compass, angle: int) -> None:
    end = turned(way, angle)
    other = turned(end, 180)
    text = (
        f"V1 was traveling {NAMES[way]}, turning {NAMES[end]}. V2 was traveling {NAMES[other]}. "
        "The front of V2 struck the side of V1."
    )
    assert _of(text, "V1") == (way, "turn_right" if angle == 90 else "turn_left", True)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "V1 was southbound. V2 entered the road from a driveway, turning north. The front of V1 struck the left "
            "side of V2.",
            ("E", "turn_left", True),
        ),
        (
            "V1 was southbound. V2 was traveling from eastbound to northbound. The front of V1 struck the left side "
            "of V2.",
            ("E", "turn_left", True),
        ),
        (
            "V1 was northbound. V2 was turning north from a driveway on the right. The right side of V1 struck the "
            "left side of V2.",
            ("W", "turn_right", True),
        ),
        (
            "V1 was northbound. V2 was turning north. The front of V1 struck the right side of V2.",
            ("E", "turn_left", True),
        ),
    ],
)
def test_an_untold_way_before_the_turn_is_across_it(text: str, told: tuple[str, str, bool]) -> None:
    assert _of(text, "V2") == told


@pytest.mark.parametrize(
    "text",
    [
        "V2 was northbound. V1 turned north and was traveling north. The front of V1 struck the back of V2.",
        "V2 was northbound. V1 was eastbound and passed the turn north of the bridge. The front of V1 struck V2.",
        "V2 was northbound. V1 crossed from northbound to southbound lanes. The front of V1 struck the front of V2.",
    ],
)
def test_a_turn_that_is_over_or_none_gives_no_hand(text: str) -> None:
    assert _of(text, "V1")[1] not in ("turn_left", "turn_right")
