"""Adaptive context-aware decoding: alpha from the disagreement of the two rows, token by token.

    alpha_t = JSD(p(. | c, x, y_<t) || p(. | x, y_<t)), base 2, so in [0, 1]
    y_t ~ softmax[(1 + alpha_t) logit(y | c, x, y_<t) - alpha_t logit(y | x, y_<t)]

Wang et al. 2025, "AdaCAD: Adaptively Decoding to Balance Conflicts between Contextual and Parametric
Knowledge", arXiv:2409.07394, eq. 3-4. Where the two rows agree it is greedy decoding.
"""

from __future__ import annotations

from math import log
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from plugins.decoder.base import Sampled, contrast, plausible_only

if TYPE_CHECKING:
    from torch import Tensor


class AdaCad(Sampled):
    """Contrasts the two rows in proportion to their disagreement at each token; `scale` 1 is the published form."""

    needs_prior: ClassVar[bool] = True
    scale: float = Field(1.0, gt=0.0, le=10.0, description="factor on the divergence")
    beta: float = Field(0.0, ge=0.0, lt=1.0, description="plausibility: p >= beta * max p with context; 0 = off")

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """Contrast by the divergence of each row, then plausibility."""
        alpha = self.scale * jensen_shannon(with_context, without_context)
        return plausible_only(contrast(with_context, without_context, alpha), with_context, self.beta)


def jensen_shannon(left: Any, right: Any) -> Tensor:
    """Jensen-Shannon divergence of two batches of logits (rows, vocabulary), in bits: (rows, 1), 0 to 1."""
    log_p, log_q = left.float().log_softmax(-1), right.float().log_softmax(-1)
    p, q = log_p.exp(), log_q.exp()
    log_m = log_p.logaddexp(log_q) - log(2.0)
    divergence = 0.5 * (_kl(p, log_p, log_m) + _kl(q, log_q, log_m)) / log(2.0)
    return divergence.clamp(0.0, 1.0)


def _kl(p: Tensor, log_p: Tensor, log_m: Tensor) -> Tensor:
    """Kullback-Leibler divergence in nats, (rows, 1); a token of probability 0 counts 0."""
    return (p * (log_p - log_m)).nan_to_num(0.0).sum(-1, keepdim=True)
