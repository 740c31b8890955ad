"""Near crashes as texts tell them: who nearly struck whom, who evaded how, how near they came."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read
from sgcad_core.reading.text.privacy import redact

FOLLOWS = "Subject vehicle is in the left lane when lead vehicle brakes hard. "
Pair = tuple[str, str]


@pytest.mark.parametrize(("text", "pair", "evasions"), [
    (FOLLOWS + "Subject driver brakes to avoid hitting the lead vehicle in the rear.",
     ("V1", "V2"), {"V1": "braking"}),
    (FOLLOWS + "Subject nearly hits the lead vehicle in the rear.", ("V1", "V2"), {}),
    (FOLLOWS + "Subject must swerve to the right to keep from hitting lead vehicle.",
     ("V1", "V2"), {"V1": "steering_right"}),
    ("Subject driver is humming. The following vehicle brakes and steers left to avoid hitting the subject vehicle.",
     ("V2", "V1"), {"V2": "braking_and_steering_left"}),
    ("Vehicle in the right lane changes into the subject vehicle's lane, almost sideswiping it.", ("V2", "V1"), {}),
    ("The subject driver is passing a farm when a pickup cuts off the subject vehicle.", ("V1", "V2"), {}),
    ("V1 was going north. V2 crossed from the east. V1 braked to avoid striking V2.", ("V1", "V2"), {"V1": "braking"}),
])  # fmt: skip
def test_who_nearly_struck_whom_and_who_evaded(text: str, pair: Pair, evasions: dict[str, str]) -> None:
    crash = read(redact(text)).crash
    assert crash.near_crash is not None
    assert {crash.contacts[0].striker, crash.contacts[0].struck} == set(pair)
    assert dict(crash.near_crash.evasions) == evasions


@pytest.mark.parametrize(
    "text",
    [
        "V1 was going north. V2 was ahead. V1 braked to avoid hitting V2 but struck the rear of V2.",
        FOLLOWS + "Subject driver brakes, but can't avoid hitting the lead vehicle.",
        FOLLOWS + "Subject hits the lead vehicle in the rear.",
        "This crash occurred on a ramp. V1 tried to avoid hitting V2. V2 was towed.",
    ],
)
def test_a_crash_is_no_near_crash(text: str) -> None:
    assert read(text).crash.near_crash is None


WAYS = "V1 was traveling north on a two-lane road. V2 was traveling south. "


@pytest.mark.parametrize(
    "text",
    [
        WAYS + "They did not touch and there was no crash.",
        "V1 and V2 did not touch and there was no crash. V1 was traveling north, V2 south.",
        WAYS + "V1 braked and did not make contact with V2. No collision occurred.",
        WAYS + "There was no contact between the vehicles.",
    ],
)
def test_where_nobody_touched_no_contact_is_made_up(text: str) -> None:
    crash = read(text).crash
    assert crash.near_crash is not None
    assert not crash.near_crash.stated


@pytest.mark.parametrize(
    "text",
    [
        WAYS + "V1 struck V2. V3 was parked. V1 did not touch V3.",
        WAYS + "The driver of V1 did not touch the brakes. V1 collided with V2.",
        WAYS + "This crash was severe. There was no contact between V1 and V3.",
    ],
)
def test_a_contact_that_is_denied_of_others_leaves_the_crash(text: str) -> None:
    assert read(text).crash.near_crash is None


@pytest.mark.parametrize(("words", "clearance_m"), [
    ("coming within 2 feet of it", 0.61), ("missing it by one foot", 0.3), ("coming within 300 feet of it", None),
])  # fmt: skip
def test_a_told_clearance_is_read_in_metres(words: str, clearance_m: float | None) -> None:
    near = read(FOLLOWS + f"Subject brakes to avoid hitting the lead vehicle, {words}.").crash.near_crash
    assert near is not None
    assert near.clearance_m == clearance_m


def test_the_lead_and_the_following_vehicle_are_two_and_the_subject_is_v1() -> None:
    text = FOLLOWS + "Subject stops suddenly. The following vehicle nearly hits the subject vehicle in the rear."
    crash = read(text).crash
    assert {crash.contacts[0].striker, crash.contacts[0].struck} == {"V1", crash.vehicles[-1].id}


def test_who_stops_to_avoid_a_contact_did_not_stand_before() -> None:
    crash = read(FOLLOWS + "Subject stops to avoid hitting the lead vehicle in the rear.").crash
    first, second = crash.vehicles[:2]
    assert (first.maneuver, second.maneuver) == ("straight", "slowing")


def test_of_a_drowsy_subject_it_stays_that_he_drives() -> None:
    kept = redact("Subject driver is drowsy. The vehicle runs off the road on the right.")
    assert kept.startswith("Subject driver is driving. The vehicle")
    assert read(kept).crash.vehicles[0].maneuver == "departing_road_right"


@pytest.mark.parametrize(("text", "hand"), [
    ("Subject is tired and nearly hits the median.", "left"),
    ("Subject is tired and nearly hits the curb on the right.", "right"),
    ("Subject is tired, drifts right and nearly hits a mailbox.", "right"),
    ("Subject steers left to avoid hitting a mailbox.", None),
    ("Subject nearly hits a mailbox.", None),
])  # fmt: skip
def test_the_hand_of_a_thing_that_is_nearly_struck_is_told_or_follows_from_the_drift(text, hand):
    crash = read(redact(text)).crash
    assert crash.others[0].hand == hand
    steers = [how for _, how in crash.near_crash.evasions if how.startswith("steering")]
    assert bool(steers) == ("avoid" in text)


def test_a_loss_of_control_is_told_of_a_near_crash_too():
    text = "Subject loses control. Subject spins 180 degrees clockwise and nearly hits the guardrail on the right."
    course = read(redact(text)).crash.driven["V1"]
    assert (course.lost_control, course.spin, course.spin_deg, course.departs) == (True, "clockwise", 180.0, "right")


def test_how_one_drives_beside_a_bystander_tells_nothing_of_the_one_that_is_nearly_struck():
    text = (
        "Subject is behind a slow truck. "
        "Subject is passing the truck when a van approaches from the opposite direction. "
        "Subject nearly hits the van head-on."
    )
    crash = read(redact(text)).crash
    assert [(v.id, v.heading) for v in crash.vehicles] == [("V1", "N"), ("V2", "S")]
