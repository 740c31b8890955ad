"""Changes of lane: into a lane of its direction only where the one behind or beside there has room (UVC 11-309 (a): not
before it can be made with safety; 11-303 (a): back to the right only when safely clear of the overtaken vehicle).

A change begins where the body reaches over the line, and counts where the center follows or a contact with a vehicle
of that lane ends the motion. Measured: metres from the rear to the front of the one behind at the beginning, below 0
beside it; the limit is the critical distance of UN R79 at the speeds of both. Changes across junctions, merges of ramps
and starts from the curb are not judged. Unknown where the motion begins over the line.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.distances import nearest_on
from sgcad_core.geometry.plane import Floats, headings, prolonged
from sgcad_core.metrics.lane_places import PLACES
from sgcad_core.roads.lane_graph import Lane, LaneGraph, edge_of, road_of
from sgcad_core.rules.records import Mover, RuleFinding, RuleLimits, RuleScene, Status

_OWN = (PLACES.index("lane"), PLACES.index("beyond"))
FAR_M = 400.0
"""Lanes go straight on beyond the ends of their roads, as `lane_places` has it."""


class Change(NamedTuple):
    """A vehicle into a lane: the samples at which its body reaches over the line and at which its center is there, or a
    contact stopped it."""

    mover: Mover
    lane: Lane
    begin: int
    end: int
    touched: bool


class Behind(NamedTuple):
    """The one in the new lane for which there is least room: metres to it, and metres that it needs."""

    mover: Mover
    gap_m: float
    needs_m: float


def lane_change(scene: RuleScene) -> Iterator[RuleFinding]:
    """One finding for each change of lane."""
    for mover in scene.movers:
        for change in changes(scene, mover) if mover.lanes_bound else ():
            if (found := _judged(scene, change)) is not None:
                yield found


def changes(scene: RuleScene, mover: Mover) -> Iterator[Change]:
    """The changes of lane of a vehicle in their order."""
    lanes, own = mover.steps.lanes, np.isin(mover.steps.codes, _OWN)
    for k in range(1, len(lanes)):
        if own[k] and _aside(lanes[k - 1], lanes[k]):
            lane = lane_of(scene.graph, lanes[k])
            yield Change(mover, lane, _begin(scene, mover, lane, k), k, touched=False)
    last = len(lanes) - 1
    if mover.until == last and own[last]:
        edge = scene.graph.edges[edge_of(lanes[last])]
        for lane in edge.car_lanes:
            if lane.id != lanes[last] and reach_m(mover, lane)[last] > scene.limits.enters_m:
                yield Change(mover, lane, _begin(scene, mover, lane, last), last, touched=True)


def reach_m(mover: Mover, lane: Lane) -> Floats:
    """(n,) metres by which a body reaches into a lane or its straight run beyond the road; below 0: it does not."""
    line = prolonged(lane.shape, FAR_M)
    at = nearest_on(line, mover.pose[:, :2])
    turned = mover.pose[:, 2] - headings(line)[at.segment]
    length, width = mover.size
    across = np.abs(np.sin(turned)) * length / 2 + np.abs(np.cos(turned)) * width / 2
    found: Floats = lane.width_m / 2 + across - np.abs(at.left_m)
    return found


def room_m(behind_mps: float, ahead_mps: float, limits: RuleLimits) -> float:
    """The least distance behind one who changes lanes (UN R79, 5.6.4.7); to a slower one its own way in the headway."""
    closing = max(behind_mps - ahead_mps, 0.0)
    brakes = closing**2 / (2 * limits.change_braking_mps2)
    return closing * limits.change_reacts_s + brakes + min(behind_mps, ahead_mps) * limits.change_headway_s


def _judged(scene: RuleScene, change: Change) -> RuleFinding | None:
    near = [b for b in _those_there(scene, change) if not change.touched or b.mover.until == change.end]
    worst = min(near, key=lambda b: b.gap_m - b.needs_m, default=None)
    if worst is None:
        return None if change.touched else _found(change, "kept", None, "nobody is behind in that lane")
    late = change.begin == 0
    status: Status = "unknown" if late else "broken" if worst.gap_m < worst.needs_m else "kept"
    note = "its motion begins over the line" if late else "beside it" if worst.gap_m < 0 else ""
    return None if change.touched and status == "kept" else _found(change, status, worst, note)


def _found(change: Change, status: Status, worst: Behind | None, note: str) -> RuleFinding:
    gap, needs, other = (worst.gap_m, worst.needs_m, worst.mover.id) if worst else (None, None, "")
    span = change.begin, change.end
    return change.mover.found(
        "lane_change", status, span, change.lane.id, gap, needs, "m to the one behind", note, other
    )


def _those_there(scene: RuleScene, change: Change) -> Iterator[Behind]:
    """Vehicles of the new lane that are behind or beside as the change begins."""
    mover, k = change.mover, change.begin
    line = prolonged(change.lane.shape, FAR_M)
    here = float(nearest_on(line, mover.pose[k : k + 1, :2]).station_m[0])
    for other in scene.movers:
        if other is mover or not other.info.record.wheeled or len(other.pose) <= k:
            continue
        if other.steps.lanes[k] != change.lane.id or other.steps.codes[k] not in _OWN:
            continue
        there = float(nearest_on(line, other.pose[k : k + 1, :2]).station_m[0])
        half = (mover.info.length_m + other.info.length_m) / 2
        if there - here < half:
            needs = room_m(float(other.speed_mps[k]), float(mover.speed_mps[k]), scene.limits)
            yield Behind(other, here - there - half, needs)


def _begin(scene: RuleScene, mover: Mover, lane: Lane, k: int) -> int:
    """The first sample of the unbroken stretch up to one in which the body is over the line."""
    outside = np.flatnonzero(reach_m(mover, lane)[:k] <= scene.limits.enters_m)
    return int(outside[-1]) + 1 if len(outside) else 0


def _aside(before: str, now: str) -> bool:
    """Whether two lanes lie beside each other: of one road, in the same or the other direction."""
    one, two = (road_of(edge_of(lane))[0] for lane in (before, now))
    return bool(before and now) and before != now and one == two


def lane_of(graph: LaneGraph, name: str) -> Lane:
    """The lane of an id."""
    edge = graph.edges[edge_of(name)]
    return next(one for one in edge.lanes if one.id == name)
