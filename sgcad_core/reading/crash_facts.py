"""The facts of a crash as its narrative tells them: vehicles with their motion, contacts, conditions.

Records, and how they are put together from what was read and inferred. What the text leaves open is inferred from what
it says (relation words, critical events, the sides that touched) and marked as such. Knows no road network.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace

from sgcad_core.kinds import CHANGES, actor_kind
from sgcad_core.reading.actors.people_objects import OtherFacts, WalkDirection, others, side_facing
from sgcad_core.reading.actors.vehicles import VehicleDescription
from sgcad_core.reading.contacts.contact_records import ContactFacts, leading_end
from sgcad_core.reading.contacts.near_crash import NearCrashFacts
from sgcad_core.reading.contacts.untouched_events import Untouched
from sgcad_core.reading.inference.gaps import Gap
from sgcad_core.reading.inference.inference_state import CrashInferred, CrashTold, end_of, side_met
from sgcad_core.reading.inference.told_stops import comes_to_stop
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.maneuvers import meant_turn
from sgcad_core.reading.motion.motion_record import Access, VehicleMotion
from sgcad_core.reading.text.conditions import Conditions
from sgcad_core.reading.text.speeds import with_impact_speeds
from sgcad_core.records.course import ComesTo, Courses, CourseTold, Hand, ImpactTold
from sgcad_core.records.specs import ActorKind, Area, Compass, Light, Maneuver, Surface, Weather
from sgcad_core.records.timeline import Act, of_actor, starts_from_rest

FROM_STOP_MPH = 12
"""More than a vehicle that has just started from a stop can drive: after 7 m at 2 m/s^2."""


@dataclass(frozen=True)
class VehicleFacts:
    """One numbered vehicle. None: neither told nor to be inferred."""

    id: str
    kind: ActorKind
    year: int | None = None
    make: str | None = None
    model: str | None = None
    heading: Compass | None = None
    """Initial heading of travel, before any turn."""
    heading_stated: bool = False
    """False: inferred from the other vehicle, or just assumed where `CrashFacts.oriented` is False."""
    exit_heading: Compass | None = None
    """Heading it turned to or meant to turn to, where told."""
    maneuver: Maneuver = "straight"
    maneuver_stated: bool = False
    lane: int | None = None
    """1 = at the right curb; where counted from the left -1 = the leftmost."""
    lane_word: str | None = None
    """left, right, middle, left_turn, right_turn, center_turn (a two-way left-turn lane)."""
    to_lane: int | str | None = None
    """The lane into which it changes, as `lane` or `lane_word`."""
    speed_mph: int | None = None
    trailer: bool = False
    origin: Access | None = None
    """driveway, parking_lot, ramp, shoulder: where it came from, if not from a road."""
    target: Access | None = None
    """driveway or parking_lot that it turned or meant to turn into."""
    meant: Maneuver | None = None
    """The turn that it meant to make, where told; `maneuver` is what it did."""
    from_stop: bool = False
    """Whether it had just started from a stop."""
    straddles: Hand | None = None
    """The hand on which the lane lies over whose line it stands."""
    comes: ComesTo | None = None
    """How it comes to the stop at which it stands; None: it is only told to stand."""
    faces: bool = False
    """Whether the told heading is the facing: a vehicle that backs then goes the other way."""

    @property
    def standing(self) -> bool:
        """Whether it does not move before the contact."""
        return self.maneuver in ("stopped", "parked")


@dataclass(frozen=True)
class CrashFacts:
    """A crash as told."""

    vehicles: tuple[VehicleFacts, ...]
    others: tuple[OtherFacts, ...] = ()
    contacts: tuple[ContactFacts, ...] = ()
    light: Light | None = None
    weather: Weather | None = None
    surface: Surface | None = None
    slight: bool = False
    """Whether all that is told of the blow speaks of a slight one."""
    courses: Courses = field(default_factory=dict)
    """Evasion, spin and rest by vehicle, of those of which anything is told."""
    impacts: tuple[ImpactTold, ...] = ()
    """Contacts behind the first one with things, and of the same pair once more, in order."""
    near_crash: NearCrashFacts | None = None
    """Set for a near crash: the first of `contacts` is the one that was avoided."""
    untouched: Untouched | None = None
    """What happens to a lone vehicle that touches nothing: `contacts` is then empty."""
    oriented: bool = False
    """Whether any heading is told: if not, all headings are right only relative to one another."""
    unnumbered: bool = False
    """Whether the report has no vehicle numbers: V1 is its subject."""
    gore: Mapping[str, str] = field(default_factory=dict)
    """Vehicles in a gore, and what they do there (`places.InGore`)."""
    gap: Gap | None = None
    """Why no crash can be drawn from the text, if so."""

    @property
    def driven(self) -> Courses:
        """The courses as they are planned: with the start from rest and the stop of the vehicles that are read so, and
        the corners that touch first."""
        corners = dict(self._corners())
        told = {
            v.id: replace(
                self.courses.get(v.id, CourseTold()), from_rest=v.from_stop, straddles=v.straddles,
                comes=v.comes if v.maneuver == "stopped" else None, slight=self.slight, corner=corners.get(v.id),
            )
            for v in self.vehicles if v.from_stop or v.straddles or v.comes or self.slight or v.id in corners
        }  # fmt: skip
        return {**self.courses, **told, **self._departing(told)}

    def _corners(self) -> Iterator[tuple[str, tuple[Area, Area]]]:
        """The vehicles of the first contact of which a corner touches, with its end and its flank."""
        for contact in self.contacts[:1]:
            for name, may in ((contact.striker, contact.striker_may), (contact.struck, contact.struck_may)):
                ends, flanks = [a for a in may if a in ("front", "back")], [a for a in may if a in ("left", "right")]
                if len(ends) == len(flanks) == 1:
                    yield name, (ends[0], flanks[0])

    def _departing(self, courses: Courses) -> Courses:
        """The courses of vehicles whose departure only the thing beside the road implies that they strike first."""
        beside = rule("departures.roadside")
        aside = (other for other in self.others if other.lies is None)
        things = {other.id: other for other in aside if other.hand or beside.search(other.word)}
        found = {}
        for v in self.vehicles:
            course = courses.get(v.id) or self.courses.get(v.id, CourseTold())
            first = self.first_contact(v.id)
            if first is not None and first.striker == v.id and first.struck in things and course.departs is None:
                found[v.id] = replace(course, departs=things[first.struck].hand or "either")
        return found

    def vehicle(self, id: str) -> VehicleFacts | None:
        """The vehicle of that number."""
        return next((v for v in self.vehicles if v.id == id), None)

    def first_contact(self, id: str) -> ContactFacts | None:
        """The first contact of an actor."""
        return next((c for c in self.contacts if id in (c.striker, c.struck)), None)

    def first_met(self, id: str) -> VehicleFacts | None:
        """The vehicle that an actor touches first; None where it touches nothing, or something else."""
        first = self.first_contact(id)
        return self.vehicle(first.struck if first.striker == id else first.striker) if first else None


_SURFACE: dict[Weather | None, Surface] = {"rain": "wet", "snow": "snow", "sleet": "ice"}
"""Surface where only the weather is told."""


_FROM_REST: tuple[Maneuver, ...] = ("straight", "merge", "turn_left", "turn_right", "u_turn", "overtaking")
"""Maneuvers that a vehicle may begin at rest."""


def _vehicle(
    v: VehicleDescription, motion: VehicleMotion, inferred: CrashInferred, acts: tuple[Act, ...]
) -> VehicleFacts:
    """One vehicle's facts put together."""
    meant = meant_turn(motion, inferred.maneuvers[v.id])
    from_stop = inferred.maneuvers[v.id] in _FROM_REST and starts_from_rest(of_actor(acts, v.id))
    over = from_stop and inferred.speeds.get(v.id, 0) > FROM_STOP_MPH and _told_before_stop(motion, inferred, v.id)
    return VehicleFacts(
        id=v.id, kind=v.kind, year=v.year, make=v.make, model=v.model,
        heading=inferred.headings.get(v.id), heading_stated=v.id in inferred.stated,
        exit_heading=inferred.exits.get(v.id), maneuver=inferred.maneuvers[v.id],
        maneuver_stated=v.id in inferred.told_maneuvers,
        lane=motion.lane or _lane_before(motion, inferred.maneuvers[v.id]), lane_word=motion.lane_word,
        to_lane=motion.to_lane, speed_mph=None if over else inferred.speeds.get(v.id),
        trailer=v.trailer, origin=motion.origin, target=motion.target,
        meant=meant.maneuver if meant else None, from_stop=from_stop,
        straddles=motion.straddles if inferred.maneuvers[v.id] in ("stopped", "parked") else None,
        comes=comes_to_stop(of_actor(acts, v.id)) if inferred.maneuvers[v.id] == "stopped" else None,
        faces=_faces(motion, inferred.headings.get(v.id)),
    )  # fmt: skip


