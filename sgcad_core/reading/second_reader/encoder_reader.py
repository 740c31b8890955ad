"""An encoder that reads a whole numbered report and gives every answer to a question a probability, in numpy.

A transformer's encoder with pre-norm layers (Vaswani et al. 2017, "Attention is all you need"; Xiong et al. 2020)
behind one convolution over three tokens. A report is read once. Per vehicle, attention with a learned query a kind of
question (Lee et al. 2019, "Set transformer": pooling by attention) gathers what is said of it: every token is marked by
whether it is that vehicle or another one, and whether its sentence is about that vehicle or another one. The weights
(`encoder.npz`, made by `python -m research.training.readers.train_encoder_reader POOL`) hold hashes of words, no words,
and the judges' figures of the kinds in which the encoder is heard
(`sgcad_core.reading.second_reader.numbered.numbered_reader`).
Knows no torch and no model server.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.reading.second_reader.encoder_tokens import (
    FIRST_VEHICLE,
    FIRST_WAY,
    Codes,
    Narrative,
    Rows,
    rows,
    vehicle_number,
)
from sgcad_core.reading.second_reader.field_claims import kind_of
from sgcad_core.reading.second_reader.learned_reader import keep, opened
from sgcad_core.records.second_reader import ENCODER_WEIGHTS

WHOLE_MARK = 9
"""Mark of every token where a question is about no vehicle."""
_NORM_EPS = 1e-5
Floats = NDArray[np.float32]


class Judge(NamedTuple):
    """Figures of a judge that hears three readers."""

    change: tuple[float, ...]
    keep: tuple[float, ...]


class Encoder(NamedTuple):
    """All that was learned: arrays by torch's names, word hashes (sorted), answers and judges by kind of question."""

    arrays: Mapping[str, Floats]
    words: Codes
    values: Mapping[str, tuple[str, ...]]
    judges: Mapping[str, Judge]
    heads: int

    def linear(self, name: str, x: Floats) -> Floats:
        """A layer's product, with its bias where it has one."""
        found: Floats = x @ self.arrays[f"{name}.weight"].T
        return found + self.arrays[f"{name}.bias"] if f"{name}.bias" in self.arrays else found

    def norm(self, name: str, x: Floats) -> Floats:
        """Layer normalisation over the last axis (Ba et al. 2016)."""
        even = (x - x.mean(-1, keepdims=True)) / np.sqrt(x.var(-1, keepdims=True) + np.float32(_NORM_EPS))
        found: Floats = even * self.arrays[f"{name}.weight"] + self.arrays[f"{name}.bias"]
        return found

    def by_head(self, x: Floats) -> Floats:
        """(..., tokens, width) -> (..., heads, tokens, width of a head)."""
        return np.swapaxes(x.reshape(*x.shape[:-1], self.heads, -1), -3, -2)

    def vehicles(self, name: str) -> Floats:
        """(vehicles + 1, width) what a layer makes of the words that name vehicles; zeros for none."""
        made = self.linear(name, self.arrays["emb.weight"][FIRST_VEHICLE:FIRST_WAY])
        return np.concatenate([np.zeros_like(made[:1]), made])


# ------------------------------------------------------------------ read
def answers(encoder: Encoder, told: Narrative, fields: Iterable[str]) -> dict[str, Floats]:
    """The probability of every answer (`encoder.values`) to some questions; nothing of an empty report."""
    if not len(told.codes):
        return {}
    ids = rows(told.codes, encoder.words)
    seen = encoded(encoder, ids, told)
    kinds = tuple(encoder.values)
    keys, contents = encoder.linear("k", seen), encoder.linear("v", seen)
    pooled: dict[int, Floats] = {}

    def about(vehicle: int) -> Floats:
        if vehicle not in pooled:
            pooled[vehicle] = _pooled(encoder, keys, contents, marks(ids, told.subjects, vehicle), vehicle)
        return pooled[vehicle]

    found = {}
    for field in fields:
        if (kind := kind_of(field)) in encoder.values:
            row = kinds.index(kind)
            whom = (1, 2) if kind == "turned" else (vehicle_number(field.partition(".")[2]),)
            gathered = np.concatenate([about(vehicle)[row] for vehicle in whom])
            found[field] = _softmax(encoder.linear(f"down.{kind}", _gelu(encoder.linear(f"up.{kind}", gathered))))
    return found


