"""Exact distances in the plane: points to a polyline, box to box. Metres; knows geometry only."""

from __future__ import annotations

import numpy as np

from sgcad_core.geometry.plane import Box, Floats, Size, box_gaps, corners, corners_of, local_points, overlap


def distance_to(line: Floats, points: Floats) -> Floats:
    """(m,) distance of (m, 2) points to an (n, 2) polyline."""
    start, step = line[:-1], np.diff(line, axis=0)
    length = np.maximum((step**2).sum(axis=1), 1e-12)
    share = np.clip(((points[:, None] - start) * step).sum(axis=2) / length, 0.0, 1.0)
    nearest = start + share[..., None] * step
    best: Floats = np.hypot(*(points[:, None] - nearest).transpose(2, 0, 1)).min(axis=1)
    return best


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
