"""Persons leave the narrative, the crash stays."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.reading.text.privacy import redact

MOTION = [
    "V1, a 2001 Ford Escort, was traveling north in the right lane.",
    "The front of V1 struck the left side of V2.",
    "Both vehicles were towed due to damage.",
    "Vehicle #2 was stopped at the stop sign waiting to turn left.",
]


@pytest.mark.parametrize("sentence", MOTION)
def test_motion_is_never_touched(sentence):
    assert redact(sentence) == sentence


@pytest.mark.parametrize(
    "sentence",
    [
        "The 44-year-old male driver was using the available three-point seat belt and the airbag deployed.",
        "She was transported via helicopter to a regional trauma center.",
        "He wears glasses to correct his myopic condition.",
        "The driver of V1 was not injured.",
    ],
)
def test_sentences_about_persons_alone_are_dropped(sentence):
    assert redact(f"{MOTION[0]} {sentence} {MOTION[1]}") == f"{MOTION[0]} {MOTION[1]}"


def test_age_and_sex_leave_a_sentence_that_tells_of_motion():
    text = redact("V1 was driven by a 17-year-old male who was transported to a hospital and V1 was stopped in a lane.")
    assert text == "V1 was driven by a person and V1 was stopped in a lane."


@pytest.mark.parametrize(
    ("told", "left"),
    [
        (
            "The Fiat (Vehicle #2) was driven by a belted 31 year old man who was not injured. He was going 9 mph.",
            "The Fiat (Vehicle #2) was driven by a person. They were going 9 mph.",
        ),
        (
            "A 30-year-old female who did not sustain any injuries drove the Kia Rio (V2). She turned left.",
            "A person drove the Kia Rio (V2). They turned left.",
        ),
        (
            "The driver of V1 was not injured. He was traveling at 20 mph.",
            "The driver of V1 was traveling at 20 mph.",
        ),
        ("The 22-year-old male driver of V2 turned left.", "The driver of V2 turned left."),
        ("V1 pulled out in front of her and stopped.", "V1 pulled out in front of them and stopped."),
    ],
)
def test_it_stays_known_whose_driver_is_meant(told, left):
    assert redact(told) == left


def test_pronouns_and_verbs_are_made_neutral():
    assert redact("He was traveling north when she braked, and her car hit him.") == (
        "They were traveling north when they braked, and their car hit them."
    )


def test_names_with_a_title_are_replaced():
    assert "Smith" not in redact("Mr. Smith stopped in the road.")


@settings(max_examples=100, deadline=None)
@given(st.lists(st.sampled_from(MOTION), min_size=1, max_size=4), st.text(max_size=60))
def test_any_text_is_redacted_without_loss_of_motion(motion, noise):
    del noise
    text = " ".join(motion)
    assert redact(text) == text


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=400))
def test_any_text_can_be_redacted_and_stays_redacted(text):
    once = redact(text)
    assert "year-old male" not in once
    assert len(once) <= 2 * len(text) + 40


def test_an_ambulance_that_drives_is_no_patient() -> None:
    text = "While V1 was stopped, the ambulance went by V1 and scraped its mirror."
    assert redact(text) == text


def test_what_a_watched_driver_does_keeps_its_subject_where_his_state_goes() -> None:
    kept = redact("Subject driver looks drowsy and drifts off the right side of the road.")
    assert kept == "Subject driver is driving and drifts off the right side of the road."


DEEDS = [
    "V1 was traveling north at 40 mph",
    "V1 crossed the centerline",
    "V1 rolled over twice",
    "V1 veered onto the shoulder",
    "V1 departed the road to the right",
    "V1 accelerated",
    "V1 lost control on the ice",
    "V1 ran a red light",
    "V1 skidded into the ditch",
    "V1 spun around",
    "V1 was stopped in the left lane",
    "V1 backed out of a driveway",
    "V1 avoided V2",
]
STATES = [
    "The driver was drowsy",
    "The driver of V1 was not injured",
    "The air bags deployed in V1",
    "The driver of V2 was wearing a lap and shoulder belt",
    "Because of a medical condition the driver blacked out",
    "V2 sustained disabling damage",
    "Nobody was hurt",
]
JOINTS = [", and ", " and ", "; ", ", but ", ", "]


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(DEEDS), st.sampled_from(STATES), st.sampled_from(JOINTS), st.booleans())
def test_nothing_that_tells_motion_place_speed_or_control_is_cut(deed, state, joint, first):
    told = f"{deed}{joint}{state[0].lower()}{state[1:]}." if first else f"{state}{joint}{deed}."
    assert deed in redact(told)


PERSONS = [
    "The driver of V1 was a 30-year-old male who was wearing his lap and shoulder belt.",
    "The driver was wearing her lap and shoulder belts, and the air bag deployed.",
    "The driver, a 24-year-old female, was wearing her lap belt and was transported to a hospital.",
    "The front seat passenger was wearing his lap and shoulder belt.",
    "The driver died and the passenger was wearing a lap belt.",
    "She was 61, licensed, and complained of neck pain.",
]


@settings(max_examples=200, deadline=None)
@given(st.lists(st.sampled_from(MOTION + PERSONS), min_size=1, max_size=6))
def test_sentences_go_whole_and_leave_no_stump(sentences):
    assert redact(" ".join(sentences)) == " ".join(s for s in sentences if s in MOTION)


@pytest.mark.parametrize(
    ("told", "left"),
    [
        ("The driver, who had been drinking alcohol, lost control.", "The driver lost control."),
        ("The driver of V1, a licensed 19-year-old male, accelerated.", "The driver of V1 accelerated."),
        ("V1 was driven by a woman who wore a lap belt and who was treated.", "V1 was driven by a woman."),
        ("The air bags of V1 fired, which then rolled over.", "The air bags of V1 fired, which then rolled over."),
        ("V1 sustained disabling damage and was towed.", "V1 was towed."),
    ],
)  # fmt: skip
def test_what_is_left_of_a_sentence_has_a_subject_and_an_end(told, left):
    assert redact(told) == left
