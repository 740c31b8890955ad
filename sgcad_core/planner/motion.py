"""Motion along a path: where a box is at which time, for one way to drive.

A motion has its own clock, which is 0 at the place chosen for the encounter; the planner shifts clocks against each
other. Knows no other actor. SI units.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sgcad_core.geometry.plane import Floats, Size
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.lines.path import Path

STEP_S = 0.05
LEAD_S = (4.2, 8.0)
"""Shortest and longest approach before the first contact."""
WINDOW_S = (-6.0, 4.5)
"""Own times in which an encounter is searched."""
LATERAL_MPS2 = 3.0
"""Sideways in ordinary driving, on a road that allows it."""
HARD_MPS2 = 4.5
"""Sideways in a swerve, or in a bend at a speed that the report states."""
ACCELERATION_MPS2 = 2.2
BRAKING_MPS2 = 3.0
YAW_RADPS = 1.1
"""Planned yaw rate at most: under the 1.5 rad/s that count."""
GROUND_MPS2 = 1.0
"""Deceleration of free wheels on grass or gravel, 0.1 g."""
EMERGENCY_SHARE = 0.6
"""Of the friction that braking before a crash takes: 5 m/s2 on dry roads, under the 7 of locked wheels."""
_STANDING_MPS = 5.0
_CRAWL_MPS = 1.0
LEAST_SLIDE_MPS = 4.0
"""Speed that a slide is left before its contact."""
_ABOUT = 0.98
_CURVE_PER_M = 0.02
"""A road that bends more is a turn and is driven at the usual speed of turns."""
_SHARE = {"lateral": 0.35, "hard": 0.5, "speeding": 0.25, "braking": 0.4}
"""Of the friction that a driver uses; the rest is the reserve for bends that begin and end."""


@dataclass(frozen=True)
class Pace:
    """How fast: cruising speed, cap in curves, and where it stops, starts or slows."""

    cruise_mps: float
    curve_mps: float = math.inf
    starts_at_m: float | None = None
    """Stands here before its clock runs on."""
    slow_at_m: float | None = None
    slow_mps: float = 0.0
    least_mps: float | None = None
    """The speed down to which it slows further from there on; None: it keeps its speed."""
    stops_at_m: float | None = None
    """Stops here and stands."""
    grip_mps2: float = DRIVING.friction_mps2(None)
    """What tires transmit on the surface."""
    hard: bool = False
    """Whether bends are driven at the highest lateral acceleration instead of the usual one."""
    brakes: bool = False
    """Whether it brakes as before an expected crash."""
    off: tuple[float, float] | None = None
    """Stations at which it begins to leave the road, and from which on it is off it."""

    @property
    def lateral_mps2(self) -> float:
        """Sideways acceleration that is planned with."""
        hard = self.hard or self.off is not None
        return self.within(HARD_MPS2, "hard") if hard else self.within(LATERAL_MPS2, "lateral")

    @property
    def braking_mps2(self) -> float:
        """Deceleration that is planned with."""
        return EMERGENCY_SHARE * self.grip_mps2 if self.brakes else self.within(BRAKING_MPS2, "braking")

    @property
    def slows_on_m(self) -> float:
        """How far behind `slow_at_m` it still slows."""
        least = self.slow_mps if self.least_mps is None else self.least_mps
        return (self.slow_mps**2 - least**2) / (2 * self.braking_mps2)

    def within(self, usual_mps2: float, use: str) -> float:
        """A usual acceleration, or as much of it as the surface allows."""
        return min(usual_mps2, _SHARE[use] * self.grip_mps2)


def gentle_mps2(grip_mps2: float) -> float:
    """Sideways acceleration of ordinary driving on a surface of some grip."""
    return Pace(0.0, grip_mps2=grip_mps2).lateral_mps2


@dataclass(frozen=True, eq=False)
class Motion:
    """A box on a path: knots of time and station, both increasing.

    `standing`: it does not move; its time then only enumerates places along the path. `begins_m`: station at which the
    maneuver begins. `penalty`: the cost of an encounter at each path point.
    """

    path: Path
    time_s: Floats
    station_m: Floats
    size: Size
    penalty: Floats
    begins_m: float
    standing: bool = False
    fixed: bool = False
    """Whether it cannot be pushed away (trees, poles, walls)."""
    axle: Path | None = None
    """The line of the rear axle, with the stations of the box; None without wheels."""
    drivable: bool = True
    """Whether the box can follow this line at all."""
    starts_s: float | None = None
    """Own time until which it stands at its stop, where it starts from one that is told or chosen."""

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

    def seen_at(self, speed_mps: float, before_s: float) -> float:
        """The last own time up to a given one at which it drives about a speed or more; -inf if never."""
        axle = self.axle or self.path
        along = np.interp(self.station_m, axle.s_m, axle.lengths)
        speed = np.diff(along) / np.maximum(np.diff(self.time_s), 1e-9)
        fast = np.flatnonzero((speed > _ABOUT * speed_mps) & (self.time_s[1:] <= before_s))
        return float(self.time_s[fast[-1]]) if len(fast) else -math.inf

    def penalties(self, time_s: ArrayLike) -> Floats:
        """The cost of an encounter at own times, by place and visible maneuver."""
        return np.interp(self.stations(time_s), self.path.s_m, self.penalty)

    @cached_property
    def digest(self) -> bytes:
        """A hash of all that determines its poses: two motions with equal digests have equal poses at all times."""
        found = hashlib.blake2b(repr((self.size, self.standing)).encode(), digest_size=16)
        path = self.path
        for part in (path.points, path.s_m, path.heading_rad, self.time_s, self.station_m):
            found.update(np.ascontiguousarray(part).tobytes())
            found.update(b"|")
        return found.digest()

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


def drive(
    path: Path,
    pace: Pace,
    place_m: float,
    more: tuple[Path, Path] | None = None,
    drag_mps2: Floats | None = None,
) -> tuple[Floats, Floats]:
    """Times and stations of a drive at a pace; time 0 at `place_m`.

    `more`: the path of the box and the line of the road (where it is capped in curves), if they are other ones.
    `drag_mps2`: (n,) what sliding tires take at the points of the path.

    The highest speed that keeps every limit on the driven line and never needs more than the usual accelerations: over
    v^2 an acceleration is a slope, so each pass is a running minimum.
    """
    station = _refined(path.s_m, pace.starts_at_m, pace.stops_at_m)
    along = np.interp(station, path.s_m, path.lengths)
    limit = np.interp(station, path.s_m, _limits(path, more or (path, path), pace)) ** 2
    if pace.slow_at_m is not None:
        on_m = np.clip(along - np.interp(pace.slow_at_m, path.s_m, path.lengths), 0.0, pace.slows_on_m)
        slow = pace.slow_mps**2 - 2 * pace.braking_mps2 * on_m
        limit = np.where(station >= pace.slow_at_m, np.minimum(limit, slow), limit)
    if pace.stops_at_m is not None:
        driven = station <= pace.stops_at_m
        station, along, limit = station[driven], along[driven], limit[driven]
        limit[-1] = 0.0
    limit = _rising(along[::-1] * -1, limit[::-1], pace.braking_mps2)[::-1]
    if pace.off is not None and drag_mps2 is None:  # tires that slide take more than the ground that wheels roll over
        limit = _rolling_off(pace, station, along, limit)
    if pace.starts_at_m is not None:
        ahead = station >= pace.starts_at_m
        station, along, limit = station[ahead], along[ahead], limit[ahead]
        limit[0] = 0.0
    squares = _rising(along, limit, pace.within(ACCELERATION_MPS2, "speeding"))
    if drag_mps2 is not None:
        squares = _slowed(along, squares, np.interp(station, path.s_m, drag_mps2))
    speed = np.sqrt(squares)
    mean = np.maximum((speed[1:] + speed[:-1]) / 2, 0.02)
    time = np.concatenate(([0.0], np.cumsum(np.diff(along) / mean)))
    return time - np.interp(place_m, station, time), station


def _rolling_off(pace: Pace, station: Floats, along: Floats, limit: Floats) -> Floats:
    """(n,) v^2 below a limit of a vehicle that leaves the road: it speeds up no more, and beside it the ground slows
    it. `along`: (n,) metres on the driven line."""
    begins, edge = pace.off or (math.inf, math.inf)
    late = station >= begins
    taken = 2 * GROUND_MPS2 * np.maximum(along - np.interp(edge, station, along), 0.0)[late]
    falls = np.minimum.accumulate(limit[late] + taken) - taken
    limit[late] = np.maximum(falls, np.minimum(limit[late], _CRAWL_MPS**2))
    return limit


def stand(path: Path, place_m: float) -> tuple[Floats, Floats]:
    """Times and stations that enumerate places to stand at, `place_m` at 0."""
    return (path.s_m - place_m) / _STANDING_MPS, path.s_m


def standing_at(pose: Floats, size: Size, *, fixed: bool = False) -> Motion:
    """The motion of what stands at a (3,) pose all the time, at its own time 0."""
    x, y, heading = (float(v) for v in pose)
    line = np.array([[x, y], [x + 0.01 * math.cos(heading), y + 0.01 * math.sin(heading)]])
    path = Path(line, np.array([0.0, 0.01]), np.full(2, heading))
    return Motion(path, *stand(path, 0.0), size, np.zeros(2), -math.inf, standing=True, fixed=fixed)


def _rising(along: Floats, limit: Floats, slope: float) -> Floats:
    """The largest v^2 below a limit whose slope over the distance is at most 2 * slope."""
    rise = 2 * slope * along
    lowest: Floats = np.minimum.accumulate(limit - rise) + rise
    return np.maximum(lowest, 0.0)


def _slowed(along: Floats, squares: Floats, drag_mps2: Floats) -> Floats:
    """v^2 along a line less the work of a drag, down to a slow slide."""
    slowed: Floats = np.maximum(squares - drag_work(along, drag_mps2), np.minimum(squares, LEAST_SLIDE_MPS**2))
    return slowed


def drag_work(along: Floats, drag_mps2: Floats) -> Floats:
    """(n,) what a drag takes from v^2 up to each of (n,) distances along a line."""
    return np.concatenate(([0.0], np.cumsum((drag_mps2[1:] + drag_mps2[:-1]) * np.diff(along))))


def _limits(path: Path, more: tuple[Path, Path], pace: Pace) -> Floats:
    """(n,) speeds that friction, yaw and habit allow on a line, m/s."""
    box, road = more
    bend = np.maximum(np.maximum(np.abs(path.curvature), np.abs(box.curvature)), 1e-5)
    curve = np.minimum(np.sqrt(pace.lateral_mps2 / bend), YAW_RADPS / bend)
    turning = np.interp(path.s_m, road.s_m, np.abs(road.curvature)) > _CURVE_PER_M
    curve = np.where(turning, np.minimum(curve, pace.curve_mps), curve)
    return np.clip(curve, _CRAWL_MPS, pace.cruise_mps)


def _refined(station: Floats, start_m: float | None, stop_m: float | None = None) -> Floats:
    """Stations with a few more behind a standing start and before a stop, where time runs fast over distance."""
    near = np.array([0.0, 0.01, 0.03, 0.06, 0.1, 0.17, 0.25, 0.35])
    added = [at + way * near for at, way in ((start_m, 1.0), (stop_m, -1.0)) if at is not None]
    return np.unique(np.concatenate((station, *added))) if added else station
