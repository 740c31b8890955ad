"""Speed limits: the limit of the lane under the vehicle, with the tolerance of `RuleLimits`.

A posted limit and the limit of an existing map count. Where the report tells none, the planner's usual speed stands in
the map and is named as assumed: the finding is then `unknown`, whatever the speed (UVC 11-801 and 11-802).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.formats.opendrive.signals import posted_mph
from sgcad_core.formats.sumo.parameters import LIMIT
from sgcad_core.geometry.plane import runs
from sgcad_core.roads.lane_graph import Edge, LaneGraph, edge_of
from sgcad_core.rules.records import Mover, RuleFinding, RuleScene, Status, lasts_s
from sgcad_core.units import MPS_PER_MPH

Basis = Literal["posted", "of the map", "assumed"]


class EdgeLimit(NamedTuple):
    """The limit of an edge, m/s, and where it comes from."""

    mps: float
    basis: Basis


def limit_of(edge: Edge, lane: int) -> EdgeLimit:
    """The limit of one lane of an edge."""
    if (told := posted_mph(edge)) is not None:
        return EdgeLimit(told * MPS_PER_MPH, "posted")
    mps = next((one.speed_mps for one in edge.lanes if one.index == lane), edge.lanes[0].speed_mps)
    return EdgeLimit(mps, "assumed" if LIMIT in edge.parameters else "of the map")


def speed_limit(scene: RuleScene) -> Iterator[RuleFinding]:
    """For each vehicle: the worst stretch above the limit on each lane; without one the lane nearest to its limit."""
    for mover in scene.movers:
        if mover.lanes_bound and (found := list(_judged(scene, mover))):
            over = [f for f in found if f.status == "broken"]
            told = [f for f in found if f.status != "unknown"] or found
            yield from over or [max(told, key=lambda f: (f.measured or 0.0) / (f.limit or 1.0))]


def _judged(scene: RuleScene, mover: Mover) -> Iterator[RuleFinding]:
    lanes = _carried(mover.steps.lanes)
    for name in dict.fromkeys(lanes):
        limit, here = _named(scene.graph, name), np.array([lane == name for lane in lanes])
        if limit and (here & (mover.speed_mps > scene.limits.moving_mps)).any():
            yield _on_lane(scene, mover, name, limit, here)


def _on_lane(scene: RuleScene, mover: Mover, name: str, limit: EdgeLimit, here: NDArray[np.bool_]) -> RuleFinding:
    told = scene.limits
    most = limit.mps + max(told.over_limit_mps, told.over_limit_share * limit.mps)
    stretches = [r for r in runs(here & (mover.speed_mps > most)) if lasts_s(r) >= told.over_limit_s]
    span = max(stretches, key=lambda r: float(mover.speed_mps[r[0] : r[1] + 1].max()), default=None)
    status: Status = "unknown" if limit.basis == "assumed" else "broken" if span else "kept"
    if span is None:
        at = int(np.flatnonzero(here)[mover.speed_mps[here].argmax()])
        span = at, at
    fastest = float(mover.speed_mps[span[0] : span[1] + 1].max())
    note = "no limit is told; this one is assumed" if limit.basis == "assumed" else f"limit {limit.basis}"
    return mover.found("speed_limit", status, span, name, fastest, limit.mps, "m/s", note)


def _carried(lanes: tuple[str, ...]) -> list[str]:
    """The lane of every sample; in a junction that from which it came."""
    found, last = [], ""
    for lane in lanes:
        last = lane or last
        found.append(last)
    return found


def _named(graph: LaneGraph, lane: str) -> EdgeLimit | None:
    edge = graph.edges.get(edge_of(lane))
    return limit_of(edge, int(lane.rpartition("_")[2])) if edge and lane.rpartition("_")[2].isdigit() else None
