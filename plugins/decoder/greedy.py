"""Greedy decoding: y_t = argmax logit(y | c, x, y_<t). The evidence row alone, no randomness."""

from __future__ import annotations

from typing import Any, ClassVar

from sgcad_core.interfaces import Decoder


class Greedy(Decoder):
    """Takes the most likely token at every step; the baseline of every ablation."""

    needs_prior: ClassVar[bool] = False

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """The row with context, unchanged."""
        return with_context
