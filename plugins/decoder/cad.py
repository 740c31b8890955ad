"""Context-aware decoding.

    y_t ~ softmax[(1 + alpha) logit(y | c, x, y_<t) - alpha logit(y | x, y_<t)]

Shi et al. 2024, "Trusting Your Evidence: Hallucinate Less with Context-aware Decoding",
arXiv:2305.14739, eq. 2. The same as classifier-free guidance with scale 1 + alpha. beta > 0 adds the
plausibility mask of contrastive decoding (Li et al. 2023, arXiv:2210.15097): without it a token that
the evidence makes unlikely can still win because the prior makes it less likely yet.
"""

from __future__ import annotations

from plugins.decoder.base import FixedContrast


class Cad(FixedContrast):
    """Amplifies what the report and its diagrams say over what the model would answer without them.

    alpha is the strength of the contrast; 0 is greedy or sampled decoding of the row with context.
    """
