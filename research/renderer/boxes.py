"""Boxes on the ground, metres: how large the actors are drawn, where they stand and whether they share ground."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from research.renderer.lines import Points

Size = tuple[float, float]
"""Length and width, metres."""
SIDE = {"front": 0.0, "left": math.pi / 2, "back": math.pi, "right": -math.pi / 2}


@dataclass
class Pose:
    """Center and heading, metres and radians."""

    x: float
    y: float
    heading: float


def wrap(angle: Any) -> Any:
    """An angle, or an array of them, to [-pi, pi)."""
    return (angle + math.pi) % (2 * math.pi) - math.pi


def half(size: Size, area: str) -> float:
    """From the center to a side."""
    return size[0] / 2 if area in ("front", "back") else size[1] / 2


def overlap(first: Pose, size: Size, second: Pose, other: Size) -> bool:
    """Whether two boxes share ground (separating axes)."""
    boxes = corners(first, size), corners(second, other)
    for heading in (first.heading, second.heading):
        for angle in (heading, heading + math.pi / 2):
            a, b = (box @ (math.cos(angle), math.sin(angle)) for box in boxes)
            if a.max() <= b.min() or b.max() <= a.min():
                return False
    return True


def corners(pose: Pose, size: Size) -> Points:
    """The four corners of a box, (4, 2), front left first."""
    return within(pose, size, [(0.5, 0.5), (0.5, -0.5), (-0.5, -0.5), (-0.5, 0.5)])


def within(pose: Pose, size: Size, shares: Sequence[tuple[float, float]]) -> Points:
    """World points (n, 2) of shares of a box: ahead and to the left of its middle."""
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    laid: Points = np.array(shares) * size @ np.array([(c, s), (-s, c)]) + (pose.x, pose.y)
    return laid


def distances_to(way: Points, pose: Pose) -> NDArray[np.float64]:
    """Metres from every point of a way to a pose."""
    gaps: NDArray[np.float64] = np.hypot(way[:, 0] - pose.x, way[:, 1] - pose.y)
    return gaps
