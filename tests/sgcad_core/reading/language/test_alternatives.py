"""Words put together match what the plain alternation matches, and of several words the same one."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.reading.language.alternatives import any_of
from sgcad_core.reading.language.data import vocabulary

WORDS = st.lists(st.text("abAk -.", max_size=4), min_size=1, max_size=12)
TEXT = st.text("abABkKs \u212a\u017f-.", max_size=20)


def plain(words: list[str]) -> str:
    return f"(?:{'|'.join(map(re.escape, words))})"


def found(pattern: str, text: str, flags: int) -> list[tuple[int, int]]:
    return [m.span() for m in re.finditer(pattern, text, flags)]


@given(WORDS, TEXT, st.sampled_from([0, re.IGNORECASE]), st.sampled_from(["{}", r"{}\b", r"\b{}", "(?:{}b)+", "x?{}$"]))
def test_the_same_is_matched(words: list[str], text: str, flags: int, around: str) -> None:
    assert found(around.format(any_of(words)), text, flags) == found(around.format(plain(words)), text, flags)


def test_the_first_of_two_words_that_match_is_taken() -> None:
    assert re.match(any_of(["crown", "crown victoria", "cab"]), "crown victoria")[0] == "crown"  # type: ignore[index]
    assert re.match(any_of(["crown victoria", "crown", "cab"]), "crown victoria")[0] == "crown victoria"  # type: ignore[index]


@pytest.mark.parametrize("name", sorted(n for n, c in vocabulary().classes.items() if c.plain and c.pattern is None))
def test_every_class_of_plain_words_matches_its_words_as_before(name: str) -> None:
    words = list(vocabulary().values(name))
    text = " ".join(words) + " " + "".join(words).upper()
    assert found(any_of(words), text, re.IGNORECASE) == found(plain(words), text, re.IGNORECASE)
