"""Plane geometry of oriented boxes and polylines. Knows numpy and nothing of the project.

Metres and radians; x east, y north, angles counter-clockwise from east. A box is given by its centre,
heading, length (along the heading) and width.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Size = tuple[float, float]
"""Length and width, metres."""
Side = Literal["front", "back", "left", "right"]


class Box(NamedTuple):
    """One oriented box, metres and radians."""

    x_m: float
    y_m: float
    heading_rad: float
    length_m: float
    width_m: float

    @classmethod
    def at(cls, pose: Floats, size: Size) -> Box:
        """The box of a size in a pose (x, y, heading)."""
        return cls(float(pose[0]), float(pose[1]), float(pose[2]), *size)


def wrap_angle(angle_rad: ArrayLike) -> Floats:
    """The same angle in [-pi, pi)."""
    return (np.asarray(angle_rad, dtype=float) + math.pi) % (2 * math.pi) - math.pi


def corners(box: Box) -> Floats:
    """(4, 2) corners, counter-clockwise from front left."""
    along = np.array([1, -1, -1, 1]) * box.length_m / 2
    across = np.array([1, 1, -1, -1]) * box.width_m / 2
    c, s = math.cos(box.heading_rad), math.sin(box.heading_rad)
    return np.column_stack((box.x_m + along * c - across * s, box.y_m + along * s + across * c))


def box_gaps(first: Floats, first_size: Size, second: Floats, second_size: Size) -> Floats:
    """Separation of two moving boxes along their best separating axis, metres, one value a row.

    Poses are (n, 3) of x, y, heading; sizes are length and width. Negative: they overlap (the
    separating-axis theorem is exact for the sign; a positive value is a lower bound of the distance).
    """
    dx, dy = second[:, 0] - first[:, 0], second[:, 1] - first[:, 1]
    ca, sa, cb, sb = np.cos(first[:, 2]), np.sin(first[:, 2]), np.cos(second[:, 2]), np.sin(second[:, 2])
    along, across = np.abs(ca * cb + sa * sb), np.abs(ca * sb - sa * cb)
    (al, aw), (bl, bw) = ((length / 2, width / 2) for length, width in (first_size, second_size))
    over_first = np.maximum(
        np.abs(dx * ca + dy * sa) - al - bl * along - bw * across,
        np.abs(dy * ca - dx * sa) - aw - bl * across - bw * along,
    )
    over_second = np.maximum(
        np.abs(dx * cb + dy * sb) - bl - al * along - aw * across,
        np.abs(dy * cb - dx * sb) - bw - al * across - aw * along,
    )
    best: Floats = np.maximum(over_first, over_second)
    return best


def gaps_where_near(first: Floats, first_size: Size, second: Floats, second_size: Size, near_m: float = 0.0) -> Floats:
    """As `box_gaps` where that is at most `near_m` (0 or more); inf where circles around the boxes show a larger gap.

    Most poses of two motions lie far apart, and comparing centers takes a fifth of the time.
    """
    # a gap g along the best axis leaves corners no more than g * sqrt(2) apart
    reach = (math.hypot(*first_size) + math.hypot(*second_size)) / 2 + 1.5 * near_m + 1e-6
    dx, dy = second[:, 0] - first[:, 0], second[:, 1] - first[:, 1]
    near = np.flatnonzero(dx * dx + dy * dy <= reach * reach)
    gaps = np.full(len(dx), np.inf)
    if len(near):
        gaps[near] = box_gaps(first[near], first_size, second[near], second_size)
    return gaps


def first_overlap(first: Floats, first_size: Size, second: Floats, second_size: Size) -> int | None:
    """The first row in which two moving boxes overlap; None where they never do."""
    hits = np.flatnonzero(gaps_where_near(first, first_size, second, second_size) <= 0)
    return int(hits[0]) if len(hits) else None


def overlap(first: Box, second: Box) -> bool:
    """Whether two boxes share a point (touching counts)."""
    gap = box_gaps(np.array([first[:3]]), (first[3], first[4]), np.array([second[:3]]), (second[3], second[4]))
    return bool(gap[0] <= 0)


def overlap_polygon(first: Box, second: Box) -> Floats:
    """(n, 2) corners of the shared area (Sutherland-Hodgman); of `first` itself where the boxes are apart."""
    shared = [tuple(p) for p in corners(first)]
    edges = corners(second)
    for a, b in zip(edges, np.roll(edges, -1, axis=0), strict=True):
        shared = _clip(shared, a, b) or shared
    return np.array(shared)


def _clip(polygon: list[tuple[float, ...]], a: Floats, b: Floats) -> list[tuple[float, ...]]:
    """The part of a polygon left of the line a -> b."""

    def side(p: tuple[float, ...]) -> float:
        return float((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]))

    out: list[tuple[float, ...]] = []
    for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        sp, sq = side(p), side(q)
        if sp >= 0:
            out.append(p)
        if sp * sq < 0:
            u = sp / (sp - sq)
            out.append((p[0] + u * (q[0] - p[0]), p[1] + u * (q[1] - p[1])))
    return out


def contact_area(box: Box, other: Box) -> Side:
    """Side of `box` (front, back, left, right) on which `other` overlaps it.

    The centroid of the shared polygon's corners, measured in half lengths and half widths, decides.
    """
    shared = overlap_polygon(other, box).mean(axis=0)
    dx, dy = shared[0] - box.x_m, shared[1] - box.y_m
    c, s = math.cos(box.heading_rad), math.sin(box.heading_rad)
    along = (dx * c + dy * s) / (box.length_m / 2)
    across = (-dx * s + dy * c) / (box.width_m / 2)
    if abs(along) >= abs(across):
        return "front" if along > 0 else "back"
    return "left" if across > 0 else "right"


# ------------------------------------------------------------------ polylines
def arc_lengths(points: Floats) -> Floats:
    """(n,) distance along a polyline of (n, 2) points, metres, starting at 0."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    return np.concatenate(([0.0], np.cumsum(steps)))


