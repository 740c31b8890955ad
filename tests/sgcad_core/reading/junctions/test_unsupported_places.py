"""A crash at a place that cannot be drawn as it is is noted; a place mentioned in passing changes nothing."""

import pytest

from sgcad_core.kinds import PARKING_LOT
from sgcad_core.reading.language import of_role
from sgcad_core.reading.reading import read

AT = {
    "Vehicle 1 was traveling north inside a parking garage when it struck the rear of Vehicle 2.": ("parking_garage",),
    "The crash occurred at a railroad crossing. V1 was northbound and struck the rear of V2.": ("rail_crossing",),
}
BESIDE = (
    "V1 was northbound on a two-lane street. It had passed a roundabout a mile before. V1 struck the rear of V2.",
    "The crash occurred in an intersection near a roundabout. V1 was northbound and struck the left side of V2.",
    "V1 was coming out of a parking garage and was turning left onto the street. V1 struck the left side of V2.",
    "V1 was northbound and struck the rear of V2. The driver of V1 said he knew the rotary well.",
)


@pytest.mark.parametrize(("text", "kinds"), AT.items())
def test_the_place_of_the_crash_is_found(text: str, kinds: tuple[str, ...]) -> None:
    assert read(text).roads.junction.unsupported == kinds


@pytest.mark.parametrize("text", BESIDE)
def test_a_place_mentioned_in_passing_has_no_effect(text: str) -> None:
    assert read(text).roads.junction.unsupported == ()


def test_a_level_of_a_parking_garage_is_drawn_as_a_parking_lot() -> None:
    assert read(next(iter(AT))).roads.junction.kind == PARKING_LOT


@pytest.mark.parametrize("rule", of_role("unsupported"), ids=lambda rule: rule.id)
def test_the_rules_read_their_examples_and_no_counterexample(rule) -> None:  # type: ignore[no-untyped-def]
    assert rule.record.examples
    assert all(rule.search(text) for text in rule.record.examples)
    assert not [text for text in rule.record.counterexamples if rule.search(text)]
