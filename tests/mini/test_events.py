"""Sentences about the collision: what they say beside their slots is so."""

import re

import pytest

from mini.generator.events import DRIFTS
from mini.generator.report import make_report
from tests.mini.reports import sentences


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


def test_one_that_keeps_its_lane_is_not_said_to_drift_into_a_parked_vehicle() -> None:
    seen = 0
    for seed in range(6000):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        if report.crash.config != "parked" or any(a.maneuver.startswith("departing") for a in report.crash.actors):
            continue
        seen += 1
        drifts = r"(drifted|strayed|moved|went|crept) (over )?(to the )?right|right, toward"
        told = [text for text, facts in sentences(report) if re.search(drifts, text) and "~named0.V1" in facts]
        assert not [text for text in told if "parked" in text], told
    assert seen > 30
