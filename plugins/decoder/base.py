"""Base classes and functions of the decoders: sampling, the plausibility mask and the contrast of two rows.

Knows tensors by their methods only, so that naming a decoder in a YAML does not load torch. Knows no
model, no cache, no grammar: the backbone masks `scores` with the grammar before it calls `draw`.
"""

from __future__ import annotations

from math import log
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from sgcad_core.interfaces import Decoder

if TYPE_CHECKING:
    from torch import Tensor

_LEAST_LOGP = -1e4
"""Instead of -inf, so that differences of two excluded tokens stay numbers."""


class Sampled(Decoder):
    """A decoder that may sample: temperature 0, the default, takes the most likely token."""

    temperature: float = Field(0.0, ge=0.0, le=5.0)
    top_p: float = Field(1.0, gt=0.0, le=1.0)
    first_temperature: float | None = Field(
        None, ge=0.0, le=5.0, description="of first attempts, if another: 0 and chance only draws what findings ask for"
    )
    warming: float = Field(
        0.0, ge=0.0, le=1.0, description="added to the temperature with every attempt after the second"
    )

    def at(self, attempt: int) -> Sampled:
        """The decoder of an attempt: first `first_temperature`, then `temperature`, then `warming` more each time."""
        cold = self.first_temperature
        wanted = cold if attempt == 1 and cold is not None else self.temperature + self.warming * max(0, attempt - 2)
        return self if wanted == self.temperature else self.model_copy(update={"temperature": wanted})

    def draw(self, scores: Any, generator: Any) -> Any:
        """Picks one token for each row of masked logits (rows, vocabulary); see `sample`."""
        return sample(scores, self.temperature, self.top_p, generator)


class FixedContrast(Sampled):
    """A decoder that contrasts the two rows with the same alpha at every token."""

    needs_prior: ClassVar[bool] = True
    alpha: float = Field(0.7, ge=0.0, le=10.0)
    beta: float = Field(0.0, ge=0.0, lt=1.0, description="plausibility: p >= beta * max p with context; 0 = off")

    def reads_prior(self) -> bool:
        """False at alpha 0, which is the row with context alone: the second row is then not run."""
        return self.alpha > 0.0

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """Contrast, then plausibility; rows (rows, vocabulary) in, the same shape out."""
        if self.alpha == 0.0:
            return plausible_only(with_context, with_context, self.beta)
        return plausible_only(contrast(with_context, without_context, self.alpha), with_context, self.beta)


def sample(scores: Tensor, temperature: float, top_p: float, generator: Any) -> Tensor:
    """Draws one token index for each row, (rows,), from logits (rows, vocabulary) in which -inf excludes a token.

    Temperature divides the logits; top-p keeps the smallest set of most likely tokens whose mass
    reaches top_p (Holtzman et al. 2020, arXiv:1904.09751, eq. 2), the first token always.
    """
    if temperature == 0.0:
        return scores.argmax(-1)
    probabilities = (scores.float() / temperature).softmax(-1)
    if top_p < 1.0:
        ordered, order = probabilities.sort(-1, descending=True)
        before = ordered.cumsum(-1) - ordered
        ordered = ordered.masked_fill(before >= top_p, 0.0)
        probabilities = probabilities.new_zeros(probabilities.shape).scatter(-1, order, ordered)
    return probabilities.multinomial(1, generator=generator).squeeze(-1)


def contrast(with_context: Tensor, without_context: Tensor | None, alpha: float | Tensor) -> Tensor:
    """(1 + alpha) * with - alpha * without, in fp32; alpha a number or a column (rows, 1)."""
    if without_context is None:
        raise ValueError("this decoder needs the row without context; the backbone handed None")
    rows = with_context.float()
    return rows + alpha * (rows - without_context.float())


def plausible_only(scores: Tensor, with_context: Tensor, beta: float) -> Tensor:
    """Exclude tokens with p(y|c,x) < beta * max p(.|c,x) (Li et al. 2023, arXiv:2210.15097, eq. 4)."""
    if beta == 0.0:
        return scores
    floor = with_context.amax(-1, keepdim=True) + log(beta)
    return scores.masked_fill(with_context < floor, float("-inf"))


def log_rows(with_context: Tensor, without_context: Tensor | None) -> tuple[Tensor, Tensor]:
    """Log-probabilities of both rows, (rows, vocabulary) in fp32, nats; no token is -inf."""
    if without_context is None:
        raise ValueError("this decoder needs the row without context; the backbone handed None")
    first, second = (row.float().log_softmax(-1) for row in (with_context, without_context))
    return first.clamp_min(_LEAST_LOGP), second.clamp_min(_LEAST_LOGP)


def entropy(log_p: Tensor) -> Tensor:
    """Shannon entropy of rows of log-probabilities, nats: (rows, 1)."""
    return -(log_p.exp() * log_p).sum(-1, keepdim=True)
