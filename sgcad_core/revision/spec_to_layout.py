"""A road spec of one hub as the layout that would draw it: the form in which small models answer. Knows specs only."""

from __future__ import annotations

from typing import Any, Literal

from sgcad_core.records.specs import Leg, Road, RoadLayout, RoadSpec
from sgcad_core.revision.values import bearing_of, hub_of, legs_of

_CONTROLS = {"signal": "signal", "flashing": "flashing", "all_way_stop": "stop"}
_BENT_M = 3.0


def layout_of(spec: RoadSpec) -> RoadLayout | None:
    """The layout of a spec whose roads all meet at one hub, straight or bent; None for any other network."""
    legs = legs_of(spec)
    rim = [road for road in spec.roads if road.circle]
    if len(legs) + len(rim) != len(spec.roads) or not 2 <= len(legs) <= 8:
        return None
    drawn = [_leg(road, spec, bool(rim)) for road in legs]
    if len({leg.bearing for leg in drawn}) < len(drawn):
        return None
    return RoadLayout(legs=tuple(drawn), circle_lanes=min(max((r.lanes_forward for r in rim), default=0), 2))


def _leg(road: Road, spec: RoadSpec, round_about: bool) -> Leg:
    inward = road.to_node == hub_of(spec).id or (round_about and road.to_node.startswith("hub"))
    lanes = (road.lanes_forward, road.lanes_backward)
    lanes_in, lanes_out = lanes if inward else lanes[::-1]
    turns = road.turns_forward if inward else road.turns_backward
    return Leg(
        bearing=bearing_of(road, spec), lanes_in=lanes_in, lanes_out=lanes_out, turns_in=turns,
        center_turn_lane=road.center_turn_lane, median=road.median, kind=road.kind,
        control=_control(road, spec, round_about), curve=_curve(road, spec, inward),
        speed_limit_mph=road.speed_limit_mph, beside=road.beside, crosswalk=bool(road.crosswalks),
    )  # fmt: skip


def _control(road: Road, spec: RoadSpec, round_about: bool) -> Any:
    at = "yield" if round_about else hub_of(spec).control
    if at in ("stop", "yield"):
        return at if road.minor else "none"
    return _CONTROLS.get(at, "none")


def _curve(road: Road, spec: RoadSpec, inward: bool) -> Literal["none", "left", "right"]:
    """The side to which a leg bends as one drives towards the hub: where its inner points lie off its chord."""
    if not road.via:
        return "none"
    at = {node.id: (node.x_m, node.y_m) for node in spec.nodes}
    (ax, ay), (bx, by) = at[road.from_node], at[road.to_node]
    middle = road.via[len(road.via) // 2]
    chord = ((bx - ax) ** 2 + (by - ay) ** 2) ** 0.5 or 1.0
    left_m = ((bx - ax) * (middle.y_m - ay) - (by - ay) * (middle.x_m - ax)) / chord
    if abs(left_m) < _BENT_M:
        return "none"
    return "right" if (left_m > 0) == inward else "left"
