"""Trailers: behind their tractor on its path before contact, dragged by the hitch afterwards."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.plane import Floats, Size
from sgcad_core.planner.motion import Motion
from sgcad_core.planner.path import Path
from sgcad_core.planner.scene import Scene, Track
from sgcad_core.specs import Actor, BehaviorSpec

HITCH_M = 1.3
"""Between the boxes of tractor and trailer: enough that they do not touch in a turn."""


def tractors(behavior: BehaviorSpec) -> dict[str, str]:
    """Trailer id -> id of the vehicle that tows it: of its number, else one on its road and lane."""
    vehicles = [a for a in behavior.actors if a.id.startswith("V")]
    found: dict[str, str] = {}
    for trailer in (a for a in behavior.actors if a.kind == "trailer" and not a.id.startswith("V")):
        tractor = _tractor(trailer, [v for v in vehicles if v.id not in found.values()])
        if tractor is not None:
            found[trailer.id] = tractor.id
    return found


def _tractor(trailer: Actor, vehicles: Sequence[Actor]) -> Actor | None:
    same = [v for v in vehicles if (v.road, v.direction) == (trailer.road, trailer.direction)]
    heavy = [v for v in same if v.kind in ("truck", "pickup", "suv", "van")]
    numbered = [v for v in vehicles if v.id[1:].lstrip("0") == trailer.id[1:].lstrip("0")]
    return next(iter([*numbered, *heavy, *same]), None)


def spacing_m(first: Size, second: Size) -> float:
    """Between the centers of tractor and trailer on a straight line."""
    return first[0] / 2 + HITCH_M + second[0] / 2


def ahead_of(motion: Motion, by_m: float, size: Size) -> Motion:
    """The same motion on the same path with its box further ahead (behind where negative)."""
    if motion.standing:
        return replace(motion, path=_slid(motion, by_m), size=size, penalty=np.zeros_like(motion.penalty))
    return replace(motion, station_m=motion.station_m + by_m, size=size)


def _slid(motion: Motion, by_m: float) -> Path:
    poses = motion.path.poses(motion.path.s_m + by_m)
    return replace(motion.path, points=poses[:, :2], heading_rad=poses[:, 2])


def drag(scene: Scene, trailer: Track, tractor: Track) -> None:
    """Let a trailer follow its tractor's hitch from the tractor's impact on, unless it was hit itself."""
    start = tractor.hit
    if start is None or trailer.hit is not None:
        return
    hitch = _hitches(tractor)
    poses = trailer.poses.copy()
    bar = hitch[start] - poses[start, :2]
    length, angle = float(np.hypot(*bar)), math.atan2(bar[1], bar[0])
    askew = poses[start, 2] - angle
    for k in range(start + 1, scene.count):
        pull = hitch[k] - poses[k - 1, :2]
        angle += math.remainder(math.atan2(pull[1], pull[0]) - angle, math.tau)
        poses[k] = (*(hitch[k] - length * np.array([math.cos(angle), math.sin(angle)])), angle + askew)
    trailer.poses, trailer.hit = poses, start


def _hitches(tractor: Track) -> Floats:
    back = tractor.size[0] / 2 + HITCH_M / 2
    heading = tractor.poses[:, 2]
    points: Floats = tractor.poses[:, :2] - back * np.column_stack((np.cos(heading), np.sin(heading)))
    return points
