"""From two rows of logits to a token: contrast, plausibility, grammar, temperature and top-p, pick.

The first two are the decoder's `scores`, the last two its `draw`; the grammar stands between them and applies to the
combined logits. The results of all jobs come to the host at once. A decoder may be third-party code: its exceptions and
invalid scores end only its own report. Knows jobs and tensors; no model, no cache.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

import torch
from torch import Tensor

from plugins.backbone.engine.faults import BadLogits, BadScores, TooBig, tried
from plugins.backbone.engine.grammar import Mask, allowed, choice_counts, single_choices
from plugins.backbone.engine.job import ChunkResult, Job

NEVER = float("-inf")
_BLOCK = 8


@dataclass
class ScoredChunk:
    """The scores of one job's chunk: `result`, or the fault that ends the job."""

    choices: list[int] = field(default_factory=list)
    parts: list[Tensor] = field(default_factory=list)
    """On the device: finite, log-probabilities of known tokens, then sound, picked tokens, their log-probabilities."""
    result: ChunkResult | None = None
    fault: Exception | None = None


def score_chunks(
    jobs: Sequence[Job], with_context: Sequence[Tensor], without_context: Sequence[Tensor | None], words: int
) -> list[ScoredChunk]:
    """Scores every job's chunk; logits are (chunk, vocabulary), `words` the length of a mask for them."""
    found = [ScoredChunk() for _ in jobs]
    for i, job in enumerate(jobs):
        prior = without_context[i]
        logits = [with_context[i]] if prior is None else [with_context[i], prior]
        found[i].fault = tried(partial(_score, found[i], job, logits, words))
        if isinstance(full := found[i].fault, TooBig):
            raise full
    whole = [(job, one) for job, one in zip(jobs, found, strict=True) if not one.fault]
    numbers = torch.cat([part for _, one in whole for part in one.parts]).tolist() if whole else []
    at = 0
    for job, one in whole:
        lists = []
        for part in one.parts:
            lists.append(numbers[at : at + len(part)])
            at += len(part)
        _set_result(job, one, lists)
    return found


def averaged(first: Tensor, views: Sequence[Tensor]) -> Tensor:
    """Logits (chunk, vocabulary) of several views as one row: the geometric mean of what they predict.

    Test-time augmentation, as in Krizhevsky et al. 2012, "ImageNet Classification with Deep Convolutional Neural
    Networks", section 4.1, which averages softmax layers; logits keep the contrast with the prior row additive.
    """
    if not views:
        return first
    rows = [row.float().log_softmax(-1) for row in (first, *views)]
    return torch.stack(rows).mean(0)


@dataclass(frozen=True)
class _Row:
    """Logits of one row's chunk and the logarithm of their mass, (chunk,), in fp32."""

    logits: Tensor
    mass: Tensor

    @classmethod
    def of(cls, logits: Tensor) -> _Row:
        """The row with its mass, computed on a CPU in blocks that fit its cache."""
        blocks = [logits] if logits.is_cuda else torch.split(logits, _BLOCK)
        return cls(logits, torch.cat([block.float().logsumexp(-1) for block in blocks]))

    def logp(self, start: int, tokens: Tensor) -> Tensor:
        """Log-probabilities of tokens at the positions from `start` on."""
        places = slice(start, start + len(tokens))
        return self.logits[places].gather(-1, tokens[:, None])[:, 0].float() - self.mass[places]


def _score(one: ScoredChunk, job: Job, logits: Sequence[Tensor], words: int) -> None:
    """Computes a chunk's log-probabilities and picks, on the device."""
    mask = job.masks(words)
    one.choices = choice_counts(mask).tolist() if mask is not None else []
    known = len(job.pending) - 1
    rows = [_Row.of(row) for row in logits]
    finite = torch.stack([row.mass.isfinite().all() for row in rows]).all()[None]
    tokens = torch.tensor(job.pending[1:], dtype=torch.long, device=finite.device)
    one.parts = [finite.double(), *(row.logp(0, tokens).double() for row in rows)]
    if job.closing or not (finite.is_cuda or bool(finite)):
        return
    scored = slice(known, known + len(job.guesses) + 1)
    sound, *tokens_of = _all_picked(job, [row.logits[scored] for row in rows], mask, one.choices, finite)
    picked = tokens_of[0]
    one.parts += [part.double() for part in (sound, picked, *(row.logp(known, picked) for row in rows), *tokens_of[1:])]


