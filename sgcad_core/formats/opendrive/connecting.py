"""Connecting roads: the way of each connection across its junction, as one line or one cubic.

The reference line is the center of the lane, so that it lies where SUMO's internal lane does; it begins and
ends with the pose of the lanes it joins. Metres and radians.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.opendrive.geometry import Pose, cubic_lengths, hermite, wrap
from sgcad_core.formats.opendrive.streets import RoadLane, Street
from sgcad_core.geometry.plane import Floats, arc_lengths, resample
from sgcad_core.roads.lane_graph import Connection

STRAIGHT_M = 5e-4
STRAIGHT_RAD = 1e-5
LEAST_REACH_M = 0.1
SAME_END_M = 0.05
_PROBES = 12
_ROUNDS = 6
_P = np.linspace(0.0, 1.0, 65)
_BASIS = np.column_stack(((1 + 2 * _P) * (1 - _P) ** 2, _P * (1 - _P) ** 2, _P**2 * (3 - 2 * _P), _P**2 * (_P - 1)))
"""Hermite basis: first point, first tangent, last point, last tangent."""


class ConnectingCurve(NamedTuple):
    """A connecting road's geometry: a cubic from `start` (aU bU cU dU aV bV cV dV, normalized), None: straight."""

    start: Pose
    cubic: tuple[float, ...] | None
    length_m: float


class Connector(NamedTuple):
    """One connecting road of one lane, with the lanes it joins."""

    id: str
    junction: str
    connection: Connection
    came: Street
    goes: Street
    incoming: RoadLane
    outgoing: RoadLane
    way: ConnectingCurve

    @property
    def widths(self) -> tuple[float, float]:
        """Lane width at both ends: those of the lanes it joins."""
        link = self.connection
        return (
            self.incoming.width_at(self.came.driven_end(link.from_edge, at_end=True)),
            self.outgoing.width_at(self.goes.driven_end(link.to_edge, at_end=False)),
        )


def connecting_curve(start: Pose, end: Pose, via: Floats) -> ConnectingCurve:
    """The way from pose to pose that lies nearest to (n, 2) points of SUMO's internal lane."""
    distance = math.dist(start[:2], end[:2])
    aside = _aside(start, end)
    if abs(wrap(end.heading_rad - start.heading_rad)) < STRAIGHT_RAD and abs(aside) < STRAIGHT_M and distance > 0:
        return ConnectingCurve(start, None, distance)
    tangents = _tangents(start, end, via)
    cubic = hermite(start, end, tangents)
    return ConnectingCurve(start, cubic, float(cubic_lengths(np.array([cubic]), np.ones(1))[0]))


def _aside(start: Pose, end: Pose) -> float:
    dx, dy = end.x_m - start.x_m, end.y_m - start.y_m
    return dy * math.cos(start.heading_rad) - dx * math.sin(start.heading_rad)


def _tangents(start: Pose, end: Pose, via: Floats) -> tuple[float, float] | None:
    """Lengths of both end tangents of the cubic nearest to the points (least squares); None where none is sound.

    Points are assigned to places on the curve, the curve is fitted, and again: each round is linear.
    """
    ends = np.array(start[:2]), np.array(end[:2])
    line = np.vstack((ends[0], _inner(via, *ends), ends[1]))
    total = float(arc_lengths(line)[-1])
    if total < LEAST_REACH_M:
        return None
    points = resample(line, np.linspace(0.0, total, _PROBES + 2)[1:-1])
    units = np.array([[math.cos(p.heading_rad), math.sin(p.heading_rad)] for p in (start, end)])
    p = np.linspace(0.0, 1.0, _PROBES + 2)[1:-1]
    found = np.array([total, total])
    for _ in range(_ROUNDS):
        fixed = ((1 + 2 * p) * (1 - p) ** 2)[:, None] * ends[0] + (p**2 * (3 - 2 * p))[:, None] * ends[1]
        columns = np.stack(((p * (1 - p) ** 2)[:, None] * units[0], (p**2 * (p - 1))[:, None] * units[1]), axis=-1)
        found = np.linalg.lstsq(columns.reshape(-1, 2), (points - fixed).ravel(), rcond=None)[0]
        if found.min() < LEAST_REACH_M or found.max() > 6 * total:
            return None
        control = np.vstack((ends[0], found[0] * units[0], ends[1], found[1] * units[1]))
        curve = _BASIS @ control
        p = _P[np.hypot(*(points[:, None] - curve).transpose(2, 0, 1)).argmin(axis=1)]
    return float(found[0]), float(found[1])


def _inner(via: Floats, first: Floats, last: Floats) -> Floats:
    """Points between the ends; SUMO's own ends too where its lanes end elsewhere than the roads."""
    away = [float(np.hypot(*(via[i] - end))) > SAME_END_M for i, end in ((0, first), (-1, last))]
    return via[0 if away[0] else 1 : len(via) if away[1] else -1]
