"""Contrast on uncertain tokens only: where the evidence is sure of a token, that token is taken as it is.

    max p(. | c, x) >= sure:   log p = log p(y | c, x)
    else:                      context-aware decoding, (1 + alpha) log p(y | c, x) - alpha log p(y | x)

The gate is that of CHASD (arXiv:2605.23344), which opens the negative branch only below a confidence; its negative
branch is a perturbed picture, ours is the row without the report, as in context-aware decoding (arXiv:2305.14739). At a
closed gate the second row is not read, so a loop could leave it out; ours runs both in one batch.
"""

from __future__ import annotations

from typing import Any

from pydantic import Field

from plugins.decoder.base import FixedContrast, plausible_only


class Gated(FixedContrast):
    """Context-aware decoding where the row with context is unsure, else that row alone."""

    sure: float = Field(0.9, gt=0.0, le=1.0, description="from this probability on a token is taken without contrast")

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """Contrast where the gate is open, (rows, vocabulary) in and out."""
        contrasted = super().scores(with_context, without_context)
        return contrasted.where(self.open(with_context), plausible_only(with_context, with_context, self.beta))

    def open(self, with_context: Any) -> Any:
        """Whether the second row is needed, (rows, 1)."""
        return with_context.float().softmax(-1).amax(-1, keepdim=True) < self.sure
