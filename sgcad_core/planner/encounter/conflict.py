"""How the declared pair comes into contact: its roles, its meeting place, and the stages of the search.

Ordinary driving first, then with the wanted sides turned to each other, then only one of the two, then odd driving.
Knows the behavior and the courses; no scene.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from sgcad_core.planner.actor_plan import Role, is_standing, speed_there
from sgcad_core.planner.encounter.arrival import MOVES_UP_M
from sgcad_core.planner.encounter.maneuver_choices import UNTOLD
from sgcad_core.planner.encounter.meeting_place import TURNING, Place, meeting_places, preferred_station
from sgcad_core.planner.encounter.motion_options import (
    Option,
    aimed,
    along,
    forced,
    options,
    plainly,
    sliding,
    spun,
    steeply,
    turned,
)
from sgcad_core.planner.encounter.pacing_choices import pacings
from sgcad_core.planner.encounter.pairing import GOOD, Encounter, Stage, Ways, cannot, search
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.planner.lines.box_angles import ASKEW
from sgcad_core.planner.lines.crossing import implied_crossings
from sgcad_core.planner.lines.departures import comes_back, departs, departure_sides, departure_station, side_of
from sgcad_core.planner.lines.told_moves import with_room
from sgcad_core.planner.lines.turning import wide_lines
from sgcad_core.planner.lines.walkers import crosswalk_station, walking_courses
from sgcad_core.planner.long_things import runs_along
from sgcad_core.planner.stationary_actors import needs_angle, parked_beside_m
from sgcad_core.records.course import Courses, CourseTold
from sgcad_core.records.specs import Actor, Area, BehaviorSpec, Contact, size_m

_TRIES = (16, 26, 24, 400)
"""Combinations of options tried in each stage of the search."""
_AS_TOLD, _TOLD_ENOUGH = 170, 1.0
"""Combinations tried without a swerve, and the cost from which on one is looked for."""
_LAST_TRIES = 90
"""Combinations tried with boxes that slide against their direction, since no driving brings the sides together."""
_ONE_TURNS = 24
"""Combinations tried in which only one of the two turns its side to the other."""
_SLIGHT_RAD, _SLIGHTLY = math.radians(25.0), 8
"""Angle at which a standing vehicle is still in line with the others, and the number of such options."""
_SLIGHT = 60
"""Combinations tried with a standing vehicle that is turned so, where an end is told to meet a flank."""
_TURNING, _WIDE, _ALL = 40, 200, 6000
"""Combinations tried with other lines of a turn, with those that swing wide, and to know that no other one will do."""


@dataclass
class Conflicts:
    """The actors of a behavior on their courses; `notes`: gaps in their stated behavior."""

    behavior: BehaviorSpec
    courses: dict[str, Course]
    may_skid: bool = False
    by_force: bool = True
    told: Courses = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    pushed: set[str] = field(default_factory=set)
    """Standing actors that are set rolling."""

    def __post_init__(self) -> None:
        self.actors = {a.id: a for a in self.behavior.actors}

    def as_they_drive(self, conflict: Contact) -> Encounter | None:
        """A conflict of a pair in ordinary driving, on any sides and on any line of a turn.

        None where their ways never meet so: no lane is left for a conflict that is avoided.
        """
        a, b = self.roles(conflict)
        ordinary = [Stage((self._options(a, b, _unturned), self._options(b, a, _unturned)), _TRIES[0])]
        sides = (conflict.striker_area, conflict.struck_area)
        turns = [Stage((self._options(a, b, turned), self._options(b, a, turned)), _TURNING)]
        found = search(ordinary, sides) or search(ordinary, None) or search([*ordinary, *turns], None)
        if found is None:
            self.notes.append(f"the ways of {conflict.striker} and {conflict.struck} never meet in ordinary driving")
        return found

    def of(self, contact: Contact) -> Encounter | None:
        """The encounter of the declared pair; None where the two cannot be brought together."""
        wanted = (contact.striker_area, contact.struck_area)
        found = self._kept_or_forced(self.roles(contact), contact, wanted)
        if found is None:  # drawn and told as odd driving: the account finds it, and the verdict is never "whole"
            a, b = (replace(role, leaves_lanes=True) for role in self.roles(contact))
            found = search(self._stages(a, b), wanted)
            if found is not None:
                self.notes.append(f"{contact.striker} and {contact.struck} touch only out of their lanes")
        return found

    def _kept_or_forced(self, pair: tuple[Role, Role], contact: Contact, wanted: tuple[Area, Area]) -> Encounter | None:
        """The encounter within the lanes, by force or on other sides; None where their ways never meet there."""
        a, b = pair
        found = search(self._stages(a, b), wanted)
        if found is None and self.by_force:
            found = search([Stage((self._options(a, b, sliding), self._options(b, a, sliding)), _LAST_TRIES)], wanted)
        if found is None:
            found = search([Stage((self._options(a, b, options), self._options(b, a, options)), _TRIES[0])], None)
            self.notes.append(cannot(contact, found))
        return found

    def _stages(self, a: Role, b: Role) -> Iterator[Stage]:
        """Driving as told at any speed and in any lane, then with slight steering, other lines of turns, the wanted
        sides turned to each other, one of the two, odd driving."""

        def both(ways: Callable[[Role], list[Option]]) -> Ways:
            return self._options(a, b, ways), self._options(b, a, ways)

        yield Stage(both(_as_told), _AS_TOLD, _TOLD_ENOUGH)
        plain = both(plainly)
        if wide_lines(a) or wide_lines(b):
            yield Stage(both(_as_told), _ALL, _TOLD_ENOUGH)  # a wide turn is forced only where none of these meets
            yield Stage(both(lambda role: along(role, wide_lines(role), pacings(role))), _WIDE)
        if implied_crossings(a) or implied_crossings(b):
            steep = both(steeply)
            yield Stage((steep[0], plain[1]), _TRIES[0])
            yield Stage((plain[0], steep[1]), _TRIES[0])
            slight = both(_slightly_askew)
            yield Stage((steep[0], slight[1]), _TRIES[0])
            yield Stage((slight[0], steep[1]), _TRIES[0])
        askew = _may_stand_askew(a) or _may_stand_askew(b)
        yield Stage(both(options), _TRIES[0], _TOLD_ENOUGH if askew else GOOD)
        if askew:
            slight, told = both(_slightly_askew), both(_as_told)
            yield Stage((slight[0] or told[0], slight[1] or told[1]), _SLIGHT)
        if a.actor.maneuver in TURNING or b.actor.maneuver in TURNING:
            yield Stage(both(turned), _TURNING)
        facing = both(aimed)
        yield Stage(facing, _TRIES[1])
        yield Stage((plain[0], facing[1]), _ONE_TURNS)
        yield Stage((facing[0], plain[1]), _ONE_TURNS)
        yield Stage(both(forced), _TRIES[2])
        if self.by_force:
            yield Stage(both(spun), _TRIES[3])

    def roles(self, contact: Contact) -> tuple[Role, Role]:
        """The two of a contact at their meeting place."""
        a, b = self.actors[contact.striker], self.actors[contact.struck]
        if a.maneuver in ("stopped", "parked") and b.maneuver in ("stopped", "parked"):
            a = self._set_rolling(a, b)
        places = self._places(a, b)
        pair = [
            Role(actor, self.courses[actor.id], size_m(actor), place, side, surface=self.behavior.surface,
                 may_skid=self.may_skid, told=self._told(actor, other), pushed=actor.id in self.pushed,
                 goes_on=self._goes_on(actor.id, contact))
            for actor, other, place, side in
            ((a, b, places[0], contact.striker_area), (b, a, places[1], contact.struck_area))
        ]  # fmt: skip
        first, second = pair
        if b.record.thing:
            first = with_room(first)
            second = replace(second, place=first.place)
        first, second = _towards_parked(first, second), _towards_parked(second, first)
        return _facing_other(first, second), _facing_other(second, first)

    def _told(self, actor: Actor, other: Actor) -> CourseTold:
        """What is told of an actor; its way off the road leads to things, not to others on the road."""
        told = self.told.get(actor.id, CourseTold())
        side = side_of(actor.maneuver, told.departs) if other.record.thing else None
        inside = self._inside(actor, other)
        same = (side, inside) == (told.departs, told.inside)
        return told if same else replace(told, departs=side, inside=inside)

    def _inside(self, *pair: Actor) -> bool:
        """Whether one of a pair is told to have driven into a junction."""
        return any(self.told.get(actor.id, CourseTold()).inside for actor in pair)

    def _goes_on(self, actor: str, contact: Contact) -> bool:
        """Whether an actor on wheels strikes something else after a contact, or behind a thing rolls over or comes back
        to the road."""
        told = list(self.behavior.contacts)
        later = told[told.index(contact) + 1 :] if contact in told else []
        own, its = self.actors[actor], self.told.get(actor, CourseTold())
        past = self.actors[contact.struck].record.thing and (its.rolls or comes_back(own.maneuver, its))
        return own.record.wheeled and (past or any(c.striker == actor for c in later))

    def _set_rolling(self, a: Actor, b: Actor) -> Actor:
        mover = b if a.record.thing else a
        self.notes.append(f"{mover.id} is set rolling: two standing actors cannot touch")
        self.pushed.add(mover.id)
        self.actors[mover.id] = mover.model_copy(update={"maneuver": "straight", "speed_mph": mover.speed_mph or 10})
        return self.actors[a.id]

    def _places(self, a: Actor, b: Actor) -> tuple[Place, Place]:
        for one, other in ((a, b), (b, a)):
            if one.record.laneless and not other.record.laneless:
                here = Place(self._station_for(one, other), 0.0, 0.0, 0.0)
                return here, here
        pair = [(x, self.courses[x.id], size_m(x)[0]) for x in (a, b)]
        return meeting_places(pair[0], pair[1], inside=self._inside(a, b))

    def _station_for(self, one: Actor, driver: Actor) -> float:
        """The station of a driver's course at which a pedestrian or an object is met."""
        course, length = self.courses[driver.id], size_m(driver)[0]
        told = self._told(driver, one)
        if departs(driver.maneuver, told.departs):
            leaving = driver.model_copy(update={"maneuver": "departing_road_right"})
            usual = preferred_station(leaving, course, length)
            return departure_station(course, driver.maneuver, usual, beyond=told.beyond)
        if one.record.walks:
            return crosswalk_station(driver, course, length, one)
        return preferred_station(driver, course, length)

    def _options(self, role: Role, other: Role, ways: Callable[[Role], list[Option]]) -> list[Option]:
        if not role.actor.record.walks or other.actor.record.laneless:
            return ways(role)
        found = []
        for cost, course, place in walking_courses(other.course, other.place.station_m, role.side):
            walk = replace(role, course=course, place=place)
            found += [replace(option, extra_cost=cost) for option in ways(walk)]
        return sorted(found, key=lambda option: option.cost)


