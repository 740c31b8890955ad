"""What a step trains on and what comes of it: padded rows, states on the way, losses, heads that ask for tags."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn import functional as F


@dataclass
class Batch:
    """Padded rows.

    ids (B, L); positions (3, B, L); sheets (n, 3, H, W) of bytes for every shape of drawing, N drawings in all; grids
    (N, P, 2) row and column of each patch, lengths (N,) real patches; image_index flat places of picture tokens,
    patch_index which tokens stand there; picks (M,) flat places before a value, wanted (M,) its token, weights (M,);
    allowed (M, K) all tokens that are as right as the wanted one, it among them, -1 behind shorter lists;
    ends (S,) flat places of sentence ends, sentence_tags (S, T) what those sentences tell; phrases (R,) flat places of
    the ends of noted phrases, noted (R, U) what those tell; drawn (sum of picture tokens, D) what each of
    `patch_index` shows; pointing (Q,) flat places before a value that some source tells, sources (Q, L) where in the
    row.
    """

    ids: Tensor
    positions: Tensor
    sheets: list[Tensor]
    grids: Tensor
    lengths: Tensor
    image_index: Tensor
    patch_index: Tensor
    picks: Tensor
    wanted: Tensor
    weights: Tensor
    allowed: Tensor
    ends: Tensor
    sentence_tags: Tensor
    phrases: Tensor
    noted: Tensor
    drawn: Tensor
    pointing: Tensor
    sources: Tensor

    def to(self, device: str) -> Batch:
        """The batch on another device."""
        moved = {key: value.to(device) for key, value in vars(self).items() if key != "sheets"}
        return Batch(**moved, sheets=[sheets.to(device) for sheets in self.sheets])


@dataclass
class Pass:
    """States on one way through: last (B, L, hidden) or (M, hidden), early and middle (B, L, hidden), seen (tokens,
    hidden)."""

    last: Tensor
    early: Tensor
    middle: Tensor
    seen: Tensor
    queries: Tensor | None = None
    keys: Tensor | None = None


@dataclass
class Lesson:
    """Losses of one batch, and the share of sure answers that are right."""

    answers: Tensor
    right: Tensor
    sentences: Tensor
    phrases: Tensor
    drawings: Tensor
    pointers: Tensor

    @property
    def figures(self) -> dict[str, float]:
        """What a log says of it."""
        named = {"loss": self.answers, **vars(self)}
        return {key: float(value.detach()) for key, value in named.items() if key != "answers"}


class Taggers(nn.Module):
    """The heads that ask what a sentence, a phrase and a picture token tell; used in training only."""

    def __init__(self, hidden: int, sentence: int, phrase: int, picture: int, blank: float = 0.2) -> None:
        """`hidden` numbers a state; so many tags of a sentence, a phrase and a picture token."""
        super().__init__()
        self.sentence, self.phrase = nn.Linear(hidden, sentence), nn.Linear(hidden, phrase)
        self.picture = nn.Linear(hidden, picture)
        self.blank = blank
        """Weight of a picture token that shows nothing."""
        for head in (self.sentence, self.phrase, self.picture):
            nn.init.zeros_(head.weight)
            nn.init.constant_(head.bias, -4.0)

    def sentences(self, states: Tensor, sentence_tags: Tensor) -> Tensor:
        """Mean over sentences of the summed binary cross-entropies; states (S, hidden), sentence_tags (S, T)."""
        return self._mean(self.sentence, states, sentence_tags)

    def phrases(self, states: Tensor, noted: Tensor) -> Tensor:
        """The same over noted phrases; states (R, hidden), noted (R, U)."""
        return self._mean(self.phrase, states, noted)

    def drawings(self, states: Tensor, drawn: Tensor) -> Tensor:
        """The same over picture tokens, blank ones with less weight; states (N, hidden), drawn (N, D)."""
        if not len(states):
            return states.sum()
        weight = torch.where(drawn.any(dim=1), 1.0, self.blank)
        return (self._loss(self.picture, states, drawn) * weight).sum() / weight.sum()

    def _mean(self, head: nn.Linear, states: Tensor, wanted: Tensor) -> Tensor:
        return self._loss(head, states, wanted).mean() if len(states) else states.sum()

    @staticmethod
    def _loss(head: nn.Linear, states: Tensor, wanted: Tensor) -> Tensor:
        logits = head(F.rms_norm(states, states.shape[-1:])).float()
        return F.binary_cross_entropy_with_logits(logits, wanted, reduction="none").sum(dim=1)
