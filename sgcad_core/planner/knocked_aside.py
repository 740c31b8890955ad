"""Things, people and animals that a vehicle strikes outside the contacts of vehicles, and drives on.

A sign, a mailbox or a deer that is struck first stands on the way on which the vehicle comes, as late as the vehicle
still drives on to the contact that follows; it is thrown aside, and the vehicle keeps its line: its driver steers on.
What is firm takes a part of its speed.
Placed when everything else is settled. Knows scenes and their tracks; no roads but their surface.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats, Size, gaps_where_near
from sgcad_core.planner.actor_plan import facing, is_beside
from sgcad_core.planner.aftermath.struck_objects import Strike, standing_track
from sgcad_core.planner.aftermath.wreck_bodies import FALLEN_MPS2, LOST
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import TUMBLING_MPS2, Scene, Track
from sgcad_core.records.specs import Area, size_m
from sgcad_core.roads.surface import RoadSurface

_BEFORE, _LONGEST = 8, 70
"""Samples between one of these contacts and the first one of vehicles at least, and further ones that are tried."""
_BETWEEN = 8
"""Samples between two of these contacts."""
_STEP = 3
"""Samples between two places that are tried."""
_LEAST_MPS = 2.0
_CORNER = 0.34
"""Of the length of the striking side: how far beside its middle a thing is met, so that it can give way to the side."""
_DEPTH_M, _SHARE = 0.12, 0.6
"""Overlap at the sample of the contact, at most that share of a step."""
_GRAZED_M = 0.06
_GLANCED_M, _GLANCED_MOST_M, _GLANCED_DEPTH_M = 0.1, 0.3, 0.06
"""Overlap with a firm thing beside the way, the most of it while the vehicle passes, and that along the way at the
sample of the contact: less than beside it, so that it is the end of the vehicle that touches."""
_OFF_ROAD_M = 0.3
_PASSES_M = 0.12
"""Gap at which the vehicle then passes it."""
_ASIDE = 3
"""Samples in which it is thrown out of the way."""
_SIDEWAYS_MPS = 1.5
_FLIES = 0.8
"""Share of the vehicle's speed with which it leaves."""
_RANK_OFF, _RANK_MET = 1.0, 4.0


class _Place(NamedTuple):
    """One place of a thing: the sample of its contact, and where it is in the vehicle's frame."""

    sample: int
    side: Area
    ahead_m: float
    left_m: float
    outward_m: float
    """How far to the left it is thrown."""


def knock_aside(scene: Scene, strikes: Sequence[Strike], surface: RoadSurface) -> Iterator[str]:
    """Places things that are struck before the first contact of vehicles, in order; notes on those that cannot be."""
    latest = scene.contact - _BEFORE
    for strike in reversed(strikes):
        found = _best(scene, strike, surface, range(latest, max(latest - _LONGEST, 1), -_STEP))
        latest = found - _BETWEEN if found else latest
        if found and strike.thing.firm:
            _slow_at(scene, strike, found)
        if found is None:
            yield f"{strike.by} does not strike {strike.thing.id} before the first contact of vehicles, as is told"


def _slow_at(scene: Scene, strike: Strike, k: int) -> None:
    """Lets a vehicle come faster up to sample `k`, at which a firm thing takes a part of its speed; it comes as before
    where it has a trailer, would touch another actor, or its line is too short."""
    track, overlap_m = scene.tracks[strike.by], _GRAZED_M if is_beside(strike.side or "front") else _GLANCED_M
    came = np.arange(-k, 0) * STEP_S / (1.0 - LOST * overlap_m / track.size[1])
    own = track.own_s + k * STEP_S + came
    if track.motion.standing or own[0] < track.motion.time_s[0] or any(strike.by in pair for pair in scene.hitches):
        return
    poses = track.motion.poses(own)
    others = (t for name, t in scene.everybody.items() if name != strike.by)
    if all(_least(poses, track.size, t.poses[:k], t.size) > 0.0 for t in others):
        track.driven = np.concatenate((poses, track.driven[k:]))
        track.poses = np.concatenate((poses, track.poses[k:]))


