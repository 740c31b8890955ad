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


@pytest.mark.parametrize(("text", "moves"), [
    ("departed the road to the right, steered left, crossed the center line, and departed the road to the left",
     ["departs right", "steers left", "crosses left", "departs left"]),
    ("swerved left, came back into its lane, entered a clockwise yaw, and left the road to the right",
     ["steers left", "returns", "yaws clockwise", "departs right"]),
    ("departed the roadway to the right and overcorrected to the left", ["departs right", "steers left"]),
    ("departed the road to the right, attempted to return to the roadway, and went on off the right side of the road",
     []),
    ("drifted to the left and departed the roadway to the left", []),
    ("drifted off the western edge of the road, corrected and drove off the eastern edge", ["departs W", "departs E"]),
    ("ran off the western edge of the road and returned to the roadway", ["departs W", "returns"]),
    ("departed the western road edge, then went off the road to the left", []),
])  # fmt: skip
def test_moves_that_lead_to_more_than_one_side_are_kept_in_order(text: str, moves: list[str]) -> None:
    course = read(f"V1 was traveling north. V1 {text}. The front of V1 struck a tree.").crash.courses["V1"]
    assert [move.words for move in course.moves] == moves


def test_moves_stand_in_the_timeline_in_their_order() -> None:
    told = read("V1 was northbound. V1 ran off the road to the right, returned to the roadway, crossed the center line "
                "and departed the road to the left, where it struck a tree.")  # fmt: skip
    kinds = [act.kind for act in told.timeline if act.phase == "before"]
    assert kinds[-4:] == ["departing_road_right", "returns", "crossing_centerline", "departing_road_left"]


def test_a_departure_that_is_told_behind_the_contact_in_its_sentence_is_none_before_it() -> None:
    told = read("V1 and V2 were northbound. The front of V2 impacted the back of V1, after which, V2 departed the road "
                "to the left.").crash  # fmt: skip
    assert told.driven.get("V2") is None or told.driven["V2"].departs is None


def test_what_comes_behind_the_first_contact_is_no_departure_before_it() -> None:
    courses = read("V1 was northbound. The front of V1 struck V2. V1 departed the road to the right.").crash.courses
    assert courses["V1"].departs is None


def test_a_thing_beside_the_road_implies_that_the_road_is_left() -> None:
    crash = read("V1 was traveling north. The front of V1 struck a tree.").crash
    assert "V1" not in crash.courses
    assert crash.driven["V1"].departs == "either"
    on_road = read("V1 was traveling north. The front of V1 struck debris.").crash
    assert "V1" not in on_road.driven
