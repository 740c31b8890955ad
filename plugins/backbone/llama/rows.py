"""Rows in llama.cpp: the token loop's `Rows`, with kept beginnings as sequences that share their cells.

A row is a sequence of the library's memory; a kept beginning is a sequence that is not written to. Where the memory is
full the oldest kept one goes first. A picture's tokens may take up fewer positions than there are. Knows no decoder
and no grammar.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
import torch

from plugins.backbone.engine.prefix import SHORTEST, Key, common, prompt_key
from plugins.backbone.engine.records import Prompt
from plugins.backbone.llama.library import Fed, OutOfCells, Session
from plugins.backbone.llama.pictures import Span, spans
from plugins.backbone.llama.projector import Projector

T = TypeVar("T")
KEPT = 4
"""Kept beginnings: every cell in use costs each token some time, so there are few."""


@dataclass(eq=False)
class Row:
    """A prompt and what was fed behind it, in a sequence; `length` tokens are held."""

    prompt: Prompt
    sequence: int
    key: Key = field(init=False)
    spans: list[Span] = field(init=False)
    length: int = 0
    reused: int = 0
    sound: bool = True

    def __post_init__(self) -> None:
        self.spans = spans(self.prompt)
        places, digests = [(one.start, one.end) for one in self.spans], [one.picture.digest for one in self.spans]
        self.key = prompt_key(self.prompt.ids, places, digests)

    def at(self, length: int) -> int:
        """The position behind the first `length` tokens, which end within no picture."""
        return length - sum(one.saved for one in self.spans if one.end <= length)

    def whole(self, length: int) -> int:
        """The length without the picture that it would cut in two."""
        return min([length, *(one.start for one in self.spans if one.start < length < one.end)])


@dataclass(eq=False)
class _Kept:
    sequence: int
    key: Key


@dataclass
class LlamaRows:
    """The open rows and the kept beginnings of one session. `window`: tokens of a prompt and its answer."""

    session: Session
    window: int
    rows_at_once: int
    projector: Projector | None = None
    calls: int = 0
    states: dict[int, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.rows: list[Row] = []
        self.kept: list[_Kept] = []
        self.free = list(range(self.rows_at_once + KEPT))

    @classmethod
    def of(cls, session: Session, window: int, reports: int, projector: Projector | None) -> LlamaRows:
        """Rows for that many reports at once, two each, in a session of `cells` and `sequences`."""
        return cls(session, window, 2 * reports, projector)

    @property
    def vocabulary(self) -> int:
        """Tokens that a row of logits tells."""
        return self.session.model.vocabulary

    @property
    def computed_in(self) -> str:
        """The file's architecture, size and packing."""
        return f"{self.session.model.described} by llama.cpp"

    def open(self, prompt: Prompt, behind: Sequence[int] = ()) -> Row:
        """Opens a row and fills it up to the last token. Raises OutOfCells."""
        row = Row(prompt, self._free_sequence())
        self.rows.append(row)
        known = [*prompt.ids, *behind][:-1]
        try:
            self._reuse(row, len(known))
            self._fill(row, known)
        except Exception:
            row.sound = False
            self.close(row)
            raise
        return row

    def step(self, chunks: Sequence[tuple[Row, Sequence[int]]]) -> list[torch.Tensor]:
        """Feeds tokens to rows in one call; what stood behind a row's length is forgotten first."""
        for row, _ in chunks:
            self.session.cut(row.sequence, row.at(row.length))
        told = self._decode([Fed(row.sequence, row.at(row.length), tokens, told=True) for row, tokens in chunks])
        return [torch.from_numpy(logits) for logits in told]

    def keep(self, row: Row, behind: Sequence[int]) -> None:
        """Lets the row's kept beginning reach over the tokens behind its prompt."""
        row.key = np.concatenate([row.key, np.asarray(behind, dtype=np.int64)])

    def close(self, row: Row) -> None:
        """Ends a row; its sequence stays as a kept beginning if it is sound and long enough."""
        self.rows.remove(row)
        key = row.key[: row.length]
        if not row.sound or len(key) < SHORTEST or any(common(one.key, key) == len(key) for one in self.kept):
            self._release(row.sequence)
            return
        self.session.cut(row.sequence, row.at(len(key)))
        for one in [one for one in self.kept if common(one.key, key) == len(one.key)]:
            self._drop(one)
        self.kept.append(_Kept(row.sequence, key))
        if len(self.kept) > KEPT:
            self._drop(self.kept[0])

    def forget(self) -> None:
        """Discards every kept beginning."""
        for one in list(self.kept):
            self._drop(one)

    def clear(self, row: Row) -> None:
        """The row's cells are not kept: no other sequence reads them."""
        row.sound = False

    def reset(self) -> None:
        """Discards everything."""
        self.session.clear()
        self.__post_init__()

    def _reuse(self, row: Row, limit: int) -> None:
        """Shares the longest beginning that a kept or an open row holds."""
        held = [(one.sequence, one.key) for one in self.kept]
        held += [(one.sequence, one.key[: one.length]) for one in self.rows if one is not row and one.sound]
        shared = [(min(common(key, row.key), limit), sequence) for sequence, key in held]
        length, source = max(shared, default=(0, 0))
        length = row.whole(length)
        if length >= SHORTEST:
            self.session.copy(source, row.sequence, row.at(length))
            row.length = row.reused = length
            self.kept.sort(key=lambda one: one.sequence == source)  # the one in use goes last

    def _fill(self, row: Row, known: Sequence[int]) -> None:
        """Feeds a row's tokens and pictures up to the last known one."""
        for one in [one for one in row.spans if one.start >= row.length]:
            self._feed(row, known[row.length : one.start])
            self._show(row, one)
        self._feed(row, known[row.length :])

    def _feed(self, row: Row, tokens: Sequence[int]) -> None:
        if tokens:
            self._decode([Fed(row.sequence, row.at(row.length), tokens, told=False)])
            row.length += len(tokens)

    def _show(self, row: Row, one: Span) -> None:
        assert self.projector is not None  # noqa: S101 -- only its prompts have pictures
        projector, place = self.projector, row.at(row.length)
        self._with_room(
            lambda: projector.show(self.session, one.shown, one.picture.digest, row.sequence, place),
            lambda: self.session.cut(row.sequence, place),
        )
        row.length = one.end

    def _decode(self, fed: Sequence[Fed]) -> list[Any]:
        def undo() -> None:
            for one in fed:
                self.session.cut(one.sequence, one.position)

        return list(self._with_room(lambda: self.session.decode(fed), undo))

    def _with_room(self, work: Callable[[], T], undo: Callable[[], None]) -> T:
        """Does some work; while the memory is full, drops the oldest kept beginning and does it again."""
        while True:
            try:
                self.calls += 1
                return work()
            except OutOfCells:
                if not self.kept:
                    raise
                self._drop(self.kept[0])
                undo()

    def _free_sequence(self) -> int:
        if not self.free:
            self._drop(self.kept[0])
        return self.free.pop()

    def _drop(self, one: _Kept) -> None:
        self.kept.remove(one)
        self._release(one.sequence)

    def _release(self, sequence: int) -> None:
        self.session.cut(sequence, 0)
        self.free.append(sequence)


def sequences(reports: int) -> int:
    """Sequences of the library's memory: two rows a report, and kept beginnings."""
    return 2 * reports + KEPT


def cells(window: int, reports: int) -> int:
    """Tokens of keys and values for that many reports: two rows each."""
    return 2 * reports * window