def drive_over(scene: Scene, strikes: Sequence[tuple[Strike, int]], surface: RoadSurface) -> Iterator[str]:
    """Places things that vehicles outside the contacts strike, each behind a sample; notes on those that cannot be."""
    earliest = scene.contact + _BEFORE
    for strike, after in strikes:
        earliest = max(earliest, after + _BETWEEN)
        found = _best(scene, strike, surface, range(earliest, min(earliest + _LONGEST, scene.count - 1), _STEP))
        earliest = found + _BETWEEN if found else earliest
        if found is None:
            yield f"{strike.by} does not reach {strike.thing.id}, which it strikes as told"


def _best(scene: Scene, strike: Strike, surface: RoadSurface, samples: Sequence[int]) -> int | None:
    """Places a thing where that is least odd, the first of equal ones; the sample of its contact, None without any."""
    best: tuple[float, int, Track] | None = None
    for place in _places(scene, strike, samples):
        track = _thrown(scene, strike, place)
        odd = _oddity(scene, strike, surface, track, place.sample)
        if odd is not None and (best is None or odd < best[0]):
            best = odd, place.sample, track
        if best is not None and best[0] <= 0.0:
            break
    scene.aside[strike.thing.id] = best[2] if best else standing_track(scene, strike.thing, _away(scene, strike))
    return best[1] if best else None


def _places(scene: Scene, strike: Strike, samples: Sequence[int]) -> Iterator[_Place]:
    """Places along the way of the vehicle, on either corner of the side that strikes."""
    size, track = size_m(strike.thing), scene.tracks[strike.by]
    for k in samples:
        side = _side(track, k, strike.side)
        if side is None:
            continue
        by_m = math.dist(track.driven[k, :2], track.driven[k - 1, :2])
        if is_beside(side):
            hand = 1.0 if side == "left" else -1.0
            left_m = hand * (track.size[1] / 2 + size[0] / 2 - _GRAZED_M)
            yield _Place(k, side, track.size[0] / 2 + size[1] / 2 - 0.9 * by_m, left_m, hand * (_GRAZED_M + _PASSES_M))
            continue
        along = 1.0 if side == "front" else -1.0
        depth_m = min(_GLANCED_DEPTH_M if strike.thing.firm else _DEPTH_M, _SHARE * by_m)
        ahead_m = along * (track.size[0] / 2 + size[0] / 2 - depth_m)
        for hand in (-1.0, 1.0):
            if strike.thing.firm:
                yield _Place(k, side, ahead_m, hand * ((track.size[1] + size[1]) / 2 - _GLANCED_M), 0.0)
                continue
            clear_m = track.size[1] / 2 + size[1] / 2 + _PASSES_M
            left_m = min(_CORNER * track.size[1] + max(size[1] / 2 - 0.4, 0.0), clear_m - 0.3)
            yield _Place(k, side, ahead_m, hand * left_m, hand * (clear_m - left_m))


def _side(track: Track, k: int, told: Area | None) -> Area | None:
    """The side that strikes: the told one, unless the vehicle leaves the thing behind; None where it hardly moves."""
    heading = float(track.driven[k, 2])
    vx, vy = (track.driven[k, :2] - track.driven[k - 1, :2]) / STEP_S
    ahead = float(vx * math.cos(heading) + vy * math.sin(heading))
    if abs(ahead) < _LEAST_MPS:
        return None
    leading: Area = "front" if ahead > 0 else "back"
    return told if told is not None and is_beside(told) and ahead > 0 else leading


def _thrown(scene: Scene, strike: Strike, place: _Place) -> Track:
    """The thing's track: it stands (who walks comes on foot) until it is struck, and slides to rest beside the way."""
    driven, k = scene.tracks[strike.by].driven, place.sample
    turn = facing(place.side) + math.pi - (facing(strike.thing_side) if strike.thing.record.walks else 0.0)
    poses = np.empty((scene.count, 3))
    poses[: k + 1] = _beside(driven[k], place.ahead_m, place.left_m, turn)
    poses[:k] += _walked(strike, poses[k], k)
    if strike.thing.stays:
        poses[k:] = poses[k]
    else:
        slows = TUMBLING_MPS2 if strike.thing.record.exposed or strike.thing.record.walks else FALLEN_MPS2
        _throw(poses, driven, place, (turn, slows))
    track = standing_track(scene, strike.thing, poses[k])
    track.poses, track.driven, track.hit = poses, poses, k
    return track


