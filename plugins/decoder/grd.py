"""Gated reversal decoding: at a conflict the prior is trusted only if it is sure and surer than the evidence.

With c and q the log-probabilities with and without context, i and j their best tokens:

    agreement, i = j:        log p = c
    conflict, not trusted:   log p = c
    conflict, trusted:       log p = t c + (1 - t) q,   t = (1 - depth) t*,
                             t* = (q_j - q_i) / ((c_i - c_j) + (q_j - q_i))
    trusted:                 q's probability of j > confidence (.5), and H(q) < H(c)

t c + (1 - t) q is the power family p_c^t p_q^(1-t); at t* the two best tokens are equally likely, below it j is ahead.
Jiang et al. 2026, "From Context-Aware to Conflict-Aware", arXiv:2606.10298, and the authors' program. They decide which
row to trust once, at the first conflict of an answer; here every conflict is decided by itself, since an answer has
many fields and a decoder keeps no state.
"""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from plugins.decoder.base import Sampled, entropy, log_rows


class Grd(Sampled):
    """Follows the evidence but where the prior is sure of something else and the evidence is not."""

    needs_prior: ClassVar[bool] = True
    depth: float = Field(0.75, ge=0.0, le=1.0, description="0: both best tokens alike; 1: the prior alone decides")
    confidence: float = Field(0.5, ge=0.0, lt=1.0, description="the prior's best token must be likelier than this")

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """The row with context, or both mixed where the prior is trusted; (rows, vocabulary) in and out."""
        c, q = log_rows(with_context, without_context)
        i, j = c.argmax(-1, keepdim=True), q.argmax(-1, keepdim=True)
        sure = (q.gather(-1, j).exp() > self.confidence) & (entropy(q) < entropy(c))
        evidence_ahead = c.gather(-1, i) - c.gather(-1, j)
        prior_ahead = q.gather(-1, j) - q.gather(-1, i)
        reversal = prior_ahead / (evidence_ahead + prior_ahead).clamp_min(1e-9)
        share = (1.0 - self.depth) * reversal
        return (share * c + (1.0 - share) * q).where((i != j) & sure, c)
