"""Weights of two readers from where they differ, and figures of what comes of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sgcad_core.metrics.statistics import mcnemar

BINS = 10
RIDGE = 1.0
"""Strength with which the fit holds to the weights of no knowledge: as much as one report of each kind."""
STEPS = 200
SIGNS = (0, 1, -1, 1, 1, 1)
"""What weights may be, in the order of `combiner.terms`: a value of the model's that is more probable, better grounded,
more likely told or likelier by the learned reader is no less likely right, and one against what the text tells outright
no more (0: of either sign)."""
Floats = NDArray[np.float64]


def logistic(rows: Floats, marks: Floats, signs: Sequence[int] = ()) -> Floats:
    """Logistic regression of marks (n,) of 0 and 1 on rows (n, k), with a ridge about (0, 1, 0, ...), (k,) weights.

    Columns: 1, logit of p, told, ... With `signs` (1: at least 0, -1: at most 0, 0: either) a column whose weight would
    have the other sign is left out, the one furthest off first.
    """
    kept = list(range(rows.shape[1]))
    while kept:
        found = np.zeros(rows.shape[1])
        found[kept] = _fitted(rows[:, kept], marks, np.array([float(column == 1) for column in kept]))
        wrong = {column: -sign * found[column] for column, sign in enumerate(signs) if sign * found[column] < 0}
        if not wrong:
            return found
        kept.remove(max(wrong, key=lambda column: wrong[column]))
    return np.zeros(rows.shape[1])


def _fitted(rows: Floats, marks: Floats, begun: Floats) -> Floats:
    """Newton's steps, halved while they lead up, for a ridge about `begun`."""

    def cost(at: Floats) -> float:
        return float(np.logaddexp(0, rows @ at).sum() - marks @ (rows @ at) + RIDGE / 2 * ((at - begun) ** 2).sum())

    found = begun.copy()
    for _ in range(STEPS if len(rows) else 0):
        share = 1 / (1 + np.exp(-np.clip(rows @ found, -30, 30)))
        slope = rows.T @ (share - marks) + RIDGE * (found - begun)
        bend = (rows * (share * (1 - share))[:, None]).T @ rows + RIDGE * np.eye(len(begun))
        step = np.linalg.solve(bend, slope)
        while np.abs(step).max() > 1e-8 and cost(found - step) > cost(found):
            step /= 2
        if np.abs(step).max() <= 1e-8:
            break
        found -= step
    return found


def calibration_error(marks: Sequence[tuple[float, bool]]) -> float:
    """Expected calibration error over `BINS` bins of equal width (Naeini et al. 2015)."""
    total = 0.0
    for low in range(BINS):
        inside = [(p, hit) for p, hit in marks if min(int(p * BINS), BINS - 1) == low]
        total += abs(sum(p for p, _ in inside) - sum(hit for _, hit in inside))
    return total / max(1, len(marks))


def versus(pairs: Sequence[tuple[bool, bool]]) -> str:
    """How many the second has right and the first wrong, the other way round, and the exact McNemar test's p."""
    better = sum(b and not a for a, b in pairs)
    worse = sum(a and not b for a, b in pairs)
    before, after = zip(*pairs, strict=True) if pairs else ((), ())
    return f"+{better} -{worse}, {mcnemar(before, after):.3f}"
