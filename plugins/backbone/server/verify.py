"""Draft and verify: the server writes an answer under the evidence, both rows score it, a decoder decides every token.

    draft y' from p(. | c, x, y)
    at every place of y':  y_t from the decoder on log p(. | c, x, y_<t) and log p(. | x, y_<t)
    the first y_t that is not y'_t replaces it, and the next draft begins behind it

So an answer takes as many rounds as it has disagreements, and one. This is speculative decoding (Leviathan et al. 2023,
arXiv:2211.17192) with the evidence row as its draft and the contrast of both rows as its target. The engine's `Job`
keeps grammar, forced tokens and random numbers of each place, so a choice is made here as it is made in process. Knows
no HTTP.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import torch

from plugins.backbone.engine.grammar import allowed
from plugins.backbone.engine.job import Draft, Job
from plugins.backbone.engine.records import Answer, Request
from plugins.backbone.engine.scoring import score_chunks
from plugins.backbone.server.protocol import Speaker, Top
from plugins.backbone.server.rows import allowed_tokens, chosen_from, even, rivals, unknown

_SHORTEST = 4
_LONGEST_IDLE = 15
_NAMED_AT_LAST = 64
"""Up to how many values are asked for by name where the largest top k does not decide."""
_WIDER = 16
"""Factor on the top k while it does not decide."""


@dataclass
class Count:
    """What an answer took: `rounds` of scoring, `drafts` of the server, and the places where top k was too small.

    `widened` of them were asked for again, `open` ones were decided as if no token outside the top k could win.
    """

    rounds: int = 0
    drafts: int = 0
    disagreements: int = 0
    widened: int = 0
    open: int = 0


@dataclass
class Place:
    """A place in both rows; `without` None if the second row is not run."""

    with_context: Top
    without_context: Top | None


class Verifier:
    """Answers one request through a server. `vocabulary` is the number of tokens that rows have, `most` the top k's
    limit (None: the whole vocabulary), `top` the k that is asked for first, `draft_tokens` the longest draft."""

    def __init__(self, speaker: Speaker, vocabulary: int, top: int, most: int | None, draft_tokens: int) -> None:
        self.speaker = speaker
        self.vocabulary = vocabulary
        self.most = vocabulary if most is None else min(most, vocabulary)
        self.top = min(top, self.most)
        self.draft_tokens = draft_tokens

    def answer(self, request: Request) -> tuple[Answer, Count]:
        """The answer and what it took. Raises the engine's faults and the server's errors."""
        job, count = Job(request), Count()
        rows = [prompt.ids for prompt in request.prompts]
        schema = request.grammar.schema if request.grammar else None
        proposal = Proposal(self, job, rows[0], schema, count)
        job.draft = proposal
        job.begin()
        while not job.finished:
            self._round(job, rows, proposal, count)
        return job.answer, count

    def _round(self, job: Job, rows: Sequence[Sequence[int]], proposal: Proposal, count: Count) -> None:
        proposal.fill()
        chunk = job.chunk(self.draft_tokens)
        behind = [*job.answer.ids, *job.guesses]
        places = self._places(rows, behind, len(chunk) + job.closing + proposal.estimated, self.top)
        places = places[:-1] if job.closing else places
        count.rounds += 1
        if proposal.estimated:
            _correct(job.answer, len(job.answer.with_context) - 1, places.pop(0), chunk[0])
        if not job.closing:
            self._settle(job, rows, behind, places, count)
        first = len(job.pending) - 1
        guesses, picked = self._decide(job, places)
        count.disagreements += any(g != p for g, p in zip(guesses, picked, strict=False))
        proposal.estimated = bool(picked) and _is_estimated(places[first + len(picked) - 1], picked[-1])
        if job.finished and proposal.estimated and picked[-1] not in job.request.eos:
            before, _ = self._places(rows, job.answer.ids, 2, self.top)
            _correct(job.answer, -1, before, job.answer.ids[-1])

    def _decide(self, job: Job, places: Sequence[Place]) -> tuple[list[int], list[int]]:
        """Lets the engine score the places and the job take the result; the guesses and what was picked instead."""
        with_context = even([place.with_context for place in places], self.vocabulary)
        prior = [place.without_context for place in places if place.without_context is not None]
        without = even(prior, self.vocabulary) if prior else None
        with torch.inference_mode():
            (one,) = score_chunks([job], [with_context], [without], (self.vocabulary + 31) // 32)
        if one.result is None:
            assert one.fault is not None  # noqa: S101 -- a chunk has a result or a fault
            raise one.fault
        guesses = list(job.guesses)
        job.take_result(one.result, one.choices)
        right = next((i for i, guess in enumerate(guesses) if guess != one.result.picked[i]), len(guesses))
        return guesses, one.result.picked[: right + 1]

    def _places(self, rows: Sequence[Sequence[int]], behind: Sequence[int], count: int, top: int) -> list[Place]:
        """The last `count` places of both rows, asked for at once."""
        found = self.speaker.tops_of(rows, behind, count, top)
        return [Place(found[0][i], found[1][i] if len(rows) > 1 else None) for i in range(count)]

    # ------------------------------------------------------------------ a top k that is too small
    def _settle(
        self, job: Job, rows: Sequence[Sequence[int]], behind: Sequence[int], places: list[Place], count: Count
    ) -> None:
        """Makes certain every place up to the first whose choice is not the guess, as far as the server allows."""
        masks = self._peek(job)
        first = len(places) - len(job.guesses) - 1
        for i in range(len(job.guesses) + 1):
            if masks is not None and i >= len(masks):
                return
            may = None if masks is None else masks[i]
            place = places[first + i]
            if self._doubts(job, place, may):
                cut = len(behind) - len(job.guesses) + i
                places[first + i] = place = self._widened(job, rows, behind[:cut], place, may, count)
            if i < len(job.guesses) and self._greedy(job, place, may) not in (job.guesses[i], None):
                return

    def _widened(
        self,
        job: Job,
        rows: Sequence[Sequence[int]],
        behind: Sequence[int],
        place: Place,
        may: torch.Tensor | None,
        count: Count,
    ) -> Place:
        """The place with the values that its choice depends on, by name where that is cheap, else by a larger k."""
        doubts = self._doubts(job, place, may)
        if len(doubts) <= self.speaker.named:
            place = self._named(rows, behind, place, doubts)
        top = self.top
        while top < self.most and self._doubts(job, place, may):
            top = min(_WIDER * top, self.most)
            (place,) = self._places(rows, behind, 1, top)
        if (doubts := self._doubts(job, place, may)) and self.speaker.named < len(doubts) <= _NAMED_AT_LAST:
            place = self._named(rows, behind, place, doubts)
        count.widened += 1
        count.open += bool(self._doubts(job, place, may))
        return place

    def _named(self, rows: Sequence[Sequence[int]], behind: Sequence[int], place: Place, tokens: list[int]) -> Place:
        """The place with the exact values of given tokens, where the protocol tells them."""
        found = [top for top in (place.with_context, place.without_context) if top is not None]
        for i, top in enumerate(found):
            if missing := unknown(tokens, top):
                found[i] = top.with_known(self.speaker.exact(rows[i], behind, missing))
        return Place(found[0], found[1] if len(found) > 1 else None)

    def _doubts(self, job: Job, place: Place, may: torch.Tensor | None) -> list[int]:
        """Tokens whose unknown values matter: the rivals of a greedy choice; of a sampled one all that may come."""
        if may is not None and int(may.sum()) == 1:
            return []
        if float(getattr(job.request.policy, "temperature", 0.0)) > 0.0:
            tokens = allowed_tokens(may, self.vocabulary)
            tops = [top for top in (place.with_context, place.without_context) if top is not None]
            return [] if all(not unknown(tokens, top) for top in tops) else tokens
        found = rivals(job.request.policy, place.with_context, place.without_context, may, self.vocabulary)
        return found if unknown(found, place.with_context) or unknown(found, place.without_context) else []

    def _greedy(self, job: Job, place: Place, may: torch.Tensor | None) -> int | None:
        """The choice at a place, None where it is drawn by chance."""
        if float(getattr(job.request.policy, "temperature", 0.0)) > 0.0:
            return None
        first = even([place.with_context], self.vocabulary)
        second = None if place.without_context is None else even([place.without_context], self.vocabulary)
        return int(chosen_from(job.request.policy, first, second, may).argmax())

    def _peek(self, job: Job) -> torch.Tensor | None:
        """What the grammar allows at the scored places, (places, vocabulary); the job stays as it is."""
        guesses = list(job.guesses)
        mask = job.masks((self.vocabulary + 31) // 32)
        job.forget_guesses()
        job.guesses = guesses
        return None if mask is None else allowed(mask, self.vocabulary, torch.device("cpu"))


def _correct(answer: Answer, at: int, place: Place, token: int) -> None:
    """Puts exact log-probabilities of a token in the place of those that were estimated when it was chosen."""
    answer.with_context[at] = place.with_context.known[token]
    if place.without_context is not None and answer.without_context:
        answer.without_context[at] = place.without_context.known[token]


def _is_estimated(place: Place, token: int) -> bool:
    """Whether a token was chosen whose value the server did not tell."""
    return bool(unknown([token], place.with_context) or unknown([token], place.without_context))


class Proposal(Draft):
    """The draft of an answer: what the server writes, the rest of it behind a replaced token, else a new one."""

    def __init__(
        self, verifier: Verifier, job: Job, prompt: Sequence[int], schema: Mapping[str, Any] | None, count: Count
    ) -> None:
        super().__init__([])
        self.verifier, self.job, self.prompt, self.schema, self.count = verifier, job, prompt, schema, count
        self.length = verifier.draft_tokens
        self.missed = True
        """The next token of the last draft was wrong: the server writes a new one."""
        self.useless = self.idle = 0
        self.estimated = False
        """The last token's log-probabilities are estimates, to be corrected with the next places."""

    def fill(self) -> None:
        """Asks the server for a new draft if nothing is left of the last one or its next token was wrong.

        A server that writes what the grammar forbids at once is asked less and less often.
        """
        job = self.job
        room = job.request.max_new_tokens - len(job.answer.ids) - 1
        if job.closing or room <= 0 or not (self.missed or not self._allowed()):
            return
        if self.idle:
            self.idle -= 1
            self.earlier = []
            return
        drafted = self.verifier.speaker.draft(self.prompt, job.answer.ids, min(self.length, room), self.schema)
        self.count.drafts += 1
        self.earlier, self.at, self.missed = [t for t in drafted if t not in job.request.eos], 0, False
        self.useless = 0 if self._allowed() else self.useless + 1
        self.idle = min(2**self.useless - 1, _LONGEST_IDLE)

    def guess(self, limit: int) -> list[int]:
        """The next tokens of the draft, at most `limit`, up to the first that the grammar forbids."""
        return self._allowed()[: max(0, limit)]

    def judge(self, guessed: int, right: int) -> None:
        """Makes the next draft longer after success, shorter after failure, and says whether a new one is needed."""
        if not guessed:
            return
        longest = self.verifier.draft_tokens
        self.missed = right == 0
        self.length = longest if right == guessed else min(longest, max(2 * right + 2, _SHORTEST))

    def _allowed(self) -> list[int]:
        rest, track, taken = self.earlier[self.at :], self.job.track, 0
        if track is None:
            return rest
        for token in rest:
            if track.done or not track.take(token):
                break
            taken += 1
        track.back(taken)
        return rest[:taken]