def encoded(encoder: Encoder, ids: Rows, told: Narrative) -> Floats:
    """(tokens, width) what the encoder makes of a report's tokens."""
    arrays = encoder.arrays
    x = arrays["emb.weight"][ids] + arrays["pos.weight"][: len(ids)] + arrays["sent.weight"][told.sentences]
    x = x + encoder.vehicles("subj")[told.subjects]
    x = x + _gelu(_convolved(x, arrays["conv.weight"], arrays["conv.bias"]))
    layer = 0
    while f"layers.{layer}.qkv.weight" in arrays:
        x = _layer(encoder, f"layers.{layer}", x)
        layer += 1
    return encoder.norm("norm", x)


def _convolved(x: Floats, weight: Floats, bias: Floats) -> Floats:
    """A convolution over a token and its two neighbors; weight: (out, in, 3)."""
    wide = np.pad(x, ((1, 1), (0, 0)))
    found: Floats = sum((wide[i : i + len(x)] @ weight[:, :, i].T for i in range(3)), start=bias)
    return found


def _layer(encoder: Encoder, name: str, x: Floats) -> Floats:
    query, key, value = np.split(encoder.linear(f"{name}.qkv", encoder.norm(f"{name}.n1", x)), 3, axis=-1)
    mixed = _attention(*map(encoder.by_head, (query, key, value)))
    x = x + encoder.linear(f"{name}.out", np.swapaxes(mixed, -3, -2).reshape(x.shape))
    wide = _gelu(encoder.linear(f"{name}.up", encoder.norm(f"{name}.n2", x)))
    return x + encoder.linear(f"{name}.down", wide)


def _attention(query: Floats, key: Floats, value: Floats) -> Floats:
    """(heads, queries, width of a head): values by the softmax of scaled products."""
    found: Floats = _softmax(query @ np.swapaxes(key, -1, -2) / np.float32(np.sqrt(query.shape[-1]))) @ value
    return found


def _pooled(encoder: Encoder, keys: Floats, contents: Floats, marked: Rows, vehicle: int) -> Floats:
    """(kinds, width) what is said of a vehicle, or of the whole (0), for every kind of question."""
    arrays = encoder.arrays
    query = arrays["query.weight"] + encoder.vehicles("query_veh")[vehicle]
    key, value = keys + arrays["mark_k.weight"][marked], contents + arrays["mark_v.weight"][marked]
    return np.swapaxes(_attention(*map(encoder.by_head, (query, key, value))), -3, -2).reshape(query.shape)


def marks(ids: Rows, subjects: Rows, vehicle: int) -> Rows:
    """A mark for every token: 3 * (1 this vehicle, 2 another one, 0 neither) + the same of its sentence's subject."""
    if not vehicle:
        return np.full(len(ids), WHOLE_MARK)
    names = (ids >= FIRST_VEHICLE) & (ids < FIRST_WAY)
    own = np.where(ids == FIRST_VEHICLE + vehicle - 1, 1, np.where(names, 2, 0))
    return 3 * own + np.where(subjects == vehicle, 1, np.where(subjects > 0, 2, 0))


def _gelu(x: Floats) -> Floats:
    """Gaussian error linear units, by the tanh form of Hendrycks and Gimpel (2016)."""
    found: Floats = 0.5 * x * (1 + np.tanh(np.float32(np.sqrt(2 / np.pi)) * (x + np.float32(0.044715) * x * x * x)))
    return found


def _softmax(scores: Floats) -> Floats:
    powers: Floats = np.exp(scores - scores.max(-1, keepdims=True))
    shares: Floats = powers / powers.sum(-1, keepdims=True)
    return shares


# ------------------------------------------------------------------ kept
def save(encoder: Encoder, file: Path) -> None:
    """Weights as 16-bit floats; the judges' figures as they are."""
    arrays: dict[str, Any] = {name: array.astype(np.float16) for name, array in encoder.arrays.items()}
    judges = {kind: one._asdict() for kind, one in encoder.judges.items()}
    keep({"values": encoder.values, "judges": judges, "heads": encoder.heads}, arrays | {"words": encoder.words}, file)


@lru_cache(maxsize=2)
def load(file: Path = ENCODER_WEIGHTS) -> Encoder:
    """The weights of a file. Raises ConfigError where it is missing or holds something else."""
    trainer = "python -m research.training.readers.train_encoder_reader POOL"
    return opened(file, "encoder of numbered reports", "the encoder of numbered reports", trainer, _encoder)


def _encoder(about: Any, arrays: dict[str, Any]) -> Encoder:
    weights = {name: one.astype(np.float32) for name, one in arrays.items() if name not in ("about", "words")}
    judges = {kind: Judge(tuple(one["change"]), tuple(one["keep"])) for kind, one in about["judges"].items()}
    values = {kind: tuple(answers) for kind, answers in about["values"].items()}
    return Encoder(weights, arrays["words"], values, judges, int(about["heads"]))
