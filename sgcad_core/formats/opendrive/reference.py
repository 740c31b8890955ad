"""Reference lines: a polyline as straight pieces and circular arcs, without kinks.

SUMO draws curves as polylines; an OpenDRIVE lane beside a kinked reference line has gaps. Every corner
becomes an arc that touches both of its segments, so that headings are continuous and straight roads stay
exact. Metres and radians; knows no lane.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.opendrive.geometry import Pose, wrap
from sgcad_core.geometry.plane import Floats

STRAIGHT_RAD = 1e-7
SHARPEST_RAD = math.radians(175)
"""A polyline that turns back on itself has no arc: such a corner keeps its kink."""
LEAST_M = 1e-6
OFF_M = 0.05
"""How far an arc may leave its corner where the road beside it needs no wider bend."""
CLEAR_M = 1.0
"""The least radius of the innermost lane border."""


class Piece(NamedTuple):
    """A straight (curvature 0) or circular piece of a reference line that begins at `start`."""

    start: Pose
    length_m: float
    curvature: float = 0.0

    def at(self, s_m: float) -> Pose:
        """The pose s_m metres along."""
        x, y, h = self.start
        k = self.curvature
        if abs(k) < 1e-12:
            return Pose(x + s_m * math.cos(h), y + s_m * math.sin(h), h)
        turn = k * s_m
        return Pose(x + (math.sin(h + turn) - math.sin(h)) / k, y + (math.cos(h) - math.cos(h + turn)) / k, h + turn)


def pieces(points: Floats, reach_m: tuple[float, float] = (0.0, 0.0)) -> tuple[Piece, ...]:
    """Lines and arcs along (n, 2) points; both ends and their headings are those of the polyline.

    `reach_m`: how far lanes extend to the left and to the right: a bend's radius stays beyond them, so that
    no lane border folds, as far as its segments have room.
    """
    steps = np.diff(points, axis=0)
    sizes, directions = np.hypot(*steps.T), np.arctan2(steps[:, 1], steps[:, 0])
    turns = np.array([wrap(float(b - a)) for a, b in pairwise(directions)])
    cuts = _cuts(sizes, turns, reach_m)
    found, gone = list[Piece](), 0.0
    for i, (size, direction) in enumerate(zip(sizes, directions, strict=True)):
        ahead = cuts[i] if i < len(cuts) else 0.0
        x, y = points[i] + gone * np.array([math.cos(direction), math.sin(direction)])
        if size - gone - ahead > LEAST_M:
            found.append(Piece(Pose(float(x), float(y), float(direction)), float(size - gone - ahead)))
        if ahead:
            here = points[i + 1] - ahead * np.array([math.cos(direction), math.sin(direction)])
            found.append(_arc(Pose(float(here[0]), float(here[1]), float(direction)), float(turns[i]), ahead))
        gone = ahead
    return tuple(_joined(found))


def _arc(start: Pose, turn: float, cut: float) -> Piece:
    """The arc that touches both segments `cut` metres from their corner."""
    curvature = math.tan(turn / 2) / cut
    return Piece(start, turn / curvature, curvature)


def _cuts(sizes: Floats, turns: Floats, reach_m: tuple[float, float]) -> list[float]:
    """How much of both segments each corner's arc takes, metres; 0 for no corner."""
    cuts = []
    for i, turn in enumerate(turns):
        room = min(_room(sizes, turns, i), _room(sizes, turns, i + 1))
        inner = reach_m[0] if turn > 0 else reach_m[1]
        tan = math.tan(abs(turn) / 2)
        wanted = max((inner + CLEAR_M) * tan, OFF_M / max(math.tan(abs(turn) / 4), 1e-12))
        cuts.append(min(room, wanted) if STRAIGHT_RAD < abs(turn) < SHARPEST_RAD else 0.0)
    return cuts


def _room(sizes: Floats, turns: Floats, segment: int) -> float:
    """What a segment can give to a corner: all where its other end is an end, else its half."""
    shared = 0 < segment < len(turns)
    return float(sizes[segment]) / (2 if shared else 1) * 0.999


def _joined(found: Sequence[Piece]) -> list[Piece]:
    """Straight pieces in a row as one."""
    merged: list[Piece] = []
    for piece in found:
        if merged and not piece.curvature and not merged[-1].curvature and _same_way(merged[-1], piece):
            merged[-1] = merged[-1]._replace(length_m=merged[-1].length_m + piece.length_m)
        else:
            merged.append(piece)
    return merged


def _same_way(one: Piece, two: Piece) -> bool:
    return abs(wrap(two.start.heading_rad - one.start.heading_rad)) < 2e-6


def length_of(line: Sequence[Piece]) -> float:
    """Length of a reference line, metres."""
    return sum(piece.length_m for piece in line)


def pose_at(line: Sequence[Piece], s_m: float) -> Pose:
    """Pose s_m metres along a reference line, clamped to its ends."""
    left = max(s_m, 0.0)
    for piece in line:
        if left <= piece.length_m:
            return piece.at(left)
        left -= piece.length_m
    return line[-1].at(line[-1].length_m)
