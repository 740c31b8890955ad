"""Edits applied to a road spec: junction, legs, lanes, limits, control.

What an edit asks for and the spec has already stays untouched. A network that was drawn from a layout is drawn anew
where its junction becomes another one; any other spec gains and loses legs at its hub. An edit that cannot be laid is
left out here; `sgcad_core.revision.standing_edits` says so. Knows no file and no narrative.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, get_args

from pydantic import ValidationError

from sgcad_core.kinds import ALLEY, DRIVEWAY, PARKING_LOT, RAMP, ROUNDABOUT, JunctionKind, T, junction_kind
from sgcad_core.reading.text.compass import angle_of, turned
from sgcad_core.records.facts import Value
from sgcad_core.records.specs import Compass, Leg, Node, Road, RoadLayout, RoadSpec
from sgcad_core.revision.values import ROAD_FIELDS, bearing_of, hub_of, junction_kind_of, legs_of, road_of, value_of
from sgcad_core.roads.layout import LEG_M, road_spec

_COMPASS: tuple[Compass, ...] = get_args(Compass)
_DRAWN_ANEW = (ROUNDABOUT, PARKING_LOT, RAMP)
"""Junctions of a form of their own, for which a hub with more or fewer legs is not enough."""
_SIGNS = ("stop", "yield")


def roads_with_edits(spec: RoadSpec, layout: RoadLayout | None, given: Mapping[str, Value]) -> RoadSpec:
    """The spec with edited values (field -> value), as far as they can be applied."""
    spec = _with_junction(spec, layout, given)
    for field, value in given.items():
        name, _, attribute = field.removeprefix("roads.").partition(".")
        if field.startswith("roads.") and attribute == "present":
            spec = _with_road(spec, layout, name, bool(value))
    for field, value in given.items():
        name, _, attribute = field.removeprefix("roads.").partition(".")
        if field.startswith("roads.") and attribute in ROAD_FIELDS:
            spec = _changed(spec, name, attribute, value)
    control = given.get("junction.control")
    return _controlled(spec, str(control), given) if control is not None else spec


# ------------------------------------------------------------------ the junction
def _with_junction(spec: RoadSpec, layout: RoadLayout | None, given: Mapping[str, Value]) -> RoadSpec:
    kind, stem = given.get("junction.kind"), given.get("junction.stem")
    wanted = kind if kind is not None else junction_kind_of(spec)
    fits = junction_kind_of(spec) == wanted and stem in (None, value_of("junction.stem", spec, None))
    if fits or (kind is None and stem is None):
        return spec
    return _redrawn(spec, layout, wanted, stem)  # type: ignore[arg-type]


def _redrawn(spec: RoadSpec, layout: RoadLayout | None, kind: JunctionKind, stem: Compass | None) -> RoadSpec:
    """Another junction in the place of the one that is drawn."""
    was = junction_kind_of(spec)
    if kind in _DRAWN_ANEW or was in _DRAWN_ANEW:
        return road_spec(_other_layout(layout, kind, stem)) if layout else spec
    legs = {bearing_of(leg, spec): leg for leg in legs_of(spec)}
    main = _main_axis(list(legs), stem, legs)
    if kind == "none":
        return _pruned(spec, {main, turned(main, 180)})
    sides = _sides(main, stem, kind, [at for at in legs if at not in (main, turned(main, 180))])
    spec = _pruned(spec, {main, turned(main, 180), *sides})
    for at in (main, turned(main, 180), *sides):
        spec = _with_leg(spec, at, kind)
    return _of_stem_kind(spec, sides, kind)


def _main_axis(legs: Sequence[Compass], stem: Compass | None, roads: Mapping[Compass, Road]) -> Compass:
    """One end of the road that goes through: never the stem's, the wider one first."""
    open_ends = [at for at in legs if at not in (stem, turned(stem, 180) if stem else None)] or list(legs)

    def through(at: Compass) -> tuple[bool, int]:
        return turned(at, 180) in legs, roads[at].lanes_forward + roads[at].lanes_backward

    return max(open_ends, key=through)


def _sides(main: Compass, stem: Compass | None, kind: JunctionKind, beside: Sequence[Compass]) -> tuple[Compass, ...]:
    """Bearings of the legs beside the main road: the stated stem, an existing leg, else a right angle."""
    drawn: Compass = next(iter(beside), turned(main, 90))
    first = stem or drawn
    return (first, turned(first, 180)) if junction_kind(kind).crossing else (first,)


