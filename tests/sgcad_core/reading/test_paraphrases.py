"""Plain facts in words that no report of the development data used."""

from __future__ import annotations

from typing import Any

import pytest

from research.benchmarks.texts.paraphrases import HELD_OUT, SEEN, judged, line, of_styles, paraphrases

TOLD = [*paraphrases(SEEN), *of_styles(held_out=False)]


@pytest.mark.parametrize("told", TOLD, ids=[str(n) for n in range(len(TOLD))])
def test_a_paraphrase_is_read_as_told(told: dict[str, Any]) -> None:
    wrong = {field for field, right in judged(told).items() if not right}
    assert wrong == set(told.get("unread", ())), told["text"]


def test_a_fact_that_is_read_otherwise_counts_against_its_field_and_the_whole() -> None:
    told = TOLD[0] | {"me": ["backing"]}
    assert judged(told)["me"] is False
    assert line("one", [told]).startswith("one: other 1 of 1, me 0 of 1")
    assert line("one", [told]).endswith("whole 0 of 1")


def test_no_fewer_held_out_paraphrases_are_read_whole_than_before() -> None:
    told = paraphrases(HELD_OUT)
    assert len(told) == 40
    assert sum(all(judged(one).values()) for one in told) >= 20


def test_no_fewer_texts_in_other_writers_styles_are_read_whole_than_before() -> None:
    told = of_styles(held_out=True)
    assert len(told) == 17
    assert sum(all(judged(one).values()) for one in told) >= 9
