"""A text that lacks what a rule needs is one in which its pattern matches nowhere."""

from __future__ import annotations

import random
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.reading.language import rule
from sgcad_core.reading.language.data import language
from sgcad_core.reading.language.needs import lacks, needs_of, slot, told_by, told_by_words
from sgcad_core.reading.language.records import rule_record

ODD = "KkSsIi\u0130\u0131\u017f\u212a\u00e9"
PIECES = st.sampled_from([
    "a", "k", "[ks]", "[^a]", r"\d", r"\b", "(?:ab|c)", "(?:ab|)", "(?=ab)", "(?!ab)", "(?<=a)", "(?:ka)?",
    "(?:i|s|a)+", "(ab)", r"(?P<n>k|is)", "(?-i:K)", "a{2}", "(?:ab){0,2}", ".", "s*?", "\u00e9", "(?:abc|abd|x)",
])  # fmt: skip


def lacking(pattern: str, text: str) -> bool:
    return lacks(text, needs_of(told_by(pattern)))


@given(st.lists(PIECES, min_size=1, max_size=5), st.text("abckisKSI x2" + ODD, max_size=12))
def test_a_text_that_lacks_it_has_no_match(pieces: list[str], text: str) -> None:
    pattern = "".join(piece.replace("?P<n>", "") for piece in pieces)
    if lacking(pattern, text):
        assert not re.search(pattern, text)
        assert not re.search(pattern, text, re.IGNORECASE)


@pytest.mark.parametrize(("pattern", "needed"), [
    ("struck", {"struck"}), ("(?:hit|struck) by", {"hit by", "struck by"}), (r"\bV\d+ (?:hit|met)\b", {" hit", " met"}),
    ("(?:red|) car", {" car"}), (r"x(?=.*rolled)", {"rolled"}), ("a?", set()), (r"\w+", set()),
])  # fmt: skip
def test_what_is_needed_is_one_of_these_words(pattern: str, needed: set[str]) -> None:
    assert set(needs_of(told_by(pattern))) == needed


def test_slots_need_what_their_words_need() -> None:
    told = told_by(f"(?:{slot(0)}|{slot(1)}) lane", [told_by_words(["left"]), told_by_words(["right", "middle"])])
    assert told[0] == {"left lane", "right lane", "middle lane"}


def test_letters_beyond_ascii_that_stand_for_letters_are_found() -> None:
    assert re.search("kiss", "\u212a\u0130\u017fS", re.IGNORECASE)
    assert not lacking("kiss", "\u212a\u0130\u017fS")


@pytest.mark.parametrize("id", sorted(language().rules))
def test_examples_of_rules_changed_at_random_are_read_as_by_the_pattern(id: str) -> None:
    record, rng = language().rules[id], random.Random(id)
    needs, pattern = language().needs(record), rule(id).pattern
    for example in (*record.examples, *record.counterexamples):
        text = example.replace("\u00ab", "").replace("\u00bb", "")
        for _ in range(3):
            if lacks(text, needs):
                assert not pattern.search(text), (sorted(needs), text)
            text = changed(text, rng)


def changed(text: str, rng: random.Random) -> str:
    """With a few characters left out, doubled, exchanged, in capitals or odd."""
    for _ in range(rng.randrange(1, 4)):
        at = rng.randrange(len(text) + 1)
        piece = text[at : at + rng.randrange(6)]
        put = rng.choice(("", piece * 2, piece.swapcase(), piece[::-1], rng.choice(ODD), " ", ". "))
        text = text[:at] + put + text[at + len(piece) :]
    return text


METHODS = ("search", "match", "finditer", "findall")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "text", ["V1 struck the back of V2.", "It rained, and nothing was seen of the road", "", "x" * 50]
)
def test_a_rule_that_was_asked_often_answers_as_its_pattern(method: str, text: str) -> None:
    asked = rule("contact.subject_area")
    for _ in range(600):
        asked.search(text + " and so on and so forth")
    ours, theirs = getattr(asked, method)(text), getattr(asked.pattern, method)(text)
    assert seen(ours) == seen(theirs)


def test_a_rule_that_was_asked_often_replaces_as_its_pattern() -> None:
    asked = rule("contact.subject_area")
    for text in ("The left of V1 struck the right of V1 in the rain.", "Nobody was hurt, and the road was dry."):
        for _ in range(600):
            asked.search(text)
        assert asked.sub("it", text, 1) == asked.pattern.sub("it", text, 1)
        assert asked.sub("it", text) == asked.pattern.sub("it", text)


def seen(found: object) -> object:
    if isinstance(found, re.Match):
        return found.span()
    return [seen(each) for each in found] if hasattr(found, "__next__") else found  # type: ignore[attr-defined]


def test_a_record_with_slots_of_the_caller_needs_its_samples() -> None:
    record = rule_record("made.yaml", "it", {"pattern": "the {thing} fell", "given": {"thing": "tree"}})
    needs = language().needs(record)
    assert needs == ("the tree fell",)
