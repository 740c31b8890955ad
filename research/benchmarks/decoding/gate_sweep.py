"""From groundings to thresholds: how well "refuse below" tells thin evidence from enough, and where to draw the line.

Pure numbers: a sample is one report at one robustness level, its group sums in nats and whether the model itself
declined. Knows no model and no file.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
CANDIDATES = 48
"""Thresholds tried a group: quantiles of what was seen."""


@dataclass(frozen=True)
class Sample:
    """One report at one level; `sums` lacks the groups that were not answered."""

    case: str
    level: str
    thin: bool
    """The level takes away what carries the crash: it should be refused."""
    declined: bool
    """The model refused by itself."""
    sums: Mapping[str, float]


@dataclass(frozen=True)
class Score:
    """Of refusals: how many were right, how many of the thin reports were caught."""

    right: int
    given: int
    wanted: int
    samples: int

    @property
    def precision(self) -> float:
        """Share of the refusals that were right; 1 where none was given."""
        return self.right / self.given if self.given else 1.0

    @property
    def recall(self) -> float:
        """Share of the thin reports that were refused."""
        return self.right / self.wanted if self.wanted else 0.0

    @property
    def f1(self) -> float:
        """Harmonic mean of both."""
        return 2 * self.right / (self.given + self.wanted) if self.given + self.wanted else 0.0

    @property
    def false_alarms(self) -> float:
        """Share of the reports with enough evidence that were refused."""
        enough = self.samples - self.wanted
        return (self.given - self.right) / enough if enough else 0.0


def halves(samples: Sequence[Sample]) -> tuple[list[Sample], list[Sample]]:
    """Reports to choose on and to measure on: by a hash of the case, so that its levels stay together."""
    first = [hashlib.sha256(s.case.encode()).digest()[0] % 2 == 0 for s in samples]
    return [s for s, one in zip(samples, first, strict=True) if one], [
        s for s, one in zip(samples, first, strict=True) if not one
    ]


def refused(samples: Sequence[Sample], thresholds: Mapping[str, float | None], model: bool = True) -> Bools:
    """Which samples the gate refuses, or (`model`) gate or model: a group's sum lies below its threshold."""
    limits = {group: limit for group, limit in thresholds.items() if limit is not None}
    return np.array(
        [
            (model and s.declined) or any(s.sums.get(group, np.inf) < limit for group, limit in limits.items())
            for s in samples
        ],
        dtype=bool,
    )


def score(samples: Sequence[Sample], refusals: Bools) -> Score:
    """Count refusals against what was wanted."""
    thin = np.array([s.thin for s in samples], dtype=bool)
    return Score(int((thin & refusals).sum()), int(refusals.sum()), int(thin.sum()), len(samples))


def area(samples: Sequence[Sample], group: str) -> float:
    """Area under the curve of one group alone: the chance that a thin report has the smaller sum; ties count half."""
    thin = np.array([s.sums[group] for s in samples if s.thin and group in s.sums])
    enough = np.array([s.sums[group] for s in samples if not s.thin and group in s.sums])
    if not len(thin) or not len(enough):
        return float("nan")
    less = (thin[:, None] < enough[None]).mean() + 0.5 * (thin[:, None] == enough[None]).mean()
    return float(less)


def candidates(samples: Sequence[Sample], group: str) -> list[float]:
    """Thresholds worth trying, ascending: between neighbouring sums, thinned out to quantiles."""
    sums = np.unique([s.sums[group] for s in samples if group in s.sums])
    if len(sums) < 2:
        return []
    between = (sums[1:] + sums[:-1]) / 2
    some = np.unique(np.quantile(between, np.linspace(0, 1, min(CANDIDATES, len(between))), method="nearest"))
    return [round(float(t), 2) for t in some]


def sweep(samples: Sequence[Sample], group: str, rows: int = 9) -> Iterator[tuple[float, Score]]:
    """One group alone at thresholds from few to many refusals; the model's own refusals left out."""
    tried = candidates(samples, group)
    for i in sorted({round(p * (len(tried) - 1)) for p in np.linspace(0, 1, rows)} if tried else ()):
        yield tried[i], score(samples, refused(samples, {group: tried[i]}, model=False))


def choose(samples: Sequence[Sample], groups: Sequence[str], precision: float | None = None) -> dict[str, float | None]:
    """Thresholds of all groups together (None: not required), for maximal F1 of the pipeline's refusals.

    With `precision`, the largest recall that keeps it. One group at a time is changed, as long as that helps; of
    equal choices the one that refuses less. Refusals of the model count: the gate cannot take them back.
    """
    found: dict[str, float | None] = dict.fromkeys(groups)
    best = _worth(score(samples, refused(samples, found)), precision)
    while True:
        tries = [{**found, group: t} for group in groups for t in (None, *candidates(samples, group))]
        ranked = [(_worth(score(samples, refused(samples, one)), precision), one) for one in tries]
        worth, one = max(ranked, key=lambda r: r[0], default=(best, found))
        if worth <= best:
            return found
        best, found = worth, one


def _worth(one: Score, precision: float | None) -> tuple[float, ...]:
    if precision is None:
        return (one.f1, -one.given)
    kept = one.precision >= precision
    return (float(kept), one.recall if kept else one.precision, -one.given)
