"""One varying quantity of a family: its distribution, the fact that it rests on, and the reason of its width.

Latent values are standard normal and independent; a value is the quantile of its distribution there. Draws no samples.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from itertools import accumulate
from statistics import NormalDist
from typing import Any, Literal

from sgcad_core.record_base import Record

_UNIT = NormalDist()
Told = Literal["stated", "inferred", "default"]


class Parameter(Record):
    """One varying quantity. `normal`: cut to [low, high]; `uniform`: over it; `choice`: one of `values`."""

    name: str
    kind: Literal["normal", "uniform", "choice"]
    mean: float
    spread: float
    """Standard deviation of a normal one."""
    low: float
    high: float
    nominal: float
    """The script's own value."""
    told: Told
    field: str
    """The fact that it rests on; "" where the report states none."""
    reason: str
    values: tuple[float, ...] = ()
    """Values of a choice, rising; `shares` are their probabilities, `words` their meanings."""
    shares: tuple[float, ...] = ()
    words: tuple[str, ...] = ()

    def value(self, latent: float) -> float:
        """The quantile of a standard normal value."""
        share = min(max(_UNIT.cdf(latent), 1e-9), 1 - 1e-9)
        if self.kind == "uniform":
            return self.low + share * (self.high - self.low)
        if self.kind == "choice":
            return self.values[min(bisect_right(list(accumulate(self.shares)), share), len(self.values) - 1)]
        normal = NormalDist(self.mean, self.spread)
        first, last = normal.cdf(self.low), normal.cdf(self.high)
        return min(max(normal.inv_cdf(first + share * (last - first)), self.low), self.high)


Facts = Mapping[str, Mapping[str, Any]]
"""By field."""


def field_at(actor: str, name: str) -> str:
    """The field name of a fact on an actor."""
    return f"{'vehicles' if actor.startswith('V') else 'others'}.{actor}.{name}"


def told_of(known: Facts, field: str) -> Told:
    """The status of a field."""
    status = known.get(field, {}).get("status", "default")
    return status if status in ("stated", "inferred") else "default"
