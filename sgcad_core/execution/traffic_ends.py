"""What background vehicles do beyond the ends of the roads: they come in straight at their first speed and go on
straight at their last one, and so that none is far away they stand in a queue, a car's place each, 140 m beyond.

Coming in is going out with the clock reversed. Knows poses; no road and no simulator.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import NamedTuple

import numpy as np

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import Floats
from sgcad_core.case.traffic import BRAKING_MPS2

FARTHEST_M = 140.0
"""Checks of scenario files allow 150 m beyond the network."""
PLACE_M = 8.0
STANDS_MPS = 1e-3


class Stretch(NamedTuple):
    """A vehicle while it was on the roads: where it came in and went out, its first row, and (m, 4) poses."""

    entry: Hashable
    exit: Hashable
    first: int
    poses: Floats


def whole_motions(driven: Mapping[str, Stretch], rows: int) -> dict[str, Floats]:
    """By id (rows, 4) poses."""
    smooth = {name: _unwrapped(one.poses) for name, one in driven.items()}
    after = {name: (one.exit, one.first + len(one.poses)) for name, one in driven.items()}
    before = {name: (one.entry, rows - one.first) for name, one in driven.items()}
    places_out, places_in = _places(after), _places(before)
    found = {}
    for name, one in driven.items():
        poses = smooth[name]
        behind = _on(poses[-1], rows - one.first - len(poses), FARTHEST_M - PLACE_M * places_out[name], 1.0)
        ahead = _on(poses[0], one.first, FARTHEST_M - PLACE_M * places_in[name], -1.0)[::-1]
        found[name] = np.vstack((ahead, poses, behind))
    return found


def _unwrapped(poses: Floats) -> Floats:
    poses = poses.copy()
    poses[:, 2] = np.unwrap(poses[:, 2])
    return poses


def _places(ends: Mapping[str, tuple[Hashable, int]]) -> dict[str, int]:
    """Place in the queue of its lane, the first to come 0."""
    found, taken = dict[str, int](), dict[Hashable, int]()
    for name, (lane, _) in sorted(ends.items(), key=lambda item: item[1][1]):
        found[name] = taken.get(lane, 0)
        taken[lane] = found[name] + 1
    return found


def _on(pose: Floats, rows: int, place_m: float, sign: float) -> Floats:
    """(rows, 4) poses from one on, straight; it comes to a stand at the place. `sign`: -1 goes backwards."""
    x, y, heading, speed = (float(v) for v in pose)
    t_s = np.arange(1, rows + 1, dtype=np.float64) * STEP_S
    along, speeds = _braking(speed, max(place_m, 0.0), t_s)
    way = sign * along
    same = np.full(rows, heading)
    return np.column_stack((x + way * np.cos(heading), y + way * np.sin(heading), same, speeds))


def _braking(speed_mps: float, place_m: float, t_s: Floats) -> tuple[Floats, Floats]:
    """Way and speed over time of a vehicle that goes on evenly and brakes evenly to a stand at a place."""
    if speed_mps < STANDS_MPS or place_m <= 0.0:
        return np.zeros(len(t_s)), np.zeros(len(t_s))
    way_m = min(speed_mps**2 / (2 * BRAKING_MPS2), place_m)
    from_s, lasts_s = (place_m - way_m) / speed_mps, 2 * way_m / speed_mps
    late = np.clip(t_s - from_s, 0.0, lasts_s)
    slower = late / lasts_s
    along = speed_mps * np.minimum(t_s, from_s) + speed_mps * late * (1 - slower / 2)
    return along, speed_mps * np.where(t_s > from_s, 1 - slower, 1.0)
