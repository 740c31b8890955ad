"""Facts on a road network: every vehicle gets a road, a direction, a lane and an exit.

Places are chosen so that travel headings fit the text, the pair in contact can meet, and turns exist; what
does not fit costs, and the cheapest choice stands. Works on any road spec. Knows no narrative.
"""

from __future__ import annotations

from collections.abc import Mapping

from sgcad_core.errors import Refused
from sgcad_core.kinds import RAMP, actor_kind
from sgcad_core.reading.behavior.added_objects import in_gore, with_roadside
from sgcad_core.reading.behavior.exit_assignment import Placed, assign, square_rad
from sgcad_core.reading.behavior.lane_choice import lane_of
from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.contacts.near_crash import NearCrashFacts
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.layout.road_ways import Way
from sgcad_core.records.acts import acts_of
from sgcad_core.records.course import Courses, CourseTold
from sgcad_core.records.specs import (  # fmt: skip
    Actor,
    BehaviorSpec,
    Contact,
    Evasion,
    Maneuver,
    NearCrash,
    RoadSpec,
    is_aisle,
)
from sgcad_core.records.words import SignalState

"""Length of what such a vehicle tows, hitch included, metres."""
_LONGEST_M = 30.0
_SHIFTS: tuple[Maneuver, ...] = ("lane_change_left", "lane_change_right")
"""From a ramp these are merges: the lane that one changes to is that of the road."""
_MOST_ACTORS, _MOST_CONTACTS = 12, 8


def behavior_of_facts(facts: CrashFacts, spec: RoadSpec) -> BehaviorSpec:
    """The crash on that network. Raises Refused where the text tells no crash or names no vehicle."""
    if facts.gap:
        raise Refused(facts.gap.reason, list(facts.gap.missing))
    if not facts.vehicles:
        raise Refused("the narrative names no vehicle", ["which vehicles were involved", "how they traveled"])
    vehicles = facts.vehicles[:_MOST_ACTORS]
    placed = assign(facts, spec)
    actors = [_actor(v, placed, facts) for v in vehicles]
    contacts = [c for c in facts.contacts if all(x in {a.id for a in actors} for x in (c.striker, c.struck))]
    if not contacts:
        actors, contacts = _with_others(actors, facts)
    near = _near_crash(facts, contacts)
    actors = in_gore(actors, [_contact(c) for c in contacts], facts.gore, spec)
    met = [] if near else [_contact(c) for c in contacts[:_MOST_CONTACTS]]
    everyone, joined = with_roadside(actors, met, facts, (_MOST_ACTORS, _MOST_CONTACTS))
    return BehaviorSpec(
        actors=everyone, contacts=joined,
        light=facts.light, weather=facts.weather, surface=facts.surface, near_crash=near,
    )  # fmt: skip


def _near_crash(facts: CrashFacts, contacts: list[ContactFacts]) -> NearCrash | None:
    """The avoided contact of a near crash, and the evasions; None of a report that tells a contact."""
    near = facts.near_crash
    return None if near is None or not contacts else near_crash_of(near, _contact(contacts[0]))


def as_read(behavior: BehaviorSpec, facts: CrashFacts) -> BehaviorSpec:
    """An answered behavior with its first contact as avoided, where the text tells a near crash; else unchanged."""
    near = facts.near_crash
    if near is None or not near.stated or not behavior.contacts:
        return behavior
    return behavior.model_copy(update={"contacts": (), "near_crash": near_crash_of(near, behavior.contacts[0])})


def with_acts_read(behavior: BehaviorSpec, courses: Courses, signals: Mapping[str, SignalState]) -> BehaviorSpec:
    """The behavior with what the text tells of vehicles beside their maneuvers; `signals`: the told state by id."""
    told = {who: acts_of(courses.get(who, CourseTold()), signals.get(who)) for who in {*courses, *signals}}
    actors = tuple(actor.model_copy(update={"acts": told.get(actor.id)}) for actor in behavior.actors)
    return behavior.model_copy(update={"actors": actors})


def near_crash_of(near: NearCrashFacts, conflict: Contact) -> NearCrash:
    """A told near crash on a conflict."""
    pair = (conflict.striker, conflict.struck)
    evasions = tuple(Evasion(actor=who, maneuver=how) for who, how in near.evasions if who in pair)
    return NearCrash(conflict=conflict, evasions=evasions, clearance_m=near.clearance_m)


def _actor(v: VehicleFacts, placed: dict[str, Placed], facts: CrashFacts) -> Actor:
    place = placed[v.id]
    return Actor(
        id=v.id, kind=v.kind, road=place.way.road.id, direction=place.way.direction,
        lane=lane_of(v, placed, facts), exit_road=place.exit.road.id if place.exit else None,
        maneuver=_maneuver(v, place.way),
        speed_mph=_speed_mph(v), length_m=_length(v),
    )  # fmt: skip


def _maneuver(v: VehicleFacts, way: Way) -> Maneuver:
    """As told; a lane change from a ramp is a merge; one to the left of the only lane crosses the middle of the road; a
    vehicle parked along an aisle with stalls is stopped in it."""
    if way.road.kind == RAMP and v.maneuver in _SHIFTS:
        return "merge"
    two_way = way.road.lanes_forward and way.road.lanes_backward
    if v.maneuver == "lane_change_left" and way.lanes == 1 and two_way and way.road.median in ("none", "painted"):
        return "crossing_centerline"
    along = is_aisle(way.road) and v.heading_stated and not square_rad(v, way)
    return "stopped" if along and v.maneuver == "parked" else v.maneuver


def _speed_mph(v: VehicleFacts) -> int | None:
    """As told of a vehicle that moves; else None, the planner's choice."""
    return None if v.standing else v.speed_mph


def _length(v: VehicleFacts) -> float | None:
    """A vehicle with a trailer is one long box: the trailer is part of the numbered vehicle."""
    record = actor_kind(v.kind)
    if not v.trailer or record.trailer_m is None:
        return None
    return min(record.length_m + record.trailer_m, _LONGEST_M)


def _contact(c: ContactFacts) -> Contact:
    return Contact(striker=c.striker, struck=c.struck, striker_area=c.striker_area, struck_area=c.struck_area)


def _with_others(actors: list[Actor], facts: CrashFacts) -> tuple[list[Actor], list[ContactFacts]]:
    """A crash without a second vehicle: the first thing or person that was hit joins in."""
    ids = {a.id for a in actors}
    hits = [c for c in facts.contacts if c.striker in ids and any(o.id == c.struck for o in facts.others)]
    if not hits:
        return actors, []
    other = next(o for o in facts.others if o.id == hits[0].struck)
    driver = next(a for a in actors if a.id == hits[0].striker)
    joined = Actor(
        id=other.id, kind=other.kind, road=driver.road, direction=driver.direction,
        maneuver="straight" if actor_kind(other.kind).exposed else "stopped",
    )  # fmt: skip
    return [*actors, joined], hits[:1]
