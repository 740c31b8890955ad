"""Objects that a vehicle strikes on its way to rest (poles, trees, fences, walls, people at the roadside).

They are placed along the motion of the settled scene: in front of a side of the box, off the road if the motion leads
there, as late as the impact is still visible, and where no actor has been before. An object gives way if the vehicle
goes on to another one, else it is fixed. Knows scenes and their tracks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sgcad_core.geometry.plane import SIDES, Floats, Size, gaps_where_near
from sgcad_core.planner.lines.path import Path
from sgcad_core.planner.motion import STEP_S, Motion, stand
from sgcad_core.planner.scene import Scene, Track
from sgcad_core.records.specs import Actor, Area, size_m
from sgcad_core.roads.surface import RoadSurface

_AFTER_S = 0.45
"""Duration of the first impact."""
_LEAST_MPS = 2.6
"""A slower impact is hardly one, and files whose vertices lie 0.11 m apart cannot show it."""
_DEPTH_M = 0.05
"""Overlap of the undisturbed box with the object at the sample of the impact."""
_GIVES_WAY_KG = 60.0
"""Mass of objects that give way: a breakaway post, a sign, a piece of fence."""
_ALL_TOLD = 1.0
"""A rest with a lower cost misses no stated part."""
_PAST_M = (6.0, 10.0, 16.0, 25.0, 40.0, 60.0)
_OFF_ROAD_M = 0.3
_OUTWARD_MPS = 0.5
"""Outward speed of a side of the box that can strike an object."""
_LATE, _EARLY = (0.95, 0.7, 0.45, 0.2), (0.1, 0.25, 0.4, 0.6)
"""Places to try, as shares of those with a visible impact: early where the vehicle goes on."""


@dataclass(frozen=True)
class Strike:
    """One object and the vehicle that strikes it."""

    thing: Actor
    by: str
    side: Area | None
    goes_on: bool
    """Whether the same vehicle strikes something else later."""
    aside: float = 0.0
    """Offset to the left of the middle of the side, as a share of it: objects struck in a row stand on both sides."""


def strike_things(
    scene: Scene, strikes: Sequence[Strike], surface: RoadSurface, cost: Callable[[], float]
) -> Iterator[str]:
    """Places every object in order; notes on those that are not reached. `cost`: of the rest as settled."""
    for strike in strikes:
        if not _placed(scene, strike, surface, cost):
            _stand(scene, strike, _out_of_reach(scene, strike))
            scene.settle()
            yield f"{strike.by} does not reach {strike.thing.id}, which it strikes as told"


def _out_of_reach(scene: Scene, strike: Strike) -> Floats:
    """A place ahead of the rest of the vehicle, at the first distance where no actor ever is."""
    size, track = size_m(strike.thing), scene.tracks[strike.by]
    x, y, heading = (float(v) for v in track.poses[-1])
    for away in (*_PAST_M, 500.0):
        pose = np.array([x + away * math.cos(heading), y + away * math.sin(heading), heading])
        if _is_free(scene, strike, pose, size, len(track.poses)):
            break
    return pose


def _placed(scene: Scene, strike: Strike, surface: RoadSurface, cost: Callable[[], float]) -> bool:
    """Places the object where the rest is best; False where no place is struck."""
    best: tuple[float, Track] | None = None
    base, before = {name: track.poses for name, track in scene.tracks.items()}, list(scene.touches)
    for pose in _places(scene, strike, surface):
        track = _stand(scene, strike, pose)
        scene.settle()
        if _is_struck(scene, strike) and (best is None or cost() < best[0]):
            best = (cost(), track)
        done = best is not None and (strike.goes_on or best[0] < _ALL_TOLD)
        del scene.tracks[strike.thing.id]
        scene.touches = before
        for name, poses in base.items():
            scene.tracks[name].poses = poses
        if done:
            break
    if best is None:
        return False
    scene.tracks[strike.thing.id] = best[1]
    scene.settle()
    return True


def _is_struck(scene: Scene, strike: Strike) -> bool:
    """Whether the object is struck by its vehicle first, after the first contact of all."""
    hits = [t for t in scene.touches if strike.thing.id in (t.first, t.second)]
    return bool(hits) and strike.by in (hits[0].first, hits[0].second) and hits[0] is not scene.touches[0]


def _stand(scene: Scene, strike: Strike, pose: Floats) -> Track:
    x, y, heading = (float(v) for v in pose)
    line = np.array([[x, y], [x + 0.01 * math.cos(heading), y + 0.01 * math.sin(heading)]])
    path = Path(line, np.array([0.0, 0.01]), np.full(2, heading))
    size = size_m(strike.thing)
    motion = Motion(path, *stand(path, 0.0), size, np.zeros(2), -math.inf, standing=True, fixed=not strike.goes_on)
    track = scene.add(strike.thing.id, strike.thing.kind, motion, 0.0, brakes=False)
    track.mass = _GIVES_WAY_KG if strike.goes_on and strike.thing.record.thing else None
    return track


# ------------------------------------------------------------------ where
def _places(scene: Scene, strike: Strike, surface: RoadSurface) -> list[Floats]:
    """(3,) poses on the way of the vehicle, best first: off the road before on it, the stated side before others."""
    size, track = size_m(strike.thing), scene.tracks[strike.by]
    samples = _samples(scene, strike, track)
    found = [(rank, pose) for k in samples for rank, pose in _beside(track, int(k), strike, size)
             if _is_free(scene, strike, pose, size, int(k))]  # fmt: skip
    if not found:
        return []
    poses = np.array([pose for _, pose in found])
    on_road = surface.off(poses[:, :2])[0] <= _OFF_ROAD_M
    ranks = np.array([rank for rank, _ in found]) + 10 * on_road
    chosen = np.flatnonzero(ranks == ranks.min())
    shares = _EARLY if strike.goes_on else _LATE
    return [poses[chosen[i]] for i in dict.fromkeys(round(share * (len(chosen) - 1)) for share in shares)]


def _samples(scene: Scene, strike: Strike, track: Track) -> Floats:
    """Samples after the last impact at which the vehicle still moves."""
    blows = [t.t_s for t in scene.touches if strike.by in (t.first, t.second)]
    if not blows:
        return np.zeros(0)
    begins = round((max(blows) + _AFTER_S) / STEP_S)
    speed = np.hypot(*np.diff(track.poses[:, :2], axis=0).T) / STEP_S
    moving = np.flatnonzero(speed > _LEAST_MPS)
    return moving[moving >= begins].astype(float) + 1


def _beside(track: Track, k: int, strike: Strike, size: Size) -> Iterator[tuple[int, Floats]]:
    """(rank, pose) of the object before each side of the box that moves outward; the stated side ranks first."""
    x, y, heading = track.poses[k]
    by = track.poses[k] - track.poses[k - 1]
    for number, side in enumerate(SIDES):
        out = heading + number * math.pi / 2
        outward = (by[0] * math.cos(out) + by[1] * math.sin(out)) / STEP_S
        if outward < _OUTWARD_MPS:
            continue
        reach = track.size[number % 2] / 2 + size[0] / 2 - min(_DEPTH_M, outward * STEP_S)
        leads = outward > 0.7 * math.hypot(by[0], by[1]) / STEP_S
        rank = 0 if side == strike.side or (strike.side is None and leads) else 1 if leads else 2
        left = strike.aside * track.size[1 - number % 2]
        yield rank, np.array([
            x + reach * math.cos(out) - left * math.sin(out), y + reach * math.sin(out) + left * math.cos(out), out,
        ])  # fmt: skip


def _is_free(scene: Scene, strike: Strike, pose: Floats, size: Size, until: int) -> bool:
    """Whether the vehicle has not been there before the impact, and no other actor ever is."""
    for name, track in scene.tracks.items():
        last = until - 1 if name == strike.by else len(track.poses)
        there = np.repeat(pose[None], last, axis=0)
        if last and float(gaps_where_near(there, size, track.poses[:last], track.size).min()) <= 0.0:
            return False
    return True