def _lane_before(motion: VehicleMotion, maneuver: Maneuver) -> int | None:
    """The lane beside the one into which it changes, where none is told: 1 at the right curb, -1 the leftmost."""
    side = CHANGES.get(maneuver, 0)
    told = {"right": 1, "left": -1}.get(motion.to_lane, 0) if isinstance(motion.to_lane, str) else motion.to_lane
    if motion.to_lane == "middle" and side and not motion.lane_word:
        return 1 if side > 0 else -1
    if not side or not told or motion.lane_word or told - side == 0:
        return None
    return told - side


def _faces(motion: VehicleMotion, heading: Compass | None) -> bool:
    """Whether a heading is where a vehicle faces: it is told so, or it is told to drive there before it backs."""
    if f"faces {heading}" in motion.sources or f"backs {heading}" in motion.sources:
        return f"faces {heading}" in motion.sources
    driven = next((told.source.number for told in motion.headings if told.value == heading), None)
    backs = next((cue.number for cue in motion.cues if cue.kind == "backing"), None)
    return motion.ordered or (driven is not None and backs is not None and driven < backs)


def _told_before_stop(motion: VehicleMotion, inferred: CrashInferred, vehicle: str) -> bool:
    """Whether the told speed is that of the approach to a stop from which the vehicle then started."""
    source = inferred.sources.get(f"{vehicle} speed")
    stops = [d.number for d in motion.cues if d.kind == "stopped"]
    return source is not None and bool(stops) and source.number <= max(stops)


