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
        ("V1 was traveling east in lane one of a two-way, four-lane roadway divided by a grass median.", 2),
        ("V1 was traveling east in lane one of a four-lane, non-physically divided roadway.", 2),
        ("V1 was traveling east in lane one of a two-lane, non-physically divided roadway.", 1),
    ],
)
def test_lanes_of_a_divided_road_are_those_of_one_half_where_vehicles_are_in_numbered_lanes(
    told: str, each: int
) -> None:
    assert _lanes(told) == {(each, each)}
