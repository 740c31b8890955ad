"""One report while it is being answered: its rows, its place in the grammar, its tokens so far.

A job turns decided tokens into the next chunk to feed, and the model's result for the chunk into tokens. Knows no model
and no batch.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field

import numpy as np
import torch

from plugins.backbone.engine.faults import DoesNotFit
from plugins.backbone.engine.grammar import GrammarState, Mask
from plugins.backbone.engine.records import Answer, Request
from plugins.backbone.engine.runner import Row
from sgcad_core.asking.json_field_spans import open_path

_LONGEST_GUESS = 64
_SHORTEST_GUESS = 2
_CLUE = 3
"""How many tokens must agree before the place in the earlier answer counts as found."""


@dataclass
class ChunkResult:
    """The model's result for one chunk; position i is about the token after chunk[i].

    The first positions are about tokens that the chunk holds, the rest about picked ones. Log-probabilities in nats.
    """

    known_with: list[float]
    known_without: list[float]
    picked: list[int]
    picked_with: list[float]
    picked_without: list[float]
    best: Sequence[tuple[int, int]] = ()
    """The best token with and without context at every picked position; empty with one row."""
    states: Sequence[torch.Tensor] = ()
    """States of the first row with context at every position, (hidden,); empty unless the loop watches them."""


@dataclass(eq=False)
class Job:
    """A request and its state."""

    request: Request
    future: Future[Answer] = field(default_factory=Future)
    answer: Answer = field(default_factory=Answer)
    rows: list[Row] = field(default_factory=list)
    """With context, then without, if that row is run, then further views of the context."""
    pending: list[int] = field(default_factory=list)
    """Decided tokens that the rows have not been fed: the last of the prompt, or a picked one and forced ones."""
    guesses: list[int] = field(default_factory=list)
    taken: int = 0
    """How many of the guesses the grammar has taken, to be taken back."""
    place: int = 0
    """Which token of the answer is being drawn."""
    closing: bool = False
    """The answer is complete; its forced end is fed once more for its log-probabilities."""
    started: float = field(default_factory=time.perf_counter)
    track: GrammarState | None = None
    draft: Draft = field(init=False)
    generator: torch.Generator | None = None
    begun: bool = False
    alone: bool = False
    """True if it must be answered by itself, because a batch with it has failed."""

    def __post_init__(self) -> None:
        self.draft = Draft([token for token in self.request.draft if token not in self.request.eos])

    def is_cancelled(self) -> bool:
        """True, once, if the caller has cancelled; notifies waiters."""
        return self.future.cancelled() and not self.future.set_running_or_notify_cancel()

    def resolve(self, outcome: Answer | Exception) -> None:
        """Ends the caller's wait with an answer or a fault, unless the caller has cancelled."""
        if not self.future.set_running_or_notify_cancel():
            return
        if isinstance(outcome, Exception):
            self.future.set_exception(outcome)
        else:
            self.future.set_result(outcome)

    # ------------------------------------------------------------------ before the step
    def begin(self) -> None:
        """Starts, or goes on after memory ran out: the first step feeds the last known token."""
        if not self.begun:
            self.begun = True
            self.track = self.request.grammar.track() if self.request.grammar else None
            self.pending = [self.request.with_context.ids[-1]]
            self._force()
        else:
            first = len(self.answer.with_context)
            before = self.answer.ids[first - 1] if first else self.request.with_context.ids[-1]
            self.pending = [before, *self.answer.ids[first:]]

    def generator_at(self, place: int, device: torch.device) -> torch.Generator:
        """The random numbers of one place of the answer, on the device of its scores.

        Each place has its own, so that neither a draft nor the reports beside it change what is drawn.
        """
        if self.generator is None:
            self.generator = torch.Generator(device=device)
        mixed = hashlib.blake2b(f"{self.request.seed} {place}".encode(), digest_size=7).digest()
        return self.generator.manual_seed(int.from_bytes(mixed, "little"))

    def fed(self) -> list[int]:
        """Answer tokens that the rows hold when the job (re)starts, the last of them to be fed again."""
        return self.answer.ids[: len(self.answer.with_context)]

    def chunk(self, guess_limit: int) -> list[int]:
        """The next tokens to feed: decided ones, then guesses. A closing job leaves out its last token."""
        if self.closing:
            return self.pending[:-1]
        room = self.request.max_new_tokens - len(self.answer.ids) - 1
        self.guesses = self.draft.guess(min(guess_limit, room))
        return [*self.pending, *self.guesses]

    def masks(self, words: int) -> Mask | None:
        """Masks of the scored positions, cutting off guesses that the grammar forbids; None without a grammar."""
        if self.track is None or self.closing:
            return None
        rows = np.zeros((len(self.guesses) + 1, max(words, self.track.words)), np.int32)
        self.track.fill(rows[0])
        for token in self.guesses:
            if not self.track.take(token):
                break
            if self.track.done:
                self.track.back(1)
                break
            self.taken += 1
            self.track.fill(rows[self.taken])
        self.guesses = self.guesses[: self.taken]
        return rows[: self.taken + 1]

    def forget_guesses(self) -> None:
        """Removes the guesses from the grammar's state, as far as they were taken."""
        if self.track:
            self.track.back(self.taken)
        self.guesses, self.taken = [], 0

    # ------------------------------------------------------------------ after the step
    def take_result(self, result: ChunkResult, choices: Sequence[int]) -> None:
        """Takes the result for a chunk: notes log-probabilities, accepts tokens, adds forced ones.

        `choices` is the number of tokens that the grammar left at each scored position, empty without a grammar. Raises
        DoesNotFit at a dead end and if the limit of tokens is reached within a grammar.
        """
        known = len(result.known_with)
        self._note(result.known_with, result.known_without, result.states[:known])
        if self.closing:
            return self._finish()
        guesses = self.guesses
        right = next((i for i, (g, p) in enumerate(zip(guesses, result.picked, strict=False)) if g != p), len(guesses))
        fed = len(self.pending) + right
        if self.track:
            self.track.back(self.taken - right)
        self.guesses, self.taken = [], 0
        self.draft.judge(len(guesses), right)
        self.pending = []
        for i in range(right + 1):
            if choices and choices[i] == 0:
                raise DoesNotFit(f"no token may follow {self.text()[-60:]!r}", self.path())
            self._accept(result.picked[i], bool(choices) and choices[i] == 1)
            if result.best and result.best[i][0] != result.best[i][1]:
                self.answer.rivals[len(self.answer.ids) - 1] = result.best[i]
            one = slice(i, i + 1)
            self._note(result.picked_with[one], result.picked_without[one], result.states[known + i : known + i + 1])
            if i == right and not self._take(result.picked[i]):
                raise DoesNotFit(f"no token may follow {self.text()[-60:]!r}", self.path())
        for row in self.rows:
            row.length += fed
        self.pending = [result.picked[right]]
        return self._go_on()

    def text(self) -> str:
        """The answer so far; empty without a grammar, which alone knows the spelling."""
        return self.request.grammar.text(self.answer.ids) if self.request.grammar else ""

    def path(self) -> str:
        """JSON path of the field being written."""
        return open_path(self.text())

    @property
    def finished(self) -> bool:
        """The answer is complete."""
        return self.answer.seconds > 0.0

    def _take(self, token: int) -> bool:
        return token in self.request.eos or self.track is None or self.track.take(token)

    def _go_on(self) -> None:
        """Adds the forced tokens that follow, or ends the answer."""
        if self.answer.ids and self.answer.ids[-1] in self.request.eos:
            if self.track and not self.track.complete:
                raise DoesNotFit("the text that must follow is an end token of this tokenizer", self.path())
            answer = self.answer
            for kept in (answer.ids, answer.with_context, answer.without_context, answer.forced, answer.states):
                del kept[-1:]
            return self._finish()
        self._force()
        if self.track and self.track.done:
            self.closing = len(self.pending) > 1
            return None if self.closing else self._finish()
        if len(self.answer.ids) >= self.request.max_new_tokens:
            if self.track:
                limit = self.request.max_new_tokens
                raise DoesNotFit(f"the answer is not finished after {limit} tokens", self.path())
            self._finish(complete=False)
        return None

    def _force(self) -> None:
        if self.track and self.request.jump_forward and not self.track.done:
            for token in self.track.forced():
                self._accept(token, forced=True)
                self.pending.append(token)

    def _accept(self, token: int, forced: bool) -> None:
        self.answer.ids.append(token)
        self.answer.forced.append(forced)
        self.draft.note(token)

    def _note(
        self, with_context: Sequence[float], without_context: Sequence[float], states: Sequence[torch.Tensor]
    ) -> None:
        self.answer.with_context += with_context
        self.answer.without_context += without_context
        self.answer.states += states

    def _finish(self, complete: bool = True) -> None:
        self.answer.finished = complete
        self.answer.prompt_tokens = sum(len(row.prompt.ids) for row in self.rows)
        self.answer.reused_tokens = sum(row.reused for row in self.rows)
        self.answer.seconds = max(time.perf_counter() - self.started, 1e-9)


