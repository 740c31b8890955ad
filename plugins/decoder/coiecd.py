"""Contextual information-entropy constraint decoding: contrast where the evidence surprises the prior, else less.

With c and q the log-probabilities with and without context, H the entropy of q and g = c - q:

    s(y) = -c(y) - H(q),   r = softmax(s)            how surprising each token is against what the prior expects
    C = {y : r(y) >= ratio min r  and  r(y) <= max r / ratio}
    log p(y) = q(y) + alpha g(y)  for y in C,   c(y) + alpha g(y)  outside

If only one token lies below the lower bound, the evidence has decided, and the lower bound excludes none.
Yuan et al. 2024, "Discerning and Resolving Knowledge Conflicts through Adaptive Decoding with Contextual
Information-Entropy Constraint", arXiv:2402.11893; bounds and ratio 4 are of the authors' program.
"""

from __future__ import annotations

from math import log
from typing import Any, ClassVar

from pydantic import Field

from plugins.decoder.base import Sampled, entropy, log_rows


class Coiecd(Sampled):
    """Contrasts tokens of unusual information, and interpolates the others."""

    needs_prior: ClassVar[bool] = True
    alpha: float = Field(0.5, ge=0.0, le=10.0)
    ratio: float = Field(4.0, gt=1.0, le=1e6, description="tokens within this factor of the extremes are unusual")

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """Constrained contrast, (rows, vocabulary) in and out."""
        c, q = log_rows(with_context, without_context)
        base = q.where(self.usual(c, q), c)
        return base + self.alpha * (c - q)

    def usual(self, c: Any, q: Any) -> Any:
        """Tokens of usual information, the set C; log-probabilities in, booleans of the same shape out."""
        surprise = (-c - entropy(q)).log_softmax(-1)
        low = surprise.amin(-1, keepdim=True) + log(self.ratio)
        high = surprise.amax(-1, keepdim=True) - log(self.ratio)
        above = surprise >= low
        decided = (~above).sum(-1, keepdim=True) == 1
        return (above | decided) & (surprise <= high)
