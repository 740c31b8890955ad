"""Nucleus sampling: temperature, then the smallest set of tokens whose mass reaches top_p.

    p'(y) = p(y) / sum_{V(p)} p   for y in V(p), else 0

Holtzman et al. 2020, "The Curious Case of Neural Text Degeneration", arXiv:1904.09751.
"""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from plugins.decoder.base import Sampled


class Nucleus(Sampled):
    """Samples from the row with context; reproducible, since the caller seeds the random generator."""

    needs_prior: ClassVar[bool] = False
    temperature: float = Field(0.7, ge=0.0, le=5.0)
    top_p: float = Field(0.9, gt=0.0, le=1.0)

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """The row with context, unchanged: `draw` samples, after the grammar."""
        return with_context
