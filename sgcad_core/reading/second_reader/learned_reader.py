"""A second reader that learned from coded reports where the rules err: two linear readers and one small judge a field.

One reader sees the words and what the rules made of them, the other one the words alone. Both give every value of a
field a probability (multinomial logistic regression over features of
`sgcad_core.reading.second_reader.learned_reader_features`). Beside the rules' value stands the likeliest other one;
that it is right where only one of both is has the probability

    sigmoid(change . (1, log ratio of the first reader, log ratio of the second, 1 if the text tells the rules' value))

and the rules' own value is right with sigmoid(keep . (1, logit of the first reader, logit of the second)). Of a text in
which too few runs of words are known nothing is said: it is of another sort than those learned from. The weights
(`learned.npz`, made by `python -m research.training.readers.train_learned_reader`) hold hashes of
features, no words. Knows no model server.
"""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from sgcad_core.errors import ConfigError
from sgcad_core.reading.second_reader.learned_reader_features import Account, account_of, readings, runs, words
from sgcad_core.reading.second_reader.seven_question_gist import alike, shown_alike
from sgcad_core.records.second_reader import LEARNED, WEIGHTS, Heard, Opinion, Value, Weights

WORDS_NORM, READING_WEIGHT = 10.0, 2.0
"""Length of the vector of a text's words; what each thing that the rules say counts."""
_EDGE = 1e-4
_TAKEN_AS_IT_IS = Weights(differ=0.0, slope=1.0, told=0.0, agree=None)
Floats = NDArray[np.float64]
T = TypeVar("T")


class Field(NamedTuple):
    """One field's readers: values, weights (features, values) of words and readings, and the judge's figures."""

    values: tuple[Value, ...]
    words: Floats
    readings: Floats
    bias: Floats
    words_alone: Floats
    bias_alone: Floats
    change: tuple[float, ...]
    keep: tuple[float, ...]


class Learned(NamedTuple):
    """All that was learned; hashes are sorted."""

    word_hashes: NDArray[np.uint32]
    reading_hashes: NDArray[np.uint32]
    fields: Mapping[str, Field]
    takes: float
    """Probability from which on another value is taken in the rules' place."""
    least_known: float
    """Share of a text's runs of words that must be known."""


class Contest(NamedTuple):
    """The likeliest other value beside the rules', and what the judge goes by."""

    other: Value
    change: tuple[float, ...]
    keep: tuple[float, ...]


def hashed(features: Iterable[str]) -> NDArray[np.uint32]:
    """Features as sorted 32-bit numbers."""
    return np.array(sorted({zlib.crc32(one.encode()) for one in features}), dtype=np.uint32)


def known(features: Iterable[str], hashes: NDArray[np.uint32]) -> NDArray[np.int64]:
    """Rows of those features that were learned."""
    asked = hashed(features)
    at = np.searchsorted(hashes, asked)
    at[at == len(hashes)] = 0
    return at[hashes[at] == asked] if len(hashes) else at[:0]


def contest(values: Sequence[Value], both: Floats, alone: Floats, rule: Value, told: bool) -> Contest | None:
    """Of two readers' probabilities of all values; None where no other value is known. What may come to the same motion
    as the rules' value is no other one."""
    others = [value for value in values if not shown_alike(value, rule)]
    if not others:
        return None
    mass = {value: _mass(values, both, alone, value) for value in others}
    best = max(others, key=lambda value: sum(map(_logit, mass[value])))
    members = [i for i, value in enumerate(values) if alike(value, best)]
    other = values[max(members, key=lambda i: both[i] * alone[i])]
    shown = [i for i, value in enumerate(values) if shown_alike(value, rule)]
    own = float(both[shown].sum()), float(alone[shown].sum())
    ratios = tuple(math.log(max(a, _EDGE) / max(b, _EDGE)) for a, b in zip(mass[best], own, strict=True))
    return Contest(other, (1.0, *ratios, float(told)), (1.0, *map(_logit, own)))


def _mass(values: Sequence[Value], both: Floats, alone: Floats, value: Value) -> tuple[float, float]:
    """What each reader gives to a value and those that mean the same."""
    same = [i for i, one in enumerate(values) if alike(one, value)]
    return float(both[same].sum()), float(alone[same].sum())


def _logit(p: float) -> float:
    p = min(max(p, _EDGE), 1 - _EDGE)
    return math.log(p / (1 - p))


def probability(figures: Sequence[float], of: Sequence[float]) -> float:
    """The logistic function of a judge's figures and what it goes by."""
    return 1 / (1 + math.exp(-sum(a * b for a, b in zip(figures, of, strict=True))))


# ------------------------------------------------------------------ asked
def opinion(narrative: str, learned: Learned | None = None) -> Opinion | None:
    """The opinion on a narrative; None for numbered reports and texts of another sort."""
    account = account_of(narrative)
    learned = learned or load()
    said = words(account)
    asked = runs(said)
    foreign = len(known(asked, learned.word_hashes)) < learned.least_known * max(1, len(asked))
    if foreign or not account.reading.crash.unnumbered:
        return None
    at = known(said, learned.word_hashes), known(readings(account), learned.reading_hashes)
    heard = {key: one for key, field in learned.fields.items() if (one := _heard(account, key, field, at, learned))}
    return Opinion(heard=heard, weights=dict.fromkeys(heard, _TAKEN_AS_IT_IS), takes=learned.takes)


