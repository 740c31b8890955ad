"""Whether a report tells a slight blow."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read

_STRUCK = "The van was stopped at a red light. A taxi struck the rear of the van."


@pytest.mark.parametrize(("told", "slight"), [
    ("", False),
    ("The van sustained minor damage to its bumper.", True),
    ("There was minor damage and no injuries were reported.", True),
    ("There were no injuries, and neither vehicle was towed.", True),
    ("The rear bumper sustained damage.", True),
    ("It was a light contact.", True),
    ("The taxi ran the red light. Contact was made.", False),
    ("The taxi had minor damage and its driver was injured.", False),
    ("The taxi had minor damage. The van was towed away.", False),
    ("Both vehicles remained drivable without needing a tow truck.", True),
])  # fmt: skip
def test_a_blow_is_slight_where_nothing_speaks_of_a_hard_one(told: str, slight: bool) -> None:
    assert read(f"{_STRUCK} {told}").crash.slight is slight


@pytest.mark.parametrize(("told", "slight"), [
    ("A taxi approached from behind and made contact with its rear.", True),
    ("It was then rear-ended by a taxi.", True),
    ("It was rear-ended by a rapidly approaching taxi.", False),
    ("A taxi failed to stop and collided with its rear. Contact was made at its bumper.", False),
])  # fmt: skip
def test_a_mere_contact_is_slight(told: str, slight: bool) -> None:
    assert read(f"The van was stopped at a red light. {told}").crash.slight is slight


def test_numbered_reports_have_their_own_speeds() -> None:
    report = "V1 was stopped at a red light. The front of V2 struck the back of V1. V1 had minor damage."
    assert not read(report).crash.slight
