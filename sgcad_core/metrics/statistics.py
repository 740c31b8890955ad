"""How sure a figure over cases is, and whether two arms differ: bootstrap intervals, paired tests, Holm's correction.

A figure is a ratio of sums over cases, sum(a) / sum(b); with b = 1 it is the mean, and with a in {0, 1} besides a
share. Everything random is seeded, so the same cases give the same digits. Knows arrays, no metric and no file.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache
from statistics import NormalDist
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgcad_core.case.records import Floats

LEVEL = 0.95
RESAMPLES = 5_000
"""The ends of an interval then move by about 0.01 standard errors of a percentile from seed to seed."""
FLIPS = 9_999
EXACT_CASES = 13
"""Up to so many differing cases every one of the 2^n sign patterns is counted instead of drawn."""
SEED = 42
BLOCK = 4_000_000
"""Elements of the resampling table kept at a time."""
_NORMAL = NormalDist()


class Interval(NamedTuple):
    """A confidence interval and how it was found: `bca`, `percentile`, or `exact` (Clopper and Pearson)."""

    low: float
    high: float
    method: Literal["bca", "percentile", "exact"]


# ------------------------------------------------------------------ intervals
def share_interval(outcomes: ArrayLike, level: float = LEVEL, seed: int = SEED) -> Interval | None:
    """Bootstrap interval of a share: outcomes are 0 or 1, one a case.

    A share of 0 or 1 has a bootstrap interval of no width, which would claim certainty from any number of cases:
    there the exact binomial interval stands.
    """
    x = np.asarray(outcomes, dtype=float)
    if x.size and x.min() == x.max():
        return _unanimous(len(x), bool(x[0]), level)
    return mean_interval(x, level, seed)


def wilson(hits: int, n: int, level: float = LEVEL) -> tuple[float, float]:
    """Score interval of hits of n (E. B. Wilson, JASA 22 (1927) 209): no wider than [0, 1], never empty; n > 0."""
    z = _NORMAL.inv_cdf((1 + level) / 2)
    share, weight = hits / n, 1 + z * z / n
    middle = (share + z * z / (2 * n)) / weight
    half = z / weight * math.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    return max(middle - half, 0.0), min(middle + half, 1.0)


def mean_interval(values: ArrayLike, level: float = LEVEL, seed: int = SEED) -> Interval | None:
    """Bootstrap interval of a mean over cases; None of no cases."""
    x = np.asarray(values, dtype=float)
    return ratio_interval(x, np.ones_like(x), level, seed)


def ratio_interval(
    numerators: ArrayLike, denominators: ArrayLike, level: float = LEVEL, seed: int = SEED
) -> Interval | None:
    """Interval of sum(a) / sum(b), cases drawn with replacement; None where sum(b) is 0.

    Bias-corrected and accelerated (Efron 1987); the plain percentiles where a jackknife sample has no
    denominator. A resample without denominator is drawn out of the picture.
    """
    a, b = np.asarray(numerators, dtype=float), np.asarray(denominators, dtype=float)
    if not a.size or b.sum() == 0:
        return None
    estimate = float(a.sum() / b.sum())
    draws = np.sort(_resampled(a, b, seed))
    ends = _bca_ends(estimate, draws, a, b, level)
    method: Literal["bca", "percentile"] = "percentile" if ends is None else "bca"
    low, high = np.quantile(draws, ends or ((1 - level) / 2, (1 + level) / 2))
    return Interval(float(low), float(high), method)


def _resampled(a: Floats, b: Floats, seed: int) -> Floats:
    """(RESAMPLES,) ratios of resampled sums."""
    rows = max(1, BLOCK // len(a))
    pair = np.stack((a, b), axis=1)
    total: Floats = np.concatenate([counts @ pair for counts in _counts(len(a), seed, rows)])
    total = total[total[:, 1] > 0]
    ratios: Floats = total[:, 0] / total[:, 1]
    return ratios


@lru_cache(maxsize=4)
def _counts(n: int, seed: int, rows: int) -> tuple[NDArray[np.float32], ...]:
    """How often each of n cases is drawn in each resample, in blocks of rows; single precision holds counts exactly."""
    draw = np.random.default_rng((seed, n))
    blocks = []
    for start in range(0, RESAMPLES, rows):
        size = min(rows, RESAMPLES - start)
        picks = draw.integers(0, n, (size, n)) + np.arange(size)[:, None] * n
        blocks.append(np.bincount(picks.ravel(), minlength=size * n).reshape(size, n).astype(np.float32))
    return tuple(blocks)


def _bca_ends(estimate: float, draws: Floats, a: Floats, b: Floats, level: float) -> tuple[float, float] | None:
    """The two percentiles of the BCa interval; None where they are undefined."""
    rest = b.sum() - b
    below = float((draws < estimate).mean() + (draws == estimate).mean() / 2)
    if len(a) < 2 or (rest <= 0).any() or not 0 < below < 1:
        return None
    left_out = (a.sum() - a) / rest
    pull = left_out.mean() - left_out
    spread = float((pull**2).sum())
    if spread < 1e-24:
        return None
    bias, bend = _NORMAL.inv_cdf(below), float((pull**3).sum()) / (6 * spread**1.5)

    def end(share: float) -> float:
        z = bias + _NORMAL.inv_cdf(share)
        return _NORMAL.cdf(bias + z / (1 - bend * z)) if bend * z < 1 else 1.0

    return end((1 - level) / 2), end((1 + level) / 2)


def _unanimous(n: int, all_ones: bool, level: float) -> Interval:
    """Clopper and Pearson's interval of n of n or 0 of n."""
    edge = ((1 - level) / 2) ** (1 / n)
    return Interval(edge, 1.0, "exact") if all_ones else Interval(0.0, 1 - edge, "exact")


# ------------------------------------------------------------------ paired tests
def mcnemar(first: ArrayLike, second: ArrayLike) -> float:
    """Exact two-sided McNemar test on paired 0/1 outcomes of the same cases: p that neither is right more often."""
    x, y = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    _check_paired(x, y)
    only_first, only_second = int(((x == 1) & (y == 0)).sum()), int(((x == 0) & (y == 1)).sum())
    differing = only_first + only_second
    tail = sum(math.comb(differing, k) for k in range(min(only_first, only_second) + 1))
    return min(1.0, 2 * tail / (1 << differing))


def swap_test(first: tuple[Floats, Floats], second: tuple[Floats, Floats], seed: int = SEED) -> float:
    """Two-sided paired permutation test on two ratios sum(a) / sum(b): the arms change places case by case.

    Every pattern is counted while 13 or fewer cases differ; else 9,999 are drawn and the seen one added to them
    (so that p is never 0).
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
