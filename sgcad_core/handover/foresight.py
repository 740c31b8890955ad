"""Prediction for drivers: actors ahead of the ego on its way, and times at which boxes would touch.

The ego is assumed to keep its way and its speed, the others speed and direction. Knows the records of the seat; no
simulation and no driver.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sgcad_core.case.driver_io import RoadUser, Task, View
from sgcad_core.geometry.plane import Floats, box_gaps

_LOOK_M = 150.0
_STEP_M = 1.5
_GRAIN_S = 0.1


class Ahead(NamedTuple):
    """Another road user in the frame of the ego's way."""

    user: RoadUser
    gap_m: float
    """Between the boxes along the way; negative: beside or behind the ego's front."""
    aside_m: float
    """Between the boxes across the way; negative: in the strip that the ego sweeps."""
    along_mps: float
    """Its speed along the way, negative: oncoming."""
    closing_mps: float
    """How fast it comes nearer across the way, negative: it leaves."""


class Meeting(NamedTuple):
    """When two boxes would touch, and when they would be apart again, seconds from now."""

    begins_s: float
    ends_s: float
    user: RoadUser


def users_ahead(task: Task, view: View) -> list[Ahead]:
    """The actors with their center ahead of the ego's rear on its next 150 m."""
    stations = np.arange(view.station_m, min(view.station_m + _LOOK_M, float(task.way.s_m[-1]) + 1.0), _STEP_M)
    if len(stations) < 2:
        return []
    line = task.way.poses_at(stations)
    course = _courses(line, view)
    found = []
    for user in view.others:
        place = _on_way(line[:, :2], course, user)
        if place is not None:
            found.append(_ahead(view, user, stations, course, place))
    return found


def _courses(line: Floats, view: View) -> Floats:
    step = np.diff(line[:, :2], axis=0)
    course = np.arctan2(step[:, 1], step[:, 0])
    return np.append(course, course[-1]) if len(course) else np.array([view.ego.course_rad])


def _on_way(points: Floats, course: Floats, user: RoadUser) -> tuple[int, float, float] | None:
    """Nearest sample of the way with how far beyond it and to the left of it; None: it lies behind the ego."""
    dx, dy = user.x_m - points[:, 0], user.y_m - points[:, 1]
    k = int((dx**2 + dy**2).argmin())
    c, s = math.cos(course[k]), math.sin(course[k])
    along, left = dx[k] * c + dy[k] * s, dy[k] * c - dx[k] * s
    return None if k == 0 and along < -user.length_m else (k, float(along), float(left))


def _ahead(view: View, user: RoadUser, stations: Floats, course: Floats, place: tuple[int, float, float]) -> Ahead:
    k, along, left = place
    turned = user.heading_rad - course[k]
    c, s = abs(math.cos(turned)), abs(math.sin(turned))
    reach, width = (user.length_m * c + user.width_m * s) / 2, (user.length_m * s + user.width_m * c) / 2
    gap = float(stations[k]) - view.station_m + along - reach - view.ego.length_m / 2
    way = user.course_rad - course[k]
    across = user.speed_mps * math.sin(way)
    closing = -across if left > 0 else across
    aside = abs(left) - width - view.ego.width_m / 2
    return Ahead(user, gap, aside, user.speed_mps * math.cos(way), closing)


def meetings(task: Task, view: View, horizon_s: float, margin_m: float = 0.0) -> list[Meeting]:
    """Predicted contacts with the ego (or approaches within a margin) up to a horizon, soonest first."""
    if view.ego.speed_mps < 0.1 and all(u.speed_mps < 0.1 for u in view.others):
        return []
    t = np.arange(0.0, horizon_s + _GRAIN_S, _GRAIN_S)
    mine = task.way.poses_at(view.station_m + view.ego.speed_mps * t)
    mine[:, :2] += np.array([view.ego.x_m, view.ego.y_m]) - mine[0, :2]
    size = view.ego.length_m, view.ego.width_m
    found = []
    for user in view.others:
        reach_m = (view.ego.speed_mps + user.speed_mps) * horizon_s + view.ego.length_m + user.length_m
        if math.hypot(user.x_m - view.ego.x_m, user.y_m - view.ego.y_m) > reach_m:
            continue
        vx, vy = user.velocity
        theirs = np.column_stack((user.x_m + vx * t, user.y_m + vy * t, np.full(len(t), user.heading_rad)))
        hits = np.flatnonzero(box_gaps(mine, size, theirs, (user.length_m, user.width_m)) <= margin_m)
        if len(hits):
            found.append(Meeting(float(t[hits[0]]), float(t[hits[-1]]), user))
    return sorted(found, key=lambda m: m.begins_s)
