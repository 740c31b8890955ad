"""Which answers of a final reading the learned reader of numbered reports does not trust."""

from __future__ import annotations

import pytest

from sgcad_core.case.records import CrashReport
from sgcad_core.reading.reading import read
from sgcad_core.reading.second_reader.numbered.fuse_numbered import fused_with_guesses
from sgcad_core.reading.second_reader.numbered.unsure_answers import LEAST_SURE, unsure_answers
from sgcad_core.records.edits import Edit
from sgcad_core.records.second_reader import Guess, Opinion, Unsure

TEXT = (
    "V1 was traveling east on a four lane road in lane one. V2 was traveling east on the same road in lane two. "
    "The front of V2 struck the left side of V1."
)
RULES = read(TEXT)


def unsure(**guesses: Guess) -> tuple[Unsure, ...]:
    """Of the reading in which the guesses are taken; "_" for the point of a question."""
    asked = {name.replace("_", "."): guess for name, guess in guesses.items()}
    return unsure_answers(RULES, fused_with_guesses(RULES, asked), asked)


@pytest.mark.parametrize(("p", "found"), [(LEAST_SURE - 0.01, True), (LEAST_SURE, False), (0.99, False)])
def test_an_answer_of_the_rules_that_is_right_too_seldom_is_unsure(p, found) -> None:
    assert bool(unsure(lanes_V1=Guess(p=p))) == found


def test_the_readers_own_answer_is_as_sure_as_it_says() -> None:
    taken = unsure(maneuver_V1=Guess(value="lane_change_left", p=0.62))
    assert taken == (Unsure(question="maneuver.V1", p=0.62),)
    assert unsure(maneuver_V1=Guess(value="lane_change_left", p=0.8)) == ()


def test_an_answer_of_the_reader_that_could_not_be_drawn_says_nothing_of_the_one_that_stands() -> None:
    alone = read("V1 was traveling east on a road. The front of V1 struck a pole.")
    passes = {"maneuver.V1": Guess(value="overtaking", p=0.9)}
    assert fused_with_guesses(alone, passes).crash == alone.crash
    assert unsure_answers(alone, alone, passes) == ()


def test_what_is_met_first_is_not_judged() -> None:
    assert unsure(met_V1=Guess(p=0.1)) == ()


def test_what_a_model_made_of_an_answer_since_is_not_judged() -> None:
    other = fused_with_guesses(RULES, {"maneuver.V1": Guess(value="turn_left", p=0.9)})
    assert unsure_answers(RULES, other, {"maneuver.V1": Guess(p=0.1)}) == ()


@pytest.mark.parametrize(("edit", "left"), [
    (None, {"lanes.V1", "area.V1", "turned.V2"}),
    (Edit(field="vehicles.V1.present", value=False), set()),
    (Edit(field="vehicles.V1.heading", value="N"), {"area.V1"}),
])  # fmt: skip
def test_what_a_person_changed_is_not_judged(edit, left) -> None:
    questions = ("lanes.V1", "area.V1", "turned.V2")
    opinion = Opinion(guesses={question: Guess(p=0.5) for question in questions})
    report = CrashReport(case="a", narrative=TEXT, opinion=opinion, edits=(edit,) if edit else ())
    assert {one.question for one in report.reading.unsure} == left
