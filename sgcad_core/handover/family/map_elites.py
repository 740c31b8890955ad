"""The hardest members of a family for each kind of hardness: MAP-Elites, with importance weights.

J.-B. Mouret, J. Clune, Illuminating search spaces by mapping elites, 2015: the hardest sample of every cell of a grid
of descriptors is kept, and new samples are normal steps from those in latent space. Every batch is drawn from a known
mixture: a share of the family itself, the rest steps from an elite chosen evenly. So each sample has the weight density
of the family / density of its batch, at most 1 / FAMILY_SHARE, and rates under the family stay unbiased. Own code: the
algorithm is short, and the library for it (ribs) has no weights. Knows numpy; hardness and cell are a function
argument.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sgcad_core.case.records import Floats
from sgcad_core.handover.family.cross_entropy import Searched, batch_sizes

FAMILY_SHARE = 0.25
"""Of every batch, drawn from the family itself."""
FIRST_SHARE = 0.3
"""Of all samples: the first batch, all of it from the family (weights 1)."""
STEP = 0.4
"""Standard deviation of a step from an elite, in standard deviations of the family."""
BATCHES = 8
Cell = tuple[int, ...]
Judged = tuple[float, Cell]
"""Hardness, and the cell of the descriptors."""


@dataclass(frozen=True, eq=False)
class Illuminated:
    """All samples with their weights, and of every cell that was reached the number of its hardest sample."""

    samples: Searched
    elites: dict[Cell, int]


class _Archive:
    def __init__(self, judge: Callable[[Floats], Judged | None], dimensions: int) -> None:
        self.judge, self.dimensions = judge, dimensions
        self.latents: list[Floats] = []
        self.hardness: list[float] = []
        self.weights: list[float] = []
        self.elites: dict[Cell, int] = {}

    def add(self, batch: Floats, weights: Floats) -> None:
        for z, weight in zip(batch, weights, strict=True):
            judged = self.judge(z)
            hardness, cell = judged if judged is not None else (-np.inf, None)
            self.latents.append(z)
            self.hardness.append(float(hardness))
            self.weights.append(float(weight))
            if cell is not None and (cell not in self.elites or hardness > self.hardness[self.elites[cell]]):
                self.elites[cell] = len(self.hardness) - 1

    @property
    def kept(self) -> Floats:
        """(m, d) latents of the elites."""
        return np.array([self.latents[k] for k in self.elites.values()]).reshape(-1, self.dimensions)


def illuminate(judge: Callable[[Floats], Judged | None], dimensions: int, count: int, seed: int) -> Illuminated:
    """Draws `count` samples. `judge` of a latent vector; None: no member, in no cell."""
    rng = np.random.default_rng(seed)
    archive = _Archive(judge, dimensions)
    first = min(max(round(FIRST_SHARE * count), 1), count)
    archive.add(rng.standard_normal((first, dimensions)), np.ones(first))
    for drawn in batch_sizes(count - first, BATCHES):
        kept = archive.kept
        batch = _drawn(rng, kept, drawn, dimensions)
        archive.add(batch, _weights(batch, kept))
    found = np.array(archive.hardness)
    latents = np.array(archive.latents).reshape(-1, dimensions)
    return Illuminated(Searched(latents, found, np.array(archive.weights)), archive.elites)


def _drawn(rng: np.random.Generator, kept: Floats, count: int, dimensions: int) -> Floats:
    """(count, d): some of the family, the others steps from elites; of the family only, where there are none."""
    batch = rng.standard_normal((count, dimensions))
    stepped = np.flatnonzero(rng.random(count) >= FAMILY_SHARE) if len(kept) else np.array([], dtype=int)
    parents = kept[rng.integers(len(kept), size=len(stepped))] if len(stepped) else kept[:0]
    batch[stepped] = parents + STEP * batch[stepped]
    return batch


def _weights(z: Floats, kept: Floats) -> Floats:
    """Density of the family over that of the mixture that a batch was drawn from."""
    if not len(kept):
        return np.ones(len(z))
    family = -(z**2).sum(axis=1) / 2
    steps = -((z[:, None, :] - kept[None, :, :]) ** 2).sum(axis=2) / (2 * STEP**2) - z.shape[1] * np.log(STEP)
    top = np.maximum(family, steps.max(axis=1))
    mixture = FAMILY_SHARE * np.exp(family - top) + (1 - FAMILY_SHARE) * np.exp(steps - top[:, None]).mean(axis=1)
    weights: Floats = np.exp(family - top) / mixture
    return weights
