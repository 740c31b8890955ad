"""Whether a vehicle has left the road where it touches something, and on which side; which told moves it makes.

Compares its center and the middle of its front with the lanes of a network (`lane_places`). Knows no report.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import cast

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats, wrap_angle
from sgcad_core.metrics.labels.course_labels import POINT_DEG
from sgcad_core.metrics.labels.observed_crash import VehicleMotion
from sgcad_core.metrics.lane_places import Place, lane_heading, lane_steps
from sgcad_core.metrics.rest_error import compass_rad
from sgcad_core.records.course import DepartureSide, Hand, Move, Spin, sense_of
from sgcad_core.roads.lane_graph import LaneGraph

_ALONG = math.sin(math.radians(20.0))
"""Sine of the angle to its way below which a compass word tells no side of it."""
_OFF: frozenset[Place] = frozenset({"off", "beside"})
_ON: frozenset[Place] = frozenset({"lane", "center_lane"})
_SOON_M = 5.0
"""Way behind the last place on a lane at which the side of a departure is seen."""


def hand_of(side: DepartureSide, heading_rad: float) -> Hand | None:
    """The side as a hand for a vehicle on a heading (radians counter-clockwise from east).

    None where it tells none: either side, or a compass word along its way.
    """
    if side == "left" or side == "right" or side == "either":
        return None if side == "either" else side
    across = math.sin(compass_rad(POINT_DEG[side]) - heading_rad)
    return None if abs(across) <= _ALONG else "left" if across > 0 else "right"


def left_road(graph: LaneGraph, poses: Floats, length_m: float) -> Hand | None:
    """The side on which a vehicle has left its lanes at the last of its (n, 3) poses, as seen along its last lane.

    It is beside the lanes, or on those of the other direction behind a median. None while it is on its own, or where it
    never was on a lane.
    """
    front, poses = poses[-1:].copy(), along_its_way(poses)
    front[0, :2] += length_m / 2 * np.array([np.cos(front[0, 2]), np.sin(front[0, 2])])
    places = lane_steps(graph, poses).places
    seen = next((at for at in (poses[-1], front[0]) if lane_steps(graph, at[None]).places[0] in _OFF), None)
    last = next((k for k in range(len(places) - 1, -1, -1) if places[k] in _ON), None)
    if seen is None and last is not None:  # over a median
        seen = next((poses[k] for k in range(last, len(places)) if places[k] in _OFF), None)
    if seen is None or last is None:
        return None
    along = lane_heading(graph, poses[last])
    way = along if along is not None else float(poses[last, 2])
    away = np.hypot(*(poses[last:, :2] - poses[last, :2]).T) >= _SOON_M
    soon = poses[last + int(away.argmax())] if away.any() else seen  # farther on, a road that bends lies elsewhere
    east, north = soon[:2] - poses[last, :2]
    return "left" if np.cos(way) * north - np.sin(way) * east > 0 else "right"


def along_its_way(poses: Floats) -> Floats:
    """(n, 3) poses that face the way of a vehicle, of one that backs the other way: one that spins drives in the lane
    over which it slides, whatever way it faces."""
    if len(poses) < 2:
        return poses
    step = np.gradient(poses[:, :2], axis=0)
    moving = np.hypot(*step.T) > _MOVES_M
    if not moving.any():
        return poses
    way = np.arctan2(step[:, 1], step[:, 0])
    first = int(moving.argmax())
    backs = math.pi * (abs(float(wrap_angle(way[first : first + 1] - poses[first, 2])[0])) > math.pi / 2)
    faced = poses.copy()
    faced[:, 2] = np.where(moving, way + backs, poses[:, 2])
    return faced


_STEERS_M = 0.4
"""Least way to the side of a visible swerve."""
_MOVES_M = 0.05
"""Way between two samples from which on a direction of travel shows."""
_YAW_RAD = math.radians(8.0)
"""Least angle of a box against its line in a visible yaw."""


def moves_made(graph: LaneGraph, one: VehicleMotion, moves: Sequence[Move], length_m: float) -> list[bool]:
    """For each told move whether a vehicle makes it before its first contact, behind the one before it.

    A move that is missed is passed over: the next one is looked for from the same time on.
    """
    places = np.array(lane_steps(graph, along_its_way(one.before)).places)
    found, at = [], 0
    for number, move in enumerate(moves):
        seen = _seen(one, places, move, at)
        if seen is None and move.kind == "departs" and number == len(moves) - 1:
            off = left_road(graph, one.before, length_m)
            seen = at if off is not None and _fits(move, one, off) else None
        found.append(seen is not None)
        at = at if seen is None else seen
    return found


def _seen(one: VehicleMotion, places: NDArray[np.str_], move: Move, at: int) -> int | None:
    """The first sample from one on by which a move is made."""
    aside, rest = one.aside[at:], places[at:]
    if move.kind == "departs":
        shown = np.isin(rest, [*_OFF]) & np.where(aside > 0, _fits(move, one, "left"), _fits(move, one, "right"))
    elif move.kind == "returns":
        away = np.maximum.accumulate(np.abs(aside)) - np.abs(aside) > _STEERS_M
        shown = np.isin(rest, [*_ON, "junction"]) & away
    elif move.kind == "crosses":
        shown = np.isin(rest, ["opposing", "center_lane"]) | ((rest == "off") & (aside > 0))
    elif move.kind == "yaws":
        shown = _slip(one)[at:] * sense_of(cast("Spin", move.side)) > _YAW_RAD
    else:
        gone = aside - np.minimum.accumulate(aside), np.maximum.accumulate(aside) - aside
        shown = {"left": gone[0], "right": gone[1]}.get(str(move.side), np.maximum(*gone)) > _STEERS_M
    return at + int(shown.argmax()) if shown.any() else None


def _fits(move: Move, one: VehicleMotion, hand: Hand) -> bool:
    return hand_of(cast("DepartureSide", move.side or "either"), float(one.before[0, 2])) in (None, hand)


def _slip(one: VehicleMotion) -> Floats:
    """(n,) angle of the box against its way, left positive; 0 where it stands."""
    step = np.gradient(one.before[:, :2], axis=0)
    moving = np.hypot(*step.T) > _MOVES_M
    angle = wrap_angle(one.before[:, 2] - np.arctan2(step[:, 1], step[:, 0]))
    slip: Floats = np.unwrap(np.where(moving, angle, 0.0))  # more than half a turn is on the side on which it began
    return np.where(moving, slip, 0.0)
