"""Edits applied to a behavior: its actors and their motion, its contacts, whether it is a near crash.

What hangs on a changed fact follows: another heading is another road, another maneuver another exit. What an edit asks
for and the behavior has already stays untouched; an edit that cannot be laid is left out here, and
`sgcad_core.revision.standing_edits` says so. Knows specs and ways; no narrative and no planner.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ValidationError

from sgcad_core.kinds import ACTORS, kind_of_letter
from sgcad_core.reading.layout.road_ways import Way, apart, degree, exits, turn_of, ways_of
from sgcad_core.reading.text.compass import angle_of
from sgcad_core.records.acts import ACT_FIELDS, with_said
from sgcad_core.records.edits import of_contacts
from sgcad_core.records.facts import Value
from sgcad_core.records.specs import Actor, BehaviorSpec, Compass, Contact, Maneuver, NearCrash, RoadSpec
from sgcad_core.revision.values import ACTOR_FIELDS, CONTACT_FIELDS, actor_of, contacts_of, road_of, way_of

_SKY = ("light", "weather", "surface")
HEADING_RAD = math.radians(50)
"""A way within this of a heading goes that way: an eighth and a bend."""
_MISFIT_RAD = 0.75 * math.pi / 2
"""An exit that is further off the maneuver's turn is none of it."""
_TURNS: Mapping[Maneuver, float] = {"turn_left": math.pi / 2, "turn_right": -math.pi / 2}


def behavior_with_edits(behavior: BehaviorSpec, spec: RoadSpec, given: Mapping[str, Value]) -> BehaviorSpec:
    """The behavior with edited values (field -> value), as far as they can be applied."""
    behavior = _cast(behavior, spec, given)
    for name, fields in _by_actor(given).items():
        actor = actor_of(behavior, name)
        if actor is not None:
            behavior = _replaced(behavior, _moved(actor, spec, fields))
    behavior = _with_contacts(behavior, given)
    sky = {name: given[f"conditions.{name}"] for name in _SKY if f"conditions.{name}" in given}
    return behavior.model_copy(update=sky)


def _by_actor(given: Mapping[str, Value]) -> dict[str, dict[str, Value]]:
    """Actor -> its edited fields."""
    found: dict[str, dict[str, Value]] = {}
    for field, value in given.items():
        group, _, rest = field.partition(".")
        if group in ("vehicles", "others"):
            name, _, attribute = rest.partition(".")
            found.setdefault(name, {})[attribute] = value
    return found


def _replaced(behavior: BehaviorSpec, actor: Actor) -> BehaviorSpec:
    return behavior.model_copy(update={"actors": tuple(actor if a.id == actor.id else a for a in behavior.actors)})


# ------------------------------------------------------------------ actors added and removed
def _cast(behavior: BehaviorSpec, spec: RoadSpec, given: Mapping[str, Value]) -> BehaviorSpec:
    """The behavior with added actors and without removed ones and their contacts."""
    for name, fields in _by_actor(given).items():
        present, known = fields.get("present"), actor_of(behavior, name)
        if present is False and known and len(behavior.actors) > 1:
            behavior = _without(behavior, name)
        elif present is True and known is None and len(behavior.actors) < 12:
            behavior = _with(behavior, name, spec, fields)
    return behavior


def _without(behavior: BehaviorSpec, name: str) -> BehaviorSpec:
    near = behavior.near_crash
    gone = near is not None and name in (near.conflict.striker, near.conflict.struck)
    return behavior.model_copy(update={
        "actors": tuple(a for a in behavior.actors if a.id != name),
        "contacts": tuple(c for c in behavior.contacts if name not in (c.striker, c.struck)),
        "near_crash": None if gone else near,
    })  # fmt: skip


def _with(behavior: BehaviorSpec, name: str, spec: RoadSpec, fields: Mapping[str, Value]) -> BehaviorSpec:
    """One more actor, behind those of its letter; it starts where the first one does unless more is said."""
    first = behavior.actors[0]
    kind = str(fields.get("kind") or kind_of_letter(name[0]))
    record = ACTORS.get(kind)
    still = record is not None and not (record.drives or record.walks)
    made = _checked(Actor, {
        "id": name, "kind": kind, "road": first.road, "direction": first.direction,
        "maneuver": "stopped" if still else "straight",
    })  # fmt: skip
    if made is None:
        return behavior
    place = max((i for i, a in enumerate(behavior.actors, 1) if a.id[0] == name[0]), default=len(behavior.actors))
    actors = behavior.actors
    return behavior.model_copy(update={"actors": (*actors[:place], made, *actors[place:])})


# ------------------------------------------------------------------ one actor
def _moved(actor: Actor, spec: RoadSpec, fields: Mapping[str, Value]) -> Actor:
    """The actor with its edited fields, on a way that fits them."""
    plain = {ACTOR_FIELDS[name]: fields[name] for name in ("kind", "maneuver", "speed_mph", "length_m", "width_m")
             if name in fields}  # fmt: skip
    changed = _checked(Actor, actor.model_dump() | plain) or actor
    changed = _acting(changed, {name: fields[name] for name in ACT_FIELDS if name in fields})
    if changed.kind != actor.kind:  # the former kind's length is not this one's
        sizes = {name: None for name in ("length_m", "width_m") if name not in fields}
        changed = changed.model_copy(update=sizes)
    placed = _placed(changed, spec, fields)
    if "start_lane" in fields:
        placed = _in_lane(placed, spec, fields["start_lane"])
    if "exit_road" in fields:
        leaves = fields["exit_road"]
        known = leaves is None or road_of(spec, str(leaves)) is not None
        return placed.model_copy(update={"exit_road": leaves}) if known else placed
    same_way = (placed.road, placed.direction, placed.maneuver) == (actor.road, actor.direction, actor.maneuver)
    return placed if same_way else placed.model_copy(update={"exit_road": _exit(placed, spec)})


