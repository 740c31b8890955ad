"""Places where a standing vehicle is struck by one that comes by after the first contact.

As for things that are struck on the way to rest: before a side of the box that comes, with the told side towards it,
along its road if that is not far off. Knows scenes and roles.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sgcad_core.geometry.plane import SIDES, Floats, gaps_where_near
from sgcad_core.kinds import ACROSS_LANES
from sgcad_core.planner.actor_plan import Role, facing
from sgcad_core.planner.encounter.meeting_place import place_near, stop_m
from sgcad_core.planner.lines.departures import DEPARTURES
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import Scene, Track
from sgcad_core.records.specs import Area
from sgcad_core.roads.surface import RoadSurface
from sgcad_core.units import MPS_PER_MPH

_LEAST_MPS = 2.6
"""A slower impact is hardly one, and files whose vertices lie 0.11 m apart cannot show it."""
_PUSHES_MPS = 0.5
"""One that is pushed touches the next one at this speed still."""
_SOON_S, _AT_ONCE_S = 0.3, 0.1
"""Time between two contacts at least, where the partner drives and where it is pushed."""
_SOON, _LATE = (0.1, 0.25, 0.45, 0.65), (0.3, 0.5, 0.7, 0.15, 0.9)
"""Places to try, as shares of those where the partner still moves: soon where it goes on to a further contact."""
_DEPTH_M = 0.05
_ALONG_RAD = math.radians(50.0)
"""The told side is met at this angle as well, so that the vehicle stands along its road."""
_ASIDE = (0.0, 0.3, -0.3)
"""Shares of the partner's side by which the vehicle stands beside its middle."""
_AGAINST, _OTHER_SIDE = 2.5, 1.5
"""Ranks of a vehicle that waits against the direction of its lane, and of one that waits in it but is met with another
side than told."""
_OFF_ROAD_M = 0.3
_LINE_M, _LINE_STEP_M = 60.0, 2.0
"""Length of the line on which a vehicle may be struck, each way from its usual place, and between its points."""
_BESIDE_M, _PARKED_M = 1.5, 8.0
"""Distance from the middle of its lane from which on a vehicle is beside it, and is not parked along its road."""
_SLOWED = 0.1
"""Share of its told speed by which a vehicle may drive slower or faster."""
_OUT_OF_LANES = ACROSS_LANES | DEPARTURES.keys() | {"crossing_centerline", "backing", "u_turn"}
_IN_JUNCTION = 0.8
"""Rank of one that waits in a junction: drivers wait before it."""


@dataclass(frozen=True)
class ToBeStruck:
    """The search for a place of a vehicle that stands until a partner in the scene strikes it.

    `sides`: of the partner and of the vehicle. `more`: whether further contacts follow.
    """

    scene: Scene
    role: Role
    partner: str
    sides: tuple[Area, Area]
    surface: RoadSurface
    more: bool

    def poses(self, after: int) -> Iterator[Floats]:
        """(3,) poses, the best first, where no other actor ever is and the partner comes behind a sample only."""
        ranked = [found for k in self._samples(after) for found in self._before(k)]
        poses = np.array([pose for _, _, pose in ranked]).reshape(-1, 3)
        waits = self.role.actor.maneuver == "stopped"
        apart = not_waiting(self.surface, poses) if waits else np.zeros(len(poses))
        order = sorted((rank + more, n) for n, ((rank, _, _), more) in enumerate(zip(ranked, apart, strict=True)))
        for _, n in order:
            _, k, pose = ranked[n]
            if self._is_free(pose, k):
                yield pose

    def _samples(self, after: int) -> list[int]:
        poses = self.scene.tracks[self.partner].poses
        speed = np.hypot(*np.diff(poses[:, :2], axis=0).T) / STEP_S
        found: list[int] = []
        for least, wait_s in ((_LEAST_MPS, _SOON_S), (_PUSHES_MPS, _AT_ONCE_S)):
            moving = np.flatnonzero(speed > least)
            moving = moving[moving >= after + round(wait_s / STEP_S)] + 1
            shares = _SOON if self.more or self.role.actor.maneuver == "stopped" else _LATE
            found += [int(moving[round(share * (len(moving) - 1))]) for share in shares] if len(moving) else []
        return found

    def _before(self, k: int) -> Iterator[tuple[float, int, Floats]]:
        """(rank, sample, pose) before the told side of the partner, else before the one that leads."""
        track = self.scene.tracks[self.partner]
        x, y, heading = (float(v) for v in track.poses[k])
        by = track.poses[k] - track.poses[k - 1]
        for number, side in enumerate(SIDES):
            out = heading + facing(side)
            outward = float(by[0] * math.cos(out) + by[1] * math.sin(out)) / STEP_S
            leads = outward > 0.7 * math.hypot(by[0], by[1]) / STEP_S
            if outward < _PUSHES_MPS / 2 or not (leads or side == self.sides[0]):
                continue
            half, wide = (track.size[number % 2] / 2, track.size[1 - number % 2])
            for turned, angle in self._headings(track.poses[k], out):
                reach = half + self._extent(angle - out) - min(_DEPTH_M, outward * STEP_S)
                for aside in _ASIDE:
                    left = aside * wide
                    rank = 2.0 * (side != self.sides[0]) + turned + 0.2 * bool(aside)
                    yield rank, k, np.array([
                        x + reach * math.cos(out) - left * math.sin(out),
                        y + reach * math.sin(out) + left * math.cos(out), angle,
                    ])  # fmt: skip

    def _headings(self, partner: Floats, out: float) -> Iterator[tuple[float, float]]:
        """(rank, heading): along its road where the told side then faces the partner about, else straight to it."""
        exact = out + math.pi - facing(self.sides[1])
        course = self.role.course
        along = float(course.path.poses([place_near(course, partner).station_m])[0, 2])
        against = _AGAINST if self.role.actor.maneuver == "stopped" else 0.3
        for rank, angle in ((0.0, along), (against, along + math.pi)):
            if abs(math.remainder(angle - exact, 2 * math.pi)) < _ALONG_RAD:
                yield rank, angle
        yield max(0.6, against if math.cos(exact - along) < 0.0 else 0.0), exact
        if self.role.actor.maneuver == "stopped":
            yield _OTHER_SIDE, along

    def _extent(self, turned: float) -> float:
        """How far the vehicle reaches from its center, at an angle to its heading."""
        length, width = self.role.size
        return length / 2 * abs(math.cos(turned)) + width / 2 * abs(math.sin(turned))

    def _is_free(self, pose: Floats, k: int) -> bool:
        for name, track in self.scene.tracks.items():
            last = k - 1 if name == self.partner else len(track.poses)
            there = np.repeat(pose[None], last, axis=0)
            if last and float(gaps_where_near(there, self.role.size, track.poses[:last], track.size).min()) <= 0.0:
                return False
        return True


