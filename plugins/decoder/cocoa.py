"""Confidence- and context-aware decoding: both rows mixed by how far they differ and how sure the evidence is.

With c and q the log-probabilities with and without context:

    log p = l c + (1 - l) q
    l = clamp(sigmoid(gamma (dH + D / (1 + D) + m)), floor, 1 - floor)
    dH = H(q) - H(c)                              entropy gap, nats
    D = -2 log sum_y sqrt(p_c(y) p_q(y))          Renyi divergence of order 1/2, nats
    m = p_c(best) - p_c(second)                   contextual peakedness

Khandelwal et al. 2025, "CoCoA: Confidence- and Context-Aware Adaptive Decoding", arXiv:2508.17670: the mixture and the
three signals are the paper's. How they make up l could not be looked up; the sum within a sigmoid and the clamp follow
the weight in the authors' program, which has dH and a divergence there. A mixture only interpolates: it never goes
beyond the evidence.
"""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from plugins.decoder.base import Sampled, entropy, log_rows


class Cocoa(Sampled):
    """Interpolates between prior and evidence; the surer the evidence against the prior, the more it counts."""

    needs_prior: ClassVar[bool] = True
    gamma: float = Field(1.0, ge=0.0, le=100.0, description="how sharply the signals decide; 0: half each")
    floor: float = Field(0.1, ge=0.0, lt=0.5, description="least share of either row")

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """The mixture, (rows, vocabulary) in and out."""
        c, q = log_rows(with_context, without_context)
        share = self.share(c, q)
        return share * c + (1.0 - share) * q

    def share(self, c: Any, q: Any) -> Any:
        """The evidence's share at each row, (rows, 1); log-probabilities in."""
        divergence = -2.0 * ((c + q) / 2.0).logsumexp(-1, keepdim=True).clamp_max(0.0)
        best = c.topk(2, -1).values.exp()
        signals = entropy(q) - entropy(c) + divergence / (1.0 + divergence) + best[..., :1] - best[..., 1:]
        return (self.gamma * signals).sigmoid().clamp(self.floor, 1.0 - self.floor)
