"""Trailers: behind their tractor on its path before contact, dragged by the hitch afterwards."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.plane import Size
from sgcad_core.planner.lines.axle_to_box import box_path
from sgcad_core.planner.lines.path import Path
from sgcad_core.planner.motion import Motion
from sgcad_core.records.specs import Actor, BehaviorSpec

HITCH_M = 1.3
"""Between the boxes of tractor and trailer: enough that they do not touch in a turn."""


def tractors(behavior: BehaviorSpec) -> dict[str, str]:
    """Trailer id -> id of the vehicle that tows it: the one with its number, else one on its road."""
    vehicles = [a for a in behavior.actors if a.id.startswith("V")]
    found: dict[str, str] = {}
    for trailer in (a for a in behavior.actors if a.record.pulled and not a.id.startswith("V")):
        tractor = _tractor(trailer, [v for v in vehicles if v.id not in found.values()])
        if tractor is not None:
            found[trailer.id] = tractor.id
    return found


def _tractor(trailer: Actor, vehicles: Sequence[Actor]) -> Actor | None:
    same = [v for v in vehicles if (v.road, v.direction) == (trailer.road, trailer.direction)]
    heavy = [v for v in same if v.record.hauls]
    numbered = [v for v in vehicles if v.id[1:].lstrip("0") == trailer.id[1:].lstrip("0")]
    return next(iter([*numbered, *heavy, *same]), None)


def spacing_m(first: Size, second: Size) -> float:
    """Between the centers of tractor and trailer on a straight line."""
    return first[0] / 2 + HITCH_M + second[0] / 2


def ahead_of(motion: Motion, by_m: float, size: Size) -> Motion:
    """The same motion on the same line with its box further ahead (behind where negative)."""
    if motion.standing:
        return replace(motion, path=_slid(motion, by_m), size=size, penalty=np.zeros_like(motion.penalty))
    if motion.axle is None:
        return replace(motion, station_m=motion.station_m + by_m, size=size)
    return _rolling(motion, motion.axle, by_m, size)


def _slid(motion: Motion, by_m: float) -> Path:
    poses = motion.path.poses(motion.path.s_m + by_m)
    return replace(motion.path, points=poses[:, :2], heading_rad=poses[:, 2])


def _rolling(motion: Motion, axle: Path, by_m: float, size: Size) -> Motion:
    """The other box with its own rear axle on the same line."""
    backing = math.cos(float(motion.path.heading_rad[0] - axle.heading_rad[0])) < 0
    path = box_path(axle, size[0], backing=backing)
    own, other = (float(np.hypot(*(p.points[0] - axle.points[0]))) for p in (motion.path, path))
    shift = by_m + (own - other) * (-1.0 if backing else 1.0)
    return replace(motion, path=replace(path, s_m=axle.s_m), station_m=motion.station_m + shift, size=size)


def coupling_m(size: Size) -> float:
    """Distance from the center of a tractor to its coupling, metres."""
    return size[0] / 2 + HITCH_M / 2
