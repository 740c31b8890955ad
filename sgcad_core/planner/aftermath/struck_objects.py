"""Objects that a vehicle strikes on its way to rest (poles, trees, fences, walls, people at the roadside).

They are placed along the motion of the settled scene: in front of a side of the box, off the road if the motion leads
there, as late as the impact is still visible, and where no actor has been before. An object gives way if the vehicle
goes on to another one, else it is fixed. Knows scenes and their tracks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from sgcad_core.geometry.plane import SIDES, Floats, Size, gaps_where_near
from sgcad_core.planner.actor_plan import is_beside
from sgcad_core.planner.aftermath.rails import (
    ANOTHER_SIDE,
    DEPTH_M,
    OUTWARD_MPS,
    SLANTED,
    across_road,
    along_road,
    along_way,
    stands_on_road,
)
from sgcad_core.planner.aftermath.second_contact import first_sides
from sgcad_core.planner.aftermath.told_order import ToldOrder, touched
from sgcad_core.planner.long_things import runs_along
from sgcad_core.planner.motion import STEP_S, standing_at
from sgcad_core.planner.scene import Scene, Track
from sgcad_core.records.specs import Actor, Area, size_m
from sgcad_core.roads.surface import RoadSurface

_AFTER_S = 0.45
"""Duration of the first impact."""
_BETWEEN = 3
"""Samples between the last contact and this one."""
_LEAST_MPS = 2.6
"""A slower impact is hardly one, and files whose vertices lie 0.11 m apart cannot show it."""
_GRAZE_M = 0.02
"""Overlap of a flank with what it scrapes: deeper, the corner ahead of it would meet the thing head on."""
_PASSED = 0.6
"""Share of the way of a sample by which the corner of a flank has passed what the flank scrapes."""
GLANCES = (0.25, 0.17, 0.08)
"""Shares of its width by which a vehicle may overlap a firm thing off which it glances, the likeliest first: up to a
quarter, as in the small-overlap test of the IIHS, where the thing passes outside of the rails of its frame."""
_ALL_TOLD = 1.0
"""A rest with a lower cost misses no stated part."""
_OTHER_SIDE = 1.0
"""Cost of striking with another side than told: as much as a missed part of the rest."""
_FURTHER, _ALL_PLACES = 2, 99
"""Places at which it is struck that are tried behind the first one, where further contacts follow and where not."""
_PAST_M = (6.0, 10.0, 16.0, 25.0, 40.0, 60.0)
_GENTLE_MPS = 0.8
"""Taken where the vehicle is no faster any more."""
_ON_ROAD, _LEFT_OUT = 10, 99
"""Rank of what stands on the road over the same beside it; that of places that are not tried."""
_RANKS = 2
"""Kinds of places (on or off the road, before the told side or another one) that are tried."""
_LATE, _EARLY = (0.95, 0.7, 0.45, 0.2), (0.1, 0.25, 0.4, 0.6)
"""Places to try, as shares of those with a visible impact: early where further contacts follow, and among many of them
at the place that leaves each an equal share of the way."""


@dataclass(frozen=True)
class Strike:
    """One object and the vehicle that strikes it."""

    thing: Actor
    by: str
    side: Area | None
    goes_on: bool
    """Whether the same vehicle strikes something else later."""
    asides: tuple[float, ...] = (0.0,)
    """Offsets to the left of the middle of the side to try, as shares of it: what is struck off the middle turns the
    vehicle, to the left where it is positive; objects struck in a row stand on both sides."""
    thing_side: Area = "front"
    """The side of the object that touches."""

    @property
    def glances(self) -> bool:
        """Whether the vehicle goes on past a thing that stays."""
        passes = self.side is None or not is_beside(self.side)
        return self.goes_on and self.thing.firm and passes and not runs_along(self.thing)


def leave_beside(scene: Scene, strike: Strike, surface: RoadSurface) -> None:
    """Places an object that is not reached beyond the rest of its vehicle, a long one along the road."""
    _stand(scene, strike, _out_of_reach(scene, strike, surface))
    scene.settle()


def _out_of_reach(scene: Scene, strike: Strike, surface: RoadSurface) -> Floats:
    """A place ahead of the rest of the vehicle, else beside it, at the first distance where no actor ever is."""
    size, track = size_m(strike.thing), scene.tracks[strike.by]
    x, y, heading = (float(v) for v in track.poses[-1])
    for turn, away in (*product((0.0, math.pi / 2, -math.pi / 2), _PAST_M), (0.0, 500.0)):
        place = np.array([x + away * math.cos(heading + turn), y + away * math.sin(heading + turn)])
        faces = across_road(surface, place) if runs_along(strike.thing) else heading
        pose = np.array([*place, faces])
        if _is_free(scene, strike, pose, size, len(track.poses)):
            break
    return pose


def place_thing(
    scene: Scene, strike: Strike, surface: RoadSurface, cost: Callable[[], float], order: ToldOrder, *,
    more: int, on_road: bool = True, as_told: bool = False,
) -> bool:  # fmt: skip
    """Places an object where it is struck with the stated side and the rest is best; False where no place is struck
    next in order.

    `cost`: of the rest as settled. `more`: number of contacts that follow. `on_road`: whether it may stand there.
    `as_told`: a long thing only along the road, and before the told side.
    """
    best: tuple[float, Track] | None = None
    further = _FURTHER if more else _ALL_PLACES
    for rank, pose in _poses(scene, strike, surface, order.after, more=more):
        if as_told and rank >= ANOTHER_SIDE:
            continue
        if not on_road and stands_on_road(surface, pose[None], size_m(strike.thing))[0]:
            continue
        track = _stand(scene, strike, pose)
        scene.settle()
        if _is_struck(scene, strike, order):
            missed = _OTHER_SIDE * on_another_side(scene, strike) + (0.0 if more else cost())
            best = (missed, track) if best is None or missed < best[0] else best
            further -= 1
        del scene.tracks[strike.thing.id]
        if best is not None and (best[0] < _ALL_TOLD or further < 0):
            break
    if best is not None:
        scene.tracks[strike.thing.id] = best[1]
        order.pairs.append(frozenset((strike.by, strike.thing.id)))
    scene.settle()
    return best is not None


def _poses(
    scene: Scene, strike: Strike, surface: RoadSurface, after: int, *, more: int
) -> Iterator[tuple[int, Floats]]:
    """The places of an object with their ranks, at one offset after the other."""
    for aside in strike.asides:
        yield from _places(scene, replace(strike, asides=(aside,)), surface, after, more=more)


def _is_struck(scene: Scene, strike: Strike, order: ToldOrder) -> bool:
    """Whether the object is struck by its vehicle first, next in told order."""
    hits = [t for t in scene.touches if strike.thing.id in (t.first, t.second)]
    pair = frozenset((strike.by, strike.thing.id))
    return bool(hits) and touched(hits[0]) == pair and hits[0] is not scene.touches[0] and order.holds(pair)


def on_another_side(scene: Scene, strike: Strike) -> bool:
    """Whether the vehicle touches the object first with another side than the stated one."""
    seen = first_sides(scene.tracks[strike.by], scene.tracks[strike.thing.id])
    return strike.side is not None and seen is not None and seen[0] != strike.side


def standing_track(scene: Scene, thing: Actor, pose: Floats, *, fixed: bool = False) -> Track:
    """An actor that stands at a pose all the time, not yet part of the scene."""
    motion = standing_at(pose, size_m(thing), fixed=fixed)
    return Track(thing.id, thing.kind, motion.size, scene.poses(motion, 0.0, brakes=False), motion, 0.0)


def _stand(scene: Scene, strike: Strike, pose: Floats) -> Track:
    stays = strike.thing.stays or not strike.goes_on
    track = standing_track(scene, strike.thing, pose, fixed=stays)
    scene.tracks[strike.thing.id] = track
    track.firm, track.flat = strike.glances, strike.thing.flat
    if not stays:
        track.give_way()
    return track


# ------------------------------------------------------------------ where
def _places(scene: Scene, strike: Strike, surface: RoadSurface, after: int, *, more: int) -> list[tuple[int, Floats]]:
    """Ranks and (3,) poses on the way of the vehicle, best first: off the road before on it, pieces on it before off
    it, the stated side first."""
    size, track = size_m(strike.thing), scene.tracks[strike.by]
    samples = _samples(scene, strike, track, after)
    near = along_road(track, samples, strike.side, size, surface) if runs_along(strike.thing) else iter(())
    ranked = ((rank, pose, int(k)) for k in samples for rank, pose in _beside(track, int(k), strike, size))
    found = [(rank, pose) for rank, pose, k in (*near, *ranked) if _is_free(scene, strike, pose, size, k)]
    if not found:
        return []
    poses = np.array([pose for _, pose in found])
    on_road = stands_on_road(surface, poses, size) != strike.thing.loose
    ranks = np.array([rank for rank, _ in found]) + _ON_ROAD * on_road
    if runs_along(strike.thing) and (ranks < SLANTED).any():
        ranks[ranks >= SLANTED] = _LEFT_OUT
    shares = (0.6 / (more + 1), *_EARLY) if more else _LATE
    ordered: list[tuple[int, Floats]] = []
    for rank in np.unique(ranks[ranks < _LEFT_OUT])[:_RANKS]:
        chosen = np.flatnonzero(ranks == rank)
        at = dict.fromkeys(round(share * (len(chosen) - 1)) for share in shares)
        ordered += [(int(rank) % _ON_ROAD, poses[chosen[i]]) for i in at]
    return ordered


def _samples(scene: Scene, strike: Strike, track: Track, after: int) -> Floats:
    """Samples after its last impact, and behind the last told contact, at which the vehicle still moves."""
    blows = [t.t_s for t in scene.touches if strike.by in (t.first, t.second)] or [scene.contact * STEP_S]
    begins = max(round((max(blows) + _AFTER_S) / STEP_S), after + _BETWEEN)
    speed = np.hypot(*np.diff(track.poses[:, :2], axis=0).T) / STEP_S
    for least in (_LEAST_MPS, _GENTLE_MPS):
        moving = np.flatnonzero(speed > least)
        if (moving >= begins).any():
            break
    return moving[moving >= begins].astype(float) + 1


def _beside(track: Track, k: int, strike: Strike, size: Size) -> Iterator[tuple[int, Floats]]:
    """(rank, pose) of the object before each side of the box that moves outward; the stated side ranks first."""
    x, y, heading = track.poses[k]
    by = track.poses[k] - track.poses[k - 1]
    for number, side in enumerate(SIDES):
        out = heading + number * math.pi / 2
        outward = (by[0] * math.cos(out) + by[1] * math.sin(out)) / STEP_S
        grazes = side == strike.side and is_beside(side) and abs(outward) < OUTWARD_MPS
        if outward < OUTWARD_MPS and not grazes:
            continue
        if runs_along(strike.thing) and side != "back":
            rank = SLANTED + (side != strike.side and strike.side is not None)
            yield from ((rank, pose) for pose in along_way(track, k, side, size))
            continue
        if grazes:
            yield 0, _grazed(track, k, out, size)
            continue
        if strike.glances and number % 2:
            continue
        depth, width = (max(size), min(size)) if strike.glances else size
        reach = track.size[number % 2] / 2 + depth / 2 - min(DEPTH_M, outward * STEP_S)
        leads = outward > 0.7 * math.hypot(by[0], by[1]) / STEP_S
        rank = 0 if side == strike.side or (strike.side is None and leads) else 1 if leads else 2
        left = strike.asides[0] * track.size[1 - number % 2]
        if strike.glances:
            left = math.copysign((track.size[1] + width) / 2 - GLANCES[-1] * track.size[1], left)
        turned = out + (math.pi / 2 if depth != size[0] else 0.0)
        yield rank, np.array([
            x + reach * math.cos(out) - left * math.sin(out), y + reach * math.sin(out) + left * math.cos(out), turned,
        ])  # fmt: skip


def _grazed(track: Track, k: int, out: float, size: Size) -> Floats:
    """The pose of a thing that a flank scrapes as the vehicle passes: it reaches into the way by the least that is
    seen, and the corner that leads has just passed its near edge. `out`: direction in which the flank looks."""
    (x, y, heading), (before_x, before_y, _) = track.poses[k], track.poses[k - 1]
    moved = (x - before_x) * math.cos(heading) + (y - before_y) * math.sin(heading)
    ahead = math.copysign(track.size[0] / 2 - _PASSED * abs(moved) + size[1] / 2, moved)
    reach = track.size[1] / 2 + size[0] / 2 - _GRAZE_M
    x, y = x + ahead * math.cos(heading), y + ahead * math.sin(heading)
    return np.array([x + reach * math.cos(out), y + reach * math.sin(out), out])


def _is_free(scene: Scene, strike: Strike, pose: Floats, size: Size, until: int) -> bool:
    """Whether the vehicle has not been there before the impact, and no other actor ever is."""
    for name, track in scene.tracks.items():
        last = until - 1 if name == strike.by else len(track.poses)
        there = np.repeat(pose[None], last, axis=0)
        if last and float(gaps_where_near(there, size, track.poses[:last], track.size).min()) <= 0.0:
            return False
    return True
