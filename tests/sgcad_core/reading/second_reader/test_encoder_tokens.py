"""Numbered reports as codes: who and what has a code of its own, and that no word is kept."""

from __future__ import annotations

import zlib

import numpy as np

from sgcad_core.reading.second_reader.encoder_tokens import (
    FIRST_NUMBER,
    FIRST_VEHICLE,
    FIRST_WAY,
    FIRST_WORD,
    LONGEST,
    MANY,
    UNKNOWN,
    Narrative,
    coded,
    narrative_of,
    rows,
    vehicle_number,
)
from sgcad_core.reading.second_reader.learned_reader_features import account_of
from sgcad_core.reading.second_reader.numbered.numbered_words import Said, Token
from sgcad_core.reading.text.compass import COMPASS

TEXT = "V1 was traveling east on a four lane road. V2 was stopped. The front of V1 struck the back of V2."


def told(text: str = TEXT) -> Narrative:
    return narrative_of(account_of(text))


def test_vehicles_directions_and_counts_have_codes_of_their_own() -> None:
    codes = told().codes.tolist()
    assert codes[0] == FIRST_VEHICLE
    assert FIRST_VEHICLE + 1 in codes
    assert FIRST_WAY + COMPASS.index("E") in codes
    assert FIRST_NUMBER + 4 in codes
    assert zlib.crc32(b"struck") in codes


def test_every_token_has_its_sentence_and_who_that_is_about() -> None:
    found = told()
    assert len(found.codes) == len(found.subjects) == len(found.sentences)
    assert (found.sentences[0], found.subjects[0]) == (0, 1)
    assert set(found.subjects[found.sentences == 1].tolist()) == {2}


def test_numbers_that_count_no_lanes_are_one_and_late_vehicles_too() -> None:
    some = (Token("number", "35"), Token("number", "70"), Token("vehicle", "V9"))
    assert coded([Said(0, None, some)]).codes.tolist() == [MANY, MANY, FIRST_WAY - 1]
    assert [vehicle_number(name) for name in ("V1", "V9", "P1", None)] == [1, 6, 0, 0]


def test_an_endless_report_is_cut_and_an_empty_one_has_no_codes() -> None:
    assert len(coded([Said(0, None, (Token("word", "a"),) * (LONGEST + 5))]).codes) == LONGEST
    assert coded([]).codes.dtype == np.uint32
    assert len(coded([]).codes) == 0


def test_a_word_that_was_not_learned_is_unknown() -> None:
    words = np.array(sorted(zlib.crc32(word.encode()) for word in ("road", "struck")), np.uint32)
    codes = np.array([zlib.crc32(b"struck"), zlib.crc32(b"secret"), FIRST_VEHICLE], np.uint32)
    found = rows(codes, words).tolist()
    assert found[0] in (FIRST_WORD, FIRST_WORD + 1)
    assert found[1:] == [UNKNOWN, FIRST_VEHICLE]
    assert rows(codes, words[:0]).tolist() == [UNKNOWN, UNKNOWN, FIRST_VEHICLE]
