"""The cells of a grid that two moving boxes both sweep, with the times at which each comes and goes.

Only cells that are swept take memory, however far apart the ends of the motions lie. Metres, seconds, radians.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.case.records import Floats

CELL_M = 0.25
MAX_CELLS = 2_000_000
"""That the boxes of a large area may cover over all instants; more, and the cells are larger."""
_AT_A_TIME = 500_000
"""Cells that are tested at a time."""
_DENSE = 2_000_000
"""Cells of an area that are kept all, which is faster; of a larger one only those that are swept."""
Size = tuple[float, float]
Times = tuple[Floats, Floats]
"""First and last time in every cell, s."""
_Whole = NDArray[np.int64]


class Track(NamedTuple):
    """The motion of one actor for the metrics."""

    t_s: Floats
    pose: Floats
    velocity: Floats
    size: Size


class _Swept(NamedTuple):
    """(n, 2) column and row of cells, each at most once for a stretch of time, in order of time."""

    cells: _Whole
    entered_s: Floats
    left_s: Floats


def common_cells(first: Track, second: Track, low: Floats, high: Floats) -> tuple[Times, Times] | None:
    """Of the cells within two corners that both boxes sweep: the times of the first and of the second; None without."""
    columns, rows = np.ceil((high - low) / CELL_M) + 1
    found = _sparse(first, second, low, high) if columns * rows > _DENSE else _dense(first, second, low, high)
    if found is None:
        return None
    one, two = found
    common = np.isfinite(one[0]) & np.isfinite(two[0])
    if not common.any():
        return None
    return (one[0][common], one[1][common]), (two[0][common], two[1][common])


# ------------------------------------------------------------------ a small area: every cell
def _dense(first: Track, second: Track, low: Floats, high: Floats) -> tuple[Times, Times]:
    columns, rows = (int(n) for n in np.ceil((high - low) / CELL_M).astype(int) + 1)
    return _on_grid(first, low, (columns, rows)), _on_grid(second, low, (columns, rows))


def _on_grid(track: Track, origin: Floats, shape: tuple[int, int]) -> Times:
    """First and last time at which the box covers each cell of a grid, s; inf and -inf where never."""
    entered = np.full(shape, np.inf)
    left = np.full(shape, -np.inf)
    half = np.array(track.size) / 2
    reach = float(np.hypot(*half))
    place = track.pose[:, :2]
    lows = np.maximum(((place - reach - origin) // CELL_M).astype(int), 0)
    highs = np.minimum(((place + reach - origin) // CELL_M).astype(int) + 1, shape)
    east, north = (origin[k] + (np.arange(shape[k]) + 0.5) * CELL_M for k in (0, 1))
    cos, sin = np.cos(track.pose[:, 2]), np.sin(track.pose[:, 2])
    moved = np.append(True, (np.diff(track.pose, axis=0) != 0.0).any(axis=1))
    last = np.append(np.flatnonzero(moved)[1:], len(moved)) - 1  # a standing box is entered once
    for k, stays in zip(np.flatnonzero(moved), last, strict=True):
        if (highs[k] <= lows[k]).any():
            continue
        window = slice(lows[k, 0], highs[k, 0]), slice(lows[k, 1], highs[k, 1])
        dx, dy = east[window[0]] - place[k, 0], north[window[1]] - place[k, 1]
        c, s, t = cos[k], sin[k], track.t_s[k]
        covered = np.abs((dx * c)[:, None] + dy * s) <= half[0]
        covered &= np.abs((-dx * s)[:, None] + dy * c) <= half[1]
        first = entered[window]
        first[covered & (first > t)] = t
        left[window][covered] = track.t_s[stays]  # times rise
    return entered, left


# ------------------------------------------------------------------ a large area: the cells that are swept
def _sparse(first: Track, second: Track, low: Floats, high: Floats) -> tuple[Times, Times] | None:
    covered = max(track.size[0] * track.size[1] * len(track.t_s) for track in (first, second))
    cell_m = max(CELL_M, math.sqrt(covered / MAX_CELLS))
    shape = np.ceil((high - low) / cell_m).astype(np.int64) + 1
    a, b = (_swept(track, low, shape, cell_m) for track in (first, second))
    if not len(a.cells) or not len(b.cells):
        return None
    cells, names = _numbered(np.vstack((a.cells, b.cells)))
    return _times(a, names[: len(a.cells)], len(cells)), _times(b, names[len(a.cells) :], len(cells))


def _times(swept: _Swept, names: _Whole, count: int) -> Times:
    """Of every numbered cell; inf and -inf where never."""
    entered, left = np.full(count, np.inf), np.full(count, -np.inf)
    entered[names[::-1]] = swept.entered_s[::-1]  # of several values the last one written stays, and times rise
    left[names] = swept.left_s
    return entered, left


def _swept(track: Track, low: Floats, shape: _Whole, cell_m: float) -> _Swept:
    parts = list(_stretches(track, low, shape, cell_m))
    cells = np.vstack([part.cells for part in parts]) if parts else np.empty((0, 2), np.int64)
    entered, left = (np.concatenate([part[k] for part in parts] or [np.empty(0)]) for k in (1, 2))
    return _Swept(cells, entered, left)


def _stretches(track: Track, low: Floats, shape: _Whole, cell_m: float) -> Iterator[_Swept]:
    """The cells of so many instances at a time that they take a few megabytes."""
    moved = np.append(True, (np.diff(track.pose, axis=0) != 0.0).any(axis=1))
    begins = np.flatnonzero(moved)
    ends = np.append(begins[1:], len(moved)) - 1  # a standing box is entered once
    reach = float(np.hypot(*track.size)) / 2
    corner = np.floor((track.pose[begins, :2] - low - reach) / cell_m).astype(np.int64)
    window = np.arange(math.ceil(2 * reach / cell_m) + 2)
    inside = ((corner < shape) & (corner + len(window) > 0)).all(axis=1)
    begins, ends, corner = begins[inside], ends[inside], corner[inside]
    step = max(1, _AT_A_TIME // len(window) ** 2)
    for k in range(0, len(begins), step):
        part = slice(k, k + step)
        which, cells = _covered(track, track.pose[begins[part]], corner[part], window, (low, cell_m))
        kept = ((cells >= 0) & (cells < shape)).all(axis=1)
        if kept.any():
            found, names = _numbered(cells[kept])
            seen = _Swept(cells[kept], track.t_s[begins[part][which[kept]]], track.t_s[ends[part][which[kept]]])
            yield _Swept(found, *_times(seen, names, len(found)))


def _covered(
    track: Track, poses: Floats, corner: _Whole, window: _Whole, grid: tuple[Floats, float]
) -> tuple[_Whole, _Whole]:
    """Which instance covers which cell (m, 2) by its center, instance by instance. `grid`: corner and size of cells."""
    low, cell_m = grid
    half = np.array(track.size) / 2
    centers = low + (corner[:, None, :] + window[None, :, None] + 0.5) * cell_m - poses[:, None, :2]
    dx, dy = centers[:, :, None, 0], centers[:, None, :, 1]
    c, s = (f(poses[:, 2])[:, None, None] for f in (np.cos, np.sin))
    which, column, row = np.nonzero((np.abs(dx * c + dy * s) <= half[0]) & (np.abs(dy * c - dx * s) <= half[1]))
    return which, corner[which] + np.column_stack((window[column], window[row]))


def _numbered(cells: _Whole) -> tuple[_Whole, _Whole]:
    """The different ones of (m, 2) cells, and for each of the m which of them it is."""
    low = cells.min(axis=0)
    span = cells.max(axis=0) - low + 1
    if float(span[0]) * float(span[1]) <= _DENSE:
        flat = (cells[:, 0] - low[0]) * span[1] + cells[:, 1] - low[1]
        number = np.zeros(int(span[0] * span[1]), np.int64)
        number[flat] = 1
        used = np.flatnonzero(number)
        number[used] = np.arange(len(used))
        return np.column_stack((used // span[1], used % span[1])) + low, number[flat]
    columns, column = np.unique(cells[:, 0], return_inverse=True)
    found, names = np.unique(column.reshape(-1) * span[1] + cells[:, 1] - low[1], return_inverse=True)
    return np.column_stack((columns[found // span[1]], found % span[1] + low[1])), names.reshape(-1)
