"""A reader of numbered reports that learned from coded ones where the rules err: two linear readers and a judge a kind.

Of the kinds in which it adds to them an encoder that reads the whole report is heard, too
(`sgcad_core.reading.second_reader.encoder_reader`); their judges have one log ratio more.

Kinds of questions and their features are those of `sgcad_core.reading.second_reader.numbered.numbered_questions`,
readers and files those of `sgcad_core.reading.second_reader.learned_reader`: one reader sees the words and what the
rules made of them, the other one the words alone. Beside the rules' answer stands the likeliest other one; that it is
right where only one of both is has the probability

    sigmoid(change . (1, log ratio of the first reader, log ratio of the second, 1 if the text tells the rules' answer,
                      1 if it follows from what the text tells))

It is taken from `TAKES` on, against what the text tells from `TAKES_TOLD` on. Of a question too few of whose words are
known nothing is said: its text is of another sort than those learned from. The weights (`numbered.npz`, made by
`python -m research.training.readers.train_numbered_reader POOL`) hold hashes of features, no words. Knows
no model server.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.reading.second_reader import encoder_reader
from sgcad_core.reading.second_reader.encoder_reader import Encoder, Judge, answers
from sgcad_core.reading.second_reader.encoder_tokens import narrative_of
from sgcad_core.reading.second_reader.field_claims import kind_of
from sgcad_core.reading.second_reader.learned_reader import (
    Field,
    Floats,
    arrays_of,
    field_of,
    hashed,
    keep,
    known,
    opened,
    probabilities,
    probability,
)
from sgcad_core.reading.second_reader.learned_reader_features import account_of
from sgcad_core.reading.second_reader.numbered.numbered_answers import same
from sgcad_core.reading.second_reader.numbered.numbered_questions import Question, questions
from sgcad_core.records.second_reader import NUMBERED_WEIGHTS, Guess

TAKES, TAKES_TOLD = 0.6, 0.7
"""Probability from which on another answer is taken in the place of the rules' own, where no text tells that and where
one does."""
_EDGE = 1e-4


class Kind(NamedTuple):
    """What was learned of one kind of question; hashes are sorted."""

    word_hashes: NDArray[np.uint32]
    reading_hashes: NDArray[np.uint32]
    field: Field
    least_known: float = 0.0
    """Share of a question's words that must be known: of a text of another sort nothing is said."""

    def knows(self, words: NDArray[np.uint32]) -> float:
        """The share of a question's words that were learned."""
        return len(rows_at(words, self.word_hashes)) / max(1, len(words))


class Contest(NamedTuple):
    """The likeliest other answer beside the rules' own, and what the judge goes by."""

    other: str
    change: tuple[float, ...]
    keep: tuple[float, ...]


Learned = Mapping[str, Kind]


def contest(
    values: Sequence[str], shares: Sequence[Floats], own: str | None, told: float, may: Sequence[str] | None = None
) -> Contest | None:
    """Of some readers' probabilities of all answers; None where no other answer is known, or open (`may`)."""
    ours = [i for i, value in enumerate(values) if same(value, own)]
    others = [i for i, value in enumerate(values) if i not in ours and (may is None or value in may)]
    if not others:
        return None
    best = max(others, key=lambda i: sum(_logit(float(one[i])) for one in shares))
    mine = tuple(float(one[ours].sum()) for one in shares)
    ratios = (math.log(max(float(one[best]), _EDGE) / max(b, _EDGE)) for one, b in zip(shares, mine, strict=True))
    return Contest(values[best], (1.0, *ratios, float(told == 1.0), float(0 < told < 1)), (1.0, *map(_logit, mine)))


def _logit(p: float) -> float:
    p = min(max(float(p), _EDGE), 1 - _EDGE)
    return math.log(p / (1 - p))


def takes(told: float) -> float:
    """The probability that another answer needs."""
    return TAKES_TOLD if told == 1.0 else TAKES


