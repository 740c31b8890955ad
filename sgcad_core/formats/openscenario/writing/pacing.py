"""A motion along a path as few straight pieces of speed over time, from which the places follow.

Knows no XML.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from sgcad_core.case.records import Floats

NEAR_M = 0.03
"""How far along the path the pieces may lead beside the motion."""
SHORTEST = 3
"""Rows of the shortest piece, 0.05 s each: shorter ones are of no use to an editor."""
MOVED = 2
"""Rows by which a new knot may lie beside the bend that asked for it: differences smear bends over their neighbors."""
STILL_MPS = 0.02
"""Speeds below are a stand."""


def pieces(t_s: Floats, along_m: Floats) -> tuple[Floats, Floats]:
    """Times (s) and speeds (m/s, never negative) of the knots between which the speed changes evenly.

    `along_m`: distance gone at each time, never falling. Knots are added where the speed is furthest from the motion's
    (there it bends), until the distance gone is within NEAR_M everywhere or no piece is left to cut.
    """
    knots, wanted = [0, len(t_s) - 1], np.gradient(along_m, t_s)
    bends = np.gradient(np.gradient(wanted, t_s), t_s)
    while True:
        speeds, error = _fitted(t_s, along_m, knots)
        if np.abs(error).max() <= NEAR_M or (cut := _cut(t_s, wanted, knots)) is None:
            return t_s[knots], speeds
        beside = [row for row in range(cut - MOVED, cut + MOVED + 1) if _long(knots, row)]
        knots = sorted([*knots, max(beside, key=lambda row: abs(bends[row]))])


def _long(knots: list[int], row: int) -> bool:
    """Whether a knot there leaves no piece too short."""
    return knots[0] < row < knots[-1] and min(abs(row - knot) for knot in knots) >= SHORTEST


def _fitted(t_s: Floats, along_m: Floats, knots: list[int]) -> tuple[Floats, Floats]:
    """Speeds at the knots by least squares of the distances gone, and what is left of those (metres)."""
    hats = np.column_stack([np.interp(t_s, t_s[knots], unit) for unit in np.eye(len(knots))])
    steps = np.diff(t_s)[:, None] * (hats[1:] + hats[:-1]) / 2
    gone = np.vstack((np.zeros((1, len(knots))), np.cumsum(steps, axis=0)))
    speeds = _never_back(gone, along_m - along_m[0])
    return speeds, gone @ speeds - (along_m - along_m[0])


def _never_back(gone: Floats, along_m: Floats) -> Floats:
    """Least squares in which speeds that come out at a stand or below are stands, until none does."""
    free = np.ones(gone.shape[1], dtype=bool)
    speeds = np.zeros(gone.shape[1])
    while free.any():
        speeds[:] = 0.0
        speeds[free] = np.linalg.lstsq(gone[:, free], along_m, rcond=None)[0]
        if not (slow := free & (speeds < STILL_MPS)).any():
            break
        free &= ~slow
        speeds[slow] = 0.0
    return speeds


def _cut(t_s: Floats, wanted_mps: Floats, knots: list[int]) -> int | None:
    """The row at which a piece can be cut in two and the wanted speed is furthest from even changes between knots."""
    error = np.abs(wanted_mps - np.interp(t_s, t_s[knots], wanted_mps[knots]))
    allowed = np.zeros(len(error), dtype=bool)
    for first, last in pairwise(knots):
        allowed[first + SHORTEST : last - SHORTEST + 1] = True
    if not allowed.any():
        return None
    return int(np.where(allowed, error, -1.0).argmax())
