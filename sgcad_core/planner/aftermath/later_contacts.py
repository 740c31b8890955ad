"""After the first contact: struck objects, second contacts of the same pair, rest as stated.

Works on a scene in which all other actors are placed. Knows behaviors, scenes and roads.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from sgcad_core.planner.aftermath.rest_candidates import MISSED
from sgcad_core.planner.aftermath.rest_fit import IMPACTS, Impact, RestFit, leaving_the_road
from sgcad_core.planner.aftermath.struck_objects import Strike, strike_things
from sgcad_core.planner.scene import Scene
from sgcad_core.records.course import Courses, CourseTold
from sgcad_core.records.specs import Actor, Area, BehaviorSpec, Contact
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.surface import road_surface


class Ended(NamedTuple):
    """Missed parts of the course after the first contact, in words and as a cost: 1 and more a stated part."""

    notes: tuple[str, ...]
    missed: float


_ASIDE = 0.3
"""Share of the length of a side: what a vehicle knocks over and pushes along is not between it and the next object."""


def _stands_by(actor: Actor) -> bool:
    """Whether an actor can be struck on the way of a wreck: a thing, or a person without a body around."""
    return actor.record.thing or actor.record.exposed


def pair_of(contact: Contact) -> frozenset[str]:
    """The two actors of a contact, in no order."""
    return frozenset((contact.striker, contact.struck))


def other_of(contact: Contact, partner: str) -> tuple[str, tuple[Area, Area]]:
    """The other actor of a contact, and the sides of the partner and of the other one."""
    if partner == contact.striker:
        return contact.struck, (contact.striker_area, contact.struck_area)
    return contact.striker, (contact.struck_area, contact.striker_area)


def strikes_of(behavior: BehaviorSpec, contacts: Sequence[Contact]) -> list[Strike]:
    """The contacts after the first with objects or with people beside the road, in order.

    An object is struck once, by an actor on the road; the two of the first contact are no objects.
    """
    actors = {a.id: a for a in behavior.actors}
    found: list[Strike] = []
    met = {contacts[0].striker, contacts[0].struck} if contacts else set()
    things = {c.struck for c in contacts[1:] if _stands_by(actors[c.struck])} - met
    for number, contact in enumerate(contacts[1:], 1):
        if contact.struck in things and contact.striker not in things:
            goes_on = any(c.striker == contact.striker for c in contacts[number + 1 :])
            before = sum(strike.by == contact.striker for strike in found)
            aside = _ASIDE * (-1) ** before if goes_on or before else 0.0
            found.append(Strike(actors[contact.struck], contact.striker, contact.striker_area, goes_on, aside))
            things.remove(contact.struck)
    return found


def expect_later_contacts(scene: Scene, contacts: Sequence[Contact]) -> None:
    """Sets the pairs of a scene that touch after the first contact, and those that touch a second time."""
    first = {pair_of(contact) for contact in contacts[:1]}
    further = frozenset(pair_of(contact) for contact in contacts[1:])
    scene.again, scene.told = further & first, further - first


def bring_to_rest(
    scene: Scene,
    behavior: BehaviorSpec,
    contacts: Sequence[Contact],
    courses: Courses,
    graph: LaneGraph,
    impacts: Sequence[Impact] = IMPACTS,
) -> Ended:
    """Brings the vehicles to rest as stated, by way of the objects that they strike.

    `contacts`: the possible ones, the first one first. `impacts`: friction and restitution to try.
    """
    strikes = strikes_of(behavior, contacts)
    told = {actor.id: courses[actor.id] for actor in behavior.actors if actor.id in courses}
    if not told and not strikes and not scene.again:
        return Ended((), 0.0)
    for strike in strikes:
        told[strike.by] = leaving_the_road(told.get(strike.by, CourseTold()))
    rests = RestFit(scene, told, road_surface(graph), frozenset(strike.by for strike in strikes), impacts)
    rests.fit()
    unreached = list(strike_things(scene, strikes, rests.surface, rests.cost))
    return Ended((*unreached, *rests.missed()), rests.cost() + MISSED * len(unreached))
