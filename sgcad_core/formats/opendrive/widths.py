"""How far one line lies beside another, and widths of lanes from such measures. Metres; knows no network."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sgcad_core.geometry.plane import Floats, arc_lengths, prolonged, resample

FIT_M = 0.003
NEAR_M = 0.5
"""Lines are prolonged so far where normals at a neighbor's ends shall meet them."""


@dataclass(frozen=True)
class Width:
    """Width from `s_m` on: a + b (s - s_m)."""

    s_m: float
    a: float
    b: float = 0.0


def clean(line: Floats) -> Floats:
    """Without points nearer than 1 mm to the one before; both ends stay."""
    keep = np.append(True, np.hypot(*np.diff(line, axis=0).T) > 1e-3)
    kept: Floats = line[keep]
    if len(kept) < 2:
        kept = line[[0, -1]]
    kept[-1] = line[-1]
    return kept


def stations_of(line: Floats) -> Floats:
    """Where widths are measured: at the vertices, and in the middle of a straight line."""
    along = arc_lengths(line)
    return along if len(along) > 2 else np.array([0.0, along[-1] / 2, along[-1]])


def offsets_or_end(line: Floats, other: Floats, stations: Floats) -> Floats:
    """As `offsets_at`; beyond the other line's ends the value of its nearest point that has one."""
    found = offsets_at(line, other, stations)
    known = np.flatnonzero(~np.isnan(found))
    return np.interp(stations, stations[known], found[known]) if len(known) else np.zeros_like(stations)


def offsets_at(line: Floats, other: Floats, stations: Floats) -> Floats:
    """(n,) t at which another line crosses the normal of a line at each station; nan where it does not."""
    points = resample(line, stations)
    ahead, behind = resample(line, stations + 0.01), resample(line, stations - 0.01)
    tangent = ahead - behind
    tangent = tangent / np.hypot(*tangent.T)[:, None]
    normal = np.column_stack((-tangent[:, 1], tangent[:, 0]))
    ends = prolonged(other, NEAR_M)
    u = (ends[None] - points[:, None]) @ tangent[:, :, None]
    v = (ends[None] - points[:, None]) @ normal[:, :, None]
    u, v = u[..., 0], v[..., 0]
    crosses = (u[:, :-1] <= 1e-9) & (u[:, 1:] > 1e-9)
    step = np.where(crosses, u[:, 1:] - u[:, :-1], 1.0)
    t = v[:, :-1] - u[:, :-1] / step * (v[:, 1:] - v[:, :-1])
    near = np.where(crosses, np.abs(t), np.inf)
    best = near.argmin(axis=1)
    return np.where(crosses.any(axis=1), t[np.arange(len(stations)), best], np.nan)


def fitted(stations: Floats, values: Floats) -> tuple[Width, ...]:
    """Straight width pieces through measured values, those that one line tells joined."""
    kept = [0, *_needed(stations, values, 0, len(stations) - 1), len(stations) - 1]
    ends = sorted(set(kept))
    return tuple(_slope(stations, values, i, j) for i, j in pairwise(ends))


def _slope(s: Floats, w: Floats, i: int, j: int) -> Width:
    return Width(float(s[i]), float(w[i]), float((w[j] - w[i]) / max(s[j] - s[i], 1e-9)))


def _needed(s: Floats, w: Floats, i: int, j: int) -> Iterator[int]:
    """Inner stations that a polyline from i to j needs to stay within `FIT_M` of all values (Douglas-Peucker)."""
    if j - i < 2:
        return
    chord = w[i] + (w[j] - w[i]) * (s[i + 1 : j] - s[i]) / max(s[j] - s[i], 1e-9)
    away = np.abs(w[i + 1 : j] - chord)
    if away.max() > FIT_M:
        k = i + 1 + int(away.argmax())
        yield from (*_needed(s, w, i, k), k, *_needed(s, w, k, j))
