"""The right side and the lanes: driving on lanes of the other direction (UVC 11-301), and beside or off the lanes
(UVC 11-309, shoulders and sidewalks).

Places are those of the center of the box (`lane_places`): two wheels on the shoulder are no finding. A stretch on the
other side in which another vehicle is passed is judged by `passing`.
Bicycles may use everything beside the lanes; bicycle lanes and parking lanes count as lanes.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import runs
from sgcad_core.metrics.drivability import STEP_S
from sgcad_core.metrics.lane_places import PLACES
from sgcad_core.roads.lane_graph import edge_of
from sgcad_core.roads.surface import RoadSurface, road_surface
from sgcad_core.rules.records import Mover, RuleFinding, RuleScene, lasts_s

_STRIPS = frozenset({"biking", "parking"})
_JOINT_S = 0.3
"""Shorter gaps between two stretches are none."""
ALIKE = 0.5
"""Cosine of the angle between headings of vehicles that go the same way."""


def wrong_side(scene: RuleScene) -> Iterator[RuleFinding]:
    """Each stretch on lanes of the other direction without a vehicle that is passed; or that there is none."""
    for mover in scene.movers:
        if not mover.lanes_bound or not _drives(scene, mover).any():
            continue
        long = opposing_stretches(scene, mover)
        for span in long:
            if passed_by(scene, mover, span) is None:
                yield mover.found("wrong_side", "broken", span, mover.steps.lanes[span[0]], lasts_s(span),
                                  scene.limits.off_lane_s, "s")  # fmt: skip
        if not long:
            yield mover.found("wrong_side", "kept", (0, len(mover.pose)), "", _opposing(scene, mover).sum() * STEP_S,
                              scene.limits.off_lane_s, "s")  # fmt: skip


def _opposing(scene: RuleScene, mover: Mover) -> NDArray[np.bool_]:
    opposing: NDArray[np.bool_] = _drives(scene, mover) & (mover.steps.codes == PLACES.index("opposing"))
    return opposing


def off_road(scene: RuleScene) -> Iterator[RuleFinding]:
    """Each stretch beside or off the lanes; or that there is none. Measured: metres beyond the lane's edge."""
    surface = road_surface(scene.graph) if scene.graph.edges else None
    for mover in scene.movers:
        if surface is None or not mover.lanes_bound or not _drives(scene, mover).any():
            continue
        long = outside_stretches(scene, mover)
        for span in long:
            far = _beyond(surface, mover, span)
            yield mover.found("off_road", "broken", span, _beside(scene, mover, span[0]), far, 0.0, "m from the lanes")
        if not long:
            yield mover.found("off_road", "kept", (0, len(mover.pose)), "", 0.0, 0.0, "m from the lanes")


def _drives(scene: RuleScene, mover: Mover) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = mover.speed_mps > scene.limits.moving_mps
    return found


def _long(scene: RuleScene, flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Stretches that count; those with a short gap between them (a joint of two lanes) are one."""
    joined = flags.copy()
    for first, last in runs(~flags):
        if first > 0 and last < len(flags) - 1 and lasts_s((first, last)) <= _JOINT_S:
            joined[first : last + 1] = True
    return [r for r in runs(joined) if lasts_s(r) > scene.limits.off_lane_s]


def _outside(scene: RuleScene, mover: Mover) -> NDArray[np.bool_]:
    off: NDArray[np.bool_] = mover.steps.codes == PLACES.index("off")
    if mover.info.record.keeps_right:
        return off
    beside: NDArray[np.bool_] = mover.steps.codes == PLACES.index("beside")
    strips = np.array([_type(scene, lane) in _STRIPS for lane in mover.steps.lanes])
    outside: NDArray[np.bool_] = off | (beside & ~strips)
    return outside


def _type(scene: RuleScene, lane: str) -> str:
    edge = scene.graph.edges.get(edge_of(lane))
    return next((one.type for one in edge.lanes if one.id == lane), "") if edge else ""


def _beside(scene: RuleScene, mover: Mover, sample: int) -> str:
    lane = mover.steps.lanes[sample]
    return f"{_type(scene, lane)} {lane}".strip() if lane else "off the road"


def _beyond(surface: RoadSurface, mover: Mover, span: tuple[int, int]) -> float:
    return float(surface.off(mover.pose[span[0] : span[1] + 1, :2])[0].max())


def opposing_stretches(scene: RuleScene, mover: Mover) -> list[tuple[int, int]]:
    """First and last samples of stretches on lanes of the other direction."""
    return _long(scene, _opposing(scene, mover))


def outside_stretches(scene: RuleScene, mover: Mover) -> list[tuple[int, int]]:
    """First and last samples of stretches beside or off the lanes."""
    return _long(scene, _drives(scene, mover) & _outside(scene, mover))


def passed_by(scene: RuleScene, mover: Mover, span: tuple[int, int]) -> Mover | None:
    """The vehicle of its own direction that a vehicle overtakes during a stretch."""
    first, last = span
    for other in scene.movers:
        if other is mover or not other.lanes_bound or len(other.pose) <= first:
            continue
        pair = (mover.pose[first : last + 1], other.pose[first : last + 1])
        n = min(map(len, pair))
        a, b = (p[:n] for p in pair)
        ahead = np.cos(a[:, 2]) * (b[:, 0] - a[:, 0]) + np.sin(a[:, 2]) * (b[:, 1] - a[:, 1])
        if (
            np.cos(a[0, 2] - b[0, 2]) > ALIKE
            and 0.0 < float(ahead[0]) < 80.0
            and ahead[-1] < ahead[0] - mover.info.length_m
        ):
            return other
    return None
