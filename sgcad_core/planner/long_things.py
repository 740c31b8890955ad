"""Long things beside the road (guardrails, walls, fences, ditches): they run along it, so that a vehicle meets them at
an angle and slides along.

Frames: headings counter-clockwise from east, radians; a thing's length is its depth, its width runs along the road, and
its front faces what comes. Knows boxes and kinds of things; no road and no time.
"""

from __future__ import annotations

import math

import numpy as np

from sgcad_core.geometry.plane import Floats, Size, corners_of
from sgcad_core.records.specs import Actor, Area, size_m

_LEAST_M, _SHAPE = 4.0, 2.5
"""Width of the shortest of them, and how often its depth it is at least."""
_BY_END_RAD, _BY_FLANK_RAD = math.radians(32.0), math.radians(10.0)
"""Angle between a vehicle and the thing that its front or back corner meets, and its flank. A corner lies on the front
from arctan(width / length) on: 21 degrees on a car."""
MOST_FLARE_DEG = 12.0
"""The largest angle to the road of a thing that runs along it, degrees: what exceeds it slants into the lanes."""
FLARES = ((0.0, 0.0), (8.0, 0.7), (MOST_FLARE_DEG, 1.0), (32.0, 1.4))
"""Angles in degrees at which the thing may come closer to the road, with their costs: along it wherever the told side
then meets it."""
_ALONG_END_RAD, _ALONG_FLANK_RAD = math.radians(25.0), math.radians(10.0)
"""The same of a vehicle that leaves the road, to what runs exactly along it."""
_AHEAD_M = 2.5
"""How far on along it the middle of the thing lies: the vehicle slides that way."""


def is_long(size: Size) -> bool:
    """Whether a thing of a depth and a width runs along the road."""
    return size[1] >= max(_LEAST_M, _SHAPE * size[0])


def runs_along(actor: Actor) -> bool:
    """Whether a thing runs along the road; a long piece that lies in the way lies across it."""
    return actor.record.thing and not actor.loose and is_long(size_m(actor))


def meeting_angle(side: Area | None) -> float:
    """The angle between the way of a vehicle and the thing that one of its sides meets."""
    return _BY_FLANK_RAD if side in ("left", "right") else _BY_END_RAD


def corner_m(by: Size, side: Area | None, behind_m: float = 0.0) -> float:
    """How far beside a vehicle its leading corner meets the thing with a side, metres: seen from its center, or from a
    point so far behind it."""
    angle = _ALONG_FLANK_RAD if side in ("left", "right") else _ALONG_END_RAD
    return (by[0] / 2 + behind_m) * math.sin(angle) + by[1] / 2 * math.cos(angle)


def reach_m(by: Size, angle_rad: Floats) -> Floats:
    """(n,) how far the farthest corner of a box lies from its center in a direction at some angle to its heading,
    metres."""
    reach: Floats = by[0] / 2 * np.abs(np.cos(angle_rad)) + by[1] / 2 * np.abs(np.sin(angle_rad))
    return reach


def meets_m(by: Size, side: Area | None, angle_rad: Floats, *, turned: bool) -> Floats:
    """(n,) how far from the center of a vehicle its corner meets the thing: at the usual angle of a side, or, where it
    has `turned` in a skid, with the thing at some angle to its heading, metres."""
    return reach_m(by, angle_rad) if turned else np.full(len(angle_rad), corner_m(by, side))


def hand_of_side(side: Area | None, leaves: int) -> tuple[int, ...]:
    """On which hands of a vehicle the thing may lie that a side meets: 1 left, -1 right; `leaves`: the hand on which it
    leaves the road, 0 where it stays on it."""
    told = {"left": 1, "right": -1}.get(side or "", leaves)
    return (told,) if told else (-1, 1)


def turned_to(hand: int, angle_rad: float) -> float:
    """Heading of the thing against that of the vehicle, whose way it crosses at an angle on one hand."""
    return -hand * (math.pi / 2 + angle_rad)


def corner_side(pose: Floats, by: Size, away_rad: float) -> Area:
    """The side on which a box at a pose touches a long thing that lies in a direction: that of the corner ahead, on
    which side it counts follows from the proportions of the box."""
    ahead, left = math.cos(away_rad - float(pose[2])), math.sin(away_rad - float(pose[2]))
    if abs(ahead) * by[0] > abs(left) * by[1]:
        return "front" if ahead > 0 else "back"
    return "left" if left > 0 else "right"


def beside(pose: Floats, by: Size, thing: Size, heading_rad: float, depth_m: float) -> Floats:
    """(3,) pose of the thing at a heading, overlapped by the nearest corner of a box at a pose by a depth, metres."""
    out = np.array([math.cos(heading_rad), math.sin(heading_rad)])
    corners = corners_of(pose[None], by)[0]
    nearest = corners[int(np.argmin(corners @ out))]
    along = np.array([-out[1], out[0]])
    ahead = math.copysign(_AHEAD_M, float(along @ [math.cos(pose[2]), math.sin(pose[2])]))
    x, y = nearest - out * (thing[0] / 2 - depth_m) + along * ahead
    return np.array([x, y, heading_rad])
