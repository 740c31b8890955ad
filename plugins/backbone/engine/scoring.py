"""From two rows of logits to a token: contrast, plausibility, grammar, temperature and top-p, pick.

The first two are the decoder's `scores`, the last two its `draw`; the grammar stands between them and
applies to the combined logits. All jobs come to the host at once. Knows jobs and tensors; no
model, no cache.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from plugins.backbone.engine.grammar import Mask, allowed, choices, only
from plugins.backbone.engine.job import Job, Said

NEVER = float("-inf")
_BLOCK = 8


@dataclass(frozen=True)
class Heard:
    """`said` is None where the model gave NaN or inf."""

    said: Said | None
    choices: list[int]


def heard(
    jobs: Sequence[Job],
    with_context: Sequence[Tensor],
    without_context: Sequence[Tensor | None],
    masks: Sequence[Mask | None],
) -> list[Heard]:
    """Score every job's chunk; logits are (chunk, vocabulary), masks (scored positions, words)."""
    left = [choices(mask).tolist() if mask is not None else [] for mask in masks]
    found = []
    for i, job in enumerate(jobs):
        prior = without_context[i]
        rows = [_Row.of(with_context[i])] + ([_Row.of(prior)] if prior is not None else [])
        found.append(_job(job, rows, masks[i], left[i]))
    numbers = torch.cat([part for parts in found for part in parts]).tolist()
    return _told(jobs, found, left, numbers)


@dataclass(frozen=True)
class _Row:
    """Logits of one row's chunk and the logarithm of their mass, (chunk,), in fp32."""

    logits: Tensor
    mass: Tensor

    @classmethod
    def of(cls, logits: Tensor) -> _Row:
        """On a CPU in blocks that stay in its cache."""
        blocks = [logits] if logits.is_cuda else torch.split(logits, _BLOCK)
        return cls(logits, torch.cat([block.float().logsumexp(-1) for block in blocks]))

    def logp(self, start: int, tokens: Tensor) -> Tensor:
        """Log-probabilities of tokens at the positions from `start` on."""
        places = slice(start, start + len(tokens))
        return self.logits[places].gather(-1, tokens[:, None])[:, 0].float() - self.mass[places]


def _job(job: Job, rows: list[_Row], mask: Mask | None, left: list[int]) -> list[Tensor]:
    """On the device: [finite, log-probabilities of known tokens, picked tokens, their log-probabilities]."""
    known = len(job.pending) - 1
    finite = torch.stack([row.mass.isfinite().all() for row in rows]).all()[None]
    tokens = torch.tensor(job.pending[1:], dtype=torch.long, device=finite.device)
    parts = [finite, *(row.logp(0, tokens) for row in rows)]
    if not job.closing:
        scored = slice(known, known + len(job.guesses) + 1)
        picked = _all_picked(job, [row.logits[scored] for row in rows], mask, left, finite)
        parts += [picked, *(row.logp(known, picked) for row in rows)]
    return [part.double() for part in parts]


def _all_picked(job: Job, rows: list[Tensor], mask: Mask | None, left: list[int], finite: Tensor) -> Tensor:
    """One token a position; where the grammar leaves one, nothing is scored."""
    free = [i for i, count in enumerate(left) if count != 1]
    job.free = free if mask is not None else list(range(len(rows[0])))
    if mask is None or len(free) == len(left):
        return _picked(job, rows, mask, left, finite)
    forced = [i for i, count in enumerate(left) if count == 1]
    picked = torch.empty(len(left), dtype=torch.long, device=finite.device)
    picked[forced] = torch.from_numpy(only(mask[forced])).to(finite.device)
    if free:
        some = [row[free] for row in rows]
        picked[free] = _picked(job, some, mask[free], [left[i] for i in free], finite)
    return picked


def _picked(job: Job, rows: list[Tensor], mask: Mask | None, left: list[int], finite: Tensor) -> Tensor:
    """One token a position; where plausibility and grammar leave none, the grammar's most likely with context."""
    policy = job.request.policy
    scores = policy.scores(rows[0].float(), rows[1].float() if len(rows) > 1 else None)
    scores = torch.where(finite, scores, torch.zeros_like(scores)) if scores.is_cuda or not bool(finite) else scores
    if mask is not None:
        mask[[count == 0 for count in left]] = -1  # a dead end: the job stops, but something must be drawn
        may = allowed(mask, scores.shape[-1], scores.device)
        scores = scores.masked_fill(~may, NEVER)
        stuck = scores.amax(-1, keepdim=True) == NEVER
        if scores.is_cuda or bool(stuck.any()):
            scores = torch.where(stuck, rows[0].float().nan_to_num(0.0).masked_fill(~may, NEVER), scores)
    picked: Tensor = policy.draw(scores, job.generator_on(scores.device))
    return picked


def _told(
    jobs: Sequence[Job], found: Sequence[Sequence[Tensor]], left: Sequence[list[int]], numbers: list[float]
) -> list[Heard]:
    told, at = [], 0
    for job, parts, choice in zip(jobs, found, left, strict=True):
        lists = []
        for part in parts:
            lists.append(numbers[at : at + len(part)])
            at += len(part)
        told.append(Heard(_said(job, lists), choice))
    return told


def _said(job: Job, lists: list[list[float]]) -> Said | None:
    finite, *rest = lists
    rows = len(job.rows)
    if not finite[0]:
        return None
    known, scored = rest[:rows], rest[rows:]
    picked = [int(token) for token in scored[0]] if scored else []
    return Said(
        known_with=known[0],
        known_without=known[1] if rows > 1 else [],
        picked=picked,
        picked_with=scored[1] if scored else [],
        picked_without=scored[2] if scored and rows > 1 else [],
    )
