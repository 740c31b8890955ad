"""A text that tells too little of who met whom is refused; it is never filled with a made-up crash."""

import pytest

from sgcad_core.narrative.reading import read

TOWED = (
    "V1 was a sedan. V2 was a pickup. It was daylight and the road was dry. Both vehicles were towed after the crash."
)


@pytest.mark.parametrize(
    "text",
    [
        TOWED,
        "The crash involved V1 and V2. V1 rotated clockwise and came to rest. V2 was driven from the scene.",
        "V2 had its lights on. The driver of V1 had failed to clear the frost from the windshield before the crash.",
    ],
)
def test_neither_contact_nor_direction_is_refused_with_what_is_missing(text: str) -> None:
    gap = read(text).crash.gap
    assert gap is not None
    assert gap.reason == "the narrative tells neither who struck whom nor how anybody traveled"
    assert gap.missing == ("who struck whom, and with which sides", "in which direction each traveled")
    assert gap.unread, "another reader may know more"


@pytest.mark.parametrize(
    "more",
    [
        " V1 struck V2.",
        " V1 was traveling north.",
        " The front of V1 contacted the back of V2.",
    ],
)
def test_one_told_contact_or_direction_is_enough(more: str) -> None:
    assert read(TOWED + more).crash.gap is None


def test_without_a_word_of_a_crash_that_is_the_reason() -> None:
    gap = read("V1 was a sedan. V2 was a pickup. It was daylight.").crash.gap
    assert gap is not None
    assert gap.reason == "the narrative tells no crash"


def test_who_crashes_alone_needs_no_direction() -> None:
    assert read("V1 ran off the road and struck a tree with its front.").crash.gap is None
