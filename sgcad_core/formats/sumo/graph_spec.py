"""A road spec read back from a compiled network that was drawn from none: a real junction, a map of a library.

Roads keep their ids (edge "R" forward, "-R" backward), so what is placed on the spec stands on the network.
Metres; x east, y north. Knows no plain XML and no crash.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from pydantic import ValidationError

from sgcad_core.case.records import Finding
from sgcad_core.errors import InvalidOutput
from sgcad_core.geometry.plane import arc_lengths, resample
from sgcad_core.records.specs import Node, NodeControl, Point, Road, RoadSpec, Turn
from sgcad_core.roads.lane_graph import Connection, Direction, Edge, Floats, LaneGraph, road_of
from sgcad_core.units import MPS_PER_MPH

MPH_PER_MPS = 1 / MPS_PER_MPH
CONTROLS: Mapping[str, NodeControl] = {
    "traffic_light": "signal", "traffic_light_right_on_red": "signal", "traffic_light_unregulated": "signal",
    "allway_stop": "all_way_stop", "priority_stop": "stop",
}  # fmt: skip
_TURNS: Mapping[frozenset[Direction], Turn] = {
    frozenset({"left"}): "left", frozenset({"through"}): "through", frozenset({"right"}): "right",
    frozenset({"left", "through"}): "left_through", frozenset({"through", "right"}): "through_right",
    frozenset({"left", "right"}): "left_right", frozenset({"left", "through", "right"}): "any",
}  # fmt: skip
_STEP_M = 30.0
_BENT_M = 1.0
"""A road whose line leaves the straight one by more than this gets inner points."""
_LIMIT_MPH = (5, 85)


def spec_of_graph(graph: LaneGraph) -> RoadSpec:
    """Nodes, roads, lanes for cars, turns and inner points. Raises InvalidOutput for a network too large for a spec."""
    roads = {road_of(edge.id)[0]: None for edge in graph.edges.values() if edge.car_lanes}
    found = [_road(graph, name) for name in roads]
    used = {end for road in found for end in (road["from_node"], road["to_node"])}
    nodes = [
        {"id": name, "x_m": node.x_m, "y_m": node.y_m, "control": CONTROLS.get(node.type, "none")}
        for name, node in graph.nodes.items()
        if name in used
    ]
    try:
        return RoadSpec(nodes=tuple(Node(**n) for n in nodes), roads=tuple(Road(**r) for r in found))
    except ValidationError as fault:
        first = fault.errors(include_url=False)[0]
        what = f"the network cannot be told as a road spec: {'.'.join(map(str, first['loc']))}: {first['msg']}"
        finding = Finding(source="net_xml", what=what, value=str(first["input"])[:80], remedy="use a smaller network")
        raise InvalidOutput.of(finding) from fault


def _road(graph: LaneGraph, name: str) -> dict[str, object]:
    ahead, back = graph.edges.get(name), graph.edges.get(f"-{name}")
    edge = ahead or back
    if edge is None:  # the name was made from an edge
        raise InvalidOutput(f"road {name!r} has no edge")
    ends = (edge.from_node, edge.to_node) if edge is ahead else (edge.to_node, edge.from_node)
    line = edge.lanes[-1].shape if edge is ahead else edge.lanes[-1].shape[::-1]
    limit = round(max(lane.speed_mps for lane in edge.lanes) * MPH_PER_MPS)
    return {
        "id": name, "from_node": ends[0], "to_node": ends[1],
        "lanes_forward": len(ahead.car_lanes) if ahead else 0, "lanes_backward": len(back.car_lanes) if back else 0,
        "turns_forward": _turns(graph, ahead), "turns_backward": _turns(graph, back), "via": _via(line),
        "speed_limit_mph": min(max(limit, _LIMIT_MPH[0]), _LIMIT_MPH[1]),
    }  # fmt: skip


def _turns(graph: LaneGraph, edge: Edge | None) -> tuple[Turn, ...]:
    """What each lane is for, from the right curb; none where it leads nowhere or all lanes lead one way."""
    if edge is None:
        return ()
    uses = [_use(graph.leaving(edge.id, lane.index)) for lane in edge.car_lanes]
    known = [use for use in uses if use is not None]
    return tuple(known) if len(known) == len(uses) and len(uses) > 1 else ()


def _use(ways: tuple[Connection, ...]) -> Turn | None:
    return _TURNS.get(frozenset(way.direction for way in ways if way.direction != "u_turn"))


def _via(line: Floats) -> tuple[Point, ...]:
    """Inner points every 30 m of a line that is not straight."""
    length = float(arc_lengths(line)[-1])
    steps = np.arange(_STEP_M, length - _STEP_M / 2, _STEP_M)
    if not len(steps) or not _bent(line):
        return ()
    return tuple(Point(x_m=round(float(x), 2), y_m=round(float(y), 2)) for x, y in resample(line, steps))


def _bent(line: Floats) -> bool:
    (x, y), (end_x, end_y) = line[0], line[-1]
    length = float(np.hypot(end_x - x, end_y - y))
    across = [abs((end_x - x) * (py - y) - (end_y - y) * (px - x)) / max(length, 1e-9) for px, py in line[1:-1]]
    return bool(max(across, default=0.0) > _BENT_M)
