"""Yielding at junctions: one who must yield goes first into a place to which the other comes within `hazard_s`, or
makes it brake hard ("so closely as to constitute an immediate hazard", UVC 11-402 to 11-404).

Measured: the least time between the one leaving a place and the other coming to it (0: they touch). Merges,
backing and starts from the curb are not judged; changes of lane are (`lane_change`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import box_gaps
from sgcad_core.metrics.conflict import box_distance
from sgcad_core.metrics.drivability import STEP_S
from sgcad_core.metrics.swept_cells import Track, common_cells
from sgcad_core.rules.passages import Passage
from sgcad_core.rules.priority import duty
from sgcad_core.rules.records import Mover, RuleFinding, RuleScene, Status

_BEHIND = 30
"""Samples after a vehicle has left the junction for which the others still come to its places."""
_SEEN_S = 6.0
"""A pair whose places are further apart in time has nothing to do with each other."""
_RISE_MPS2 = 0.5


class Meeting(NamedTuple):
    """Two motions: seconds between one leaving places and the other coming to them (0: touched; inf: never after), and
    whether one came first anywhere."""

    gap_s: float
    first: bool
    apart_s: float
    """Least time between them at a place, in either order; inf: no common place."""


def right_of_way(scene: RuleScene, crossed: Sequence[Passage]) -> Iterator[RuleFinding]:
    """One finding for each pair at a junction of which one must yield and both come near in time."""
    for one in crossed:
        for other in crossed:
            if other.mover is one.mover or other.node != one.node:
                continue
            told = duty(scene, one, other)
            if told.yields is not False and (found := _judged(scene, one, other, told.yields, told.why)) is not None:
                yield found


def _judged(scene: RuleScene, one: Passage, other: Passage, yields: bool | None, why: str) -> RuleFinding | None:
    met = meeting(one.mover, (one.line, one.clear + _BEHIND), other.mover)
    braked = _braked(scene, one, other)
    if met.apart_s > _SEEN_S and not braked:
        return None
    hazard = (met.first and met.gap_s < scene.limits.hazard_s) or braked
    status: Status = "unknown" if yields is None else "broken" if hazard else "kept"
    measured = met.gap_s if met.first else met.apart_s
    note = why + (f"; {other.mover.id} brakes for it" if braked and yields else "")
    return one.mover.found("right_of_way", status, (one.line, one.clear), one.where, _finite(measured),
                           scene.limits.hazard_s, "s", note, other.mover.id)  # fmt: skip


def meeting(one: Mover, span: tuple[int, int], other: Mover) -> Meeting:
    """How one between two samples and another meet."""
    if touches(one, other):
        return Meeting(0.0, True, 0.0)
    a, b = one.track(*span), other.track(0, len(other.pose) - 1)
    area = _area(a, b)
    if area is None:
        return Meeting(np.inf, False, np.inf)
    (a_in, a_out), (b_in, b_out) = area
    first = a_in < b_in
    after = np.where(first, np.maximum(b_in - a_out, 0.0), np.inf)
    apart = np.maximum(np.maximum(b_in - a_out, a_in - b_out), 0.0)
    return Meeting(float(after.min()), bool(first.any()) or float(apart.min()) == 0.0, float(apart.min()))


def touches(one: Mover, other: Mover) -> bool:
    """Whether the first contact of both is with each other."""
    if one.until is None or one.until != other.until:
        return False
    last = one.whole.pose[[one.until]], other.whole.pose[[other.until]]
    return bool(box_gaps(last[0], one.size, last[1], other.size)[0] <= 0)


def _area(a: Track, b: Track) -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]] | None:
    low = np.maximum(*(t.pose[:, :2].min(axis=0) - max(t.size) for t in (a, b)))
    high = np.minimum(*(t.pose[:, :2].max(axis=0) + max(t.size) for t in (a, b)))
    return None if (high <= low).any() else common_cells(a, b, low, high)


def _braked(scene: RuleScene, one: Passage, other: Passage) -> bool:
    """Whether the other brakes hard, near and before its own passage, only once one is on its way."""
    n = min(len(one.mover.pose), len(other.mover.pose))
    last = min(one.clear, other.line, n - 1)
    if last - one.line < 2:
        return False
    rate = np.gradient(other.mover.speed_mps[:n], STEP_S)
    before = float(rate[max(one.line - 10, 0) : one.line + 1].min())
    near = box_distance(one.mover.track(one.line, last), other.mover.track(one.line, last))
    hard = rate[one.line : last + 1] < -scene.limits.hazard_braking_mps2
    return before > -_RISE_MPS2 and bool((hard & (near < scene.limits.hazard_range_m)).any())


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
