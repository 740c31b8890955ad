"""Who moves where two vehicles meet that are both told to keep to their lanes."""

from __future__ import annotations

import pytest

from sgcad_core.reading.inference.untold_moves import ACROSS, BESIDE, OVER_MIDDLE
from sgcad_core.reading.reading import read

ONCOMING = "V1 was traveling south on a two-lane undivided road. V2 was traveling north on the same road. "
BESIDE_EACH_OTHER = "V1 was northbound in lane two of a three-lane one-way road. V2 was northbound in lane one. "


def _maneuvers(text: str) -> dict[str, tuple[str, bool]]:
    return {v.id: (v.maneuver, v.maneuver_stated) for v in read(text).crash.vehicles}


@pytest.mark.parametrize(
    ("contact", "mover"),
    [
        ("The front of V1 contacted the front of V2.", "V1"),
        ("The front of V2 contacted the left side of V1.", "V2"),
        ("The left side of V1 contacted the left side of V2.", "V1"),
        ("V2 lost control on ice. The front of V1 contacted the left side of V2.", "V2"),
    ],
)
def test_of_two_that_come_against_each_other_one_is_over_the_middle(contact: str, mover: str) -> None:
    told = _maneuvers(ONCOMING + contact)
    other = {"V1": "V2", "V2": "V1"}[mover]
    assert told[mover] == ("crossing_centerline", False)
    assert told[other][0] == "straight"
    fact = next(f for f in read(ONCOMING + contact).facts if f.field == f"vehicles.{mover}.maneuver")
    assert (fact.status, fact.rule) == ("inferred", OVER_MIDDLE)


@pytest.mark.parametrize(
    "text",
    [
        ONCOMING + "The right side of V1 contacted the front of V2.",  # V1 had turned
        ONCOMING + "V1 and V2 collided.",  # on sides that nobody tells
        ONCOMING + "Both were approaching a four-leg intersection. The front of V1 contacted the left side of V2.",
        "V1 was traveling south. V2 was traveling east. The front of V1 contacted the left side of V2.",
        "V1 hit V2.",
    ],
)
def test_where_more_may_have_happened_nobody_is_given_a_move(text: str) -> None:
    assert {maneuver for maneuver, _ in _maneuvers(text).values()} == {"straight"}


@pytest.mark.parametrize("turner", ["V1", "V2"])
@pytest.mark.parametrize("verb", ["The front of {other} contacted the right side of {turner}.",
                                  "The right side of {turner} contacted the front of {other}."])  # fmt: skip
def test_of_two_that_meet_in_a_junction_the_one_that_shows_its_right_flank_turns_left(turner: str, verb: str) -> None:
    other = {"V1": "V2", "V2": "V1"}[turner]
    text = ONCOMING + "Both were approaching a four-leg intersection. " + verb.format(turner=turner, other=other)
    assert _maneuvers(text) == {turner: ("turn_left", False), other: ("straight", False)}
    fact = next(f for f in read(text).facts if f.field == f"vehicles.{turner}.maneuver")
    assert (fact.status, fact.rule) == ("inferred", ACROSS)


def test_a_told_crossing_stays_with_the_one_of_whom_it_is_told() -> None:
    told = _maneuvers(ONCOMING + "V2 crossed the centerline. The front of V1 contacted the front of V2.")
    assert (told["V1"][0], told["V2"]) == ("straight", ("crossing_centerline", True))


@pytest.mark.parametrize(
    ("text", "maneuver"),
    [
        (BESIDE_EACH_OTHER + "The right side of V1 contacted the left side of V2.", "lane_change_right"),
        (
            BESIDE_EACH_OTHER.replace("two", "2").replace("lane one", "lane 3")
            + "The left side of V1 contacted the right side of V2.",
            "lane_change_left",
        ),
    ],
)
def test_of_two_side_by_side_the_striker_changes_lanes(text: str, maneuver: str) -> None:
    assert _maneuvers(text) == {"V1": (maneuver, False), "V2": ("straight", False)}
    assert any(f.rule == BESIDE and f.value == maneuver for f in read(text).facts)


def test_told_lanes_that_contradict_the_sides_give_no_move() -> None:
    told = _maneuvers(BESIDE_EACH_OTHER + "The left side of V1 contacted the right side of V2.")
    assert told == {"V1": ("straight", False), "V2": ("straight", False)}