def _all_picked(job: Job, rows: list[Tensor], mask: Mask | None, left: list[int], finite: Tensor) -> tuple[Tensor, ...]:
    """Whether the decoder's scores are valid, one token for each position, and the best token of each row there if
    there are two; forced positions are not scored."""
    free = [i for i in range(len(rows[0])) if mask is None or left[i] != 1]
    if mask is None or len(free) == len(left):
        return _picked(job, rows, mask, free, finite)
    forced = [i for i, count in enumerate(left) if count == 1]
    picked = torch.empty(len(left), dtype=torch.long, device=finite.device)
    picked[forced] = torch.from_numpy(single_choices(mask[forced])).to(finite.device)
    sound = torch.ones(1, dtype=torch.bool, device=finite.device)
    best = [picked.clone() for _ in rows] if len(rows) > 1 else []
    if free:
        sound, picked[free], *found = _picked(job, [row[free] for row in rows], mask[free], free, finite)
        for whole, part in zip(best, found, strict=True):
            whole[free] = part
    return sound, picked, *best


def _picked(job: Job, rows: list[Tensor], mask: Mask | None, free: list[int], finite: Tensor) -> tuple[Tensor, ...]:
    """One token for each position; if plausibility and grammar leave none, the most likely one with context. Then the
    best token of each row that the grammar allows, if there are two."""
    full = [row.to(torch.float32, copy=True) for row in rows]
    scores = job.request.policy.scores(full[0], full[1] if len(full) > 1 else None)
    if (
        not isinstance(scores, Tensor)
        or scores.shape != full[0].shape
        or not scores.is_floating_point()
        or scores.device != full[0].device
    ):
        raise _unsound(job, f"scores are {_described(scores)}, expected float logits {_place(full[0])}")
    may = None
    if mask is not None:
        mask[~mask.any(-1)] = -1  # a dead end: the job stops, but something must be drawn
        may = allowed(mask, scores.shape[-1], scores.device)
        scores = scores.masked_fill(~may, NEVER)
    top = scores.amax(-1, keepdim=True)
    sound = (top < float("inf")).all()[None]
    if scores.is_cuda or bool((top == NEVER).any()):
        bare = rows[0].float() if may is None else rows[0].float().masked_fill(~may, NEVER)
        scores = torch.where(top == NEVER, bare, scores)
    if scores.is_cuda:  # a draw from NaN would end the device's work for every report
        scores = torch.where(finite & sound, scores, torch.zeros_like(scores))
    elif not bool(sound):
        raise _unsound(job, "scores are NaN or inf")
    picked = _drawn(job, scores, free)
    inside = ((picked >= 0) & (picked < scores.shape[-1])).all()[None]
    best = [_best(row, may) for row in rows] if len(rows) > 1 else []
    return sound & inside, picked.clamp(0, scores.shape[-1] - 1), *best


def _best(row: Tensor, may: Tensor | None) -> Tensor:
    """The most likely token of each position, (positions,), that the grammar allows.

    On a CPU numpy searches fp32 ten times as fast as torch, and forty times as fast as torch searches bf16.
    """
    full = row.float() if may is None else torch.where(may, row.float(), NEVER)
    return torch.from_numpy(full.numpy().argmax(-1)) if full.device.type == "cpu" else full.argmax(-1)


def _drawn(job: Job, scores: Tensor, free: list[int]) -> Tensor:
    """One token for each position, (positions,), drawn with the random numbers of its place in the answer."""
    found = []
    for i, position in enumerate(free):
        job.place = len(job.answer.ids) + position
        drawn = job.request.policy.draw(scores[i : i + 1], job.generator_at(job.place, scores.device))
        if not isinstance(drawn, Tensor) or drawn.shape != (1,) or drawn.is_floating_point():
            raise _unsound(job, f"draw gave {_described(drawn)}, expected one token index a row, (1,)")
        found.append(drawn)
    return torch.cat(found)


def _unsound(job: Job, what: str) -> BadScores:
    return BadScores(f"{what} behind token {len(job.answer.ids)}")


def _described(found: object) -> str:
    if isinstance(found, Tensor):
        return f"{found.dtype} {_place(found)}"
    return "None" if found is None else type(found).__name__


def _place(found: Tensor) -> str:
    return f"{tuple(found.shape)} on {found.device}"


def _set_result(job: Job, one: ScoredChunk, lists: list[list[float]]) -> None:
    finite, *rest = lists
    rows = 1 + (job.request.without_context is not None)
    if not finite[0]:
        one.fault = BadLogits(f"the model gave NaN or inf behind token {len(job.answer.ids)} of the answer")
        return
    known, scored = rest[:rows], rest[rows:]
    if scored and not scored[0][0]:
        one.fault = _unsound(job, "scores are NaN or inf, or its tokens outside the vocabulary,")
        return
    one.result = ChunkResult(
        known_with=known[0],
        known_without=known[1] if rows > 1 else [],
        picked=[int(token) for token in scored[1]] if scored else [],
        picked_with=scored[2] if scored else [],
        picked_without=scored[3] if scored and rows > 1 else [],
        best=[(int(c), int(q)) for c, q in zip(scored[4], scored[5], strict=True)] if scored and rows > 1 else [],
    )
