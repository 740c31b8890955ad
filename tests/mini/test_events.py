"""Sentences about the collision: what they say beside their slots is so."""

import pytest

from mini.generator.events import DRIFTS


@pytest.mark.parametrize(
    "clause",
    [
        "{V} drifted to the right",
        "Easing to the right, {V} headed toward {W}",
        "A deviation to the right brought {V} toward {W}",
        "The course of {V} bent to the right",
        "{V} got over against the line of parked cars",
        "{V} was guided too far right by its driver",
        "Over to the right went {V}, where {W} was parked",
        "The driver of {V} let the wheel slip rightward",
    ],
)
def test_clauses_of_one_that_leaves_its_lane_are_known(clause: str) -> None:
    assert DRIFTS.search(clause)


@pytest.mark.parametrize(
    "clause",
    [
        "The driver of {V} did not see {W} parked ahead",
        "{V} was too far to the right",
        "{V} did not leave enough room to pass {W}",
        "The driver of {V} was attending to a child and did not see the parked {W}",
        "On a slippery road {V} passed too close to {W}",
    ],
)
def test_clauses_of_one_that_may_have_kept_its_lane_are_not_taken_for_a_drift(clause: str) -> None:
    assert not DRIFTS.search(clause)