def lane_line(role: Role) -> Floats:
    """(n, 2) points of the line of a vehicle on which it may be struck: of one that waits, before its junction; of one
    that is parked, beside its lane."""
    course, parked = role.course, role.actor.maneuver == "parked"
    entry_m = next((p.entry_m for p in course.passages if p.is_junction and p.entry_m > course.start_m), course.end_m)
    end_m = stop_m(entry_m, role.size[0]) if role.actor.maneuver == "stopped" else course.end_m
    here_m = min(role.place.station_m, end_m)
    stations = np.arange(max(course.start_m, here_m - _LINE_M), min(end_m, here_m + _LINE_M), _LINE_STEP_M)
    line = course.path.moved(-course.beside_m.get("parking", course.lane_width_m)) if parked else course.path
    return line.poses(stations)[:, :2]


def is_astray(role: Role, track: Track, surface: RoadSurface) -> bool:
    """Whether a vehicle is beside its lane untold as it is struck: led out of it, or waiting where drivers do not."""
    told, actor = role.told, role.actor
    if not actor.record.drives or actor.record.laneless or actor.maneuver in _OUT_OF_LANES:
        return False
    if told.departs or told.steers or told.lost_control or told.moves:
        return False
    pose = track.poses[max((track.hit or 1) - 1, 0)]
    aside_m = abs(place_near(role.course, pose).aside_m)
    if actor.maneuver == "parked":
        return aside_m > _PARKED_M and not role.course.stalls
    waits = actor.maneuver == "stopped" and bool(not_waiting(surface, pose[None])[0])
    return waits or aside_m > _BESIDE_M


def is_slowed(role: Role, track: Track) -> bool:
    """Whether a vehicle never drives at the speed that is told of it before it is struck."""
    told_mps = (role.actor.speed_mph or 0) * MPS_PER_MPH
    before = track.poses[: track.hit or len(track.poses), :2]
    if not told_mps or track.motion.standing or len(before) < 2:
        return False
    mps = np.hypot(*np.diff(before, axis=0).T) / STEP_S
    return float(np.abs(mps - told_mps).min()) > _SLOWED * told_mps


def not_as_told(role: Role, track: Track, surface: RoadSurface) -> int:
    """How much of what is told, or usual, of a vehicle before it is struck is missed: its lane, its speed."""
    return is_astray(role, track, surface) + is_slowed(role, track)


def not_waiting(surface: RoadSurface, poses: Floats) -> Floats:
    """(n,) ranks of (n, 3) poses at which drivers do not wait: off the road, and in a junction."""
    off, _, nearest = surface.nearest(poses[:, :2]) if len(poses) else (np.zeros(0), None, np.zeros(0, dtype=int))
    inside = np.array([bool(surface.lanes) and surface.lanes[n] == "junction" for n in nearest], dtype=float)
    ranks: Floats = np.where(off > _OFF_ROAD_M, 1.0, _IN_JUNCTION * inside)
    return ranks
