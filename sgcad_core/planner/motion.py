"""Motion along a path: where a box is at which time, for one way to drive.

A motion has a clock of its own, 0 at the place that was chosen for the encounter; the planner shifts clocks
against each other. Knows no other actor. SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sgcad_core.geometry.plane import Floats, Size
from sgcad_core.planner.path import Path

STEP_S = 0.05
WINDOW_S = (-6.0, 4.5)
"""Own time in which an encounter is looked for."""
LATERAL_MPS2 = 3.5
ACCELERATION_MPS2 = 2.2
BRAKING_MPS2 = 3.0
_STANDING_MPS = 5.0
_TURN_HALF_M = 20.0
_TURN_RAD = math.radians(25)
"""Over twice that length: less is no turn but a shift from lane to lane across a junction."""


@dataclass(frozen=True)
class Pace:
    """How fast: cruising speed, cap in curves, and where it stops, starts or slows."""

    cruise_mps: float
    curve_mps: float = math.inf
    starts_at_m: float | None = None
    """Stands here before its clock runs on."""
    slow_at_m: float | None = None
    slow_mps: float = 0.0
    braking_mps2: float = BRAKING_MPS2


@dataclass(frozen=True, eq=False)
class Motion:
    """A box on a path: knots of time and station, both increasing.

    `standing`: it does not move; its "time" then only enumerates places along the path. `begins_m`: station
    at which the maneuver begins. `penalty`: one value a path point, how ill an encounter there fits.
    """

    path: Path
    time_s: Floats
    station_m: Floats
    size: Size
    penalty: Floats
    begins_m: float
    standing: bool = False
    fixed: bool = False
    """Cannot be pushed away (trees, poles, walls)."""

    def stations(self, time_s: ArrayLike) -> Floats:
        """Stations at own times."""
        stations: Floats = np.interp(np.asarray(time_s, dtype=float), self.time_s, self.station_m)
        return stations

    def poses(self, time_s: ArrayLike) -> Floats:
        """(n, 3) x, y, heading at own times."""
        return self.path.poses(self.stations(time_s))

    def time_at(self, station_m: float) -> float:
        """Own time at which a station is passed."""
        return float(np.interp(station_m, self.station_m, self.time_s))

    def penalties(self, time_s: ArrayLike) -> Floats:
        """How ill an encounter at own times fits the maneuver and the place."""
        return np.interp(self.stations(time_s), self.path.s_m, self.penalty)

    @cached_property
    def window_poses(self) -> Floats:
        """Poses on the search window's grid, STEP_S apart."""
        return self.poses(window_times())


def window_times() -> Floats:
    """The search window's grid of own times, seconds."""
    return clock(round(WINDOW_S[0] / STEP_S), round(WINDOW_S[1] / STEP_S) + 1)


def clock(start: int, stop: int) -> Floats:
    """Times of the samples from `start` to before `stop`, seconds."""
    return np.arange(start, stop, dtype=np.float64) * STEP_S


def drive(path: Path, pace: Pace, place_m: float, road: Path) -> tuple[Floats, Floats]:
    """Times and stations of a drive at a pace; time 0 at `place_m`. `road`: the line whose curves slow it down.

    The highest speed that keeps every limit and never needs more than the usual accelerations: over v^2 an
    acceleration is a slope, so each pass is a running minimum.
    """
    station = _refined(path.s_m, pace.starts_at_m)
    along = np.interp(station, path.s_m, path.lengths())
    limit = np.interp(station, path.s_m, _limits(road, pace)) ** 2
    if pace.slow_at_m is not None:
        limit = np.where(station >= pace.slow_at_m, np.minimum(limit, pace.slow_mps**2), limit)
    limit = _rising(along[::-1] * -1, limit[::-1], pace.braking_mps2)[::-1]
    if pace.starts_at_m is not None:
        ahead = station >= pace.starts_at_m
        station, along, limit = station[ahead], along[ahead], limit[ahead]
        limit[0] = 0.0
    speed = np.sqrt(_rising(along, limit, ACCELERATION_MPS2))
    mean = np.maximum((speed[1:] + speed[:-1]) / 2, 0.02)
    time = np.concatenate(([0.0], np.cumsum(np.diff(along) / mean)))
    return time - np.interp(place_m, station, time), station


def stand(path: Path, place_m: float) -> tuple[Floats, Floats]:
    """Times and stations that enumerate places to stand at, `place_m` at 0."""
    return (path.s_m - place_m) / _STANDING_MPS, path.s_m


def _rising(along: Floats, limit: Floats, slope: float) -> Floats:
    """The largest v^2 below a limit whose slope over the distance is at most 2 * slope."""
    rise = 2 * slope * along
    lowest: Floats = np.minimum.accumulate(limit - rise) + rise
    return np.maximum(lowest, 0.0)


def _limits(road: Path, pace: Pace) -> Floats:
    bend = np.abs(road.curvature())
    bend = np.convolve(np.pad(bend, 2, mode="edge"), np.ones(5) / 5, mode="valid")
    swing = np.abs(_swing(road))
    bend = np.where(swing < _TURN_RAD, np.minimum(bend, swing / (2 * _TURN_HALF_M)), bend)
    curve = np.sqrt(LATERAL_MPS2 / np.maximum(bend, 1e-5))
    curve = np.where(bend > 0.02, np.minimum(curve, pace.curve_mps), curve)
    return np.clip(curve, 2.0, pace.cruise_mps)


def _swing(road: Path) -> Floats:
    """(n,) how far the line turns from _TURN_HALF_M before each point to as far behind it, radians."""
    angle, at = road.tangents(), road.lengths()
    ahead, behind = np.interp(at + _TURN_HALF_M, at, angle), np.interp(at - _TURN_HALF_M, at, angle)
    swing: Floats = ahead - behind
    return swing


def _refined(station: Floats, start_m: float | None) -> Floats:
    """Stations with a few more behind a standing start, where time runs fast over distance."""
    if start_m is None:
        return station
    near = start_m + np.array([0.0, 0.01, 0.03, 0.06, 0.1, 0.17, 0.25, 0.35])
    return np.unique(np.concatenate((station, near)))
