"""Which rows of a trajectory become vertices of a polyline, so that every player keeps them all.

esmini merges vertices nearer than 0.1 m to the last one kept (its `traj_filter`, on by default), unless they turn
right by 0.1 rad or end a standstill of a second, and moves evenly across what it dropped: up to 0.09 m beside the
file while an actor comes to rest. So what it would drop is not written; where actors drive faster than
APART_M / 0.05 s = 2.2 m/s that is nothing. Knows no XML.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sgcad_core.case.records import Floats, Trajectory
from sgcad_core.geometry.plane import arc_lengths, runs

APART_M = 0.11
"""Nearest neighbors in space; a little above esmini's 0.1 m."""
TURN_RAD = (-0.11, 0.8)
"""Right and left turns on the spot that are vertices of their own; left ones are kept so that no turn is lost
(headings go along the shortest arc), although esmini drops them."""
NEAREST = 8
"""How many rows before one are tried as its neighbor."""
_TOGETHER = 64
"""Rows whose distances to all earlier ones are computed together."""
STAND_S = 1.0 + 1e-3
"""Shortest standstill between two motions that a player keeps as such."""
BLOW_M = 0.075
"""Change from one step to the next, 30 m/s2 at 20 steps a second: three times what tires transmit."""
_STILL = 1e-6
LEFT_OUT_M, LEFT_OUT_RAD = 0.01, 0.005
"""A vertex of an untimed path is left out where the way without it is this near."""


def vertex_rows(move: Trajectory, ahead_m: float = 0.0) -> list[int]:
    """Rows to write, rising; the first and the last are always among them.

    `move` is the origin's motion; of all choices that players keep, the one is taken under which the box center,
    `ahead_m` before it, moves nearest to its rows (least squares).
    """
    poses = np.column_stack((move.x_m, move.y_m, np.unwrap(move.heading_rad)))
    end = len(poses) - 1
    rows = [0]
    for first, last in pairwise(_anchors(poses, move.t_s)):
        here = slice(first, last + 1)
        stretch = _Stretch(move.t_s[here], poses[here], ahead_m)
        rows += [first + row for row in stretch.choice(last == end)]
    return rows


def held_at_standstill(move: Trajectory) -> Trajectory:
    """The motion of an actor that an impact hardly moves from its standstill, without that movement.

    Of a standstill and so small a motion behind it to the end, esmini keeps the first and the last vertex only, and
    creeps between them from the start on.
    """
    poses = np.column_stack((move.x_m, move.y_m, np.unwrap(move.heading_rad)))
    end = len(poses) - 1
    stands = [b for a, b in _standstills(poses) if b < end and move.t_s[b] - move.t_s[a] >= STAND_S]
    if not stands or _apart(poses[stands[-1] :], poses[stands[-1]]).any():
        return move
    rows = np.minimum(np.arange(len(poses)), stands[-1])
    return move.model_copy(update={name: getattr(move, name)[rows] for name in ("x_m", "y_m", "heading_rad")})


@dataclass(frozen=True)
class _Stretch:
    """Rows from one that is written to another: times (n,) and the origin's poses (n, 3)."""

    t_s: Floats
    poses: Floats
    ahead_m: float

    def choice(self, final: bool) -> list[int]:
        """The rows behind the first one, the last included, with the least error (dynamic programming).

        The final vertex of a polyline is never merged, so its neighbor may be near.
        """
        end = len(self.poses) - 1
        neighbors = self._neighbors(final)
        plain = 1  # as long as every row may follow the one before, nothing is nearer to the motion than all rows
        while plain <= end and neighbors[plain][-1:] == [plain - 1]:
            plain += 1
        errors = self._errors([(k, row) for row in range(plain, end + 1) for k in neighbors[row]])
        least, before = [0.0] * plain + [math.inf] * (end + 1 - plain), [0, *range(plain - 1), *[0] * (end + 1 - plain)]
        for row in range(plain, end + 1):
            for k in neighbors[row]:
                if (error := least[k] + errors[k, row]) <= least[row]:  # of equals the nearest
                    least[row], before[row] = error, k
        rows = [end]
        while (row := before[rows[-1]]) > 0:
            rows.append(row)
        return rows[::-1]

    def _neighbors(self, final: bool) -> list[list[int]]:
        """For each row the rows that may be written before it, rising."""
        end = len(self.poses) - 1
        reached, found = np.arange(end + 1) == 0, [list[int]()]
        for row in range(1, end + 1):
            if row % _TOGETHER == 1:
                some = slice(row, row + _TOGETHER)
                apart = _apart(self.poses[None, : some.stop], self.poses[some, None])
            closes = final and row == end
            reach = np.flatnonzero(reached[:row] & (closes | apart[(row - 1) % _TOGETHER, :row]))
            found.append((reach if closes else reach[-NEAREST:]).tolist())
            reached[row] = bool(found[row])
        return found

    def _errors(self, pairs: Sequence[tuple[int, int]]) -> dict[tuple[int, int], float]:
        """(first, last) -> sum of squared distances of the box centers between two rows from even motion, m2.

        All pairs in one computation: (N, 3) poses of even motion, those of a pair behind those of the one before.
        """
        far = np.array([pair for pair in pairs if pair[1] - pair[0] > 1], dtype=int).reshape(-1, 2)
        first, last = far.T
        counts = last - first + 1
        ends = np.cumsum(counts)
        rows = np.arange(counts.sum()) - np.repeat(ends - counts - first, counts)
        first, last = np.repeat(first, counts), np.repeat(last, counts)
        share = ((self.t_s[rows] - self.t_s[first]) / (self.t_s[last] - self.t_s[first]))[:, None]
        even = self.poses[first] + share * (self.poses[last] - self.poses[first])
        away = self._centers(even) - self._centers(self.poses)[rows]
        squares = away * away
        found = dict.fromkeys(pairs, 0.0)
        for count in np.unique(counts):
            same = np.flatnonzero(counts == count)
            sums = squares[(ends[same] - count)[:, None] + np.arange(count)].reshape(len(same), -1).sum(axis=1)
            found.update(zip(map(tuple, far[same].tolist()), sums.tolist(), strict=True))
        return found

    def _centers(self, poses: Floats) -> Floats:
        reach = np.column_stack((np.cos(poses[:, 2]), np.sin(poses[:, 2])))
        return np.asarray(poses[:, :2] + self.ahead_m * reach, dtype=np.float64)


