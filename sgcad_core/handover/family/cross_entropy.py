"""The hardest members of a family for a driver, by cross-entropy, and a rate with importance weights.

R. Y. Rubinstein, D. P. Kroese, The Cross-Entropy Method, 2004: in the space of latent standard normals a diagonal
normal proposal is moved, round by round, to the elite of the samples, smoothed. Every sample has the weight density of
the family / density of its own proposal, so that all samples give an unbiased rate of an event under the family (a
mixture of the proposals would be tighter). Knows numpy; the hardness is a function argument.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sgcad_core.case.records import Floats

ELITE = 0.2
SMOOTHING = 0.7
LEAST_SPREAD = 0.3
"""Least standard deviation of the proposal: narrower ones give useless weights."""


@dataclass(frozen=True, eq=False)
class Searched:
    """All samples: latents (n, d), hardness (n,), weights (n,) with mean 1 in expectation, and the last proposal, if
    there is one."""

    latents: Floats
    hardness: Floats
    weights: Floats
    mean: Floats | None = None
    spread: Floats | None = None

    def rate(self, event: ArrayLike) -> tuple[float, float]:
        """Probability of an event under the family, and its standard error."""
        w = self.weights * np.asarray(event, dtype=float)
        n = len(w)
        return float(w.mean()), float(w.std(ddof=1) / math.sqrt(n)) if n > 1 else math.inf

    @property
    def effective(self) -> float:
        """Kish's effective number of samples."""
        return float(self.weights.sum() ** 2 / (self.weights**2).sum())


def search(hardness: Callable[[Floats], float | None], dimensions: int, count: int, rounds: int, seed: int) -> Searched:
    """Moves a proposal towards hard samples. `hardness` of a latent vector; None: no member, counts as the least hard.

    Each round draws count / rounds samples; the first one is the family itself (weights 1).
    """
    rng = np.random.default_rng(seed)
    mean, spread = np.zeros(dimensions), np.ones(dimensions)
    latents, values, weights = [], [], []
    for drawn in batch_sizes(count, rounds):
        z = mean + spread * rng.standard_normal((drawn, dimensions))
        judged = [hardness(row) for row in z]
        found = np.array([-math.inf if value is None else value for value in judged])
        latents.append(z)
        values.append(found)
        weights.append(_weights(z, mean, spread))
        known = np.isfinite(found)
        if known.sum() >= 4:
            mean, spread = _towards(z[known], found[known], mean, spread)
    return Searched(np.vstack(latents), np.concatenate(values), np.concatenate(weights), mean, spread)


def batch_sizes(count: int, batches: int) -> list[int]:
    """A number of samples split as evenly as possible; empty batches are left out."""
    return [n for k in range(batches) if (n := count // batches + (k < count % batches))]


def _weights(z: Floats, mean: Floats, spread: Floats) -> Floats:
    """Density of the family over that of the proposal."""
    log = ((z - mean) ** 2 / spread**2 - z**2).sum(axis=1) / 2 + np.log(spread).sum()
    weights: Floats = np.exp(log)
    return weights


def _towards(z: Floats, values: Floats, mean: Floats, spread: Floats) -> tuple[Floats, Floats]:
    elite = z[np.argsort(-values, kind="stable")[: max(int(ELITE * len(z)), 3)]]
    a = SMOOTHING
    return (1 - a) * mean + a * elite.mean(axis=0), np.maximum((1 - a) * spread + a * elite.std(axis=0), LEAST_SPREAD)


def rank_correlations(latents: Floats, outcome: Floats) -> Floats:
    """(d,) Spearman rank correlation of each parameter with the outcome; 0 where one of the two does not vary."""
    from scipy.stats import spearmanr

    known = np.isfinite(outcome)
    if known.sum() < 3 or np.ptp(outcome[known]) == 0:
        return np.zeros(latents.shape[1])
    varies = np.ptp(latents[known], axis=0) > 0
    return np.array([
        float(spearmanr(column, outcome[known]).statistic) if moves else 0.0
        for column, moves in zip(latents[known].T, varies, strict=True)
    ])  # fmt: skip
