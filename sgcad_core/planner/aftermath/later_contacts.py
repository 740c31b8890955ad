"""Behind the first contact: the things that wrecks strike, second contacts of the same two, rest as told.

Works on a scene in which everybody else is placed. Knows behaviors, scenes and roads.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from sgcad_core.planner.aftermath.rest_candidates import MISSED
from sgcad_core.planner.aftermath.rest_fit import IMPACTS, Impact, Rests, leaving
from sgcad_core.planner.aftermath.struck_objects import Strike, strike_things
from sgcad_core.planner.encounter.contact_queries import pair_of
from sgcad_core.planner.scene import Scene
from sgcad_core.records.course import Courses, CourseTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.surface import road_surface


class Ended(NamedTuple):
    """What of the course behind the first contact could not be had, in words and as a cost: 1 and more a told part."""

    notes: tuple[str, ...]
    missed: float


_ASIDE = 0.3
"""Of a side's length: what a vehicle knocks over and pushes along is not between it and the next thing."""


def _stands_by(actor: Actor) -> bool:
    return actor.record.thing or actor.record.exposed


def strikes_of(behavior: BehaviorSpec, contacts: Sequence[Contact]) -> list[Strike]:
    """The contacts behind the first that are with a thing, or with somebody who stands beside the road, in order.

    A thing is struck once, by somebody who is on the road by then; who meets in the first contact is no thing.
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


def expect(scene: Scene, contacts: Sequence[Contact]) -> None:
    """Tell a scene which pairs touch behind the first contact, and which of them once more."""
    first = {pair_of(contact) for contact in contacts[:1]}
    further = frozenset(pair_of(contact) for contact in contacts[1:])
    scene.again, scene.told = further & first, further - first


def run_out(
    scene: Scene,
    behavior: BehaviorSpec,
    contacts: Sequence[Contact],
    courses: Courses,
    graph: LaneGraph,
    impacts: Sequence[Impact] = IMPACTS,
) -> Ended:
    """Bring the wrecks to rest as told, by way of the things that they strike.

    `contacts`: those that can come about, the first one first. `impacts`: friction and restitution that are tried.
    """
    strikes = strikes_of(behavior, contacts)
    told = {actor.id: courses[actor.id] for actor in behavior.actors if actor.id in courses}
    if not told and not strikes and not scene.again:
        return Ended((), 0.0)
    for strike in strikes:
        told[strike.by] = leaving(told.get(strike.by, CourseTold()))
    rests = Rests(scene, told, road_surface(graph), frozenset(strike.by for strike in strikes), impacts)
    rests.fit()
    unreached = list(strike_things(scene, strikes, rests.surface, rests.cost))
    return Ended((*unreached, *rests.missed()), rests.cost() + MISSED * len(unreached))
