"""Distances in the plane: from points to a polyline, and between boxes. Metres; knows geometry only."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import (
    Box,
    Floats,
    Size,
    arc_lengths,
    box_gaps,
    corners,
    corners_of,
    local_points,
    overlap,
)


class Nearest(NamedTuple):
    """(m,) nearest places on a polyline: number of the segment, station, and metres to the left of the line."""

    segment: NDArray[np.int_]
    station_m: Floats
    left_m: Floats


def nearest_on(line: Floats, points: Floats) -> Nearest:
    """The places on an (n, 2) polyline that are nearest to (m, 2) points."""
    start, step = line[:-1], np.diff(line, axis=0)
    square = np.maximum((step**2).sum(axis=1), 1e-12)
    share = np.clip(((points[:, None] - start) * step).sum(axis=2) / square, 0.0, 1.0)
    away = points[:, None] - (start + share[..., None] * step)
    rows = np.arange(len(points))
    segment = np.hypot(*away.transpose(2, 0, 1)).argmin(axis=1)
    away, along = away[rows, segment], share[rows, segment] * np.sqrt(square[segment])
    left = step[segment, 0] * away[:, 1] - step[segment, 1] * away[:, 0]
    return Nearest(segment, arc_lengths(line)[segment] + along, np.copysign(np.hypot(*away.T), left))


def distance_to(line: Floats, points: Floats) -> Floats:
    """(m,) distance of (m, 2) points to an (n, 2) polyline, metres."""
    return np.abs(nearest_on(line, points).left_m)


def box_distance(first: Box, second: Box) -> float:
    """Distance of two boxes, 0 where they touch: where they are apart a corner of one is nearest to the other."""
    if overlap(first, second):
        return 0.0
    one, two = corners(first), corners(second)
    return float(min(distance_to(_ring(one), two).min(), distance_to(_ring(two), one).min()))


def box_distances(first: Floats, first_size: Size, second: Floats, second_size: Size) -> Floats:
    """(n,) distance of two boxes in (n, 3) poses, row by row; 0 where they touch. Convex outlines meet at a corner."""
    apart = np.minimum(
        _corner_distances(first, corners_of(second, second_size), first_size),
        _corner_distances(second, corners_of(first, first_size), second_size),
    )
    return np.where(box_gaps(first, first_size, second, second_size) <= 0, 0.0, apart)


def _corner_distances(poses: Floats, points: Floats, size: Size) -> Floats:
    """Least distance of (n, k, 2) points from one box in (n, 3) poses."""
    beyond = np.maximum(np.abs(local_points(poses, points)) - np.array(size) / 2, 0.0)
    nearest: Floats = np.hypot(beyond[..., 0], beyond[..., 1]).min(axis=1)
    return nearest


def _ring(points: Floats) -> Floats:
    return np.vstack((points, points[:1]))