def _pruned(spec: RoadSpec, kept: set[Compass]) -> RoadSpec:
    """Without the legs at other bearings."""
    for leg in legs_of(spec):
        if bearing_of(leg, spec) not in kept:
            spec = _without(spec, leg.id)
    return spec


def _of_stem_kind(spec: RoadSpec, sides: Sequence[Compass], kind: JunctionKind) -> RoadSpec:
    """The legs beside the main road are what they are in a junction of that kind: streets, or a driveway."""
    for leg in legs_of(spec):
        if bearing_of(leg, spec) in sides:
            spec = _changed(spec, leg.id, "kind", junction_kind(kind).stem)
            spec = _changed(spec, leg.id, "alley", kind == ALLEY)
    return spec


def _other_layout(layout: RoadLayout, kind: JunctionKind, stem: Compass | None) -> RoadLayout:
    """A layout with another junction: its streets stay as they are."""
    streets = tuple(leg for leg in layout.legs if leg.kind == "road") or layout.legs
    main = streets[0].bearing
    ends = (main, turned(main, 180))
    through = tuple(_leg_at(streets, at) for at in ends)
    side = stem if stem and stem not in ends else turned(main, 90)
    if kind == ROUNDABOUT:
        legs = _crossed(streets, through, (side, turned(side, 180)))
        return RoadLayout(legs=tuple(leg.model_copy(update={"control": "yield"}) for leg in legs), circle_lanes=1)
    if kind == PARKING_LOT:
        aisle = {"lanes_in": 1, "lanes_out": 1, "kind": DRIVEWAY, "beside": ("parking",), "turns_in": ()}
        return RoadLayout(legs=tuple(leg.model_copy(update=aisle) for leg in through))
    if kind == RAMP:
        at = stem if stem in (turned(main, 135), turned(main, 225)) else turned(main, 135)
        return RoadLayout(legs=(*through, Leg(bearing=at, lanes_in=1, lanes_out=0, kind=RAMP)))
    if kind == "none":
        return RoadLayout(legs=through)
    if junction_kind(kind).crossing:
        return RoadLayout(legs=_crossed(streets, through, (side, turned(side, 180))))
    joined = _leg_at(streets, side).model_copy(update={"kind": junction_kind(kind).stem, "alley": kind == ALLEY})
    return RoadLayout(legs=(*through, joined))


def _crossed(streets: Sequence[Leg], through: tuple[Leg, ...], sides: tuple[Compass, ...]) -> tuple[Leg, ...]:
    return (*through, *(_leg_at(streets, at) for at in sides))


def _leg_at(legs: Sequence[Leg], at: Compass) -> Leg:
    """The leg at a bearing; one like the leg that faces it, or a plain one."""
    facing = next((leg for leg in legs if leg.bearing == turned(at, 180)), None)
    known = next((leg for leg in legs if leg.bearing == at), None)
    if known:
        return known
    if facing:
        lanes = {"lanes_in": facing.lanes_out, "lanes_out": facing.lanes_in}
        return facing.model_copy(update={"bearing": at, "turns_in": (), "curve": "none", **lanes})
    return Leg(bearing=at, lanes_in=1, lanes_out=1, speed_limit_mph=legs[0].speed_limit_mph)


# ------------------------------------------------------------------ legs
def _with_road(spec: RoadSpec, layout: RoadLayout | None, name: str, present: bool) -> RoadSpec:
    """With or without a road; a road that is to be added is named by its bearing."""
    known = road_of(spec, name) is not None
    if known == present or (present and name not in _COMPASS):
        return spec
    if any(road.circle for road in spec.roads):
        if layout is None:
            return spec
        others = tuple(leg for leg in layout.legs if leg.bearing != name)
        legs = (*others, _leg_at(layout.legs, name)) if present else others  # type: ignore[arg-type]
        return road_spec(layout.model_copy(update={"legs": legs})) if len(legs) > 1 else spec
    return _with_leg(spec, name, T) if present else _without(spec, name)  # type: ignore[arg-type]


