"""Passing another vehicle of the same direction over the center line (UVC 11-301, 11-305 to 11-307) and beside the
lanes on the right (UVC 11-304 (b)).

Over the center line it is lawful where that line is told to be broken, not within a junction or 100 ft before one,
on roads of fewer than four lanes, and where it ends 200 ft before one that comes towards it. A vehicle that stands is
an obstruction, which the line does not forbid to pass. Where no line is told the rest decides, else it is unknown.
Passing in a lane of one's own direction is lawful on either side. Measured: metres to the one that comes, or to the
junction; else the seconds of the stretch.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.sumo.parameters import CENTER_LINE, KIND
from sgcad_core.geometry.distances import distance_to, nearest_on
from sgcad_core.geometry.plane import prolonged
from sgcad_core.kinds import UNPAINTED
from sgcad_core.metrics.lane_places import PLACES
from sgcad_core.roads.lane_graph import Edge, LaneGraph, edge_id, edge_of, road_of
from sgcad_core.rules.lane_change import FAR_M, lane_of
from sgcad_core.rules.lane_keeping import ALIKE, opposing_stretches, outside_stretches, passed_by
from sgcad_core.rules.records import Mover, RuleFinding, RuleScene, Status, lasts_s

_JUNCTION = PLACES.index("junction")
_LANES = 4
"""From so many lanes in both directions the other side is closed (UVC 11-301 (c))."""
_BESIDE_M = 10.0
"""One who passes on the right goes by so near to the side of the other."""


class _Why(NamedTuple):
    """What decides: status, a note, the figure, its limit and unit."""

    status: Status
    note: str
    measured: float | None
    limit: float | None
    unit: str


def passing(scene: RuleScene) -> Iterator[RuleFinding]:
    """One finding for each stretch on the other side or beside the lanes in which another vehicle is passed."""
    for mover in scene.movers:
        if not mover.lanes_bound:
            continue
        for span in opposing_stretches(scene, mover):
            if (other := passed_by(scene, mover, span)) is not None:
                why = _over_the_line(scene, mover, other, span)
                yield mover.found("passing", why.status, span, mover.steps.lanes[span[0]], why.measured, why.limit,
                                  why.unit, why.note, other.id)  # fmt: skip
        for span in outside_stretches(scene, mover):
            other = passed_by(scene, mover, span)
            if other is not None and _on_the_right(mover, other, span):
                yield mover.found("passing", "broken", span, mover.steps.lanes[span[0]] or "off the road",
                                  lasts_s(span), None, "s", "on the right, beside the lanes", other.id)  # fmt: skip


def _over_the_line(scene: RuleScene, mover: Mover, other: Mover, span: tuple[int, int]) -> _Why:
    """The first rule of several that is broken; else what the center line says."""
    edge = scene.graph.edges[edge_of(mover.steps.lanes[span[0]])]
    seconds, part = lasts_s(span), slice(span[0], span[1] + 1)
    if (near := _oncoming(scene, mover, span)) and near[0] < scene.limits.pass_oncoming_m:
        return _Why("broken", f"{near[1]} comes towards it", near[0], scene.limits.pass_oncoming_m, "m")
    stands = bool((other.speed_mps[part] < scene.limits.moving_mps).all())
    if (to := _to_junction(scene.graph, mover, span)) < scene.limits.pass_junction_m:
        note = "within a junction" if to <= 0 else "before a junction"
        status: Status = "unknown" if stands else "broken"
        return _Why(status, f"{note}{f'; {other.id} may wait there' if stands else ''}", max(to, 0.0),
                    scene.limits.pass_junction_m, "m")  # fmt: skip
    if stands:
        return _Why("kept", f"{other.id} stands in the way", seconds, None, "s")
    if _lanes_of(scene.graph, edge) >= _LANES:
        return _Why("broken", "its own side has lanes to pass in", seconds, None, "s")
    line = edge.parameters.get(CENTER_LINE, "")
    if not line:
        return _Why("unknown", "whether the center line may be crossed is not told", seconds, None, "s")
    called = line.replace("_", " ")
    return _Why("kept" if line.startswith("broken") else "broken", f"{called} center line", seconds, None, "s")


def _oncoming(scene: RuleScene, mover: Mover, span: tuple[int, int]) -> tuple[float, str] | None:
    """The least distance from front to front to one that comes in that lane or its straight run, and who."""
    lane = lane_of(scene.graph, mover.steps.lanes[span[0]])
    line = prolonged(lane.shape, FAR_M)
    found: list[tuple[float, str]] = []
    for other in scene.movers:
        part = slice(span[0], min(span[1], len(other.pose) - 1) + 1)
        if other is mover or not other.info.record.wheeled or part.stop <= part.start:
            continue
        a, b = mover.pose[part], other.pose[part]
        ahead = np.cos(a[:, 2]) * (b[:, 0] - a[:, 0]) + np.sin(a[:, 2]) * (b[:, 1] - a[:, 1])
        comes = (np.cos(a[:, 2] - b[:, 2]) < -ALIKE) & (other.speed_mps[part] > scene.limits.moving_mps) & (ahead > 0)
        comes &= distance_to(line, b[:, :2]) < lane.width_m / 2
        if comes.any():
            least = float(ahead[comes].min()) - (mover.info.length_m + other.info.length_m) / 2
            found.append((max(least, 0.0), other.id))
    return min(found, default=None)


def _to_junction(graph: LaneGraph, mover: Mover, span: tuple[int, int]) -> float:
    """Least metres from the front to the junction ahead in a stretch; 0 within one; inf without one."""
    part = slice(span[0], span[1] + 1)
    least = 0.0 if (mover.steps.codes[part] == _JUNCTION).any() and _crossroads(graph, mover, span) else np.inf
    for name in dict.fromkeys(mover.steps.lanes[part]):
        edge = graph.edges.get(edge_of(name))
        if edge is None or _roads_at(graph, edge.from_node) < 3:
            continue
        # on the other side it drives towards the node from which that lane comes
        at = nearest_on(prolonged(lane_of(graph, name).shape, 1.0), mover.front[part])
        here = np.array([lane == name for lane in mover.steps.lanes[part]])
        least = min(least, float((at.station_m[here] - 1.0).min()))
    return least


def _crossroads(graph: LaneGraph, mover: Mover, span: tuple[int, int]) -> bool:
    """Whether a node of a crossed junction joins three roads and more."""
    names = {mover.steps.lanes[max(span[0] - 1, 0)], *mover.steps.lanes[span[0] : span[1] + 2]} - {""}
    edges = [graph.edges[edge_of(n)] for n in names if edge_of(n) in graph.edges]
    return any(_roads_at(graph, node) > 2 for e in edges for node in (e.from_node, e.to_node))


def _roads_at(graph: LaneGraph, node: str) -> int:
    """How many roads meet at a node, driveways and alleys not counted."""
    meet = (e for e in graph.edges.values() if node in (e.from_node, e.to_node))
    return len({road_of(e.id)[0] for e in meet if e.parameters.get(KIND) not in UNPAINTED})


def _lanes_of(graph: LaneGraph, edge: Edge) -> int:
    """Lanes for cars in both directions."""
    road = road_of(edge.id)[0]
    both = (graph.edges.get(edge_id(road, way)) for way in ("forward", "backward"))
    return sum(len(e.car_lanes) for e in both if e)


def _on_the_right(mover: Mover, other: Mover, span: tuple[int, int]) -> bool:
    """Whether it comes beside the other, which lies to its left."""
    last = min(span[1], len(other.pose) - 1)
    a, b = mover.pose[last], other.pose[last]
    off = b[:2] - a[:2]
    ahead, left = float(off @ [np.cos(a[2]), np.sin(a[2])]), float(off @ [-np.sin(a[2]), np.cos(a[2])])
    return ahead < (mover.info.length_m + other.info.length_m) / 2 and 0.0 < left < _BESIDE_M
