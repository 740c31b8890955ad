"""Context-aware decoding.

    y_t ~ softmax[(1 + alpha) logit(y | c, x, y_<t) - alpha logit(y | x, y_<t)]

Shi et al. 2024, "Trusting Your Evidence: Hallucinate Less with Context-aware Decoding",
arXiv:2305.14739, eq. 2. The same as classifier-free guidance with scale 1 + alpha. beta > 0 adds the
plausibility mask of contrastive decoding (Li et al. 2023, arXiv:2210.15097): without it a token that
the evidence makes unlikely can still win because the prior makes it less likely yet.
"""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from plugins.decoder.base import Sampled, contrast, plausible_only


class Cad(Sampled):
    """Amplifies what the evidence says over what the model believes anyway."""

    needs_prior: ClassVar[bool] = True
    alpha: float = Field(0.7, ge=0.0, le=10.0)
    beta: float = Field(0.0, ge=0.0, lt=1.0, description="plausibility: p >= beta * max p with context; 0 = off")

    def reads_prior(self) -> bool:
        """alpha 0 is the evidence row alone, so the second row is not run."""
        return self.alpha > 0.0

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """Contrast, then plausibility; rows (rows, vocabulary) in, the same shape out."""
        if self.alpha == 0.0:
            return plausible_only(with_context, with_context, self.beta)
        return plausible_only(contrast(with_context, without_context, self.alpha), with_context, self.beta)