class Draft:
    """Guesses at the next tokens, taken from an earlier answer of which a repair repeats most.

    Guessed tokens are fed together and kept as far as the decoder picks the same ones: they change the speed and never
    the answer. Follows one place in the earlier answer.
    """

    def __init__(self, earlier: Sequence[int]) -> None:
        self.earlier = list(earlier)
        self.at = 0
        self.length = 16
        self.recent: list[int] = []

    def guess(self, limit: int) -> list[int]:
        """The next tokens, at most `limit`."""
        return self.earlier[self.at : self.at + min(self.length, max(0, limit))]

    def note(self, token: int) -> None:
        """Follows a token of the new answer; after a difference, searches the place again."""
        self.recent = [*self.recent[-(_CLUE - 1) :], token]
        if self.at < len(self.earlier) and self.earlier[self.at] == token:
            self.at += 1
        else:
            self.at = self._found() or min(self.at + 1, len(self.earlier))

    def judge(self, guessed: int, right: int) -> None:
        """Makes the next guess longer after success, shorter after failure."""
        if guessed:
            self.length = min(2 * self.length, _LONGEST_GUESS) if right == guessed else max(right + 1, _SHORTEST_GUESS)

    def _found(self) -> int | None:
        """The place after the nearest occurrence of the last tokens; None if there is none."""
        if len(self.recent) < _CLUE:
            return None
        ends = [i + _CLUE for i in range(len(self.earlier) - _CLUE + 1) if self.earlier[i : i + _CLUE] == self.recent]
        return min(ends, key=lambda end: abs(end - self.at), default=None)
