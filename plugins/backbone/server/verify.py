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

import torch

from plugins.backbone.engine.grammar import allowed
from plugins.backbone.engine.job import Job
from plugins.backbone.engine.records import Answer, Request
from plugins.backbone.engine.scoring import score_chunks
from plugins.backbone.server.pictures import Shown
from plugins.backbone.server.proposal import Proposal
from plugins.backbone.server.protocol import Speaker, Top
from plugins.backbone.server.rows import allowed_tokens, chosen_from, even, rivals, unknown

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
        proposal = Proposal(self.speaker, job, rows[0], (self.draft_tokens, self.top))
        job.draft = proposal
        job.begin()
        while not job.finished:
            self._round(job, rows, proposal, count)
        count.drafts = proposal.drafts
        return job.answer, count

    def _round(self, job: Job, rows: Sequence[Sequence[int]], proposal: Proposal, count: Count) -> None:
        proposal.fill()
        chunk = job.chunk(self.draft_tokens)
        behind = [*job.answer.ids, *job.guesses]
        needed = len(chunk) + job.closing + proposal.estimated
        places = self._places(rows, behind, needed, self.top, proposal.told(behind, needed))
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

    def _places(
        self,
        rows: Sequence[Sequence[int]],
        behind: Sequence[int],
        count: int,
        top: int,
        told: Sequence[Top] | None = None,
    ) -> list[Place]:
        """The last `count` places of both rows, asked for at once; the first row's not if they are `told` already."""
        asked = rows if told is None else rows[1:]
        found = self.speaker.tops_of(asked, behind, count, top) if asked else []
        found = found if told is None else [list(told), *found]
        return [Place(found[0][i], found[1][i] if len(rows) > 1 else None) for i in range(count)]

    # ------------------------------------------------------------------ a top k that is too small
    def _settle(
        self, job: Job, rows: Sequence[Sequence[int]], behind: Sequence[int], places: list[Place], count: Count
    ) -> None:
        """Makes certain every place up to the first whose choice is not the guess, as far as the server allows."""
        masks = self._peek(job)
        first = len(places) - len(job.guesses) - 1
        if self.speaker.at_once and _plain(rows):
            self._name_all(job, rows, behind, places, masks)
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

    def _name_all(
        self,
        job: Job,
        rows: Sequence[Sequence[int]],
        behind: Sequence[int],
        places: list[Place],
        masks: torch.Tensor | None,
    ) -> None:
        """Asks at once for the values on which choices depend, up to the first that is surely not the guess."""
        first, found = len(places) - len(job.guesses) - 1, dict[int, list[int]]()
        for i in range(len(job.guesses) + 1 if masks is None else min(len(job.guesses) + 1, len(masks))):
            may = None if masks is None else masks[i]
            doubts = self._doubts(job, places[first + i], may)
            found |= {i: doubts} if 0 < len(doubts) <= self.speaker.named else {}
            if i < len(job.guesses) and not doubts and self._greedy(job, places[first + i], may) != job.guesses[i]:
                break
        tokens = sorted({token for doubts in found.values() for token in doubts})
        if len(found) < 2 or len(tokens) > self.speaker.named:
            return
        cuts = [behind[: len(behind) - len(job.guesses) + i] for i in found]
        told = self.speaker.exact_of([[*row, *cut] for cut in cuts for row in rows], tokens)
        for n, i in enumerate(found):
            places[first + i] = _with_known(places[first + i], told[n * len(rows) : (n + 1) * len(rows)])

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
        elif doubts and self.speaker.at_once:
            place = self._named(rows, behind, place, _contenders(place, may)[: self.speaker.named])
        count.widened += 1
        count.open += bool(self._doubts(job, place, may))
        return place

    def _named(self, rows: Sequence[Sequence[int]], behind: Sequence[int], place: Place, tokens: list[int]) -> Place:
        """The place with the exact values of given tokens, where the protocol tells them."""
        found = [top for top in (place.with_context, place.without_context) if top is not None]
        missing = sorted({token for top in found for token in unknown(tokens, top)})
        if self.speaker.at_once and 0 < len(missing) <= self.speaker.named and _plain(rows):
            return _with_known(place, self.speaker.exact_of([[*row, *behind] for row in rows], missing))
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


def _contenders(place: Place, may: torch.Tensor | None) -> list[int]:
    """Tokens that either row tells and the grammar allows: where too many could win, one of them most likely does."""
    told = {**place.with_context.known, **(place.without_context.known if place.without_context else {})}
    return [token for token in told if may is None or bool(may[token])]


def _with_known(place: Place, told: Sequence[Mapping[int, float]]) -> Place:
    """A place with further values, row by row."""
    without = None if place.without_context is None else place.without_context.with_known(told[-1])
    return Place(place.with_context.with_known(told[0]), without)


def _plain(rows: Sequence[Sequence[int]]) -> bool:
    """Whether no row sees a picture: their texts alone are the whole of what the server reads."""
    return not any(isinstance(row, Shown) for row in rows)


def _is_estimated(place: Place, token: int) -> bool:
    """Whether a token was chosen whose value the server did not tell."""
    return bool(unknown([token], place.with_context) or unknown([token], place.without_context))