def _anchors(poses: Floats, t_s: Floats) -> list[int]:
    """First and last row, both ends of standstills that last, the end of those too short to be kept."""

    def apart(first: int, second: int) -> bool:
        return bool(_apart(poses[first : first + 1], poses[second])[0])

    end = len(poses) - 1
    anchors = [0]
    for first, last in _standstills(poses):
        if last == end:
            break  # the choice of rows sees to it
        lasting = t_s[last] - t_s[first] >= STAND_S and (first == anchors[-1] or apart(anchors[-1], first))
        if lasting or apart(anchors[-1], last):
            anchors += [row for row in (first, last) if row > anchors[-1] and (lasting or row == last)]
    for row in _blows(poses):
        before, after = (
            max((a for a in anchors if a < row), default=0),
            min((a for a in anchors if a > row), default=end),
        )
        if row not in anchors and apart(before, row) and (after == end or apart(row, after)):
            anchors = sorted([*anchors, row])
    return [*anchors, end]


def _blows(poses: Floats) -> list[int]:
    """Rows at which a motion changes as only a blow changes it: a vertex there keeps the moment of the contact."""
    jump = np.hypot(*np.diff(poses[:, :2], n=2, axis=0).T)
    return [int(row) + 1 for row in np.flatnonzero(jump > BLOW_M)]


def _standstills(poses: Floats) -> list[tuple[int, int]]:
    """First and last row of every run of equal poses."""
    still = (np.abs(np.diff(poses, axis=0)) < _STILL).all(axis=1)
    return [(first, last + 1) for first, last in runs(still)]


def _apart(poses: Floats, other: Floats) -> NDArray[np.bool_]:
    """Whether no player merges poses (..., 3) with a later one."""
    by = other - poses
    dx, dy, turn = by[..., 0], by[..., 1], by[..., 2]
    return np.asarray((dx * dx + dy * dy >= APART_M**2) | (turn <= TURN_RAD[0]) | (turn >= TURN_RAD[1]), dtype=np.bool_)


# ------------------------------------------------------------------ untimed paths
def path_rows(line: Trajectory, ahead_m: float) -> list[int]:
    """Rows to write of an untimed path: of a timed one those that move on and do not lie between others."""
    poses = np.column_stack((line.x_m, line.y_m, np.unwrap(line.heading_rad)))
    rows = vertex_rows(line, ahead_m)
    moved = np.concatenate(([True], np.hypot(*np.diff(poses[rows, :2], axis=0).T) > 1e-4))
    return _bends(poses, np.array(rows)[moved])


def _bends(poses: Floats, rows: NDArray[np.intp]) -> list[int]:
    """The rows (of poses (n, 3), none in place) between which the way runs straight and turns evenly."""
    kept, at = [int(rows[0])], 0
    while at < len(rows) - 1:
        after = at + 1
        while after + 1 < len(rows) and _even(poses[rows[at : after + 2]]):
            after += 1
        kept, at = [*kept, int(rows[after])], after
    return kept


def _even(poses: Floats) -> bool:
    """Whether what lies between two poses can be left out of a path."""
    along = arc_lengths(poses[:, :2])
    share = (along / along[-1])[:, None]
    away = np.abs(poses[0] + share * (poses[-1] - poses[0]) - poses)
    return bool(np.hypot(away[:, 0], away[:, 1]).max() < LEFT_OUT_M and away[:, 2].max() < LEFT_OUT_RAD)
