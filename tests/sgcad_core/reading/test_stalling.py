"""Text made to stall the reader is read in bearable time, and in time that grows with its length."""

from __future__ import annotations

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.benchmarks.texts.reading_time import KINDS, text_of
from sgcad_core.reading.reading import read
from sgcad_core.reading.text.normalise import MOST_READ, sentences

BEARABLE_S = 10.0
"""Processor seconds, several times what a slow machine takes: a stall takes minutes."""


@pytest.mark.parametrize("kind", ["spaces", "abbreviations", "strangers", "lanes"])
def test_a_text_of_the_largest_size_is_read_in_bearable_time(kind: str) -> None:
    began = time.process_time()
    read(text_of(kind, 100_000))
    assert time.process_time() - began < BEARABLE_S


@settings(max_examples=15, deadline=None)
@given(st.lists(st.sampled_from(sorted(KINDS.values())), min_size=1, max_size=4))
def test_any_mixture_of_stalling_words_is_read(pieces: list[str]) -> None:
    text = ("".join(pieces) * 3000)[:3000]
    began = time.process_time()
    read(text)
    assert time.process_time() - began < BEARABLE_S


def test_what_stands_behind_the_limit_is_not_read() -> None:
    text = "V1 was parked. " * (MOST_READ // 15 + 5) + "V2 struck it."
    assert all("V2" not in s.text for s in sentences(text))
