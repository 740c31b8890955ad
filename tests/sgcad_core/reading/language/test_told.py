"""Every rule is worth its place: a text gives the facts that it says, and gives them no longer without the rule."""

from __future__ import annotations

import pytest

from sgcad_core.reading.language.data import language
from tests.sgcad_core.reading.language.readings import facts_of_sentences
from tests.sgcad_core.reading.language.told import differs, drawn, silenced, told

ELSEWHERE = ("account", "company", "degrade", "report", "street_places", "telling", "typos", "wordings")
"""Files whose rules no reading uses: what a scenario made of a report, who stands ahead, robustness levels, texts
without roads, the learned reader's words, names that a map knows, slips of typing. They have tests of their own."""
WITHOUT = 66
"""Rules that no text of facts needs yet; let it only shrink."""


@pytest.mark.parametrize("id", sorted(told()))
def test_a_text_gives_what_it_says(id: str) -> None:
    assert {text: wrong for text, fields in told()[id].items() if (wrong := differs(text, fields))} == {}


@pytest.mark.parametrize("id", sorted(told()))
def test_without_its_rule_a_text_gives_something_else(id: str) -> None:
    with silenced(id):
        assert any(_lost(text, fields) for text, fields in told()[id].items()), "no text needs the rule"


def _lost(text: str, fields: dict[str, object]) -> bool:
    try:
        return bool(differs(text, fields))
    except (KeyError, AttributeError, IndexError):  # the reader counts on the rule
        return True


def test_silence_ends() -> None:
    before = drawn("V1 was eastbound and hit a tree.")
    with silenced("headings.heading_bare"):
        assert drawn("V1 was eastbound and hit a tree.") != before
    assert drawn("V1 was eastbound and hit a tree.") == before


def test_rules_without_a_text_of_facts_grow_no_more() -> None:
    covered = {id for id, _, _ in facts_of_sentences()} | set(told())
    reading = {id for id in language().rules if not id.startswith(tuple(f"{file}." for file in ELSEWHERE))}
    lacking = sorted(reading - covered)
    assert len(lacking) <= WITHOUT, lacking
    assert len(lacking) == WITHOUT, f"there are only {len(lacking)} left: lower WITHOUT"


def test_texts_are_told_of_rules_that_there_are() -> None:
    assert set(told()) - set(language().rules) == set()
