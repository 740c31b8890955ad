"""Run-outs by which a vehicle that was struck gets to a further contact.

All run-outs of one are computed at once, against the motions of the others as they are settled. Knows scenes; no
report.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats, gaps_where_near
from sgcad_core.planner.aftermath.ground_friction import Released, RunOut, run_out_paths
from sgcad_core.planner.aftermath.rest_candidates import all_runs, loops, oddities
from sgcad_core.planner.aftermath.second_contact import wrong_sides
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import Scene
from sgcad_core.records.specs import Area
from sgcad_core.roads.surface import RoadSurface

_BLOW_S = 0.3
"""Duration of an impact; then wheels and driver count."""
_COARSE = 2
"""Samples of the clock in a step of the run-outs."""
_APART_S = 0.2
"""Time after the last contact from which on the next one is looked for."""
_PER_S, _OTHER_SIDE = 0.05, 2.0
"""Cost of a contact that comes later, and of one with another side than told."""
_PARTED_M = 0.06
"""Gap beyond which two touch anew."""
_STEERS_PER_M = (0.03, 0.06, 0.1)
"""Bends of the ways on which a vehicle is led towards the stated sides of a further contact."""
_SOON, _GOES_ON_M = 4, 5.0
"""Steps after which a vehicle that goes on still has that way before it."""
_ON_LINE_M, _LINE_STEPS, _STRIKES_MPS = 1.3, 2, 2.6
"""Distance of a center that is on a line, steps of the ways between two looks, and least speed of a blow."""
_OFF_ROAD_M, _ON_ROAD = 1.0, 0.1
"""Distance from the road, and the cost of ending nearer."""


def with_run(scene: Scene, name: str, run: RunOut) -> dict[str, tuple[RunOut, ...]]:
    """The run-outs of a scene with a further one of a vehicle, which counts from its time on."""
    earlier = tuple(one for one in scene.runs.get(name, ()) if one.from_s < run.from_s)
    return {**scene.runs, name: (*earlier, run)}


def runs_into(scene: Scene, name: str, other: str, after: int, side: Area | None = None) -> Iterator[RunOut]:
    """Run-outs of a struck vehicle that lead into another actor behind a sample, with a side if any does so, the least
    odd ones first."""
    if (found := run_outs(scene, name, after)) is not None:
        meets = _first_meetings(scene, (name, other), found.ways, found.sample)
        wrong: Floats = np.zeros(len(meets))
        if side is not None:
            at = np.maximum(meets, 0)
            own = found.ways[at, np.arange(len(at))], scene.tracks[name].size
            theirs = scene.tracks[other].poses[np.minimum(found.sample + _COARSE * (at + 1), scene.count - 1)]
            wrong[:] = _OTHER_SIDE * wrong_sides(own, (theirs, scene.tracks[other].size), (side, None))
        yield from found.best(meets >= 0, wrong + _PER_S * meets * _COARSE * STEP_S)


def runs_on(scene: Scene, name: str, surface: RoadSurface, after: int) -> Iterator[RunOut]:
    """Run-outs of a struck vehicle that go on for a while behind a sample, those that leave the road first."""
    if (found := run_outs(scene, name, after)) is not None:
        way_m = np.hypot(*(found.ways[-1] - found.ways[_SOON])[:, :2].T) if len(found.ways) > _SOON else np.zeros(0)
        off = surface.off(found.ways[-1][:, :2])[0] > _OFF_ROAD_M
        yield from found.best(way_m > _GOES_ON_M, np.where(off, 0.0, _ON_ROAD)) if len(way_m) else ()


def runs_to_line(scene: Scene, name: str, line: Floats, after: int) -> Iterator[RunOut]:
    """The run-outs of a struck vehicle behind a sample that lead it onto a line, (k, 2) points, while it still moves:
    the least odd one of each sort, by steering, locked wheels and turning."""
    if len(line) == 0 or (found := run_outs(scene, name, after)) is None or len(found.ways) < 2:
        return
    ways = found.ways[::_LINE_STEPS, :, :2]
    near = np.hypot(*(ways[:, :, None] - line).transpose(3, 0, 1, 2)).min(axis=2)[1:] < _ON_LINE_M
    mps = np.hypot(*np.diff(ways, axis=0).transpose(2, 0, 1)) / (_LINE_STEPS * _COARSE * STEP_S)
    met = near & (mps > _STRIKES_MPS)
    sorts = set()
    for run in found.best(met.any(axis=0), _PER_S * met.argmax(axis=0) * _LINE_STEPS * _COARSE * STEP_S):
        sort = (np.sign(run.bend_per_m), run.slides, np.sign(run.yaws_radps2))
        if sort not in sorts:
            sorts.add(sort)
            yield run


def runs_aside(scene: Scene, name: str, after: int) -> Iterator[RunOut]:
    """The least odd run-out of a struck vehicle behind a sample for some ways in which it steers, gently at first."""
    if (found := run_outs(scene, name, after)) is not None:
        plainest: dict[float, RunOut] = {}
        for run in found.best(np.ones(len(found.runs), bool), np.zeros(len(found.runs))):
            if not run.slides and abs(run.bend_per_m) in _STEERS_PER_M:
                plainest.setdefault(run.bend_per_m, run)
        yield from sorted(plainest.values(), key=lambda run: abs(run.bend_per_m))


class RunOuts(NamedTuple):
    """All run-outs of a vehicle with their (m, n, 3) ways from a sample on, and their oddity."""

    sample: int
    runs: list[RunOut]
    ways: Floats
    odd: Floats

    def best(self, able: NDArray[np.bool_], cost: Floats) -> Iterator[RunOut]:
        """Those that are able to, the cheapest first; `cost` on top of their oddity."""
        order = np.argsort(self.odd + cost, kind="stable")
        return (self.runs[int(n)] for n in order if able[n])


def run_outs(scene: Scene, name: str, after: int) -> RunOuts | None:
    """The run-outs of a vehicle behind a sample and its last touch; None where it was not struck or time is up."""
    track = scene.tracks[name]
    if track.hit is None or track.motion.fixed:
        return None
    last_s = max(touch.t_s for touch in scene.touches if name in (touch.first, touch.second))
    sample = max(round(last_s / STEP_S), after) + round(_BLOW_S / STEP_S)
    if sample >= scene.count - 2 * _COARSE:
        return None
    wreck, drag = scene.wreck(), scene.drag(track)
    wreck.settle(sample)
    if not wreck.named[name].free:
        return None
    from_s, end_s = sample * STEP_S, (scene.count - 4) * STEP_S
    released = Released(wreck.named[name].body, from_s)
    runs = all_runs(from_s, drag.across, released.body.speed)
    (ways,) = run_out_paths([released], [drag], [runs], end_s, _COARSE * STEP_S)
    return RunOuts(sample, runs, ways, oddities(runs, drag.across, 0.0) + loops(ways, _COARSE * STEP_S))


def _first_meetings(scene: Scene, pair: tuple[str, str], ways: Floats, from_sample: int) -> Floats:
    """(n,) step at which each of (m, n, 3) run-outs first touches the other actor; -1 where it never does."""
    own, other = (scene.tracks[name] for name in pair)
    steps = np.arange(len(ways))
    theirs = other.poses[np.minimum(from_sample + _COARSE * (steps + 1), scene.count - 1)]
    every = np.repeat(theirs[:, None], ways.shape[1], axis=1)
    gaps = gaps_where_near(ways.reshape(-1, 3), own.size, every.reshape(-1, 3), other.size, _PARTED_M)
    gaps = gaps.reshape(ways.shape[:2])
    met = (gaps <= 0.0) & np.maximum.accumulate(gaps > _PARTED_M, axis=0)
    met[: round(_APART_S / STEP_S / _COARSE)] = False
    return np.where(met.any(axis=0), met.argmax(axis=0), -1)