def _unturned(role: Role) -> list[Option]:
    """The options that steer no more than the maneuver asks; those of standing actors and things are all of them."""
    if is_standing(role):
        return options(role)
    return [option for option in options(role) if not option.twist.angle_rad and not option.drift.note]


def _may_stand_askew(role: Role) -> bool:
    """Whether it stands in the road where an end is told to meet a flank, which takes an angle between the two."""
    return is_standing(role) and not role.actor.record.thing and needs_angle(role)


def _slightly_askew(role: Role) -> list[Option]:
    """The most ordinary options in which a standing one is turned a little to what comes; none of others."""
    if not is_standing(role):
        return []
    return [option for option in options(role) if 0.0 < abs(option.twist.angle_rad) < _SLIGHT_RAD][:_SLIGHTLY]


def _as_told(role: Role) -> list[Option]:
    """The options in which it neither swerves, skids nor stands askew, unless that is told."""
    if is_standing(role):
        return [option for option in options(role) if option.twist.note != ASKEW]
    able = (o for o in options(role) if o.drift.note not in UNTOLD)
    return [option for option in able if option.twist.told or not option.twist.angle_rad]


def _towards_parked(role: Role, other: Role) -> Role:
    """A driving role whose other one stands beside the lanes: the other's line lies there."""
    aside_m = 0.0 if is_standing(role) or other.course.stalls else parked_beside_m(other)
    if not aside_m:
        return role
    left_m = role.place.aside_m - aside_m * math.cos(role.place.angle_rad)
    place = role.place._replace(aside_m=left_m, apart_m=math.hypot(left_m, role.place.ahead_m))
    return replace(role, place=place, other_parked=True)


def _facing_other(role: Role, other: Role) -> Role:
    """A role with the data on the other actor that it depends on."""
    return replace(
        role,
        other_mps=speed_there(other),
        other_width_m=other.size[1],
        other_side=None if runs_along(role.actor) and other.skids_as_told else other.side,  # any side may face a rail
        other_road=other.actor.road,
        other_spins=bool(other.spins),
        other_lost=other.told.lost_control,
        other_moves_up_m=MOVES_UP_M if other.told.comes == "moves_up" else 0.0,
        other_long_m=other.size[0] if runs_along(other.actor) else 0.0,
        other_leaves=_leaves(other),
    )


def _leaves(role: Role) -> int:
    """The hand on which it leaves the road, likeliest: 1 left, -1 right; 0: it stays on it."""
    if role.actor.record.laneless or not departs(role.actor.maneuver, role.told.departs):
        return 0
    return departure_sides(role.course, role.place.station_m, role.told.departs or "either")[0]