# ------------------------------------------------------------------ asked
def guesses(narrative: str, learned: Learned | None = None, encoder: Encoder | None = None) -> Mapping[str, Guess]:
    """What the reader says of each question of a numbered report; nothing of others. Both None: with the shipped
    encoder."""
    if learned is None:
        learned, encoder = load(), encoder_reader.load() if encoder is None else encoder
    account = account_of(narrative)
    some = [one for one in questions(account) if kind_of(one.field) in learned]
    heard: Mapping[str, NDArray[np.float32]] = {}
    if encoder is not None and some:
        asked = [one.field for one in some if kind_of(one.field) in encoder.judges]
        heard = answers(encoder, narrative_of(account), asked)
    found = {}
    for one in some:
        third = heard.get(one.field)
        judge = encoder.judges[kind_of(one.field)] if encoder is not None and third is not None else None
        if (said := _guess(one, learned[kind_of(one.field)], third, judge)) is not None:
            found[one.field] = said
    return found


def _guess(one: Question, kind: Kind, third: NDArray[np.float32] | None, judge: Judge | None) -> Guess | None:
    words = hashed(one.words)
    if kind.knows(words) < kind.least_known:
        return None
    voices = (*shares(kind, words, hashed(one.readings)), *((third,) if third is not None else ()))
    values = tuple(map(str, kind.field.values))
    found = contest(values, voices, one.rule, one.told, one.may)
    if found is None:
        return None
    change, keeps = (kind.field.change, kind.field.keep) if judge is None else judge
    p = probability(change, found.change)
    taken = p >= takes(one.told)
    mean = np.prod(voices, axis=0) ** (1 / len(voices))
    odds = {value: round(float(share), 5) for value, share in zip(values, mean / mean.sum(), strict=True)}
    return Guess(
        value=found.other if taken else None, p=p if taken else probability(keeps, found.keep),
        shares=odds, sentence=_sentence(one, kind, values.index(found.other)) if taken else None,
    )  # fmt: skip


def shares(kind: Kind, words: NDArray[np.uint32], readings: NDArray[np.uint32]) -> tuple[Floats, Floats]:
    """What both readers give to every answer."""
    return probabilities(kind.field, rows_at(words, kind.word_hashes), rows_at(readings, kind.reading_hashes))


def rows_at(asked: NDArray[np.uint32], hashes: NDArray[np.uint32]) -> NDArray[np.int64]:
    """Rows of those hashes that were learned."""
    at = np.searchsorted(hashes, asked)
    at[at == len(hashes)] = 0
    return at[hashes[at] == asked] if len(hashes) else at[:0]


def _sentence(one: Question, kind: Kind, answer: int) -> int | None:
    """The sentence whose words speak most for an answer against the mean of all, by both readers."""

    def speaks(words: Iterable[str]) -> float:
        at = known(words, kind.word_hashes)
        weights = kind.field.words[at] + kind.field.words_alone[at]
        return float(weights[:, answer].sum() - weights.mean(1).sum())

    return max(one.sentences, key=lambda number: speaks(one.sentences[number]), default=None)


# ------------------------------------------------------------------ kept
def save(learned: Learned, file: Path) -> None:
    """Weights of all kinds in one file."""
    arrays: dict[str, Any] = {}
    about: dict[str, Any] = {}
    for name, kind in learned.items():
        arrays |= {f"{name}.word_hashes": kind.word_hashes, f"{name}.reading_hashes": kind.reading_hashes}
        arrays |= arrays_of(name, kind.field)
        about[name] = {"values": kind.field.values, "change": kind.field.change, "keep": kind.field.keep}
        about[name]["least_known"] = kind.least_known
    keep(about, arrays, file)


@lru_cache(maxsize=2)
def load(file: Path = NUMBERED_WEIGHTS) -> Learned:
    """The weights of a file. Raises ConfigError where it is missing or holds something else."""
    return opened(
        file,
        "numbered reader",
        "the numbered reader",
        "python -m research.training.readers.train_numbered_reader POOL",
        _kinds,
    )


def _kinds(about: Any, arrays: dict[str, Any]) -> Learned:
    return {name: _kind(arrays, name, one) for name, one in about.items()}


def _kind(arrays: Mapping[str, Any], name: str, about: Mapping[str, Any]) -> Kind:
    hashes = arrays[f"{name}.word_hashes"], arrays[f"{name}.reading_hashes"]
    return Kind(*hashes, field_of(arrays, name, about), float(about["least_known"]))