def _without_vehicle(
    crash: CrashTold, inferred: CrashInferred, beside: tuple[OtherFacts, ...]
) -> tuple[ContactFacts, ...]:
    """What vehicles hit that has no number: things with the end that leads unless told, people on the side from which
    they are met as they go, their left one where that is not told."""
    ids = {o.word: o for o in beside}
    found: dict[str, ContactFacts] = {}
    for mention in crash.contact_mentions:
        other = ids.get(mention.other)
        if other and other.id not in found:
            backs = inferred.maneuvers.get(mention.actor) == "backing"
            side_told = end_of(mention.actor_area) if backs else side_met(mention.actor_area)
            area = side_told or leading_end(inferred.maneuvers.get(mention.actor, "other"))
            faces = (
                side_facing(crash.walks.get(mention.other, WalkDirection()), inferred.headings.get(mention.actor))
                or "left"
            )
            side: Area = "front" if actor_kind(other.kind).thing else faces
            found[other.id] = ContactFacts(mention.actor, other.id, area, side, False)
    return tuple(found.values())


def _subject_first(
    vehicles: tuple[VehicleFacts, ...], contacts: tuple[ContactFacts, ...]
) -> tuple[tuple[VehicleFacts, ...], tuple[ContactFacts, ...]]:
    """Moves the subject's own contact to the front: only the first one is sure to happen in a scenario.

    A vehicle that stood and was pushed into the subject stands until then. A vehicle that strikes the side of another
    and is told to have stood before is under way, which the report does not say.
    """
    mine = next((c for c in contacts if vehicles and vehicles[0].id in (c.striker, c.struck)), None)
    if mine is None or not mine.stated:
        return vehicles, contacts
    pair = {v.id: v for v in vehicles if v.id in (mine.striker, mine.struck)}
    aside = {mine.striker_area, mine.struck_area} & {"left", "right"}
    if aside and mine is contacts[0] and len(pair) == 2 and all(v.standing for v in pair.values()):
        came = pair[mine.striker]
        moving = replace(came, maneuver="straight", maneuver_stated=False)
        vehicles = tuple(moving if v is came else v for v in vehicles)
    return vehicles, (mine, *(c for c in contacts if c is not mine))


def crash_of(crash: CrashTold, inferred: CrashInferred, sky: Conditions, timeline: tuple[Act, ...] = ()) -> CrashFacts:
    """The crash that was read (`crash_told`) and what follows from it. A text that names no vehicle gives none."""
    vehicles = tuple(_vehicle(v, crash.motions[v.id], inferred, timeline) for v in crash.roster.vehicles)
    beside = others(crash.contact_mentions, crash.roster.ids, sum(v.beside for v in crash.roster.vehicles))
    beside = tuple(
        replace(other, hand=crash.hands.get(other.word), lies=crash.lying.get(other.word)) for other in beside
    )
    contacts = tuple(inferred.contacts) or _without_vehicle(crash, inferred, beside)
    if crash.roster.counted:
        vehicles, contacts = _subject_first(vehicles, contacts)
    if crash.near or not crash.roster.counted:  # labels of numbered reports hold the state at the contact throughout
        kept = () if crash.near else ("moves_off",)
        vehicles = tuple(v if v.comes in kept else replace(v, comes=None) for v in vehicles)
    return CrashFacts(
        vehicles,
        beside,
        contacts,
        sky.light,
        sky.weather,
        sky.surface or _SURFACE.get(sky.weather),
        slight=sky.slight and crash.roster.counted and crash.near is None,
        near_crash=_near(crash, inferred.maneuvers) if contacts else None,
        courses=with_impact_speeds(crash.course.courses, inferred.sources),
        impacts=tuple(read.impact for read in crash.impacts),
        untouched=crash.untouched,
        oriented=bool(inferred.stated),
        unnumbered=crash.roster.counted,
    )


def _near(crash: CrashTold, maneuvers: Mapping[str, Maneuver]) -> NearCrashFacts | None:
    near = crash.near
    if near is None:
        return None
    changes = {e.vehicle: CHANGES.get(maneuvers.get(e.vehicle, "other"), 0) for e in near.evasions}
    evasions = tuple((e.vehicle, how) for e in near.evasions if (how := e.beside(changes[e.vehicle])))
    return NearCrashFacts(evasions, near.clearance_m, bool(near.contact_mentions))


def with_turned_signals(crash: CrashFacts, turned: Collection[str]) -> CrashFacts:
    """The crash with the vehicles whose signals are told to have turned just before."""
    told = {who: replace(crash.courses.get(who, CourseTold()), signal_turned=True) for who in turned}
    return replace(crash, courses={**crash.courses, **told})
