"""After the first contact: struck objects, second contacts of the same pair, rest as stated.

Works on a scene in which all other actors are placed. Knows behaviors, scenes and roads.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import NamedTuple, Protocol

from sgcad_core.kinds import actor_kind
from sgcad_core.planner.aftermath.impact import IMPACTS, Impact
from sgcad_core.planner.aftermath.rest_candidates import odd_ways
from sgcad_core.planner.aftermath.rest_fit import RestFit
from sgcad_core.planner.aftermath.second_contact import MISSED
from sgcad_core.planner.aftermath.struck_objects import Strike, leave_beside, on_another_side, place_thing
from sgcad_core.planner.aftermath.told_order import Pair, ToldOrder, pair_of
from sgcad_core.planner.encounter.off_center import NARROW_M, SHARES, USUAL
from sgcad_core.planner.later.later_courses import runs_on, with_run
from sgcad_core.planner.long_things import runs_along
from sgcad_core.planner.scene import Scene
from sgcad_core.records.course import Courses, CourseTold, sense_of
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, size_m
from sgcad_core.roads.surface import RoadSurface


class Ended(NamedTuple):
    """Missed parts of the course after the first contact, in words and as a cost: 1 and more a stated part."""

    notes: tuple[str, ...]
    missed: float
    passed: tuple[tuple[Strike, int], ...] = ()
    """Objects that are struck by vehicles without any other contact, not yet placed, and the sample behind which each
    is struck."""


class Meet(Protocol):
    """Arranges a further contact of vehicles."""

    def __call__(self, contact: Contact, *, more: bool) -> bool:
        """Whether it comes about; `more`: others follow."""


_OTHER_WAYS = 4
"""Run-outs that are tried where a thing is not reached."""
_ASIDE = 0.3
"""Share of the length of a side: what a vehicle knocks over and pushes along is not between it and the next object."""


def _stands_by(actor: Actor) -> bool:
    """Whether an actor can be struck on the way of a wreck: a thing, or a person without a body around."""
    return actor.record.thing or actor.record.exposed


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
            asides = (_ASIDE * (-1) ** before,) if goes_on or before else (0.0,)
            found.append(Strike(actors[contact.struck], contact.striker, contact.striker_area, goes_on, asides))
            things.remove(contact.struck)
    return found


def struck_before(behavior: BehaviorSpec, contacts: Sequence[Contact]) -> list[Strike]:
    """The contacts with objects, people and animals that are told before the first one of two vehicles, in order; none
    where no two vehicles touch. Contacts of unknown actors are left out."""
    actors = {a.id: a for a in behavior.actors}
    contacts = [c for c in contacts if {c.striker, c.struck} <= actors.keys()]
    count = next((n for n, c in enumerate(contacts) if not _stands_by(actors[c.struck])), 0)
    early = [c for c in contacts[:count] if not _stands_by(actors[c.striker])]
    met = [c.struck for c in early] + [x for c in contacts[count:] for x in (c.striker, c.struck)]
    return [
        Strike(actors[c.struck], c.striker, c.striker_area, goes_on=True, thing_side=c.struck_area)
        for c in early if met.count(c.struck) == 1
    ]  # fmt: skip


def expect_later_contacts(scene: Scene, contacts: Sequence[Contact]) -> None:
    """Sets the pairs of a scene that touch after the first contact, and those that touch a second time."""
    first = {pair_of(contact) for contact in contacts[:1]}
    further = frozenset(pair_of(contact) for contact in contacts[1:])
    met: set[Pair] = set()
    for contact in contacts:
        if (pair := pair_of(contact)) in met:
            sides = {contact.striker: contact.striker_area, contact.struck: contact.struck_area}
            scene.sides.setdefault(pair, sides)
        met.add(pair)
    scene.again, scene.told = frozenset(scene.sides), further - first


def _off_middle(strike: Strike, course: CourseTold) -> Strike:
    """A narrow thing that ends the way of its vehicle, beside the middle of the side that strikes it, so that the blow
    turns the vehicle as told."""
    if strike.asides != (0.0,) or max(size_m(strike.thing)) > NARROW_M:
        return strike
    if course.spin:
        return replace(strike, asides=tuple(sense_of(course.spin) * share / 2 for share in SHARES))
    both = course.spin_deg or course.rest.facing_deg is not None
    return replace(strike, asides=(-USUAL / 2, USUAL / 2) if both else (-USUAL / 2,))


def leaving_the_road(course: CourseTold) -> CourseTold:
    """The stated course of a vehicle that strikes an object beside the road: without a stated place it leaves the
    road."""
    where = course.rest.where or "off_road"
    return replace(course, rest=replace(course.rest, where=where))


def _on_the_way(told: Courses, rolling: frozenset[str]) -> Courses:
    """The stated courses of vehicles as they come to what they strike: how they face at rest follows from that, but for
    those that come to rest against it."""
    return {
        name: replace(course, rest=replace(course.rest, facing_deg=None))
        if name in rolling and course.rest.against is None else course
        for name, course in told.items()
    }  # fmt: skip


class Ending:
    """What brings the vehicles of a scene to rest: stated ends, what they strike on the way, and what they meet there.

    `contacts`: the possible ones, the first one first. `impacts`: friction and restitution to try. `meet`: arranges a
    further contact of vehicles (`more`: others follow); whether it comes about.
    """

    def __init__(
        self, scene: Scene, behavior: BehaviorSpec, contacts: Sequence[Contact], order: ToldOrder, meet: Meet,
    ) -> None:  # fmt: skip
        self.scene, self.order, self.meet = scene, order, meet
        self.strikes = {strike.thing.id: strike for strike in strikes_of(behavior, contacts)}
        further = [c for c in contacts[1:] if pair_of(c) != pair_of(contacts[0])]
        at = next((n for n, c in enumerate(further) if c.struck in self.strikes), len(further))
        self.before, self.then = further[:at], further[at:]

    def meet_first(self) -> Iterator[str]:
        """Arranges the contacts before the first one with a thing on the way; notes on those that cannot be."""
        for number, contact in enumerate(self.before, 1):
            yield from self._meet(contact, more=bool(self.then) or number < len(self.before))

    def come(self, courses: Courses, surface: RoadSurface, impacts: Sequence[Impact] = IMPACTS) -> Ended:
        """Brings the vehicles to rest as stated, by way of what they strike and meet."""
        scene, touched = self.scene, {name for touch in self.scene.touches for name in (touch.first, touch.second)}
        rolling = frozenset(strike.by for strike in self.strikes.values() if strike.by in touched)
        told = {name: courses[name] for name in scene.tracks if name in courses}
        for name in self._turning_on_the_spot(surface):
            told.setdefault(name, CourseTold())
        passed: list[tuple[Strike, int]] = []
        if not told and not rolling and not scene.again:
            notes = list(self._then(courses, surface, lambda: 0.0, passed))
            return Ended(tuple(notes), MISSED * len(notes), tuple(passed))
        for name in rolling:
            told[name] = leaving_the_road(told.get(name, CourseTold()))
        RestFit(scene, _on_the_way(told, rolling), surface, rolling, impacts, self.order).fit()
        as_told = RestFit(scene, told, surface, rolling, impacts, self.order)
        notes = list(self._then(courses, surface, as_told.cost, passed))
        told = {name: courses[name] for name in scene.tracks if name in courses} | told
        rests = RestFit(scene, told, surface, rolling, impacts, self.order)
        rests.finish()
        return Ended((*notes, *rests.missed()), rests.cost() + MISSED * len(notes), tuple(passed))

    def _turning_on_the_spot(self, surface: RoadSurface) -> list[str]:
        """Vehicles that turn on the spot behind the first contact, as no wreck does."""
        tracks = {name: t for name, t in self.scene.tracks.items() if t.hit is not None and actor_kind(t.kind).wheeled}
        ways = {name: track.poses[self.scene.contact :, None] for name, track in tracks.items()}
        return [name for name, way in ways.items() if odd_ways(CourseTold(), way, surface)[0] > 0.0]

    def _then(
        self, courses: Courses, surface: RoadSurface, cost: Callable[[], float], passed: list[tuple[Strike, int]]
    ) -> Iterator[str]:
        """The contacts from the first thing on the way on, in order; notes on those that do not come about.

        `passed` gets the strikes of vehicles that were not touched: they drive on, and are placed later.
        """
        for number, contact in enumerate(self.then, 1):
            more, strike = len(self.then) - number, self.strikes.get(contact.struck)
            if strike is None or contact.struck in self.scene.tracks:
                yield from self._meet(contact, more=more > 0)
            elif any(strike.by in (touch.first, touch.second) for touch in self.scene.touches):
                strike = _off_middle(strike, courses.get(strike.by, CourseTold()))
                yield from self._strike(strike, courses.get(strike.by, CourseTold()), surface, (cost, more))
            else:
                passed.append((strike, self.order.after))

    def _strike(
        self, strike: Strike, told: CourseTold, surface: RoadSurface, ends: tuple[Callable[[], float], int]
    ) -> Iterator[str]:
        """Places a thing on the way of its vehicle, or on another one that it can take; a note where it is missed. What
        stays where it stands is beside the road, unless the vehicle is told to rest on the road. `ends`: the cost of
        the rest as settled, and the number of contacts that follow."""
        along = runs_along(strike.thing)
        beside = strike.thing.stays and (along or told.rest.where not in ("road", "intersection"))
        placed = along and self._is_met(strike, surface, ends, on_road=False, as_told=True)
        placed = placed or (beside and self._is_met(strike, surface, ends, on_road=False))
        if placed:
            yield from self._sides(strike)
            return
        aside = along and told.rest.where in ("off_road", "shoulder", "median")
        if not aside and self._is_met(strike, surface, ends, on_road=True):
            if along:
                yield f"{strike.thing.id} stands in the lanes, where nothing runs along the road"
        else:
            leave_beside(self.scene, strike, surface)
            yield f"{strike.by} does not reach {strike.thing.id}, which it strikes as told"

    def _sides(self, strike: Strike) -> Iterator[str]:
        """A note where a thing is struck with another side than told; what runs along the road has few places."""
        if not runs_along(strike.thing) and on_another_side(self.scene, strike):
            yield f"{strike.by} strikes {strike.thing.id} with another side than told ({strike.side})"

    def _is_met(
        self,
        strike: Strike,
        surface: RoadSurface,
        ends: tuple[Callable[[], float], int],
        *,
        on_road: bool,
        as_told: bool = False,
    ) -> bool:
        """Whether a thing has a place on the way of its vehicle, or on another one that it can take; `on_road`: the
        place may be on the road; `as_told`: only along the road, before the told side."""
        scene, before, (cost, more) = self.scene, self.scene.runs, ends
        placed = partial(
            place_thing, scene, strike, surface, cost, self.order, more=more, on_road=on_road, as_told=as_told
        )
        if placed():
            return True
        for run in islice(runs_on(scene, strike.by, surface, self.order.after), _OTHER_WAYS * (1 + as_told)):
            scene.runs = with_run(scene, strike.by, run)
            scene.settle()
            if self.order.kept and placed():
                return True
            scene.runs = before
            scene.settle()
        return False

    def _meet(self, contact: Contact, *, more: bool) -> Iterator[str]:
        if not self.meet(contact, more=more):
            yield f"later contact of {contact.striker} and {contact.struck} could not be arranged"
