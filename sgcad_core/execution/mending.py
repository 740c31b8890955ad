"""What a writer without a model may change of a behavior whose first contact does not come about.

One thing at a time, what the report leaves open before what it states: the side of a thing, a maneuver without which a
side cannot strike, where a backing vehicle faces, a lane; last the sides that do touch where the pair meets otherwise
than told. Knows behaviors and plans; no report.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, NamedTuple, get_args

from sgcad_core.case.records import ObservedContact
from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.contact import first_contact
from sgcad_core.execution.scenario import actor_infos
from sgcad_core.execution.starts import off_lane
from sgcad_core.planner import plan
from sgcad_core.records.course import NOTHING_TOLD, Courses
from sgcad_core.records.specs import Actor, Area, BehaviorSpec, Contact, Maneuver, size_m
from sgcad_core.roads.lane_graph import LaneGraph

_STILL: tuple[Maneuver, ...] = ("stopped", "parked")
_OTHER_WAY: dict[str, Literal["forward", "backward"]] = {"forward": "backward", "backward": "forward"}


class Mended(NamedTuple):
    """A behavior that comes about, and the change in words."""

    behavior: BehaviorSpec
    words: str


def mended(
    behavior: BehaviorSpec, graph: LaneGraph, seen: ObservedContact | None, *, may_skid: bool = False,
    courses: Courses = NOTHING_TOLD,
) -> Mended | None:  # fmt: skip
    """The first change with which the pair meets as declared and all start in a lane; None if there is none.

    `seen`: the first contact of the plan as it is.
    """
    for other in _changes(behavior, seen):
        try:
            planned = plan(other.behavior, graph, may_skid=may_skid, courses=courses)
        except InvalidOutput:
            continue
        touch = first_contact(planned.trajectories, {a.id: size_m(a) for a in other.behavior.actors})
        astray = off_lane(actor_infos(other.behavior), planned.trajectories, graph, touch)
        if planned.realised and not any(astray):
            return other
    return None


def _changes(behavior: BehaviorSpec, seen: ObservedContact | None) -> Iterator[Mended]:
    if not behavior.contacts:
        return
    contact = behavior.contacts[0]
    meets = seen is not None and {seen.actor, seen.other} == {contact.striker, contact.struck}
    touched = _touching(contact, seen) if seen and meets else None
    yield from _sides_of_things(behavior, contact)
    moving = [*_striking(behavior, contact), *_facing(behavior, contact), *_in_any_lane(behavior, contact)]
    yield from moving
    if touched:
        yield _with_contact(behavior, touched, "the sides that touch instead of those that are told")


def _sides_of_things(behavior: BehaviorSpec, contact: Contact) -> Iterator[Mended]:
    """Another side of a thing, which no report tells."""
    for role in ("striker", "struck"):
        if any(actor.id == getattr(contact, role) and actor.record.thing for actor in behavior.actors):
            for side in get_args(Area):
                if side != getattr(contact, f"{role}_area"):
                    other = contact.model_copy(update={f"{role}_area": side})
                    yield _with_contact(behavior, other, "another side of the thing")


def _touching(contact: Contact, seen: ObservedContact) -> Contact:
    sides = {seen.actor: seen.actor_area, seen.other: seen.other_area}
    areas = {"striker_area": sides[contact.striker], "struck_area": sides[contact.struck]}
    return contact.model_copy(update=areas)


def _with_contact(behavior: BehaviorSpec, contact: Contact, words: str) -> Mended:
    changed = behavior.model_copy(update={"contacts": (contact, *behavior.contacts[1:])})
    sides = f"{contact.striker_area} of {contact.striker}, {contact.struck_area} of {contact.struck}"
    return Mended(changed, f"{words}: {sides}")


def _striking(behavior: BehaviorSpec, contact: Contact) -> Iterator[Mended]:
    """A striker backs up if its back strikes, and drives on if it stands and its front strikes."""
    striker = next((a for a in behavior.actors if a.id == contact.striker), None)
    if striker is None or not striker.record.wheeled:
        return
    if contact.striker_area == "back" and striker.maneuver != "backing":
        backing = _with_actor(behavior, striker, maneuver="backing", exit_road=None)
        yield Mended(backing, f"{striker.id} backs up")
        yield Mended(_turned_round(backing, backing.actors[behavior.actors.index(striker)]), f"{striker.id} backs up")
    if contact.striker_area == "front" and striker.maneuver in _STILL:
        yield Mended(_with_actor(behavior, striker, maneuver="straight"), f"{striker.id} drives on")


def _facing(behavior: BehaviorSpec, contact: Contact) -> Iterator[Mended]:
    """A backing vehicle faces the other way on its road."""
    for actor in _pair(behavior, contact):
        if actor.maneuver == "backing":
            yield Mended(_turned_round(behavior, actor), f"{actor.id} faces the other way")


def _in_any_lane(behavior: BehaviorSpec, contact: Contact) -> Iterator[Mended]:
    for actor in _pair(behavior, contact):
        if actor.lane is not None:
            yield Mended(_with_actor(behavior, actor, lane=None), f"{actor.id} in any lane")


def _pair(behavior: BehaviorSpec, contact: Contact) -> list[Actor]:
    return [a for a in behavior.actors if a.id in (contact.striker, contact.struck)]


def _turned_round(behavior: BehaviorSpec, actor: Actor) -> BehaviorSpec:
    return _with_actor(behavior, actor, direction=_OTHER_WAY[actor.direction], lane=None)


def _with_actor(behavior: BehaviorSpec, actor: Actor, **changes: object) -> BehaviorSpec:
    other = actor.model_copy(update=changes)
    return behavior.model_copy(update={"actors": tuple(other if a.id == actor.id else a for a in behavior.actors)})
