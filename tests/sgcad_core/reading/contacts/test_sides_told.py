"""Which sides touch where corners, flanks and things are told, who else is struck by one verb, and things in order."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read

SIDE_BY_SIDE = "V1 and V2 were eastbound in lanes one and two. V1 changed lanes to the left and "
AHEAD = "V1 was eastbound. V2 was stopped in front of V1. "
OFF_ROAD = "V1 was northbound on a two-lane road and left it on the right. "


def _contacts(text: str) -> list[str]:
    return [f"{c.striker} {c.striker_area} {c.struck} {c.struck_area}" for c in read(text).crash.contacts]


@pytest.mark.parametrize(
    ("text", "first"),
    [
        (SIDE_BY_SIDE + "its left front corner struck the right side of V2.", "V1 left V2 right"),
        (SIDE_BY_SIDE + "the left front corner of V1 struck the right front corner of V2.", "V1 left V2 right"),
        (SIDE_BY_SIDE + "sideswiped the right side of V2.", "V1 left V2 right"),
        ("V1 was southbound. V2 was northbound. The front of V2 struck the left rear of V1.", "V2 front V1 left"),
        ("V1 was northbound. V2 was westbound. The front of V1 struck the right rear of V2.", "V1 front V2 right"),
        (AHEAD + "The left front of V1 struck the right rear of V2.", "V1 front V2 back"),
    ],
)
def test_corners_touch_with_the_end_or_flank_that_meets(text: str, first: str) -> None:
    assert _contacts(text)[0] == first


@pytest.mark.parametrize(
    ("told", "side"),
    [
        ("Its left rear struck a guardrail.", "left"),
        ("Its left front struck a guardrail.", "front"),
        ("Its right front tire struck a boulder.", "front"),
        ("Its right front tire and right rear tire struck a wall.", "right"),
        ("Its front and right side struck a fence.", "front"),
    ],
)
def test_a_thing_is_met_with_the_end_of_a_front_corner_and_the_flank_of_a_rear_one(told: str, side: str) -> None:
    assert _contacts(OFF_ROAD + told)[0] == f"V1 {side} O1 front"


def test_one_that_backs_meets_a_thing_with_its_rear_corner_as_its_back() -> None:
    assert (
        _contacts("V1 was backing out of a driveway and its left rear corner struck a pole.")[0] == "V1 back O1 front"
    )


@pytest.mark.parametrize(
    ("told", "pairs"),
    [
        ("V2 and V3 were then struck in the rear by the front of V1.", {("V1", "V2"), ("V1", "V3")}),
        ("Both V1 and V2 struck the left side of V3.", {("V1", "V3"), ("V2", "V3")}),
    ],
)
def test_one_verb_tells_a_contact_of_each_of_its_subjects(told: str, pairs: set[tuple[str, str]]) -> None:
    found = read(f"V1 was eastbound. V2 and V3 were stopped ahead of V1. {told}").crash.contacts
    assert pairs <= {(c.striker, c.struck) for c in found}


def test_things_of_one_sentence_stand_in_their_order_though_a_word_comes_twice() -> None:
    text = OFF_ROAD + "It hit a small tree with its front, a bush with its left side, then a large tree with its front."
    assert [(i.other, i.after) for i in read(text).crash.impacts] == [("tree", 1), ("bush", 1), ("tree", 1)]


def test_a_thing_that_is_told_again_in_the_same_sentence_is_one() -> None:
    text = "V1 hit V2. V1 left the road and hit a pole, and its right side hit the pole as it passed."
    assert [i.other for i in read(text).crash.impacts] == ["pole"]


@pytest.mark.parametrize(
    ("told", "sides"),
    [
        ("Its front struck a tree, then its back struck another tree.", [None, "back"]),
        ("The front of V1 struck a tree and V1 spun, striking another tree with its left plane.", [None, "left"]),
        ("The front of V1 struck two trees.", [None, "front"]),
        ("The left side door of V1 struck a hydrant and the right front tire of V1 struck a wall.", [None, "front"]),
    ],
)
def test_each_of_two_things_is_met_by_the_side_that_is_told_of_it(told: str, sides: list[str | None]) -> None:
    """The side of the first contact of all stands with that contact."""
    assert [i.actor_area for i in read(OFF_ROAD + told).crash.impacts] == sides


def test_another_thing_of_a_name_is_a_further_contact_however_far_behind() -> None:
    text = OFF_ROAD + "Its front struck a tree. V1 turned. V1 slid on. Its front struck {} tree."
    assert [len(read(text.format(which)).crash.impacts) for which in ("a second", "the")] == [2, 1]


def test_the_damage_tells_the_side_of_a_contact_that_has_none() -> None:
    street = "The AV was stopped southbound on Oak Street. A pickup truck was traveling northbound on Oak Street. "
    hit = "The pickup truck made contact with the AV, damaging the AV's rear driver side bumper."
    contact = read(street + hit).crash.contacts[0]
    assert set(contact.struck_may) == {"back", "left"}
    named = "The pickup truck made contact with the right door of the AV, damaging the AV's rear bumper."
    assert read(street + named).crash.contacts[0].struck_area == "right"


def first_sides(text: str) -> tuple[str, str]:
    """The sides of the first contact, striker first."""
    first = read(text).crash.contacts[0]
    return first.striker_area, first.struck_area


def test_one_that_goes_along_a_front_corner_touches_it_with_its_flank() -> None:
    text = (
        "The AV was stopped at a red light on northbound Elm Street. A lane-splitting motorcycle made contact with the "
        "AV's right front corner."
    )
    assert first_sides(text) == ("left", "right")


def test_a_rear_corner_that_stands_and_is_passed_is_its_end() -> None:
    text = (
        "The AV was stopped eastbound when a car that had been behind the AV began to maneuver around the AV on its "
        "left. The passenger side of the car made contact with the rear driver side of the AV."
    )
    assert first_sides(text) == ("right", "back")


def test_corners_of_two_that_pass_each_other_touch_with_their_flanks() -> None:
    text = (
        "The AV was southbound and stopped. A van was northbound, and the front driver side of the van made contact "
        "with the rear driver side of the AV."
    )
    assert first_sides(text) == ("left", "left")


def test_front_corners_touch_with_their_flanks_where_one_drives_past_one_that_stands() -> None:
    text = (
        "The AV was southbound and stopped to yield to an oncoming truck. As the truck was passing, the front left "
        "corner of the truck made contact with the front left corner of the AV."
    )
    assert first_sides(text) == ("left", "left")


def test_one_that_nearly_changes_into_the_lane_of_another_one_comes_beside_it() -> None:
    text = (
        "The subject driver is in the left lane when a car in the right lane starts to change into the subject "
        "driver's lane. The subject driver brakes to avoid being hit."
    )
    assert first_sides(text) == ("left", "right")


def test_what_this_caused_is_a_second_contact() -> None:
    text = (
        "V1 was southbound. V2 was westbound. The front of V1 struck the right side of V2. V1 spun clockwise. This "
        "caused the left side of V1 to come into contact with the right side of V2."
    )
    told = read(text).crash.impacts
    assert [(i.actor, i.other, i.actor_area, i.other_area) for i in told] == [("V1", "V2", "left", "right")]


def test_things_of_one_kind_are_as_many_as_told() -> None:
    text = "V1 was northbound, departed the road and struck {}."
    struck = {"a tree": 1, "two trees": 2, "several small trees": 2, "five mailboxes": 3, "a tree and two poles": 3}
    assert {told: len(read(text.format(told)).crash.impacts) for told in struck} == struck


@pytest.mark.parametrize(("text", "first"), [
    ("Subject driver is changing into the left lane. The lead vehicle applies his brakes.", ("V1", "front", "back")),
    ("Subject driver is changing into the left lane. A following vehicle nearly hits her.", ("V2", "front", "back")),
    ("Subject driver is trying to merge onto the interstate. A truck next to her does not let her in. She brakes.",
     ("V1", "left", "right")),
])  # fmt: skip
def test_in_a_near_crash_the_place_of_the_other_one_tells_who_comes_from_behind(
    text: str, first: tuple[str, ...]
) -> None:
    contact = read(text).crash.contacts[0]
    sides = {contact.striker: contact.striker_area, contact.struck: contact.struck_area}
    other = "V2" if first[0] == "V1" else "V1"
    assert (sides[first[0]], sides[other]) == first[1:]


def test_who_starts_after_having_stopped_does_not_stand() -> None:
    text = (
        "Subject driver is starting to make a left turn after having stopped for a traffic signal, when a vehicle "
        "heading in the opposite direction starts to accelerate after having stopped for the same signal."
    )
    assert [v.maneuver for v in read(text).crash.vehicles] == ["turn_left", "straight"]
