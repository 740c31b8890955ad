"""Conflict measures of two actors: distance, time to collision, post-encroachment time.

Two readings, never mixed. `paper`: the formulas to the letter, on box centres. `exact`: oriented boxes, only on a
collision course, 0 on overlap, infinite (no finite number) without a collision course. Tracks are (n, 3) poses (x, y,
heading) and (n, 2) velocities; sizes are length and width, metres.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from sgcad_core.case.records import Floats
from sgcad_core.geometry import plane
from sgcad_core.geometry.distances import box_distances
from sgcad_core.geometry.plane import gaps_where_near
from sgcad_core.metrics.swept_cells import Track, common_cells

Size = tuple[float, float]


class Encroachment(NamedTuple):
    """A post-encroachment time and the reason of its value."""

    seconds: float | None
    reason: Literal["measured", "overlap", "no common area", "ego never leaves", "other there from the start"]


# ------------------------------------------------------------------ distance
def center_distance(first: Track, second: Track) -> Floats:
    """d(t) of the paper: distance of box centres, metres."""
    distance: Floats = np.hypot(*(second.pose[:, :2] - first.pose[:, :2]).T)
    return distance


def box_distance(first: Track, second: Track) -> Floats:
    """Distance between the two boxes' outlines, metres; 0 where they overlap."""
    return box_distances(first.pose, first.size, second.pose, second.size)


def overlaps(first: Track, second: Track) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Whether the boxes share a point, one value an instance."""
    return gaps_where_near(first.pose, first.size, second.pose, second.size) <= 0


def first_overlap(first: Track, second: Track) -> int | None:
    """The first instance in which the boxes share a point; None where there is none."""
    return plane.first_overlap(first.pose, first.size, second.pose, second.size)


# ------------------------------------------------------------------ time to collision
def time_to_collision_paper(first: Track, second: Track) -> Floats:
    """TTC(t) = d(t) / |v_rel(t)|, s; inf where the relative speed is 0. No test of a collision course."""
    relative = np.hypot(*(first.velocity - second.velocity).T)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(relative > 0, center_distance(first, second) / relative, np.inf)


def time_to_collision(first: Track, second: Track) -> Floats:
    """Exact TTC, s: when the boxes touch if both keep velocity and heading; 0 on overlap, inf if never.

    Separating axes on moving boxes: they overlap while they overlap on all four axes.
    """
    axes = np.stack([h + o for h in (first.pose[:, 2], second.pose[:, 2]) for o in (0.0, np.pi / 2)])
    cos, sin = np.cos(axes), np.sin(axes)
    delta, speed = second.pose[:, :2] - first.pose[:, :2], second.velocity - first.velocity
    place, rate = (v[:, 0] * cos + v[:, 1] * sin for v in (delta, speed))
    reach = sum(
        np.abs(track.size[0] / 2 * np.cos(track.pose[:, 2] - axes))
        + np.abs(track.size[1] / 2 * np.sin(track.pose[:, 2] - axes))
        for track in (first, second)
    )
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        times = np.sort(np.stack([(-reach - place) / rate, (reach - place) / rate]), axis=0)
    still = np.abs(rate) < 1e-12
    inside = np.abs(place) <= reach
    enter = np.where(still, np.where(inside, -np.inf, np.inf), times[0]).max(axis=0)
    leave = np.where(still, np.where(inside, np.inf, -np.inf), times[1]).min(axis=0)
    meets = (enter <= leave) & (leave >= 0)
    return np.where(meets, np.maximum(enter, 0.0), np.inf)


def required_deceleration(first: Track, second: Track, ttc: Floats | None = None) -> Floats:
    """Deceleration rate to avoid the crash (DRAC), m/s^2: the deceleration that one of the two needs at once.

    Closing speed^2 / (2 * distance to the contact) = closing speed / (2 * TTC); 0 off a collision course, infinite on
    overlap. Two-dimensional form, along the relative velocity, of J. Archer, Indicators for Traffic Safety Assessment
    and Prediction, 2005, ch. 2 (there for car following). `ttc`: the time to collision, if known.
    """
    ttc = time_to_collision(first, second) if ttc is None else ttc
    closing = np.hypot(*(first.velocity - second.velocity).T)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.isfinite(ttc), np.where(ttc > 0, closing / (2 * ttc), np.inf), 0.0)


# ------------------------------------------------------------------ post-encroachment time
def _conflict_area(first: Track, second: Track) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]] | None:
    """Entry and exit times of both actors in the cells that both sweep; None if their paths stay apart."""
    bounds = [
        (track.pose[:, :2].min(axis=0) - max(track.size), track.pose[:, :2].max(axis=0) + max(track.size))
        for track in (first, second)
    ]
    low = np.maximum(bounds[0][0], bounds[1][0])
    high = np.minimum(bounds[0][1], bounds[1][1])
    if (high <= low).any():
        return None
    return common_cells(first, second, low, high)


def post_encroachment_time_paper(ego: Track, other: Track) -> Encroachment:
    """|t_ego_exit - t_other_entry| of the area that both sweep, s.

    Undefined where the ego is in the area at the end, or the other one at the start; the formula would then measure the
    clock.
    """
    area = _conflict_area(ego, other)
    if area is None:
        return Encroachment(None, "no common area")
    exit_s, entry_s = float(area[0][1].max()), float(area[1][0].min())
    if exit_s >= ego.t_s[-1]:
        return Encroachment(None, "ego never leaves")
    if entry_s <= other.t_s[0]:
        return Encroachment(None, "other there from the start")
    return Encroachment(abs(exit_s - entry_s), "measured")


def post_encroachment_time(first: Track, second: Track) -> Encroachment:
    """Exact PET, s: least time between one actor leaving a place and the other coming to it; 0 on overlap.

    Taken cell by cell (0.25 m) over the swept conflict area, so that it does not grow with the area.
    """
    if overlaps(first, second).any():
        return Encroachment(0.0, "overlap")
    area = _conflict_area(first, second)
    if area is None:
        return Encroachment(None, "no common area")
    (a_in, a_out), (b_in, b_out) = area
    gap = np.maximum(b_in - a_out, a_in - b_out)
    return Encroachment(float(max(gap.min(), 0.0)), "measured")
