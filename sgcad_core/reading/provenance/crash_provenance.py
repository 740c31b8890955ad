"""Facts with their sentences: what was read of vehicles, contacts and conditions, one record each.

Everything that a report's reading holds becomes a `Fact`: stated in a sentence, inferred from what is stated, or a
default where nothing is. Knows no road (see `sgcad_core.reading.provenance.road_provenance`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sgcad_core.reading.actors.vehicles import VehicleDescription
from sgcad_core.reading.contacts.contact_records import ContactFacts, ContactMention
from sgcad_core.reading.contacts.near_crash import RETURNS
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.inference.inference_state import CrashInferred, CrashTold
from sgcad_core.reading.motion.maneuvers import meant_turn
from sgcad_core.reading.motion.motion_record import Source, WeightedValue
from sgcad_core.reading.text.compass import between
from sgcad_core.reading.text.normalise import Sentence
from sgcad_core.records.course import CourseTold
from sgcad_core.records.facts import Fact, Value
from sgcad_core.records.specs import Area


@dataclass(frozen=True)
class Confidence:
    """Confidence of facts before any measurement: plain figures, to be calibrated on truth.

    Stated by the report itself; by a quoted person or by its codes; following from what is stated; answered by a model;
    assumed. `conflict`: factor where the report also says otherwise.
    """

    stated: float = 0.9
    quoted: float = 0.7
    inferred: float = 0.5
    model: float = 0.5
    default: float = 0.2
    conflict: float = 0.6


CONFIDENCE = Confidence()
_QUOTED = ("interview", "codes", "factors", "police", "health", "injury")
"""Roles of sentences that retell a crash, or sum it up."""


@dataclass(frozen=True)
class FactBuilder:
    """Makes facts of what was read in these sentences."""

    sentences: Sequence[Sentence]

    def stated(self, field: str, value: Value, source: Source | None, conflict: bool = False) -> Fact:
        """A fact of a sentence; without one it was put together from several and counts as inferred."""
        if source is None:
            return self.inferred(field, value, "several sentences")
        quoted = self.sentences[source.number].role in _QUOTED
        sure = (CONFIDENCE.quoted if quoted else CONFIDENCE.stated) * (CONFIDENCE.conflict if conflict else 1.0)
        return self._fact(field, value, "stated", source.rule, source, sure)

    def inferred(self, field: str, value: Value, rule: str, source: Source | None = None) -> Fact:
        """A fact that follows from others; `source`: the sentence that suggests it."""
        return self._fact(field, value, "inferred", rule, source, CONFIDENCE.inferred)

    def _fact(self, field: str, value: Value, status: str, rule: str, source: Source | None, confidence: float) -> Fact:
        start, end = self.sentences[source.number][4:] if source else (0, 0)
        place = {"start": start, "end": end} if end > start else {}  # coded fields have no place in a narrative
        sure = round(confidence, 3)
        told = {"field": field, "value": value, "basis": "text", "status": status, "rule": rule, "confidence": sure}
        return Fact.model_validate(told | place)


def default(field: str, value: Value, rule: str) -> Fact:
    """A fact that no sentence tells."""
    return Fact(field=field, value=value, basis="default", status="default", rule=rule, confidence=CONFIDENCE.default)


class StageResults(NamedTuple):
    """What the stages left: as read, as settled, as it stands."""

    crash_told: CrashTold
    inferred: CrashInferred
    crash: CrashFacts
    sky: dict[str, Source]


def crash_provenance(builder: FactBuilder, read: StageResults) -> Iterator[Fact]:
    """Facts of vehicles, what else was hit, contacts and conditions."""
    for v, identity in zip(read.crash.vehicles, read.crash_told.roster.vehicles, strict=True):
        yield from _identity(builder, v, identity)
        yield from _motion(builder, v, read)
    for other in read.crash.others:
        source = next((b.source for b in read.crash_told.contact_mentions if b.other == other.word), None)
        yield builder.stated(f"others.{other.id}.kind", other.kind, source)
        yield builder.stated(f"others.{other.id}.word", other.word, source)
    for number, contact in enumerate(read.crash.contacts):
        yield from _contact(builder, f"contacts.{number}", contact, read)
    yield from _evasions(builder, read)
    yield from _conditions(builder, read)


def _evasions(builder: FactBuilder, read: StageResults) -> Iterator[Fact]:
    """What was done to avoid a near crash; going back into a lane apart."""
    sources = {e.vehicle: e.source for e in read.crash_told.near.evasions} if read.crash_told.near else {}
    for vehicle, maneuver in read.crash.near_crash.evasions if read.crash.near_crash else ():
        name = "back_in_lane" if sources[vehicle].rule == RETURNS else "evasion"
        yield builder.stated(f"near_crash.{vehicle}.{name}", maneuver, sources[vehicle])


# ------------------------------------------------------------------ vehicles
def _identity(builder: FactBuilder, v: VehicleFacts, identity: VehicleDescription) -> Iterator[Fact]:
    at = f"vehicles.{v.id}"
    described = {name: _described(identity, word) for name, word in (("make", v.make), ("model", v.model))}
    year = _described(identity, str(v.year)) if v.year else None
    if identity.kind_stated:
        yield builder.stated(f"{at}.kind", v.kind, described["model"] or next(iter(identity.described), None))
    elif described["model"] or described["make"]:
        yield builder.inferred(f"{at}.kind", v.kind, "makes.kind_of", described["model"] or described["make"])
    else:
        yield default(f"{at}.kind", v.kind, "a vehicle is a car unless more is told")
    if v.year:
        yield builder.stated(f"{at}.year", v.year, year)
    if v.make:
        yield builder.stated(f"{at}.make", v.make, described["make"] or year)
    if v.model:
        yield builder.stated(f"{at}.model", v.model, described["model"])
    if v.trailer:
        yield builder.stated(f"{at}.trailer", True, _described(identity, "trailer"))


def _described(identity: VehicleDescription, word: str | None) -> Source | None:
    """The first description that has a word."""
    having = (c for c in identity.described if word and word.lower() in c.words.lower())
    found = next(having, None)
    return found._replace(words=str(word), rule="vehicles.description") if found else None


def _motion(builder: FactBuilder, v: VehicleFacts, read: StageResults) -> Iterator[Fact]:
    at, motion, sources = f"vehicles.{v.id}", read.crash_told.motions[v.id], read.inferred.sources
    yield from _heading(builder, v, read)
    if v.exit_heading:
        yield builder.stated(f"{at}.exit_heading", v.exit_heading, motion.sources.get(f"exit {v.exit_heading}"))
    yield from _maneuver(builder, v, sources.get(f"{v.id} maneuver"))
    meant = meant_turn(motion)
    if meant and meant.cue:
        yield builder.stated(f"{at}.meant_maneuver", meant.maneuver, meant.cue.source)
    for name, value in (("lane", motion.lane), ("lane_word", v.lane_word), ("to_lane", v.to_lane)):
        if value is not None:
            yield builder.stated(f"{at}.{name}", value, motion.sources.get("to_lane" if name == "to_lane" else "lane"))
    if v.lane is not None and motion.lane is None:
        yield builder.inferred(f"{at}.lane", v.lane, "infer.lane_before", motion.sources.get("to_lane"))
    if v.speed_mph is not None:
        conflict = _differ(motion.speeds_mph, 3)
        yield builder.stated(f"{at}.speed_mph", v.speed_mph, sources.get(f"{v.id} speed"), conflict)
    for name, place in (("origin", v.origin), ("target", v.target)):
        if place is not None:
            yield builder.stated(f"{at}.{name}", place, motion.sources.get(name))
    if v.from_stop:
        stop = motion.cue("stopped") or motion.cue("parked")
        yield builder.stated(f"{at}.from_stop", True, stop.source if stop else None)
    if v.comes:
        stop = motion.cue("stopped") or motion.cue("slowing")
        yield builder.stated(f"{at}.comes", v.comes, stop.source if stop else None)
    if v.straddles:
        yield builder.stated(f"{at}.straddles", v.straddles, motion.sources.get("straddles"))


def _heading(builder: FactBuilder, v: VehicleFacts, read: StageResults) -> Iterator[Fact]:
    field, first = f"vehicles.{v.id}.heading", read.crash.vehicles[0]
    if v.heading is None:
        return
    if v.heading_stated:
        motion = read.crash_told.motions[v.id]
        turns = {v.maneuver, v.meant} & {"turn_left", "turn_right", "u_turn"}
        ways = {h.value for h in motion.headings if turns and f"exit {h.value}" in motion.sources} - {v.heading}
        other = [h for h in motion.headings if h.value not in ways]
        faced = v.maneuver == "parked" and f"faces {v.heading}" in motion.sources
        conflict = not faced and _differ(other)  # the way that it turned to is no second heading
        yield builder.stated(field, v.heading, read.inferred.sources.get(f"{v.id} heading"), conflict)
    elif v is first and not read.crash.oriented:
        yield default(field, v.heading, "the first vehicle heads along its road, north if none is told")
    else:
        source = read.inferred.sources.get(f"{v.id} heading") or _told_beside(v, read)
        yield builder.inferred(field, v.heading, "relative.heading", source)


def _told_beside(v: VehicleFacts, read: StageResults) -> Source | None:
    """The words that tell a vehicle to drive the way of another one, or the opposite one, if it is read so."""
    motions = read.crash_told.motions
    if v.maneuver == "merge" and (joined := motions[v.id].sources.get(f"exit {v.heading}")):
        return joined
    for other in read.crash.vehicles:
        if other.id == v.id or other.heading is None or v.heading is None:
            continue
        relation = {0: "same", 180: "opposite"}.get(between(other.heading, v.heading))
        for me, you in ((v.id, other.id), (other.id, v.id)):
            if relation and (source := motions[me].sources.get(f"{relation} {you}")):
                return source
    return None


def _differ(heard: Sequence[WeightedValue], slack: int = 0) -> bool:
    """Whether the best witnesses tell different values; numbers may be off by the slack."""
    best = max((h.weight for h in heard), default=0)
    values = [h.value for h in heard if h.weight == best]
    if slack:
        return bool(values) and max(values) - min(values) > slack
    return len(set(values)) > 1


def _maneuver(builder: FactBuilder, v: VehicleFacts, source: Source | None) -> Iterator[Fact]:
    field = f"vehicles.{v.id}.maneuver"
    if v.maneuver_stated:
        yield builder.stated(field, v.maneuver, source)
    elif source:
        yield builder.inferred(field, v.maneuver, source.rule, source)
    else:
        yield default(field, v.maneuver, "who is told to do nothing else drives straight on")


# ------------------------------------------------------------------ contacts and conditions
def _contact(builder: FactBuilder, at: str, contact: ContactFacts, read: StageResults) -> Iterator[Fact]:
    names = {o.id: o.word for o in read.crash.others}
    struck = names.get(contact.struck, contact.struck)
    told = [b for b in read.crash_told.contact_mentions if {b.actor, b.other} == {contact.striker, struck}]
    source = told[0].source if told else None
    for role, name in (("striker", contact.striker), ("struck", contact.struck)):
        known = contact.stated and source
        yield builder.stated(f"{at}.{role}", name, source) if known else builder.inferred(f"{at}.{role}", name, "infer")
    may = {"striker": contact.striker_may, "struck": contact.struck_may}
    areas: tuple[tuple[str, str, Area], ...] = (
        ("striker", contact.striker, contact.striker_area), ("struck", struck, contact.struck_area),
    )  # fmt: skip
    for role, name, area in areas:
        yield _area(builder, f"{at}.{role}_area", area, _telling_area(told, name), len(may[role]))


def _telling_area(told: Sequence[ContactMention], name: str) -> list[ContactMention]:
    """The tellings of a contact that say where one of both was touched."""
    return [b for b in told if b.areas_of(name)[0]]


def _area(builder: FactBuilder, field: str, area: Area, told: Sequence[ContactMention], open_sides: int) -> Fact:
    source = told[0].source if told else None
    if source and open_sides == 1:
        return builder.stated(field, area, source)
    rule = "sides.corner" if source else "sides.from headings and maneuvers"
    return builder.inferred(field, area, rule, source)


def _conditions(builder: FactBuilder, read: StageResults) -> Iterator[Fact]:
    crash = read.crash
    for name, value in (("light", crash.light), ("weather", crash.weather), ("surface", crash.surface)):
        if value is None:
            continue
        if name in read.sky:
            yield builder.stated(f"conditions.{name}", value, read.sky[name])
        else:
            yield builder.inferred(f"conditions.{name}", value, "surface follows weather", read.sky.get("weather"))


_REST = ("facing_deg", "where", "side", "attitude", "against", "distance_m", "lane", "lane_way")
_OWN = (
    "pace", "stops", "lost_control", "yaws", "departs", "beyond", "spin", "spin_deg", "rolls", "roll_quarters",
    "rolls_to", "leaves",
)  # fmt: skip


def course_provenance(builder: FactBuilder, crash: CrashTold) -> Iterator[Fact]:
    """Facts of every vehicle's course, then of what else was hit, in order."""
    for vehicle, course in crash.course.courses.items():
        for name, value, told_as in _course_values(course):
            source = crash.course.sources.get(f"{vehicle} {told_as}")
            yield builder.stated(f"vehicles.{vehicle}.{name}", value, source)
    if (event := crash.untouched) is not None:
        yield builder.stated(f"vehicles.{event.vehicle}.event", event.kind, event.source)
    for number, (impact, source, _) in enumerate(crash.impacts):
        for name in ("actor", "other", "actor_area", "other_area"):
            if (told := getattr(impact, name)) is not None:
                yield builder.stated(f"impacts.{number}.{name}", told, source)


def _course_values(course: CourseTold) -> Iterator[tuple[str, Value, str]]:
    """(field, value, where its source stands) of what is told."""
    if course.brakes:
        yield "evasion.brakes", True, "brakes"
    if course.steers:
        yield "evasion.steers", course.steers, "steers"
    if course.no_evasion and not (course.brakes or course.steers):
        yield "evasion.none", True, "no_evasion"
    for name in _OWN:
        if value := getattr(course, name):
            yield name, value, name
    for number, move in enumerate(course.moves):
        yield f"moves.{number}", move.words, f"moves.{number}"
    for name in _REST:
        if (value := getattr(course.rest, name)) is not None:
            yield f"rest.{name}", value, f"rest.{name}"
