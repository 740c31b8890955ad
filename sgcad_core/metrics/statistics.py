"""Confidence intervals of a figure over cases, and tests whether two arms differ.

A figure is a ratio of sums over cases, sum(a) / sum(b): a mean where b = 1, a share where also a is 0 or 1. All random
draws are seeded, so the same cases give the same digits. `scipy.stats` does the work where it has the method (bootstrap
and binomial intervals and tests); it is imported on first use, since it takes a second to load.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sgcad_core.case.records import Floats

LEVEL = 0.95
RESAMPLES = 5_000
"""With these many the ends of an interval move by about 0.01 standard errors of a percentile from seed to seed."""
FLIPS = 9_999
"""Sign patterns drawn by `swap_test` where not all are counted."""
EXACT_CASES = 13
"""Up to this number of differing cases all 2^n sign patterns are counted instead of drawn."""
SEED = 42
BLOCK = 4_000_000
"""Elements of the resampling table in memory at a time."""


class Interval(NamedTuple):
    """A confidence interval and its method: `bca`, `percentile`, or `exact` (Clopper and Pearson)."""

    low: float
    high: float
    method: Literal["bca", "percentile", "exact"]


# ------------------------------------------------------------------ intervals
def share_interval(outcomes: ArrayLike, level: float = LEVEL, seed: int = SEED) -> Interval | None:
    """Bootstrap interval of a share; outcomes are 0 or 1, one a case.

    A share of 0 or 1 has a bootstrap interval of no width, which would claim certainty from any number of cases.
    The exact binomial interval (Clopper and Pearson) replaces it.
    """
    x = np.asarray(outcomes, dtype=float)
    if x.size and x.min() == x.max():
        return Interval(*_binomial_interval(int(x.sum()), len(x), level, "exact"), "exact")
    return mean_interval(x, level, seed)


def wilson(hits: int, n: int, level: float = LEVEL) -> tuple[float, float]:
    """Score interval of hits of n (E. B. Wilson, JASA 22 (1927) 209): no wider than [0, 1], never empty; n > 0."""
    return _binomial_interval(hits, n, level, "wilson")


def _binomial_interval(hits: int, n: int, level: float, method: Literal["exact", "wilson"]) -> tuple[float, float]:
    from scipy.stats import binomtest

    low, high = binomtest(hits, n).proportion_ci(level, method)
    return float(low), float(high)


def mean_interval(values: ArrayLike, level: float = LEVEL, seed: int = SEED) -> Interval | None:
    """Bootstrap interval of a mean over cases; None of no cases."""
    x = np.asarray(values, dtype=float)
    return ratio_interval(x, np.ones_like(x), level, seed)


def ratio_interval(
    numerators: ArrayLike, denominators: ArrayLike, level: float = LEVEL, seed: int = SEED
) -> Interval | None:
    """Interval of sum(a) / sum(b), cases drawn with replacement; None where sum(b) is 0.

    Bias-corrected and accelerated (B. Efron, JASA 82 (1987) 171); plain percentiles where that is not defined, e.g.
    where all denominators but one are 0. Resamples whose denominator is 0 are left out.
    """
    a, b = np.asarray(numerators, dtype=float), np.asarray(denominators, dtype=float)
    if not a.size or b.sum() == 0:
        return None
    if a.size == 1:
        return Interval(float(a[0] / b[0]), float(a[0] / b[0]), "percentile")
    return _bootstrapped(a, b, level, np.random.default_rng((seed, a.size)))


def _bootstrapped(a: Floats, b: Floats, level: float, draw: np.random.Generator) -> Interval:
    from scipy.stats import DegenerateDataWarning, bootstrap

    settings: dict[str, Any] = {"paired": True, "vectorized": True, "confidence_level": level}
    with warnings.catch_warnings(), np.errstate(divide="ignore", invalid="ignore"):
        warnings.simplefilter("ignore", DegenerateDataWarning)
        drawn = bootstrap(
            (a, b), _ratio_of_sums, n_resamples=RESAMPLES, batch=max(1, BLOCK // a.size), method="percentile",
            random_state=draw, **settings,
        )  # fmt: skip
        drawn.bootstrap_distribution = drawn.bootstrap_distribution[np.isfinite(drawn.bootstrap_distribution)]
        settings |= {"n_resamples": 0, "bootstrap_result": drawn}
        low, high = bootstrap((a, b), _ratio_of_sums, method="BCa", **settings).confidence_interval
        if np.isfinite(low) and np.isfinite(high):
            return Interval(float(low), float(high), "bca")
        low, high = bootstrap((a, b), _ratio_of_sums, method="percentile", **settings).confidence_interval
    return Interval(float(low), float(high), "percentile")


def _ratio_of_sums(a: Floats, b: Floats, axis: int) -> Floats:
    ratio: Floats = a.sum(axis=axis) / b.sum(axis=axis)
    return ratio


# ------------------------------------------------------------------ paired tests
def mcnemar(first: ArrayLike, second: ArrayLike) -> float:
    """Exact two-sided McNemar test on paired 0/1 outcomes of the same cases: p of "neither is right more often"."""
    from scipy.stats import binomtest

    x, y = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    _check_paired(x, y)
    only_first, only_second = int(((x == 1) & (y == 0)).sum()), int(((x == 0) & (y == 1)).sum())
    if not only_first + only_second:
        return 1.0
    return float(binomtest(only_first, only_first + only_second).pvalue)


def swap_test(first: tuple[Floats, Floats], second: tuple[Floats, Floats], seed: int = SEED) -> float:
    """Two-sided paired permutation test on two ratios sum(a) / sum(b): the arms are swapped case by case.

    All patterns are counted where 13 or fewer cases differ; else 9,999 are drawn and the observed one is added, so that
    p is never 0. (`scipy.stats.permutation_test` would draw other patterns, and published digits would change.)
    """
    x, y = np.stack(first, axis=1).astype(float), np.stack(second, axis=1).astype(float)
    _check_paired(x, y)
    total, other, step = x.sum(axis=0), y.sum(axis=0), (y - x)[(x != y).any(axis=1)]
    flips = _patterns(len(step), seed)
    moved = flips @ step
    seen = abs(_ratio(total) - _ratio(other))
    drawn = np.abs(_ratio(total + moved) - _ratio(other - moved))
    as_far = int((drawn >= seen - 1e-12).sum())
    return as_far / len(flips) if len(step) <= EXACT_CASES else (as_far + 1) / (len(flips) + 1)


def _patterns(n: int, seed: int) -> Floats:
    """(m, n) of 0 and 1: all patterns, or FLIPS drawn ones."""
    if n <= EXACT_CASES:
        return ((np.arange(2**n)[:, None] >> np.arange(n)) & 1).astype(float)
    return np.random.default_rng((seed, n)).integers(0, 2, (FLIPS, n)).astype(float)


def _ratio(sums: Floats) -> Floats:
    a, b = sums[..., 0], sums[..., 1]
    ratio: Floats = np.divide(a, b, out=np.zeros_like(a), where=b > 0)
    return ratio


def _check_paired(x: Floats, y: Floats) -> None:
    if x.shape != y.shape:
        raise ValueError(f"a paired test needs the same cases in both arms: {len(x)} and {len(y)} values")


def holm(p_values: Mapping[str, float]) -> dict[str, float]:
    """Holm's step-down correction over the comparisons of one figure; keys stay, p never falls below the raw one."""
    corrected: dict[str, float] = {}
    worst = 0.0
    for rank, name in enumerate(sorted(p_values, key=lambda k: (p_values[k], k))):
        worst = max(worst, min(1.0, (len(p_values) - rank) * p_values[name]))
        corrected[name] = worst
    return {name: corrected[name] for name in p_values}
