"""The draft of an answer that a server writes, and which tokens of it are guessed. Knows no decoder and no HTTP."""

from __future__ import annotations

from collections.abc import Sequence

from plugins.backbone.engine.job import Draft, Job
from plugins.backbone.server.protocol import Speaker, Top

_SHORTEST = 4
_LONGEST_IDLE = 15


class Proposal(Draft):
    """What the server writes, the rest of it behind a replaced token, else a new one.

    A schema guides servers from the start of an answer only. So the first draft is written from there, and its rest is
    kept as long as the grammar allows it; later drafts are unguided and short until one is right.
    """

    def __init__(self, speaker: Speaker, job: Job, prompt: Sequence[int], sizes: tuple[int, int]) -> None:
        """`sizes`: the longest draft in tokens, and the top k that is asked for with it."""
        super().__init__([])
        self.speaker, self.job, self.prompt = speaker, job, prompt
        self.longest, self.top = sizes
        self.length = self.longest
        self.drafts = 0
        """Drafts that the server has written."""
        self.missed = True
        """The next token of the last draft was wrong: the server writes a new one."""
        self.useless = self.idle = 0
        self.estimated = False
        """The last token's log-probabilities are estimates, to be corrected with the next places."""
        self.written: list[int] = []
        """The answer as the server would have it: what stood before the last draft, and the draft."""
        self.tops: list[Top] = []
        """Places of the last tokens of `written`, where the server told them with its draft."""

    def fill(self) -> None:
        """Asks the server for a new draft if nothing is left of the last one or its next token was wrong.

        A server that writes what the grammar forbids at once is asked less and less often, and for little.
        """
        job = self.job
        room = job.request.max_new_tokens - len(job.answer.ids) - 1
        if job.closing or room <= 0 or not (self.missed or not self._allowed()):
            return
        if self.idle:
            self.idle -= 1
            self.earlier = []
            return
        drafted = self._new(min(self.length, room))
        self.drafts += 1
        self.earlier, self.at, self.missed = [t for t in drafted if t not in job.request.eos], 0, False
        useful = bool(self._allowed())
        self.useless = 0 if useful else self.useless + 1
        self.length = self.length if useful or job.track is None else _SHORTEST
        self.idle = min(2**self.useless - 1, _LONGEST_IDLE)

    def told(self, behind: Sequence[int], count: int) -> list[Top] | None:
        """The last `count` places of an answer's tokens, as the server told them with its draft; None if it did not.

        The place behind a complete answer is not used, so any stands there.
        """
        first, start = len(self.written) - len(self.tops), len(behind) + 1 - count
        if start < first or list(behind) != self.written[: len(behind)]:
            return None
        tops = [*self.tops, *([self.tops[-1]] if self.job.closing and self.tops else [])]
        found = tops[start - first : len(behind) + 1 - first]
        return found if len(found) == count else None

    def guess(self, limit: int) -> list[int]:
        """The next tokens of the draft, at most `limit`, up to the first that the grammar forbids.

        The last token of a draft with places is left to be decided: the place behind it is not told.
        """
        known = self.job.answer.ids
        if self.tops and self.written[: len(known)] == known:
            limit = min(limit, len(self.written) - len(known) - 1)
        return self._allowed()[: max(0, limit)]

    def judge(self, guessed: int, right: int) -> None:
        """Makes the next draft longer after success, shorter after failure, and says whether a new one is needed."""
        if not guessed:
            return
        self.missed = right == 0 and self.job.track is None
        self.length = self.longest if right == guessed else min(self.longest, max(2 * right + 2, _SHORTEST))

    def _new(self, limit: int) -> list[int]:
        """Tokens of a new draft behind the answer so far."""
        job, grammar = self.job, self.job.request.grammar
        known = list(job.answer.ids)
        if grammar is None or self.drafts or not self.speaker.guided:
            drafted, self.tops = self.speaker.draft_told(self.prompt, known, limit, None, self.top)
            self.written = [*known, *drafted]
            return drafted
        self.written, self.tops = self.speaker.draft_told(self.prompt, (), limit + len(known), grammar.schema, self.top)
        if self.written[: len(known)] == known:
            return self.written[len(known) :]
        text, begun = grammar.text(self.written), grammar.text(known)
        return grammar.spelled(text.removeprefix(begun)) if text.startswith(begun) else []

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
