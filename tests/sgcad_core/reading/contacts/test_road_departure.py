"""Where a vehicle leaves the road before its first contact: the last telling counts, with its side."""

from __future__ import annotations

import pytest

from sgcad_core.reading.contacts.road_departure import DepartureReader
from sgcad_core.reading.reading import read


def heard(*texts: str) -> str | None:
    reader = DepartureReader()
    for text in texts:
        reader.hear(text)
    return reader.found.side if reader.found else None


@pytest.mark.parametrize(("texts", "side"), [
    (["departed the roadway to the right and"], "right"),
    (["departed the left road edge and"], "left"),
    (["ran off the road on the north side and"], "N"),
    (["left the roadway"], "either"),
    (["exited the roadway left"], "left"),
    (["drifted to the left", "departed the roadway"], "left"),
    (["crossed the center line and left the road"], "left"),
    (["departed the road to the right", "re-entered the roadway", "departed the roadway to the left"], "left"),
    (["departed the road to the right", "re-entered the roadway"], None),
    (["departed the road to the right", "continued off the road"], "right"),
    (["was in the left lane", "departed its lane"], None),
])  # fmt: skip
def test_the_last_side_on_which_the_road_is_left(texts: list[str], side: str | None) -> None:
    assert heard(*texts) == side


def test_what_comes_behind_the_first_contact_is_no_departure_before_it() -> None:
    courses = read("V1 was northbound. The front of V1 struck V2. V1 departed the road to the right.").crash.courses
    assert courses["V1"].departs is None


def test_a_thing_beside_the_road_implies_that_the_road_is_left() -> None:
    crash = read("V1 was traveling north. The front of V1 struck a tree.").crash
    assert "V1" not in crash.courses
    assert crash.driven["V1"].departs == "either"
    on_road = read("V1 was traveling north. The front of V1 struck debris.").crash
    assert "V1" not in on_road.driven
