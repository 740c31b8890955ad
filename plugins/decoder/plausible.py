"""The plausibility mask alone: contrastive decoding with its contrast taken out.

    V_head = {y : p(y | c, x, y_<t) >= beta max p(. | c, x, y_<t)},  y_t from p(. | c, x) on V_head

Li et al. 2023, "Contrastive Decoding", arXiv:2210.15097, eq. 4. An arm of ablations: part of the gains
published for contrastive decoding came from this mask, not from the contrast. With temperature 0 it is
greedy decoding unless the grammar excludes the best token.
"""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from plugins.decoder.base import Sampled, plausible_only


class Plausible(Sampled):
    """Picks from the row with context without its implausible tokens: contrastive decoding without the contrast.

    beta is the share of the largest probability below which a token is excluded.
    """

    needs_prior: ClassVar[bool] = False
    beta: float = Field(0.1, gt=0.0, lt=1.0)

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """The row with context without its implausible tail."""
        return plausible_only(with_context, with_context, self.beta)