def resample(points: Floats, s_m: ArrayLike) -> Floats:
    """(m, 2) points at the given distances along a polyline, clamped to its ends."""
    along = arc_lengths(points)
    return np.column_stack([np.interp(np.asarray(s_m, dtype=float), along, points[:, i]) for i in (0, 1)])


def runs(flags: ArrayLike) -> list[tuple[int, int]]:
    """First and last place of every unbroken run of true values in (n,) flags."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], np.asarray(flags, dtype=int), [0]))))
    return [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]


def distinct(points: Floats, apart_m: float = 1e-3) -> Floats:
    """The points of a polyline that lie further than `apart_m` from the one before."""
    kept: Floats = points[np.append(True, np.hypot(*np.diff(points, axis=0).T) > apart_m)]
    return kept


def headings(points: Floats) -> Floats:
    """(n,) heading of each point of a polyline: that of its next segment, unwrapped; the last repeats."""
    step = np.diff(points, axis=0)
    angle = np.arctan2(step[:, 1], step[:, 0])
    return np.unwrap(np.append(angle, angle[-1]))


def offset_polyline(points: Floats, left_m: ArrayLike) -> Floats:
    """A polyline moved to its left by `left_m` (a number or one value a point), metres."""
    tangent = np.gradient(points, axis=0)
    norm = np.hypot(tangent[:, 0], tangent[:, 1])
    normal = np.column_stack((-tangent[:, 1], tangent[:, 0])) / np.where(norm > 0, norm, 1.0)[:, None]
    moved: Floats = points + normal * np.broadcast_to(np.asarray(left_m, dtype=float), len(points))[:, None]
    return moved


def parallel_polyline(points: Floats, left_m: float) -> Floats:
    """(n, 2) polyline whose segments run parallel to those of another, `left_m` metres to their left (mitered)."""
    steps = np.diff(points, axis=0)
    normals = np.column_stack((-steps[:, 1], steps[:, 0])) / np.hypot(*steps.T)[:, None]
    before, behind = np.vstack((normals[:1], normals)), np.vstack((normals, normals[-1:]))
    along = 1 + (before * behind).sum(axis=1)
    moved: Floats = points + left_m * (before + behind) / np.maximum(along, 0.1)[:, None]
    return moved


def prolonged(points: Floats, by_m: float) -> Floats:
    """(m + 2, 2) polyline extended straight at both ends by `by_m` metres; points within 1 mm of the last one are
    dropped."""
    kept = distinct(points)
    points = kept if len(kept) > 1 else points[[0, -1]]
    first, last = points[0] - points[1], points[-1] - points[-2]
    ahead, behind = (step / max(float(np.hypot(*step)), 1e-12) * by_m for step in (first, last))
    longer: Floats = np.vstack((points[0] + ahead, points, points[-1] + behind))
    return longer


# ------------------------------------------------------------------ many boxes at once
SIDES: tuple[Side, ...] = ("front", "left", "back", "right")
"""Names of the side codes 0 to 3, counter-clockwise from the front."""


def local_points(poses: Floats, points: Floats) -> Floats:
    """Points (n, k, 2) in the frames of (n, 3) poses: x ahead, y to the left."""
    cos, sin = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
    dx, dy = points[..., 0] - poses[:, :1], points[..., 1] - poses[:, 1:2]
    return np.stack((dx * cos + dy * sin, dy * cos - dx * sin), axis=-1)


def corners_of(poses: Floats, size: Size) -> Floats:
    """(n, 4, 2) corners of one box in (n, 3) poses, counter-clockwise from front left."""
    along = np.array([1, -1, -1, 1]) * size[0] / 2
    across = np.array([1, 1, -1, -1]) * size[1] / 2
    cos, sin = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
    return np.stack((poses[:, :1] + along * cos - across * sin, poses[:, 1:2] + along * sin + across * cos), axis=-1)


def overlap_centers(first: Floats, first_size: Size, second: Floats, second_size: Size) -> Floats:
    """(n, 2) mean of the corners of the shared polygon of two boxes, row by row; nan where they are apart.

    The same point as `overlap_polygon(...).mean(axis=0)` without building the polygon: the corners of either box inside
    the other, and the crossings of their sides. (Where sides coincide exactly, either method may count a corner twice.)
    """
    theirs = corners_of(second, second_size)
    ours = corners_of(first, first_size)
    crossings, crossed = _side_crossings(local_points(first, theirs), first_size)
    points = np.concatenate((theirs, ours, world_points(first, crossings)), axis=1)
    used = np.concatenate(
        (_inside(local_points(first, theirs), first_size), _inside(local_points(second, ours), second_size), crossed),
        axis=1,
    )
    count = used.sum(axis=1)
    total = np.where(used[..., None], points, 0.0).sum(axis=1)
    center: Floats = np.where(count[:, None] > 0, total / np.maximum(count, 1)[:, None], np.nan)
    return center


def sides_at(poses: Floats, size: Size, points: Floats) -> tuple[NDArray[np.int_], Floats]:
    """Side codes (see SIDES) on which (n, 2) points lie as seen from (n, 3) poses, and how clearly.

    The second array is | |along| - |across| | in half lengths and half widths: 0 on a diagonal of the box.
    """
    local = local_points(poses, points[:, None])[:, 0] / (np.array(size) / 2)
    along, across = local[:, 0], local[:, 1]
    lengthwise = np.abs(along) >= np.abs(across)
    side = np.where(lengthwise, np.where(along > 0, 0, 2), np.where(across > 0, 1, 3))
    return side, np.abs(np.abs(along) - np.abs(across))


def _inside(local: Floats, size: Size) -> NDArray[np.bool_]:
    return (np.abs(local[..., 0]) <= size[0] / 2) & (np.abs(local[..., 1]) <= size[1] / 2)


def world_points(poses: Floats, local: Floats) -> Floats:
    """(n, k, 2) points in the frames of (n, 3) poses, in the world; `local`: as those of `local_points`."""
    cos, sin = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
    x, y = local[..., 0], local[..., 1]
    return np.stack((poses[:, :1] + x * cos - y * sin, poses[:, 1:2] + x * sin + y * cos), axis=-1)


def _side_crossings(quad: Floats, size: Size) -> tuple[Floats, NDArray[np.bool_]]:
    """Crossings of the sides of (n, 4, 2) quads with those of an upright box at 0: (n, 16, 2) points, (n, 16) real."""
    start, step = quad, np.roll(quad, -1, axis=1) - quad
    points, real = [], []
    for axis, sign in ((0, 1), (0, -1), (1, 1), (1, -1)):
        slope = step[..., axis]
        t = np.divide(sign * size[axis] / 2 - start[..., axis], slope, out=np.full_like(slope, -1.0), where=slope != 0)
        other = start[..., 1 - axis] + t * step[..., 1 - axis]
        point = np.empty_like(start)
        point[..., axis], point[..., 1 - axis] = sign * size[axis] / 2, other
        points.append(point)
        real.append((t > 0) & (t < 1) & (np.abs(other) < size[1 - axis] / 2))
    return np.concatenate(points, axis=1), np.concatenate(real, axis=1)
