"""What a signal showed to whom: the crash's own sentences first, the last of them; nothing that is only thought."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read

OPENING = "The crash occurred at a signalized intersection. V1, a 2001 Honda Civic, was northbound. V2 was eastbound. "


def states(text):
    return dict(read(OPENING + text).signals)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("V1 ran the red light and V2 had a green light.", {"V1": "red", "V2": "green"}),
        ("V2 failed to stop for the red signal and the front of V2 struck the left side of V1.", {"V2": "red"}),
        ("V1 was stopped for a red light. V1 accelerated when the light turned green.", {"V1": "green"}),
        ("V1 slowed for the amber light and was struck in the back by V2.", {"V1": "yellow"}),
        ("V2 was stopped at the light until it turned green.", {"V2": "green"}),
        ("As the light turned green and V2 began to move, the front of V1 struck the back of V2.", {"V2": "green"}),
        ("When the signal changed to red, V1 braked and was struck in the back by V2.", {"V1": "red"}),
        ("V1 had a flashing red light.", {}),
        ("The driver of V1 thought that the light had turned green.", {}),
        ("V1 was waiting for a green light.", {}),
        ("V1 passed a green sedan on Green Street.", {}),
    ],
)
def test_states_are_those_of_the_subject(text, told):
    assert states(text) == told


def test_the_crash_is_believed_before_the_driver():
    assert states("V1 ran the red light. The driver of V1 stated that V1 had the green light.") == {"V1": "red"}


def test_witnesses_who_differ_tell_nothing():
    assert states("The driver of V1 stated that V1 had a green light. A witness stated that V1 had a red light.") == {}


def test_a_state_is_a_fact_with_its_sentence():
    reading = read(OPENING + "V1 ran the red light.")
    fact = next(f for f in reading.facts if f.field == "vehicles.V1.signal")
    assert (fact.value, fact.rule, fact.status) == ("red", "signal_states.red", "stated")
    assert "ran the red light" in reading.narrative[fact.start : fact.end]


@pytest.mark.parametrize(("text", "turned"), [
    ("V1 accelerated when the light turned green.", True),
    ("V1 entered on a green light.", False),
])  # fmt: skip
def test_a_signal_that_turned_just_before_is_told_apart_from_one_that_showed_its_state(text, turned):
    reading = read(OPENING + text)
    assert reading.crash.driven["V1"].signal_turned == turned if turned else not reading.crash.driven.get("V1")
    assert any(fact.field == "vehicles.V1.signal_turned" for fact in reading.facts) == turned
