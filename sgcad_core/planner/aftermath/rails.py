"""Places of long things on the way of a vehicle to rest: along the nearest road, where a side of the box comes to them.

Knows tracks and the road surface; no scene.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats, Size
from sgcad_core.planner.long_things import (
    MOST_FLARE_DEG,
    beside,
    corner_side,
    hand_of_side,
    is_long,
    meeting_angle,
    turned_to,
)
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import Track
from sgcad_core.records.specs import Area
from sgcad_core.roads.surface import RoadSurface

DEPTH_M = 0.05
"""Overlap of the undisturbed box with the object at the sample of the impact."""
OUTWARD_MPS = 0.5
"""Outward speed of a side of the box that can strike an object."""
_OFF_ROAD_M = 0.3
_FLARES = ((0.0, 0), (8.0, 1), (-8.0, 1), (MOST_FLARE_DEG, 2), (-MOST_FLARE_DEG, 2))
ANOTHER_SIDE, SLANTED = 3, 4
"""Angles to the road at which a long thing may run, degrees, with their ranks; the rank of one along the road that is
met with another side than told, and that from which on one stands across: the last resort."""


def along_road(
    track: Track, samples: Floats, told_side: Area | None, size: Size, surface: RoadSurface
) -> Iterator[tuple[int, Floats, int]]:
    """(rank, pose, sample) of a long thing that runs along the nearest road, or nearly: first where the vehicle comes
    to it with the stated side, last along the road where another side meets it."""
    poses = track.poses[samples.astype(int)]
    by = (poses - track.poses[samples.astype(int) - 1])[:, :2] / STEP_S
    roads = surface.roads
    _, _, nearest = roads.nearest(poses[:, :2])
    for k, pose, speed, way in zip(samples.astype(int), poses, by, roads.ways[nearest], strict=True):
        outward = float(speed[1] * math.cos(way) - speed[0] * math.sin(way))
        if abs(outward) <= OUTWARD_MPS:
            continue
        for flare_deg, rank in _FLARES:
            away = float(way) + math.copysign(math.pi / 2, outward) + math.radians(flare_deg)
            told = told_side in (None, corner_side(pose, track.size, away))
            if told or not flare_deg:
                rank = rank if told else ANOTHER_SIDE
                yield rank, beside(pose, track.size, size, away + math.pi, DEPTH_M), int(k)


def across_road(surface: RoadSurface, place: Floats) -> float:
    """The heading of a long thing at a (2,) place that runs along the nearest road."""
    _, _, nearest = surface.roads.nearest(place[None])
    return float(surface.roads.ways[nearest[0]]) + math.pi / 2


def along_way(track: Track, k: int, side: Area, size: Size) -> Iterator[Floats]:
    """The poses of a long thing that runs along the road, before a side of the box on one hand or the other."""
    pose = track.poses[k]
    for hand in hand_of_side(side, 0):
        heading = float(pose[2]) + turned_to(hand, meeting_angle(side))
        yield beside(pose, track.size, size, heading, DEPTH_M)


def stands_on_road(surface: RoadSurface, poses: Floats, size: Size) -> NDArray[np.bool_]:
    """(n,) whether a thing at (n, 3) poses stands on the road: of a long one any part."""
    off: Floats = surface.off(poses[:, :2])[0]
    if not is_long(size):
        return off <= _OFF_ROAD_M
    across = np.column_stack((-np.sin(poses[:, 2]), np.cos(poses[:, 2])))
    for share in (-0.5, 0.5):
        off = np.minimum(off, surface.off(poses[:, :2] + share * size[1] * across)[0])
    return off <= 0.0