def _with_leg(spec: RoadSpec, at: Compass, kind: JunctionKind) -> RoadSpec:
    """With a leg at a bearing of the hub, like the one that faces it."""
    drawn = {bearing_of(leg, spec): leg for leg in legs_of(spec)}
    if at in drawn or road_of(spec, at) is not None:
        return spec
    hub, facing = hub_of(spec), drawn.get(turned(at, 180))
    x, y = hub.x_m + LEG_M * math.cos(angle_of(at)), hub.y_m + LEG_M * math.sin(angle_of(at))
    end = Node(id=_free(f"{at}_end", [n.id for n in spec.nodes]), x_m=round(x, 2), y_m=round(y, 2))
    alike = facing if facing and junction_kind(kind).stem != DRIVEWAY else None
    lanes = _towards(facing, hub) if alike and facing else (1, 1)
    road = Road(
        id=at, from_node=end.id, to_node=hub.id, lanes_forward=lanes[1], lanes_backward=lanes[0],
        kind=junction_kind(kind).stem, alley=kind == ALLEY, minor=alike.minor if alike else True,
        speed_limit_mph=(alike or next(iter(drawn.values()))).speed_limit_mph,
    )  # fmt: skip
    return spec.model_copy(update={"nodes": (*spec.nodes, end), "roads": (*spec.roads, road)})


def _towards(road: Road, hub: Node) -> tuple[int, int]:
    """Lanes of a leg towards the hub and away from it."""
    lanes = road.lanes_forward, road.lanes_backward
    return lanes if road.to_node == hub.id else lanes[::-1]


def _free(name: str, taken: Sequence[str]) -> str:
    return next(found for found in (name, *(f"{name}{n}" for n in range(2, 99))) if found not in taken)


def _without(spec: RoadSpec, name: str) -> RoadSpec:
    """Without a road, and without what only it joins to the others; the last road stays."""
    hub = hub_of(spec).id
    roads = [road for road in spec.roads if road.id != name]
    joined = {hub}
    for _ in roads:
        joined |= {n for r in roads if {r.from_node, r.to_node} & joined for n in (r.from_node, r.to_node)}
    kept = tuple(road for road in roads if {road.from_node, road.to_node} <= joined)
    if not kept:
        return spec
    nodes = tuple(node for node in spec.nodes if node.id in joined)
    return spec.model_copy(update={"nodes": nodes, "roads": tuple(_as_before(kept, nodes))})


def _as_before(roads: Sequence[Road], nodes: Sequence[Node]) -> list[Road]:
    """Turns that are left: those of a lane list hold for the former exits, so lists at the hub are dropped."""
    ends = {node.id: sum((r.from_node == node.id) + (r.to_node == node.id) for r in roads) for node in nodes}
    cut = [node for node, count in ends.items() if count > 1]
    return [_checked(r, {"turns_forward": () if r.to_node in cut else r.turns_forward}) or r for r in roads]


# ------------------------------------------------------------------ one road
def _changed(spec: RoadSpec, name: str, attribute: str, value: Value) -> RoadSpec:
    """One road's attribute; a list of turns that no longer fits its lanes is left to the usual rules."""
    road = road_of(spec, name)
    if road is None or getattr(road, attribute) == value:
        return spec
    update: dict[str, Any] = {attribute: value}
    for way in ("forward", "backward"):
        turns = getattr(road, f"turns_{way}")
        if attribute == f"lanes_{way}" and turns and len(turns) != value:
            update[f"turns_{way}"] = ()
    changed = _checked(road, update)
    if changed is None or not (changed.lanes_forward or changed.lanes_backward):
        return spec
    return spec.model_copy(update={"roads": tuple(changed if r.id == name else r for r in spec.roads)})


def _checked(road: Road, update: dict[str, Any]) -> Road | None:
    try:
        return Road.model_validate(road.model_dump() | update)
    except ValidationError:
        return None


def _controlled(spec: RoadSpec, control: str, given: Mapping[str, Value]) -> RoadSpec:
    """The hub's control; where signs are to stand somewhere, the legs beside the main road have them."""
    hub, legs = hub_of(spec), legs_of(spec)
    if len(legs) < 3 or any(road.circle for road in spec.roads) or hub.control == control:
        return spec
    nodes = tuple(n.model_copy(update={"control": control}) if n.id == hub.id else n for n in spec.nodes)
    spec = spec.model_copy(update={"nodes": nodes})
    told = any(f"roads.{leg.id}.minor" in given for leg in legs)
    if control not in _SIGNS or told or any(leg.minor for leg in legs):
        return spec
    drawn = {bearing_of(leg, spec): leg for leg in legs}
    main = _main_axis(list(drawn), value_of("junction.stem", spec, None), drawn)  # type: ignore[arg-type]
    for at, leg in drawn.items():
        if at not in (main, turned(main, 180)):
            spec = _changed(spec, leg.id, "minor", True)
    return spec