def _throw(poses: Floats, driven: Floats, place: _Place, how: tuple[float, float]) -> None:
    """Writes how a thing is thrown aside behind the sample of its contact, and slides to rest; `how`: its heading in
    the frame of the vehicle, and its deceleration."""
    k, end, grazed, (turn, slows_mps2) = place.sample, len(poses) - 1, is_beside(place.side), how
    for j in range(1, _ASIDE + 1):
        share = 1.0 if grazed else j / _ASIDE
        base = driven[k] if grazed else driven[min(k + j, end)]
        poses[min(k + j, end)] = _beside(base, place.ahead_m, place.left_m + share * place.outward_m, turn)
    last = min(k + _ASIDE, end)
    poses[last:] = poses[last] if grazed else poses[last] + _slide(driven, place, len(poses) - last, slows_mps2)


def _beside(pose: Floats, ahead_m: float, left_m: float, turn: float) -> Floats:
    """A pose in the frame of another one."""
    x, y, heading = pose
    c, s = math.cos(heading), math.sin(heading)
    return np.array([x + ahead_m * c - left_m * s, y + ahead_m * s + left_m * c, heading + turn])


def _walked(strike: Strike, pose: Floats, k: int) -> Floats:
    """(k, 3) differences of the poses before a contact to that of it: none for what stands."""
    pace = strike.thing.record.pace_mps if strike.thing.record.walks else 0.0
    back = -(pace or 0.0) * STEP_S * np.arange(k, 0, -1)
    return np.column_stack((back * math.cos(pose[2]), back * math.sin(pose[2]), np.zeros(k)))


def _slide(driven: Floats, place: _Place, count: int, slows_mps2: float) -> Floats:
    """(count, 3) differences to the pose in which it leaves the vehicle, until it has slid to rest."""
    k = place.sample
    speed = (driven[k, :2] - driven[k - 1, :2]) / STEP_S * _FLIES
    heading = float(driven[k, 2])
    hand = math.copysign(_SIDEWAYS_MPS, place.outward_m)
    speed = speed + hand * np.array([-math.sin(heading), math.cos(heading)])
    mps = math.hypot(*speed)
    time = np.minimum(np.arange(count) * STEP_S, mps / slows_mps2)
    way = time - slows_mps2 * time**2 / (2 * mps)
    return np.column_stack((speed[0] * way, speed[1] * way, np.zeros(count)))


def _oddity(scene: Scene, strike: Strike, surface: RoadSurface, track: Track, k: int) -> float | None:
    """0 for what stands beside the road (who walks: on it) and meets no other actor; None where it meets one before
    the contact."""
    own = scene.tracks[strike.by]
    if k < 1 or _least(track.poses[:k], track.size, own.driven[:k], own.size) <= 0.0:
        return None
    if _least(track.poses[k : k + 1], track.size, own.driven[k : k + 1], own.size) >= 0.0:
        return None
    others = [t for name, t in scene.everybody.items() if name not in (strike.by, strike.thing.id)]
    until = max(k, scene.contact) + 1
    if any(_least(track.poses[:until], track.size, t.poses[:until], t.size) <= 0.0 for t in others):
        return None
    met = sum(_least(track.poses, track.size, other.poses, other.size) <= 0.0 for other in others)
    if strike.thing.firm:
        met += _least(track.poses[k:], track.size, own.driven[k:], own.size) < -_GLANCED_MOST_M
    beside = float(surface.off(track.poses[k : k + 1, :2])[0][0]) > _OFF_ROAD_M
    return _RANK_MET * met + _RANK_OFF * (beside == strike.thing.record.walks)


def _least(a: Floats, size: Size, b: Floats, other: Size) -> float:
    return float(gaps_where_near(a, size, b, other).min())


def _away(scene: Scene, strike: Strike) -> Floats:
    """A place far beside the way, for what cannot be struck."""
    x, y, heading = scene.tracks[strike.by].driven[0]
    aside = heading - math.pi / 2
    return np.array([x + 30.0 * math.cos(aside), y + 30.0 * math.sin(aside), heading])