def _heard(account: Account, key: str, field: Field, at: tuple[Any, Any], learned: Learned) -> Heard | None:
    """The other value where it is taken, else the rules' own with how sure that is."""
    rule = account.say.values.get(key)
    both, alone = probabilities(field, *at)
    if rule is None or (found := contest(field.values, both, alone, rule, key in account.say.told)) is None:
        return None
    p = probability(field.change, found.change)
    if p >= learned.takes:
        return Heard(value=found.other, p=p)
    return Heard(value=rule, p=probability(field.keep, found.keep))


def probabilities(field: Field, words_at: NDArray[np.int64], readings_at: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """What both readers give to every value, by the rows of the features that are there."""
    scale = WORDS_NORM / math.sqrt(max(1, len(words_at)))
    seen = scale * field.words[words_at].sum(0) + READING_WEIGHT * field.readings[readings_at].sum(0) + field.bias
    return _softmax(seen), _softmax(scale * field.words_alone[words_at].sum(0) + field.bias_alone)


def _softmax(scores: Floats) -> Floats:
    powers: Floats = np.exp(scores - scores.max())
    shares: Floats = powers / powers.sum()
    return shares


# ------------------------------------------------------------------ kept
_ARRAYS = ("words", "readings", "bias", "words_alone", "bias_alone")


def save(learned: Learned, file: Path) -> None:
    """Weights as 8-bit numbers with one scale a value; biases and the judge's figures as they are."""
    arrays: dict[str, Any] = {"word_hashes": learned.word_hashes, "reading_hashes": learned.reading_hashes}
    about: dict[str, Any] = {"takes": learned.takes, "least_known": learned.least_known, "fields": {}}
    for key, field in learned.fields.items():
        arrays |= arrays_of(key, field)
        about["fields"][key] = {"values": field.values, "change": field.change, "keep": field.keep}
    keep(about, arrays, file)


def keep(about: Mapping[str, Any], arrays: Mapping[str, Any], file: Path) -> None:
    """Write a file of weights: arrays by name, and what JSON holds of them."""
    np.savez_compressed(file, about=np.frombuffer(json.dumps(about).encode(), dtype=np.uint8), **arrays)


def opened(file: Path, reader: str, wanted_by: str, trainer: str, build: Callable[[Any, dict[str, Any]], T]) -> T:
    """What `build` makes of a kept file's JSON and arrays. Raises ConfigError where it is missing or something else."""
    remedy = f"make it with `{trainer}`"
    if not file.is_file():
        raise ConfigError(f"{wanted_by}: its file of weights {file} is missing; {remedy}")
    try:
        with np.load(file) as kept:
            arrays = dict(kept)
        return build(json.loads(arrays["about"].tobytes()), arrays)
    except (ValueError, KeyError, TypeError, OSError) as fault:
        raise ConfigError(f"{file}: is not a file of weights for the {reader} ({fault}); {remedy}") from fault


def arrays_of(key: str, field: Field) -> dict[str, Any]:
    """A field's weights as 8-bit numbers, by names that begin with its key."""
    arrays: dict[str, Any] = {}
    for name in _ARRAYS:
        arrays |= _packed(f"{key}.{name}", getattr(field, name))
    return arrays


def _packed(name: str, values: Floats) -> dict[str, Any]:
    if values.ndim == 1:
        return {name: values.astype(np.float32)}
    scale = np.maximum(np.abs(values).max(0), 1e-9) / 127
    return {name: np.round(values / scale).astype(np.int8), f"{name}.scale": scale.astype(np.float32)}


@lru_cache(maxsize=2)
def load(file: Path = WEIGHTS) -> Learned:
    """The weights of a file. Raises ConfigError where it is missing or holds something else."""
    return opened(
        file,
        "learned reader",
        f"second_opinion {LEARNED!r}",
        "python -m research.training.readers.train_learned_reader",
        _learned,
    )


def _learned(about: Any, arrays: dict[str, Any]) -> Learned:
    fields = {key: field_of(arrays, key, one) for key, one in about["fields"].items()}
    hashes = arrays["word_hashes"], arrays["reading_hashes"]
    return Learned(*hashes, fields, float(about["takes"]), float(about["least_known"]))


def field_of(arrays: Mapping[str, Any], key: str, about: Mapping[str, Any]) -> Field:
    """A field's weights from the arrays of its key; `about`: its values and the judge's figures."""

    def weights(name: str) -> Floats:
        found: Floats = arrays[f"{key}.{name}"].astype(np.float64) * arrays.get(f"{key}.{name}.scale", 1.0)
        return found

    return Field(
        values=tuple(about["values"]), words=weights("words"), readings=weights("readings"), bias=weights("bias"),
        words_alone=weights("words_alone"), bias_alone=weights("bias_alone"),
        change=tuple(about["change"]), keep=tuple(about["keep"]),
    )  # fmt: skip
