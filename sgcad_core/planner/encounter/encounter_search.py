"""When and where two motions first touch, over all shifts of their clocks.

Both motions are sampled on one time grid; a shift of the clocks is a diagonal of the matrix of their pose pairs (a
column where one of them only enumerates places to stand at). Pure search on arrays; knows neither roads nor maneuvers.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import SIDES, Floats, box_gaps, overlap_centers, sides_at
from sgcad_core.planner.encounter.touch_costs import (
    PART_COST,
    Ints,
    Parts,
    Touches,
    against_spin,
    blow_levers,
    off_part,
    own_s,
)
from sgcad_core.planner.motion import Motion
from sgcad_core.records.specs import Area

DEPTH_M = 0.016
"""Overlap of the boxes at the first common sample: enough to be seen, and less than `wreck.SEEN_M`, so that the
consequences of the touch begin after that sample."""
_SECANTS = 6
"""Iterations; the time of the overlap is then known to some microseconds."""
_MOST_SHIFTS = 64
_LEAST_MARGIN = 0.001
"""Nearer to a diagonal of the box the side depends on tenths of a millimetre."""


class Meeting(NamedTuple):
    """One contact: own times of both motions at the first common sample at which they overlap."""

    cost: float
    first: Motion
    second: Motion
    first_s: float
    second_s: float
    sides: tuple[Area, Area]
    margin: float
    """How clear both sides are, 0 to 1."""


class _Judged(NamedTuple):
    """Touches with the side codes of both motions, the smaller of both margins, and how deep they really are."""

    touches: Touches
    sides: tuple[Ints, Ints]
    margins: Floats
    depth: Floats


_KEPT = 2_000
_known: dict[tuple[bytes, bytes], tuple[_Judged | None]] = {}
"""Touches of pairs of motions, some 4 KB each: other readings of a report, and other sides, test many pairs again."""


def find_meeting(
    first: Motion,
    second: Motion,
    wanted: tuple[Area, Area] | None,
    spins: tuple[float, float] = (0.0, 0.0),
    *,
    glances: bool = False,
    parts: Parts = (None, None),
) -> Meeting | None:
    """The best contact of two motions on the wanted sides (any sides where None), or None.

    `spins`: stated rotation of each after the contact: 1 counter-clockwise, -1 clockwise, 0 open. `glances`: off
    center. `parts`: the ends of the sides at which they touch: the front part of a flank, the left part of a front.
    """
    found = _fitting(first, second, wanted)
    if found is None:
        return None
    judged, good = found
    touches, sides, margins, _ = judged
    cost = _cost(first, second, touches.first, touches.second, margins) + _edge_cost(touches.key, good)
    if any(spins) or glances:
        cost = cost + against_spin(blow_levers(first, second, touches, sides), spins, glances)
    if any(parts):
        cost = cost + off_part((first, second), touches, parts)
    return _meeting(first, second, judged, int(np.argmin(np.where(good, cost, np.inf))), cost)


def along_sides(
    first: Motion, second: Motion, wanted: tuple[Area, Area], count: int, parts: Parts = (None, None)
) -> list[Meeting]:
    """Contacts all along the wanted sides, or at the told parts of them where there are such: `count` at most, over all
    shifts of the clocks that have one."""
    found = _fitting(first, second, wanted)
    if found is None:
        return []
    judged, good = found
    cost = _cost(first, second, judged.touches.first, judged.touches.second, judged.margins)
    able = good
    if any(parts):
        there = good & (off_part((first, second), judged.touches, parts) < PART_COST / 2)
        able = there if there.any() else good
    places = np.flatnonzero(able)
    shares = (np.arange(count) + 0.5) / count
    chosen = dict.fromkeys(int(places[int(share * len(places))]) for share in shares)
    return [_meeting(first, second, judged, number, cost) for number in chosen]


def _fitting(
    first: Motion, second: Motion, wanted: tuple[Area, Area] | None
) -> tuple[_Judged, NDArray[np.bool_]] | None:
    """All touches, and which of them are clear and on the wanted sides; None without one."""
    judged = _judged(first, second)
    if judged is None:
        return None
    _, sides, margins, depth = judged
    good = (depth > 0.2 * DEPTH_M) & (depth < 1.2 * DEPTH_M) & (margins > _LEAST_MARGIN)
    if wanted is not None:
        good &= (sides[0] == SIDES.index(wanted[0])) & (sides[1] == SIDES.index(wanted[1]))
    return (judged, good) if good.any() else None


def _meeting(first: Motion, second: Motion, judged: _Judged, number: int, cost: Floats) -> Meeting:
    """One of the touches as a record."""
    touches, sides, margins, _ = judged
    named = (SIDES[sides[0][number]], SIDES[sides[1][number]])
    first_s, second_s = (float(own_s(k[number])) for k in (touches.first, touches.second))
    return Meeting(float(cost[number]), first, second, first_s, second_s, named, float(margins[number]))


def _judged(first: Motion, second: Motion) -> _Judged | None:
    """Touches of two motions, cached; None without one."""
    key = first.digest, second.digest
    if known := _known.get(key):
        return known[0]
    touches = _touches(first, second)
    if len(_known) >= _KEPT:
        _known.clear()
    found = touches and _Judged(touches, *_judge(first, second, touches.first, touches.second))
    _known[key] = (found,)
    return found


def _touches(first: Motion, second: Motion) -> Touches | None:
    """The first touch for every shift of the clocks that has one."""
    if first.standing and second.standing:
        return None
    p, q = first.window_poses, second.window_poses
    i, j = _near(p, q, (math.hypot(*first.size) + math.hypot(*second.size)) / 2)
    if not len(i):
        return None
    key = j if second.standing else i if first.standing else j - i
    low = int(key.min())
    some = (key - low) % max(1, math.ceil((int(key.max()) - low) / _MOST_SHIFTS)) == 0
    i, j, key = i[some], j[some], key[some]
    hit = box_gaps(p[i], first.size, q[j], second.size) <= 0
    i, j = i[hit], j[hit]
    kept, at = np.unique(key[hit], return_index=True)
    inside = (i[at] > 0) & (j[at] > 0)
    kept, at = kept[inside], at[inside]
    if not len(at):
        return None
    return _refined(first, second, kept, i[at].astype(float), j[at].astype(float))


def _near(p: Floats, q: Floats, reach_m: float) -> tuple[Ints, Ints]:
    """Index pairs of poses whose centers lie within reach, ordered by the first index."""
    rows, columns = np.arange(len(p)), np.arange(len(q))
    for _ in range(2):
        rows = rows[_about(p[rows], q[columns], reach_m)]
        columns = columns[_about(q[columns], p[rows], reach_m)]
    apart = p[rows, 0][:, None] - q[columns, 0]
    apart *= apart  # in place: these matrices have some 100,000 numbers
    north = p[rows, 1][:, None] - q[columns, 1]
    north *= north
    apart += north
    i, j = np.divmod(np.flatnonzero(apart < reach_m * reach_m), max(len(columns), 1))
    return rows[i], columns[j]


def _about(points: Floats, others: Floats, reach_m: float) -> NDArray[np.bool_]:
    """Which points lie in the others' bounding box, widened by reach."""
    if not len(others):
        return np.zeros(len(points), dtype=bool)
    low, high = others[:, :2].min(axis=0) - reach_m, others[:, :2].max(axis=0) + reach_m
    inside: NDArray[np.bool_] = ((points[:, :2] >= low) & (points[:, :2] <= high)).all(axis=1)
    return inside


