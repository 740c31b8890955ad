"""What a model's server must be able to do for contrast, whatever its protocol: draft, and tell log-probabilities.

A place is where a token follows: place i of a text is behind its first i tokens. Knows no HTTP and no decoder.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

Schema = Mapping[str, Any] | None
LEAST = -1e4
"""Servers write -inf as -9999 or as no number; a finite value keeps differences of two rows finite."""


@dataclass(frozen=True)
class Top:
    """Log-probabilities in nats of the tokens that a server told at one place.

    No token that is not in `known` is above `bound`, which is -inf where the whole vocabulary is told.
    """

    known: Mapping[int, float]
    bound: float

    @classmethod
    def of(cls, pairs: Iterable[tuple[int, float | None]], asked: int) -> Top:
        """From (token, log-probability) pairs: the `asked` most likely ones, and perhaps the token that is there."""
        known = {int(token): LEAST if logp is None else max(float(logp), LEAST) for token, logp in pairs}
        ranked = sorted(known.values(), reverse=True)
        return cls(known, ranked[asked - 1] if 0 < asked <= len(ranked) else float("-inf"))

    def with_known(self, more: Mapping[int, float]) -> Top:
        """The same place with the exact values of further tokens."""
        return Top({**self.known, **more}, self.bound)


@dataclass(frozen=True)
class Offer:
    """What a server says of itself. `most` is the largest top k (None: the whole vocabulary), `window` in tokens."""

    model: str
    window: int | None
    most: int | None


class Speaker(ABC):
    """One server's protocol. Every method may raise the errors of `http.ServerHttp`."""

    named = 64
    """Up to how many tokens asking for their values by `exact` costs less than a larger top k."""
    at_once = False
    """Whether one request tells the values of given tokens at many places (`exact_of`)."""
    guided = True
    """Whether a draft from the start of an answer follows the schema."""

    @abstractmethod
    def offer(self) -> Offer:
        """Asks the server what it has. Raises ConfigError where no contrast is possible, with the reason."""

    @abstractmethod
    def spelled(self, text: str) -> list[int] | None:
        """The server's tokens of a text, no special ones added; None where it does not tell."""

    @abstractmethod
    def draft(self, prompt: Sequence[int], behind: Sequence[int], limit: int, schema: Schema) -> list[int]:
        """At most `limit` tokens that the model finds most likely behind prompt and `behind`.

        `schema` guides the server from the start of an answer; it may be ignored.
        """

    def draft_told(
        self, prompt: Sequence[int], behind: Sequence[int], limit: int, schema: Schema, top: int
    ) -> tuple[list[int], list[Top]]:
        """A draft, and the places of its tokens where the server tells them with it; here it does not.

        Values are those before the schema's mask.
        """
        return self.draft(prompt, behind, limit, schema), []

    @abstractmethod
    def tops(self, prompt: Sequence[int], behind: Sequence[int], count: int, top: int) -> list[Top]:
        """The last `count` places of prompt and `behind`: [-1] is the place of the token that would follow."""

    def tops_of(self, prompts: Sequence[Sequence[int]], behind: Sequence[int], count: int, top: int) -> list[list[Top]]:
        """`tops` of several prompts behind which the same tokens stand: side by side, or in one request."""
        with ThreadPoolExecutor(len(prompts)) as pool:
            return list(pool.map(lambda prompt: self.tops(prompt, behind, count, top), prompts))

    @abstractmethod
    def exact(self, prompt: Sequence[int], behind: Sequence[int], tokens: Sequence[int]) -> dict[int, float]:
        """Log-probabilities of given tokens at the place behind it all; whatever their rank."""

    def exact_of(self, texts: Sequence[list[int]], tokens: Sequence[int]) -> list[dict[int, float]]:
        """`exact` behind each of several texts, prompts included."""
        return [self.exact(text, (), tokens) for text in texts]
