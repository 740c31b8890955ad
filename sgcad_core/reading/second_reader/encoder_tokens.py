"""A numbered report as numbers for an encoder: every token of its sentences, and the vehicle that a sentence is about.

A vehicle, a compass point and a number have a code of their own, a word is the CRC-32 of its letters, so that what is
kept of a narrative holds no word. Knows no weights.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from sgcad_core.reading.second_reader.learned_reader_features import Account
from sgcad_core.reading.second_reader.numbered.numbered_words import FEW, Said, Token, said_of
from sgcad_core.reading.text.compass import COMPASS
from sgcad_core.records.specs import Compass

PAD, HIDDEN, UNKNOWN = 0, 1, 2
VEHICLES = 6
"""Vehicles that are told apart; a later number is the last one."""
FIRST_VEHICLE = 3
FIRST_WAY = FIRST_VEHICLE + VEHICLES
FIRST_NUMBER = FIRST_WAY + len(COMPASS)
MANY = FIRST_NUMBER + FEW
"""The code of all numbers that count no lanes."""
FIRST_WORD = MANY + 1
LONGEST, SENTENCES = 320, 24
"""Tokens that are seen of a report, and sentences that are told apart."""
Codes = NDArray[np.uint32]
Rows = NDArray[np.int64]


class Narrative(NamedTuple):
    """Of every token its code, the vehicle that its sentence is about (0: none), and the sentence's place."""

    codes: Codes
    subjects: Rows
    sentences: Rows


def narrative_of(account: Account) -> Narrative:
    """A report in codes."""
    return coded(said_of(account.statements))


def coded(said: Sequence[Said]) -> Narrative:
    """Sentences in codes."""
    found = [
        (_code(token), vehicle_number(one.subject), min(place, SENTENCES - 1))
        for place, one in enumerate(said)
        for token in one.tokens
    ][:LONGEST]
    codes, subjects, sentences = zip(*found, strict=True) if found else ((), (), ())
    return Narrative(*(np.array(codes, np.uint32), np.array(subjects, np.int64), np.array(sentences, np.int64)))


def vehicle_number(name: str | None) -> int:
    """1 for V1 up to `VEHICLES`; 0 for whatever is no numbered vehicle."""
    return min(int(name[1:]), VEHICLES) if name and name[0] == "V" and name[1:].isdigit() else 0


@lru_cache(maxsize=20_000)
def _code(token: Token) -> int:
    if token.kind == "vehicle":
        return FIRST_VEHICLE + max(vehicle_number(token.text), 1) - 1
    if token.kind == "compass":
        return FIRST_WAY + COMPASS.index(cast("Compass", token.text))
    if token.kind == "number":
        return FIRST_NUMBER + int(token.text) if int(token.text) < FEW else MANY
    return max(zlib.crc32(token.text.encode()), FIRST_WORD)


def rows(codes: Codes, words: Codes) -> Rows:
    """Of every code its row in a table of codes that are no words, and then of words (sorted)."""
    at = np.minimum(np.searchsorted(words, codes), max(0, len(words) - 1))
    known = words[at] == codes if len(words) else np.zeros(len(codes), bool)
    return np.where(codes < FIRST_WORD, codes.astype(np.int64), np.where(known, at + FIRST_WORD, UNKNOWN))
