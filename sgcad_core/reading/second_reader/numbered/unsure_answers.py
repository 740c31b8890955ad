"""Answers of a final reading that the learned reader of numbered reports does not trust.

That reader gives to every question that it understands how often what stands is right (`Guess.p`; calibrated on coded
reports that it did not learn from). That holds for the rules' answer where it keeps it, and for its own where that is
taken; not for one that could not be drawn, nor for what a model made of the answer since. Knows no weights.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.second_reader.numbered.numbered_answers import answer_of, same
from sgcad_core.records.second_reader import Guess, Unsure

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading

LEAST_SURE = 0.65
"""An answer that is wrong in more than a third of such reports is a guess."""
_NOT_ASKED = "met."
"""What is met first: no answer to it is taken, and those that it doubts are as often right as others."""


def unsure_answers(rules: Reading, final: Reading, guesses: Mapping[str, Guess]) -> tuple[Unsure, ...]:
    """The answers of a reading that are right less often than `LEAST_SURE`; `rules`: the reading that the guesses are
    of, before any of them was taken."""
    first, last = layout_of_facts(rules.roads), layout_of_facts(final.roads)
    found = []
    for question, guess in guesses.items():
        if question.startswith(_NOT_ASKED):
            continue
        stood, stands = answer_of(question, rules.crash, first), answer_of(question, final.crash, last)
        if stands is not None and (p := _probability(guess, stood, stands)) is not None and p < LEAST_SURE:
            found.append(Unsure(question=question, p=round(p, 3)))
    return tuple(found)


def _probability(guess: Guess, stood: str | None, stands: str) -> float | None:
    """How often the answer that stands is right; None where the reader does not say it of this one."""
    holds = stands == stood if guess.value is None else same(guess.value, stands)
    return guess.p if holds else None
