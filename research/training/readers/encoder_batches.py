"""Batches for the encoder of numbered reports: questions beside tokens, words hidden, numbers and directions changed.

Vehicles are renumbered and the compass is turned at random, since neither changes an answer; and words are hidden,
which the encoder is to tell.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from research.rows.narrative_rows import Case
from research.training.readers.encoder_net import Batch
from sgcad_core.reading.second_reader.encoder_tokens import (
    FIRST_NUMBER,
    FIRST_VEHICLE,
    FIRST_WAY,
    FIRST_WORD,
    HIDDEN,
    LONGEST,
    VEHICLES,
    Codes,
    rows,
    vehicle_number,
)
from sgcad_core.reading.second_reader.field_claims import kind_of

BATCH, CHUNK = 32, 40
"""Reports of a batch; batches between which reports are sorted by length."""
RENUMBERED = 0.6
"""Share of the reports whose vehicles are renumbered."""
AS_IT_IS, ANOTHER = 0.08, 0.07
"""Of the words to be told, the share that is not hidden, and that of those replaced by another one."""
Ints = NDArray[np.int64]


class Asked(NamedTuple):
    """A question: its kind, the vehicles it is about (0: the whole), and which answers are to be taught."""

    kind: str
    vehicles: tuple[int, ...]
    may: NDArray[np.bool_]


class Prepared(NamedTuple):
    """A report as rows of tables, with its questions."""

    ids: Ints
    subjects: Ints
    sentences: Ints
    asked: tuple[Asked, ...]


class Lesson(NamedTuple):
    """A batch with its questions by kind (places of their vehicles in it, answers) and the hidden words."""

    batch: Batch
    asked: Mapping[str, tuple[torch.Tensor, torch.Tensor]]
    hidden: torch.Tensor
    words: torch.Tensor


def prepared(case: Case, words: Codes, values: Mapping[str, Sequence[str]]) -> Prepared:
    """A case in rows of tables."""
    asked = []
    for one in case.rows:
        kind = kind_of(one.field)
        of = (1, 2) if kind == "turned" else (vehicle_number(one.field.partition(".")[2]),)
        asked.append(Asked(kind, of, np.array([value in one.target for value in values[kind]])))
    told = case.told
    return Prepared(
        rows(told.codes, words), told.subjects, told.sentences, tuple(one for one in asked if one.may.any())
    )


def batches(cases: Sequence[Prepared], draw: np.random.Generator) -> Iterator[list[Prepared]]:
    """All cases once, those of about one length together."""
    order, found = draw.permutation(len(cases)), []
    for begin in range(0, len(order), BATCH * CHUNK):
        chunk = sorted(order[begin : begin + BATCH * CHUNK], key=lambda at: len(cases[at].ids))
        found += [chunk[at : at + BATCH] for at in range(0, len(chunk), BATCH)]
    for at in draw.permutation(len(found)):
        yield [cases[one] for one in found[at]]


def lesson(some: Sequence[Prepared], words: int, hide: float, draw: np.random.Generator | None = None) -> Lesson:
    """A batch; with `draw` changed at random, and so many words hidden (`hide`, a share)."""
    shape = len(some), min(LONGEST, max(len(one.ids) for one in some))
    ids, subjects, sentences = (np.zeros(shape, np.int64) for _ in range(3))
    places: dict[tuple[int, int], int] = {}
    asked: dict[str, list[tuple[list[int], NDArray[np.bool_]]]] = {}
    for row, one in enumerate(some):
        number = renumbered(draw)
        size = len(one.ids)
        ids[row, :size] = one.ids if draw is None else changed(one.ids, number, int(draw.integers(8)))
        subjects[row, :size], sentences[row, :size] = number[one.subjects], one.sentences
        for kind, vehicles, may in one.asked:
            of = [places.setdefault((row, int(number[vehicle])), len(places)) for vehicle in vehicles]
            asked.setdefault(kind, []).append((of, may))
    keep = np.arange(shape[1]) < np.array([[len(one.ids)] for one in some])
    shown, hidden = (ids, np.zeros(shape, bool)) if draw is None else hid(ids, words, hide, draw)
    tensors = (torch.from_numpy(one) for one in (shown, subjects, sentences, keep))
    batch = Batch(*tensors, *torch.tensor(list(places)).reshape(-1, 2).T)
    questions = {kind: _stacked(found) for kind, found in asked.items()}
    return Lesson(batch, questions, torch.from_numpy(hidden), torch.from_numpy(ids[hidden]))


def _stacked(found: Sequence[tuple[list[int], NDArray[np.bool_]]]) -> tuple[torch.Tensor, torch.Tensor]:
    return torch.tensor([of for of, _ in found]), torch.from_numpy(np.array([may for _, may in found]))


def renumbered(draw: np.random.Generator | None) -> Ints:
    """Each vehicle's new number; 0 stays."""
    numbers = np.arange(VEHICLES + 1)
    if draw is not None and draw.random() < RENUMBERED:
        numbers[1:] = 1 + draw.permutation(VEHICLES)
    return numbers


def changed(ids: Ints, number: Ints, turns: int) -> Ints:
    """Tokens with other numbers for vehicles, and the compass turned by eighths."""
    found = ids.copy()
    names, ways = (ids >= FIRST_VEHICLE) & (ids < FIRST_WAY), (ids >= FIRST_WAY) & (ids < FIRST_NUMBER)
    found[names] = FIRST_VEHICLE - 1 + number[ids[names] - FIRST_VEHICLE + 1]
    found[ways] = FIRST_WAY + (ids[ways] - FIRST_WAY + turns) % (FIRST_NUMBER - FIRST_WAY)
    return found


def hid(ids: Ints, words: int, hide: float, draw: np.random.Generator) -> tuple[Ints, NDArray[np.bool_]]:
    """Tokens with some hidden, and which are to be told; vehicles, directions and numbers less often."""
    share = np.select([ids >= FIRST_WORD, ids >= FIRST_WAY, ids >= FIRST_VEHICLE], [hide, hide / 4, hide / 3], 0.0)
    told = draw.random(ids.shape) < share
    how = draw.random(ids.shape)
    other = draw.integers(FIRST_WORD - 1, words, ids.shape)
    shown = np.where(how < AS_IT_IS, ids, np.where(how < AS_IT_IS + ANOTHER, other, HIDDEN))
    return np.where(told, shown, ids), told
