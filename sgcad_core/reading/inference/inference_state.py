"""What was read and what is settled so far, handed between the steps of inference. Angles are clockwise degrees."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from sgcad_core.reading.actors.people_objects import Lies, WalkDirection
from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.contacts.contact_records import ContactFacts, ContactMention
from sgcad_core.reading.contacts.crash_course import CoursesRead, ImpactRead
from sgcad_core.reading.contacts.near_crash import NearMiss
from sgcad_core.reading.contacts.untouched_events import Untouched
from sgcad_core.reading.motion.motion_record import Source, VehicleMotion
from sgcad_core.reading.text.area_phrases import Zone
from sgcad_core.records.course import Hand
from sgcad_core.records.specs import Area, Compass, Maneuver

TURN_DEG: dict[Maneuver, float] = {
    "turn_left": -50.0,
    "turn_right": 50.0,
    "u_turn": -110.0,
    "crossing_centerline": -10.0,
}
"""Heading change of a vehicle at the moment of contact, clockwise degrees: turns are seldom complete then."""
QUARTER_DEG: dict[Maneuver, float] = {"turn_left": -90, "turn_right": 90}
"""Heading change of a turn from one leg to another, clockwise degrees."""
HIT_FROM: dict[Area, float] = {"left": 90.0, "right": 270.0, "back": 0.0, "front": 180.0}
"""Heading of a striker relative to the vehicle whose side it hits with its front, clockwise degrees."""


@dataclass
class CrashTold:
    """What was read."""

    roster: Roster
    motions: dict[str, VehicleMotion]
    contact_mentions: tuple[ContactMention, ...]
    course: CoursesRead = field(default_factory=CoursesRead)
    impacts: tuple[ImpactRead, ...] = ()
    near: NearMiss | None = None
    """Of a report that tells no contact: `contact_mentions` are then those that did not come about."""
    walks: Mapping[str, WalkDirection] = field(default_factory=dict)
    """Directions of pedestrians and others without a number, by their word in `contact_mentions`."""
    hands: Mapping[str, Hand] = field(default_factory=dict)
    """On which hand things along the road lie, by their word in `contact_mentions`, where that is told."""
    missed: frozenset[frozenset[str]] = frozenset()
    """Pairs that the text tells to have nearly touched."""
    untouched: Untouched | None = None
    """Of a report that tells no contact: what happens instead."""
    lying: Mapping[str, Lies] = field(default_factory=dict)
    """How things lie in the road, by their word in `contact_mentions`, where that is told."""


@dataclass
class CrashInferred:
    """What follows."""

    headings: dict[str, Compass] = field(default_factory=dict)
    stated: set[str] = field(default_factory=set)
    exits: dict[str, Compass] = field(default_factory=dict)
    maneuvers: dict[str, Maneuver] = field(default_factory=dict)
    told_maneuvers: set[str] = field(default_factory=set)
    sources: dict[str, Source] = field(default_factory=dict)
    """Where "V1 heading", "V1 maneuver" and "V1 speed" were read, as far as they were."""
    speeds: dict[str, int] = field(default_factory=dict)
    contacts: list[ContactFacts] = field(default_factory=list)
    started: set[str] = field(default_factory=set)
    """Vehicles that are told to have stood, and must have moved on to be in the contact as it is told."""


def end_of(zone: Zone | None) -> Area | None:
    """A corner's end; an area as it is."""
    return zone.split("/")[0] if zone else None  # type: ignore[return-value]


def side_met(zone: Zone | None) -> Area | None:
    """The side that meets a thing: a rear corner's flank, since nothing strikes it that does not back; else as
    `end_of`."""
    corner = (zone or "").split("/")
    return corner[1] if len(corner) == 2 and corner[0] == "back" else end_of(zone)  # type: ignore[return-value]


def bend_deg(maneuver: Maneuver, own: Area | None, other: Area | None) -> float:
    """Heading change at contact, clockwise degrees: little where a turning vehicle's front finds a flank."""
    early = own == "front" and other in ("left", "right", "back")
    return TURN_DEG.get(maneuver, 0.0) * (0.3 if early else 1.0)


def apart(a: float, b: float) -> float:
    """Unsigned difference of two angles, degrees in [0, 180]."""
    return abs((a - b + 180) % 360 - 180)


def side_hit(from_deg: float) -> Area:
    """The side that a vehicle heading `from_deg` clockwise of mine hits with its front."""
    return min(HIT_FROM, key=lambda area: apart(HIT_FROM[area], from_deg))


def is_sideswipe(mention: ContactMention) -> bool:
    """Whether the verb of the contact says that flanks touched."""
    return mention.words.startswith(("sideswip", "side-swip", "side-slap", "sideslap"))
