"""The vertices of many lanes' centers, found by place: those near a point without a look at all of them.

Metres, radians. Knows no lane.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats


@dataclass(frozen=True, eq=False)
class LaneVertices:
    """x, y, driving heading, s and half width of every vertex, and the lane that it belongs to."""

    x_m: Floats
    y_m: Floats
    heading_rad: Floats
    s_m: Floats
    half_m: Floats
    lane: NDArray[np.intp]

    def near(self, x_m: float, y_m: float, beyond_m: float) -> tuple[NDArray[np.intp], Floats, int]:
        """Indices of the vertices no farther from a point than their half width and some more, their distances, and
        how many were looked at."""
        low, high = np.searchsorted(self._by_x[1], [x_m - beyond_m - self._widest_m, x_m + beyond_m + self._widest_m])
        close = np.sort(self._by_x[0][low:high])
        gap = np.hypot(self.x_m[close] - x_m, self.y_m[close] - y_m)
        kept = gap <= self.half_m[close] + beyond_m
        return close[kept], gap[kept], len(close)

    @cached_property
    def _by_x(self) -> tuple[NDArray[np.intp], Floats]:
        order = np.argsort(self.x_m, kind="stable")
        return order, self.x_m[order]

    @cached_property
    def _widest_m(self) -> float:
        return float(self.half_m.max(initial=0.0)) + 1e-6


def vertices(parts: Sequence[Floats], backwards: Sequence[bool]) -> LaneVertices:
    """Of lanes' centers: (n, 5) s, x, y, reference heading, half width each; `backwards`: driven against s."""
    if not parts:
        empty = np.empty(0)
        return LaneVertices(empty, empty, empty, empty, empty, np.empty(0, np.intp))
    counts = [len(part) for part in parts]
    s, x, y, heading, half = (np.concatenate([part[:, k] for part in parts]) for k in range(5))
    turned = np.repeat(np.where(np.array(backwards), np.pi, 0.0), counts)
    return LaneVertices(x, y, heading + turned, s, half, np.repeat(np.arange(len(parts)), counts))
