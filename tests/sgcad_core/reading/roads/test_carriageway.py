"""Whether a told number of lanes is that of both directions or of one half of a divided road."""

import pytest

from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read

_STOOD = "V2 was stopped ahead of V1. The front of V1 contacted the back of V2."


def _lanes(text: str) -> set[tuple[int, int]]:
    return {(leg.lanes_in, leg.lanes_out) for leg in layout_of_facts(read(f"{text} {_STOOD}").roads).legs}


@pytest.mark.parametrize(
    ("told", "each"),
    [
        ("V1 was traveling east on a two-lane, divided roadway.", 2),
        ("V1 was traveling east in lane one of a four-lane divided roadway.", 4),
        ("V1 was traveling east in lane four of a five-lane, two-way, divided roadway.", 5),
        ("V1 was traveling east on a four-lane divided highway.", 2),
        ("V1 was traveling east in the left lane of a six-lane, divided interstate.", 6),
        ("V1 was traveling east in lane two of a four-lane divided highway.", 4),
        ("V1 was traveling east on a three-lane divided highway.", 3),
        ("V1 was traveling east on a four-lane divided road.", 2),
        ("V1 was traveling east on a five-lane highway.", 5),
        ("V1 was traveling east in lane two of a four-lane highway.", 4),
        ("V1 was traveling east on a four-lane highway.", 2),
        ("V1 was traveling east on a four-lane, two-way highway.", 2),
        ("V1 was traveling southeast on an east/west road, divided by a barrier, in lane 1 (of four lanes).", 4),
        ("V1 was traveling east in lane two of a six-lane roadway divided by a grass median.", 6),
        ("V1 was traveling east in lane six of a seven-lane roadway divided by a raised median.", 7),
        ("V1 was traveling east in lane one of a two-way, four-lane roadway divided by a grass median.", 2),
        ("V1 was traveling east in lane one of a four-lane, non-physically divided roadway.", 2),
        ("V1 was traveling east in lane one of a two-lane, non-physically divided roadway.", 1),
    ],
)
def test_lanes_of_a_divided_road_are_those_of_one_half_where_vehicles_are_in_numbered_lanes(
    told: str, each: int
) -> None:
    assert _lanes(told) == {(each, each)}


def test_a_lane_beyond_the_half_of_an_undivided_road_makes_one_direction_wider() -> None:
    told = "V1 was traveling east in lane three of a four-lane, undivided roadway."
    assert _lanes(told) == {(3, 1), (1, 3)}
    both = f"{told} V3 was traveling west in lane two of the same roadway."
    assert {sum(one) for one in _lanes(both)} != {4}  # no room for both


def test_seven_lanes_of_a_divided_road_are_those_of_both_halves() -> None:
    told = "V1 was traveling east in lane two of a seven-lane roadway divided by a raised median."
    assert _lanes(told) == {(3, 4), (4, 3)}
