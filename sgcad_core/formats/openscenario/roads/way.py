"""A way through a road network: the polyline that is driven, and the lane that each piece of it lies in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.formats.openscenario.roads.road_links import Leg
from sgcad_core.geometry.plane import Floats, arc_lengths


class LanePlace(NamedTuple):
    """A place in lane coordinates: road id, lane id, s along the road and offset to the left of the lane center.

    Left is that of the reference direction (rising s).
    """

    road: str
    lane: int
    s_m: float
    offset_m: float


@dataclass(frozen=True, eq=False)
class Way:
    """(n, 2) points in driving direction, with road, lane and s of each, and the senses in which roads are driven."""

    points: Floats
    s_m: Floats
    which: NDArray[np.intp]
    """Index into `lanes` of each point."""
    lanes: tuple[tuple[str, int, int], ...]
    """Road, lane and sense (1: along s) of each piece."""
    dead_end: bool
    """Whether there is nothing behind it; else it was cut for length."""

    def place(self, index: int, share: float, left_m: float) -> tuple[LanePlace, int]:
        """The place between point `index` and the next, `left_m` to the left of the way; and the sense of driving."""
        road, lane, sense = self.lanes[int(self.which[index])]
        same = index + 1 < len(self.which) and self.which[index + 1] == self.which[index]
        s_m = self.s_m[index] + (share * (self.s_m[index + 1] - self.s_m[index]) if same else 0.0)
        return LanePlace(road, lane, float(s_m), left_m * sense), sense


def way_of(parts: Sequence[tuple[Floats, tuple[str, int, int]]], dead_end: bool) -> Way:
    """Join pieces of (n, 3) s, x, y; points closer than 1 mm to the one before are left out."""
    rows = np.vstack([part for part, _ in parts])
    which = np.repeat(np.arange(len(parts)), [len(part) for part, _ in parts])
    apart = np.concatenate(([True], np.hypot(*np.diff(rows[:, 1:], axis=0).T) > 1e-3))
    rows, which = rows[apart], which[apart]
    return Way(rows[:, 1:], rows[:, 0], which, tuple(lane for _, lane in parts), dead_end)


def cut(part: Floats, most_m: float) -> tuple[Floats, float]:
    """(n, 3) s, x, y up to the first point behind a distance, and the length up to there, metres."""
    along = arc_lengths(part[:, 1:])
    end = int(np.searchsorted(along, most_m, side="right")) + 1
    return part[:end], float(along[min(end, len(along)) - 1])


@dataclass(frozen=True, eq=False)
class Route:
    """Roads in the order in which they are driven, from a place on the first to a place on the last."""

    legs: tuple[Leg, ...]
    lengths_m: tuple[float, ...]
    first_s_m: float
    """Where on the first road it begins."""

    def at(self, path_m: float) -> tuple[str, float, int]:
        """Road, s and sense at a distance along the route. Raises ValueError beyond it."""
        rest = path_m
        for i, (leg, length) in enumerate(zip(self.legs, self.lengths_m, strict=True)):
            begin = (self.first_s_m if leg.sense > 0 else length - self.first_s_m) if i == 0 else 0.0
            if -1e-6 <= rest <= length - begin + 1e-6:
                s_m = begin + rest
                return leg.road, s_m if leg.sense > 0 else length - s_m, leg.sense
            rest -= length - begin
        raise ValueError(f"{path_m:g} m along the route lies beyond it")

    def along(self, road: str, s_m: float) -> float | None:
        """Distance along the route of a place on one of its roads; None where it does not lead there."""
        way = 0.0
        for i, (leg, length) in enumerate(zip(self.legs, self.lengths_m, strict=True)):
            begin = (self.first_s_m if leg.sense > 0 else length - self.first_s_m) if i == 0 else 0.0
            if leg.road == road:
                return way + (s_m if leg.sense > 0 else length - s_m) - begin
            way += length - begin
        return None

    def legs_after(self, road: str) -> tuple[Leg, ...]:
        """The roads behind one of its roads; none behind a road that it does not lead over."""
        roads = [leg.road for leg in self.legs]
        return self.legs[roads.index(road) + 1 :] if road in roads else ()
