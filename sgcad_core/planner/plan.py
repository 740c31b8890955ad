"""From a behavior and a road network to timed motions in which the declared contact comes first.

Ordinary driving is tried first, then other speeds, lines beside the lane, and swerves; the notes of the plan list the
changes. Boxes that slide against their direction of travel without a stated loss of control are the last resort: noted,
and doubted by the validator `drivable`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from sgcad_core.case.records import ObservedContact, Record, Trajectory
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.aftermath.impact import Impact
from sgcad_core.planner.aftermath.later_contacts import Ending, expect_later_contacts, strikes_of, struck_before
from sgcad_core.planner.aftermath.second_contact import MISSED
from sgcad_core.planner.aftermath.struck_objects import Strike
from sgcad_core.planner.aftermath.told_order import ToldOrder, met_in_order, pair_of
from sgcad_core.planner.bystanders import place_clear
from sgcad_core.planner.company import stand_ahead, with_company
from sgcad_core.planner.encounter.arrival import as_they_come
from sgcad_core.planner.encounter.conflict import Conflicts
from sgcad_core.planner.encounter.meeting_place import Place, preferred_station
from sgcad_core.planner.encounter.motion_options import Option
from sgcad_core.planner.encounter.off_center import is_passed
from sgcad_core.planner.encounter.pacing_choices import ROLLS_IN
from sgcad_core.planner.encounter.pairing import Encounter
from sgcad_core.planner.encounter.try_elsewhere import WholeCourse, least_missed
from sgcad_core.planner.knocked_aside import drive_over, knock_aside
from sgcad_core.planner.later.drive_away import LEAVES_S, drive_away
from sgcad_core.planner.later.later_meetings import LaterMeetings
from sgcad_core.planner.lead_time import lead_alone, lead_of
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.planner.lines.departures import comes_back, departs, departure_station
from sgcad_core.planner.lines.gore_lines import into_gores
from sgcad_core.planner.lines.maneuver_course import course_of
from sgcad_core.planner.lines.told_moves import off_and_back, off_on_one_side, off_to_median, unturned, with_room
from sgcad_core.planner.maneuver_visible import unseen_evasion, unseen_maneuver
from sgcad_core.planner.motion import STEP_S, Motion, gentle_mps2
from sgcad_core.planner.near_crash.near_miss import near_encounter
from sgcad_core.planner.scene import AFTER_S, Scene
from sgcad_core.planner.towing import ahead_of, coupling_m, spacing_m, tractors
from sgcad_core.records.course import NOTHING_TOLD, Courses, CourseTold
from sgcad_core.records.specs import BehaviorSpec, Contact, NearCrash, size_m
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.surface import road_surface

_FURTHER_S, _EACH_S, _MOST_S = 3.0, 0.8, 7.0
"""Additional time after the first contact where an actor goes on far, for each contact from the third on, at most."""
_TOLD_S_PER_M = 0.14
"""Time for a told distance to the rest: slowed evenly from 14 m/s."""
_MANEUVER_MISSED = 3.0
"""Cost of a stated maneuver that is not visible: more than any two parts of the course after the contact."""


class Plan(Record):
    """Trajectories of all actors, in the order of the behavior, on one clock.

    `contact` is the first overlap of any two; `realised`: it is between the first declared pair on the declared areas
    (without a declared contact: no boxes touch). `notes` list what was changed.
    `oddity`: how far from ordinary driving they meet, both actors' `Option.oddity` in sum: up to 0.4 for other speeds
    and swerves, more for skids, spins and leaving the road, 1 more where no road leads; 0 where not met as declared.
    """

    trajectories: tuple[Trajectory, ...]
    contact: ObservedContact | None
    realised: bool
    notes: tuple[str, ...] = ()
    oddity: float = 0.0


def plan(
    behavior: BehaviorSpec, graph: LaneGraph, *,
    may_skid: bool = False, by_force: bool = True, courses: Courses = NOTHING_TOLD,
) -> Plan:  # fmt: skip
    """Motions for a behavior on a network. Raises InvalidOutput for road ids that the network does not have.

    `courses`: evasion and rest that the report states, by actor. `may_skid`: it states a loss of control, so boxes may
    turn against their direction before they touch. Not `by_force`: without slides and the longest search.
    """
    behavior = into_gores(behavior)
    courses = off_and_back(courses, (s.by for s in struck_before(behavior, behavior.contacts) if s.thing.firm))
    courses = off_on_one_side(courses, behavior)
    gentle = gentle_mps2(DRIVING.friction_mps2(behavior.surface))
    lines = with_company(behavior, {a.id: course_of(graph, a, gentle) for a in behavior.actors}, courses)
    courses = off_to_median(courses, behavior, lines)
    conflicts = Conflicts(behavior, lines, may_skid, by_force, courses)
    cast = _Cast(behavior, lines, tractors(behavior), courses, [note for line in lines.values() for note in line.notes])
    contacts, near = cast.contacts, behavior.near_crash
    found = conflicts.of(contacts[0]) if contacts else cast.near_crash(near, conflicts) if near else None
    cast.notes += conflicts.notes
    done = least_missed(found, lambda encounter, impacts: cast.unfolded(encounter, graph, conflicts, impacts))
    first = behavior.contacts[0] if behavior.contacts else None
    observed = done.scene.first_contact()
    realised = observed is None if first is None else observed is not None and observed.is_of(first)
    if not realised and any(course.yaws for course in courses.values()):  # another contact comes first in such a skid
        return plan(behavior, graph, may_skid=may_skid, by_force=by_force, courses=unturned(courses))
    return Plan(
        trajectories=done.scene.trajectories(tuple(a.id for a in behavior.actors), courses), contact=observed,
        realised=realised, notes=tuple(dict.fromkeys(done.notes)), oddity=round(done.oddity, 3) if realised else 0.0,
    )  # fmt: skip


@dataclass
class _Cast:
    """The actors with their courses; collects notes on changes of the stated behavior."""

    behavior: BehaviorSpec
    courses: dict[str, Course]
    tractors: dict[str, str]
    told: Courses
    notes: list[str]
    oddity: float = 0.0
    missed: float = 0.0
    """Cost of stated maneuvers and evasions that are not visible before the first contact."""

    def __post_init__(self) -> None:
        self.actors = {a.id: a for a in self.behavior.actors}

    @cached_property
    def things(self) -> frozenset[str]:
        """Objects that are struck on the way to rest; they are placed when that way is known."""
        return frozenset(strike.thing.id for strike in strikes_of(self.behavior, self.contacts))

    @property
    def wandering(self) -> list[str]:
        """Those of which several moves are told, or that leave the road and touch nothing."""
        alone = not (self.possible or self.behavior.near_crash)
        told = ((a, self.told.get(a.id, CourseTold())) for a in self.behavior.actors)
        off = [(a.id, its.moves, its.lost_control or departs(a.maneuver, its.departs)) for a, its in told]
        return [who for who, moves, leaves in off if moves or (alone and leaves)]

    @cached_property
    def possible(self) -> list[Contact]:
        """The contacts of the behavior that are possible."""
        return self.usable(self.behavior.contacts)

    @cached_property
    def early(self) -> list[Strike]:
        """What is struck before the first contact of two vehicles."""
        return struck_before(self.behavior, self.possible)

    @cached_property
    def contacts(self) -> list[Contact]:
        """The possible contacts from the first one of vehicles on; all of them where no two vehicles touch."""
        aside = {strike.thing.id for strike in self.early}
        return [contact for contact in self.possible if contact.struck not in aside]

    def usable(self, contacts: Sequence[Contact]) -> list[Contact]:
        """Contacts between two different actors of the behavior."""
        left = [c for c in contacts if not self._can_meet(c.striker, c.struck)]
        self.notes += (f"contact of {c.striker} and {c.struck} left out: they cannot meet" for c in left)
        return [c for c in contacts if c not in left]

    def _can_meet(self, one: str, other: str) -> bool:
        towed = self.tractors.get(one) == other or self.tractors.get(other) == one
        return {one, other} <= self.actors.keys() and one != other and not towed

    # -------------------------------------------------------------- the whole course
    def unfolded(
        self, found: Encounter | None, graph: LaneGraph, conflicts: Conflicts, impacts: Sequence[Impact]
    ) -> WholeCourse:
        """The whole course from an encounter on, and its distance from what is stated; this object stays unchanged."""
        cast = replace(self, tractors=dict(self.tractors), notes=list(self.notes))
        lead, after = round(lead_alone(map(cast.alone, cast.wandering)) / STEP_S), round(AFTER_S / STEP_S)
        scene = cast.staged(found) if found else Scene(lead + after + 1, lead)
        expect_later_contacts(scene, cast.contacts)
        scene.settle()
        surface = road_surface(graph)
        order = ToldOrder(scene, frozenset(map(pair_of, cast.contacts)), [pair_of(c) for c in cast.contacts[:1]])
        meetings = LaterMeetings(scene, surface, cast.role, conflicts.of, order)
        ending = Ending(scene, self.behavior, cast.contacts, order, meetings.arrange)
        cast.notes += ending.meet_first()
        ended = ending.come(self.told, surface, impacts)
        cast.rest(scene)
        scene.settle()
        aside = [*knock_aside(scene, cast.early, surface), *drive_over(scene, ended.passed, surface)]
        notes = () if cast.possible or self.behavior.near_crash else tuple(scene.turn_over(self.told))
        notes += tuple(drive_away(scene, self.courses, self.told, self.possible))
        missed = ended.missed + cast.missed + MISSED * (len(aside) + cast.unmet(scene) + scene.rolls_short(self.told))
        return WholeCourse(scene, (*cast.notes, *ended.notes, *aside, *notes), cast.oddity, missed)

    def unmet(self, scene: Scene) -> int:
        """The number of further contacts of vehicles that do not happen in order; those with objects and second ones
        are counted elsewhere."""
        further = [pair_of(c) for c in self.contacts[1:] if c.struck not in self.things]
        pairs = dict.fromkeys(pair for pair in further if pair not in scene.again)
        return met_in_order(scene.touches, pairs).count(None)

    # -------------------------------------------------------------- the first contact
    def near_crash(self, near: NearCrash, conflicts: Conflicts) -> Encounter | None:
        """A conflict with its evasion; None where the two cannot be brought near or cannot be parted."""
        if not self.usable((near.conflict,)):
            return None
        found, notes = near_encounter(conflicts, near)
        self.notes += notes
        return found

    def staged(self, found: Encounter) -> Scene:
        """Both actors with what they tow on the world clock, through the collision."""
        pair = as_they_come(found)
        contact = math.ceil(lead_of(pair) / STEP_S)
        after = AFTER_S + self._runs_on_s()
        again = frozenset(name for c in self.contacts[1:] for name in (c.striker, c.struck))
        scene = Scene(contact + round(after / STEP_S) + 1, contact, again, self.behavior.surface)
        for option, motion, own in pair:
            self.notes += option.notes
            self.oddity += option.oddity + option.role.course.astray
            scene.add(option.role.actor.id, option.role.actor.kind, motion, own, brakes=False)
        if self.contacts:
            self._let_through(scene, self.contacts[0])
        for option, _, own in pair:
            self._couple(scene, option.role.actor.id, own)
        scene.settle()
        if self.contacts:
            self._look(scene, pair)
        return scene

    def _let_through(self, scene: Scene, first: Contact) -> None:
        """Lets a thing that is struck first give way where it is loose, or its vehicle goes on behind it."""
        track, thing, who = scene.tracks[first.struck], self.actors[first.struck], self.actors[first.striker]
        its, further = self.told.get(who.id, CourseTold()), any(who.id in pair_of(c) for c in self.contacts[1:])
        track.flat, goes_on = thing.flat, further or its.rolls or comes_back(who.maneuver, its)
        if track.motion.fixed and not thing.flat and (goes_on or thing.loose):
            track.let_pass(glances=is_passed(thing, first.striker_area), stays=thing.firm)

    def _look(self, scene: Scene, pair: Iterable[tuple[Option, Motion, float]]) -> None:
        """Notes which stated maneuvers and evasions are not visible before the contact."""
        for option in (one for one, motion, _ in pair if not motion.standing):
            role = option.role
            until = scene.tracks[role.actor.id].driven[: scene.contact + 1]
            if words := unseen_maneuver(role.actor, role.course, until):
                self.notes.append(words)
                self.missed += _MANEUVER_MISSED
            if ROLLS_IN in option.pacing.note:
                self.missed += _MANEUVER_MISSED
            self.notes += (unseen := list(unseen_evasion(role.actor.id, role.course, role.told, until)))
            self.missed += len(unseen)

    def _runs_on_s(self) -> float:
        """Additional time where an actor goes on far after the first contact: off the road, into further contacts."""
        rests = [course.rest for course in self.told.values()]
        told_s = max((rest.distance_m or 0.0 for rest in rests), default=0.0) * _TOLD_S_PER_M - AFTER_S
        afar = len(self.contacts) > 1 or any(rest.where in ("off_road", "shoulder", "median") for rest in rests)
        further_s = _FURTHER_S + _EACH_S * max(len(self.contacts) - 2, 0) if afar else 0.0
        return min(max(further_s, told_s, LEAVES_S * any(its.leaves for its in self.told.values())), _MOST_S)

    # -------------------------------------------------------------- the others
    def _couple(self, scene: Scene, actor: str, own_s: float) -> None:
        """Adds the trailer behind a tractor, or the tractor before a trailer; uncoupled where they would touch another
        actor first."""
        track = scene.tracks[actor]
        for trailer, tractor in list(self.tractors.items()):
            other = self.actors[tractor if actor == trailer else trailer]
            if actor not in (trailer, tractor) or other.id in scene.tracks:
                continue
            gap = spacing_m(track.size, size_m(other)) * (1 if actor == trailer else -1)
            coupled = ahead_of(track.motion, gap, size_m(other))
            touches = any(actor in (c.striker, c.struck) for c in self.contacts[:1])
            brakes = other.id == tractor or not touches
            if scene.clear_until(scene.poses(coupled, own_s, brakes=brakes), coupled.size, 0.0) <= scene.contact:
                self.notes.append(f"{trailer} is not towed by {tractor}: it would touch somebody first")
                del self.tractors[trailer]
                continue
            scene.add(other.id, other.kind, coupled, own_s, brakes=brakes)
            scene.hitches.append((tractor, trailer, coupling_m(scene.tracks[tractor].size)))

    def rest(self, scene: Scene) -> None:
        """Places all remaining actors that are not struck on the way, clear of the others."""
        aside = {strike.thing.id for strike in self.early}
        for actor in self.behavior.actors:
            if actor.id in scene.tracks or self.tractors.get(actor.id) or actor.id in self.things | aside:
                continue
            ahead = stand_ahead(scene, actor, self.behavior, self.courses)
            role = (self.role if self.possible else self.alone)(actor.id) if not ahead else None
            if role and (note := place_clear(scene, role, passes=bool(scene.tracks) and actor.id not in self.told)):
                self.notes.append(note)
            track = scene.tracks[actor.id]
            self._couple(scene, actor.id, track.own_s + scene.contact * STEP_S * (not track.motion.standing))

    def alone(self, name: str) -> Role:
        """An actor where nothing is touched: it leaves the road as told."""
        role, told = self.role(name), self.told.get(name, CourseTold())
        leaves = departs(role.actor.maneuver, told.departs)
        if self.behavior.near_crash or not (leaves or told.lost_control):
            return role
        at = departure_station(role.course, role.actor.maneuver, role.place.station_m, beyond=told.beyond)
        lost = replace(role, told=told, untouched=not leaves, place=role.place._replace(station_m=at))
        return with_room(replace(lost, may_skid=told.lost_control and (leaves or told.rolls)))

    def role(self, name: str) -> Role:
        """An actor at its usual place, for an encounter with another one."""
        actor, course = self.actors[name], self.courses[name]
        place = Place(preferred_station(actor, course, size_m(actor)[0]), 0.0, 0.0, 0.0)
        return Role(actor, course, size_m(actor), place, surface=self.behavior.surface)
