"""Present values of editable fields in specs. Knows specs and their geometry; no edit and no narrative."""

from __future__ import annotations

from collections.abc import Mapping

from sgcad_core.kinds import ALLEY, DRIVEWAY, FOUR_LEG, PARKING_LOT, RAMP, ROUNDABOUT, JunctionKind, T
from sgcad_core.reading.layout.road_ways import Way, degree, ways_of
from sgcad_core.reading.text.compass import compass_of_angle, turned
from sgcad_core.records.acts import ACT_FIELDS, act_of
from sgcad_core.records.facts import Value
from sgcad_core.records.specs import Actor, BehaviorSpec, Compass, Contact, Node, Road, RoadSpec, centers, is_aisle

ROAD_FIELDS = (
    "lanes_forward", "lanes_backward", "turns_forward", "turns_backward", "center_turn_lane", "median", "kind",
    "minor", "speed_limit_mph",
)  # fmt: skip
ACTOR_FIELDS: Mapping[str, str] = {
    "kind": "kind", "maneuver": "maneuver", "start_road": "road", "start_direction": "direction", "start_lane": "lane",
    "exit_road": "exit_road", "speed_mph": "speed_mph", "length_m": "length_m", "width_m": "width_m",
}  # fmt: skip
"""Field of an actor -> that of its spec."""
CONTACT_FIELDS = ("striker", "struck", "striker_area", "struck_area")


def value_of(field: str, road: RoadSpec | None, behavior: BehaviorSpec | None) -> Value:
    """The present value of a field; None where it is open, or there is no such road, actor or contact."""
    group, _, rest = field.partition(".")
    if group == "junction":
        return _junction(rest, road) if road else None
    if group == "roads":
        return _of_road(rest, road)
    if behavior is None:
        return None
    if group in ("vehicles", "others"):
        return _of_actor(rest, road, behavior)
    if group == "contacts":
        return _of_contact(rest, behavior)
    if group == "near_crash":
        return _near_crash(rest, behavior)
    value: Value = getattr(behavior, rest)
    return value


def _of_road(rest: str, spec: RoadSpec | None) -> Value:
    name, _, attribute = rest.partition(".")
    road = road_of(spec, name)
    if attribute == "present":
        return road is not None
    return getattr(road, attribute) if road else None


def _of_actor(rest: str, spec: RoadSpec | None, behavior: BehaviorSpec) -> Value:
    name, _, attribute = rest.partition(".")
    actor = actor_of(behavior, name)
    if attribute == "present":
        return actor is not None
    if actor is None:
        return None
    if attribute == "heading":
        way = way_of(actor, spec) if spec else None
        return compass_of_angle(way.heading_rad) if way else None
    value: Value = act_of(actor.acts, attribute) if attribute in ACT_FIELDS else getattr(actor, ACTOR_FIELDS[attribute])
    return value


def _of_contact(rest: str, behavior: BehaviorSpec) -> Value:
    number, _, attribute = rest.partition(".")
    found = contacts_of(behavior)
    contact = found[int(number)] if number.isdigit() and int(number) < len(found) else None
    if attribute == "present":
        return contact is not None
    return getattr(contact, attribute) if contact else None


def _near_crash(rest: str, behavior: BehaviorSpec) -> Value:
    near = behavior.near_crash
    if not rest:
        return near is not None
    return near.clearance_m if near else None


# ------------------------------------------------------------------ parts
def road_of(spec: RoadSpec | None, name: str) -> Road | None:
    """The road of that id."""
    return next((road for road in spec.roads if road.id == name), None) if spec else None


def actor_of(behavior: BehaviorSpec, name: str) -> Actor | None:
    """The actor of that id."""
    return next((actor for actor in behavior.actors if actor.id == name), None)


def contacts_of(behavior: BehaviorSpec) -> tuple[Contact, ...]:
    """The contacts; of a near crash the one that was avoided."""
    return (behavior.near_crash.conflict,) if behavior.near_crash else behavior.contacts


def way_of(actor: Actor, spec: RoadSpec) -> Way | None:
    """The direction of a road in which an actor starts."""
    ways = (w for w in ways_of(spec) if (w.road.id, w.direction) == (actor.road, actor.direction))
    return next(ways, None)


def hub_of(spec: RoadSpec) -> Node:
    """The node where most roads meet; of equals the nearest to the origin."""
    return min(spec.nodes, key=lambda n: (-degree(n.id, spec), n.x_m**2 + n.y_m**2))


def legs_of(spec: RoadSpec) -> tuple[Road, ...]:
    """The roads that meet at the hub, or at the roundabout it belongs to."""
    center = centers(spec)
    hub = hub_of(spec).id
    here = {n for n, name in center.items() if name == center.get(hub, "")} or {hub}
    return tuple(r for r in spec.roads if not r.circle and (r.from_node in here or r.to_node in here))


def bearing_of(leg: Road, spec: RoadSpec) -> Compass:
    """Where a leg lies, seen from the hub."""
    legs = {r.id for r in legs_of(spec)}
    mine = [w for w in ways_of(spec.model_copy(update={"roads": tuple(_open(r) for r in spec.roads)}))
            if w.road.id == leg.id and leg.id in legs]  # fmt: skip
    center = centers(spec)
    hub = center.get(hub_of(spec).id, hub_of(spec).id)
    return compass_of_angle(next(w for w in mine if w.from_node == hub).start_rad)


def _open(road: Road) -> Road:
    """The road with a lane each way, so that both of its directions are ways."""
    return road.model_copy(update={"lanes_forward": 1, "lanes_backward": 1})


def _junction(attribute: str, spec: RoadSpec) -> Value:
    legs = legs_of(spec)
    if attribute == "kind":
        return junction_kind_of(spec)
    if attribute == "control":
        return hub_of(spec).control
    bearings = {bearing_of(leg, spec): leg for leg in legs}
    return next((at for at in bearings if len(legs) == 3 and turned(at, 180) not in bearings), None)


def junction_kind_of(spec: RoadSpec) -> JunctionKind:
    """The kind of junction that is drawn at the hub."""
    legs = legs_of(spec)
    if any(road.circle for road in spec.roads):
        return ROUNDABOUT
    if len(legs) < 3 or all("parking" in leg.beside for leg in legs):
        return PARKING_LOT if all(map(is_aisle, legs)) else "none"
    if any(leg.kind == RAMP for leg in legs):
        return RAMP
    if len(legs) > 3:
        return FOUR_LEG
    stem = next((leg for leg in legs if leg.kind == DRIVEWAY), None)
    return T if stem is None else ALLEY if stem.alley else DRIVEWAY