def _acting(actor: Actor, said: dict[str, Value]) -> Actor:
    """The actor with what is said of its acts, where these are possible together."""
    try:
        return actor.model_copy(update={"acts": with_said(actor.acts, said)})
    except ValidationError:
        return actor


def _placed(actor: Actor, spec: RoadSpec, fields: Mapping[str, Value]) -> Actor:
    """On the road that is asked for, else on one with the heading that is asked for; elsewhere the lane is open."""
    road, direction, heading = (fields.get(name) for name in ("start_road", "start_direction", "heading"))
    ways = [w for w in ways_of(spec) if road in (None, w.road.id) and direction in (None, w.direction)]
    if road is None and direction is not None:
        ways = [w for w in ways if w.road.id == actor.road]
    if road is None and direction is None:
        own = way_of(actor, spec)
        if heading is None or (own is not None and goes(own, heading)):  # type: ignore[arg-type]
            return actor
    if heading is not None:
        ways = [w for w in ways if goes(w, heading)]  # type: ignore[arg-type]
    best = min(ways, key=lambda w: _place_cost(w, actor, spec), default=None)
    if best is None or (best.road.id, best.direction) == (actor.road, actor.direction):
        return actor
    return actor.model_copy(update={"road": best.road.id, "direction": best.direction, "lane": None})


def goes(way: Way, heading: Compass) -> bool:
    """Whether a way heads there, at its start or by what a report calls its direction."""
    wanted = angle_of(heading)
    return min(apart(way.heading_rad, wanted), apart(way.start_rad, wanted)) < HEADING_RAD


def _place_cost(way: Way, actor: Actor, spec: RoadSpec) -> tuple[bool, float]:
    """The way it is on before others; approaches to a junction before roads that lead away."""
    same = (way.road.id, way.direction) == (actor.road, actor.direction)
    return not same, {1: 1.0, 2: 0.5}.get(degree(way.to_node, spec), 0.0)


def _in_lane(actor: Actor, spec: RoadSpec, lane: Value) -> Actor:
    """In a lane that its road has."""
    way = way_of(actor, spec)
    there = lane is None or (isinstance(lane, int) and (way is None or lane <= way.lanes))
    return actor.model_copy(update={"lane": lane}) if there else actor


def _exit(actor: Actor, spec: RoadSpec) -> str | None:
    """The road that a maneuver leads to: the exit that fits its turn best; None leaves it to the planner."""
    way = way_of(actor, spec)
    if way is None or actor.maneuver == "u_turn":
        return None
    wanted = _TURNS.get(actor.maneuver, 0.0)
    onward = [(apart(turn_of(way, w), wanted), w.road.id) for w in exits(way, ways_of(spec))]
    off, road = min(onward, default=(math.inf, None))
    return road if off <= _MISFIT_RAD else None


def _checked(model: type[Any], fields: dict[str, Any]) -> Any:
    """A spec of these fields; None where they are not possible together."""
    try:
        made: BaseModel = model.model_validate(fields)
    except ValidationError:
        return None
    return made


# ------------------------------------------------------------------ contacts
def _with_contacts(behavior: BehaviorSpec, given: Mapping[str, Value]) -> BehaviorSpec:
    """The contacts that were changed, added or taken out, and whether the first was avoided."""
    contacts: list[Contact | None] = list(contacts_of(behavior))
    for number, fields in sorted(of_contacts(given).items()):
        known = contacts[number] if number < len(contacts) else None
        if fields.get("present") is False:
            contacts[number : number + 1] = [None] if known else []
        elif known is not None:
            contacts[number] = _struck(known, fields, behavior)
        elif number == len(contacts) and (made := _struck(None, fields, behavior)):
            contacts.append(made)
    kept = tuple(c for c in contacts if c is not None)
    avoided = given.get("near_crash", behavior.near_crash is not None)
    if not (avoided and kept):
        return behavior.model_copy(update={"contacts": kept, "near_crash": None})
    return _avoided(behavior, kept[0], given)


def _avoided(behavior: BehaviorSpec, conflict: Contact, given: Mapping[str, Value]) -> BehaviorSpec:
    """A near crash of that conflict."""
    near = behavior.near_crash or NearCrash(conflict=conflict)
    pair = (conflict.striker, conflict.struck)
    evasions = tuple(e for e in near.evasions if e.actor in pair)
    update = {"conflict": conflict, "evasions": evasions}
    update |= {"clearance_m": given["near_crash.clearance_m"]} if "near_crash.clearance_m" in given else {}
    return behavior.model_copy(update={"contacts": (), "near_crash": near.model_copy(update=update)})


def _struck(known: Contact | None, fields: Mapping[str, Value], behavior: BehaviorSpec) -> Contact | None:
    """A contact with the edited fields. Naming one of both may exchange striker and struck: the sides stay
    with their vehicles."""
    said = {name: fields[name] for name in CONTACT_FIELDS if name in fields}
    start = known.model_dump() if known else {"striker_area": "front", "struck_area": "front"}
    if known and {said.get("striker"), said.get("struck")} in ({known.struck, None}, {known.striker, None}):
        turned = {"striker": known.struck, "struck": known.striker,
                  "striker_area": known.struck_area, "struck_area": known.striker_area}  # fmt: skip
        start = turned if said.get("striker") == known.struck or said.get("struck") == known.striker else start
    made: Contact | None = _checked(Contact, start | said)
    ids = {a.id for a in behavior.actors}
    if made is None or made.striker == made.struck or not {made.striker, made.struck} <= ids:
        return known
    return made