def _refined(first: Motion, second: Motion, key: Ints, i: Floats, j: Floats) -> Touches:
    """Times at which the overlap is DEPTH_M deep, from overlaps known to a grid step."""
    move_i, move_j = float(not first.standing), float(not second.standing)

    standing = [m.poses(own_s(k)) if m.standing else None for m, k in ((first, i), (second, j))]

    def over(at: Floats) -> Floats:
        p, q = standing
        p = first.poses(own_s(i + at)) if p is None else p
        q = second.poses(own_s(j + at)) if q is None else q
        return -DEPTH_M - box_gaps(p, first.size, q, second.size)

    at = _root(over, len(i))
    return Touches(key, i + move_i * at, j + move_j * at)


def _root(over: Callable[[Floats], Floats], count: int) -> Floats:
    """(count,) zeros of a function that rises from below 0 to above it between -1 and 1, by false position.

    The value at an end that stays is halved (Illinois algorithm; M. Dowell, P. Jarratt, BIT 11, 1971).
    """
    here = over(np.zeros(count))
    there = over(np.where(here >= 0.0, -1.0, 1.0))
    low, high = np.where(here >= 0.0, -1.0, 0.0), np.where(here >= 0.0, 0.0, 1.0)
    below, above = np.minimum(here, there), np.maximum(here, there)
    at, was = high, np.zeros(count)
    for _ in range(_SECANTS):
        at = np.clip((low * above - high * below) / np.maximum(above - below, 1e-12), low, high)
        value = over(at)
        side = np.sign(value)
        deep, half = side >= 0.0, np.where(side == was, 0.5, 1.0)
        below, above = np.where(deep, below * half, value), np.where(deep, value, above * half)
        low, high, was = np.where(deep, low, at), np.where(deep, at, high), side
    return at


def _judge(first: Motion, second: Motion, i: Floats, j: Floats) -> tuple[tuple[Ints, Ints], Floats, Floats]:
    """Side codes of both, the smaller of both margins, and the depth of the overlap."""
    p, q = first.poses(own_s(i)), second.poses(own_s(j))
    center = overlap_centers(p, first.size, q, second.size)
    (side_p, clear_p), (side_q, clear_q) = sides_at(p, first.size, center), sides_at(q, second.size, center)
    return (side_p, side_q), np.minimum(clear_p, clear_q), -box_gaps(p, first.size, q, second.size)


def _cost(first: Motion, second: Motion, i: Floats, j: Floats, margins: Floats) -> Floats:
    """Cost of unclear sides and unsuitable places; small differences only decide between shifts."""
    unfit = first.penalties(own_s(i)) + second.penalties(own_s(j))
    unclear: Floats = 30.0 * np.maximum(0.01 - margins, 0.0) + 0.15 * np.maximum(0.6 - margins, 0.0)
    return unfit + unclear


def _edge_cost(key: Ints, good: NDArray[np.bool_]) -> Floats:
    """Cost of contacts near the end of their interval of good shifts: a small change of timing would spoil them."""
    rank, bad = np.arange(len(key)), ~good
    before = np.maximum.accumulate(np.where(bad, rank, -1))
    after = np.minimum.accumulate(np.where(bad, rank, len(key))[::-1])[::-1]
    room = np.minimum(rank - before, after - rank)
    run = np.maximum(after - before, 1)
    off_middle: Floats = 0.15 * (1 - 2 * room / run) + 0.15 * (room < 2)
    return off_middle
