"""Facts with their sentences: what was read of vehicles, contacts and conditions, one record each.

Everything that a report's reading holds becomes a `Fact`: stated in a sentence, inferred from what is stated, or a
default where nothing is. Knows no road (see `sgcad_core.reading.provenance.road_provenance`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sgcad_core.reading.actors.vehicles import Identity
from sgcad_core.reading.contacts.contact_telling import Blow
from sgcad_core.reading.crash_facts import ContactFacts, CrashFacts, VehicleFacts
from sgcad_core.reading.inference.inference_state import Draft, Settled
from sgcad_core.reading.motion.maneuvers import meant_turn
from sgcad_core.reading.motion.motion_record import Cue, Heard
from sgcad_core.reading.text.normalise import Sentence
from sgcad_core.records.facts import Fact, Value
from sgcad_core.records.specs import Area


@dataclass(frozen=True)
class Confidence:
    """How far a fact is believed before anything is measured: plain figures, to be calibrated on truth.

    Stated by the report itself; by somebody whom it quotes or by its codes; following from what is stated; answered by
    a model; assumed. `conflict`: what is left of it where the report also says otherwise.
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
class Telling:
    """Makes facts of what was read in these sentences."""

    sentences: Sequence[Sentence]

    def stated(self, field: str, value: Value, cue: Cue | None, conflict: bool = False) -> Fact:
        """A fact of a sentence; without one it was put together from several and counts as inferred."""
        if cue is None:
            return self.inferred(field, value, "several sentences")
        quoted = self.sentences[cue.number].role in _QUOTED
        sure = (CONFIDENCE.quoted if quoted else CONFIDENCE.stated) * (CONFIDENCE.conflict if conflict else 1.0)
        return self._fact(field, value, "stated", cue.rule, cue, sure)

    def inferred(self, field: str, value: Value, rule: str, cue: Cue | None = None) -> Fact:
        """A fact that follows from others; `cue`: the sentence that suggests it."""
        return self._fact(field, value, "inferred", rule, cue, CONFIDENCE.inferred)

    def _fact(self, field: str, value: Value, status: str, rule: str, cue: Cue | None, confidence: float) -> Fact:
        start, end = self.sentences[cue.number][4:] if cue else (0, 0)
        place = {"start": start, "end": end} if end > start else {}  # coded fields have no place in a narrative
        sure = round(confidence, 3)
        told = {"field": field, "value": value, "basis": "text", "status": status, "rule": rule, "confidence": sure}
        return Fact.model_validate(told | place)


def default(field: str, value: Value, rule: str) -> Fact:
    """A fact that nobody tells."""
    return Fact(field=field, value=value, basis="default", status="default", rule=rule, confidence=CONFIDENCE.default)


class Read(NamedTuple):
    """What the stages left: as read, as settled, as it stands."""

    draft: Draft
    settled: Settled
    crash: CrashFacts
    sky: dict[str, Cue]


def crash_provenance(telling: Telling, read: Read) -> Iterator[Fact]:
    """Facts of vehicles, what else was hit, contacts and conditions."""
    for v, identity in zip(read.crash.vehicles, read.draft.who.vehicles, strict=True):
        yield from _identity(telling, v, identity)
        yield from _motion(telling, v, read)
    for other in read.crash.others:
        cue = next((b.cue for b in read.draft.blows if b.other == other.word), None)
        yield telling.stated(f"others.{other.id}.kind", other.kind, cue)
        yield telling.stated(f"others.{other.id}.word", other.word, cue)
    for number, contact in enumerate(read.crash.contacts):
        yield from _contact(telling, f"contacts.{number}", contact, read)
    yield from _conditions(telling, read)


# ------------------------------------------------------------------ vehicles
def _identity(telling: Telling, v: VehicleFacts, identity: Identity) -> Iterator[Fact]:
    at = f"vehicles.{v.id}"
    described = {name: _described(identity, word) for name, word in (("make", v.make), ("model", v.model))}
    year = _described(identity, str(v.year)) if v.year else None
    if identity.kind_stated:
        yield telling.stated(f"{at}.kind", v.kind, described["model"] or next(iter(identity.described), None))
    elif described["model"] or described["make"]:
        yield telling.inferred(f"{at}.kind", v.kind, "makes.kind_of", described["model"] or described["make"])
    else:
        yield default(f"{at}.kind", v.kind, "a vehicle is a car unless more is told")
    if v.year:
        yield telling.stated(f"{at}.year", v.year, year)
    if v.make:
        yield telling.stated(f"{at}.make", v.make, described["make"] or year)
    if v.model:
        yield telling.stated(f"{at}.model", v.model, described["model"])
    if v.trailer:
        yield telling.stated(f"{at}.trailer", True, _described(identity, "trailer"))


def _described(identity: Identity, word: str | None) -> Cue | None:
    """The first description that has a word."""
    having = (c for c in identity.described if word and word.lower() in c.words.lower())
    found = next(having, None)
    return found._replace(words=str(word), rule="vehicles.description") if found else None


def _motion(telling: Telling, v: VehicleFacts, read: Read) -> Iterator[Fact]:
    at, motion, sources = f"vehicles.{v.id}", read.draft.motions[v.id], read.settled.sources
    yield from _heading(telling, v, read)
    if v.exit_heading:
        yield telling.stated(f"{at}.exit_heading", v.exit_heading, motion.sources.get(f"exit {v.exit_heading}"))
    yield from _maneuver(telling, v, sources.get(f"{v.id} maneuver"))
    meant = meant_turn(motion)
    if meant and meant.deed:
        yield telling.stated(f"{at}.meant_maneuver", meant.maneuver, meant.deed.cue)
    for name, value in (("lane", v.lane), ("lane_word", v.lane_word)):
        if value is not None:
            yield telling.stated(f"{at}.{name}", value, motion.sources.get("lane"))
    if v.speed_mph is not None:
        conflict = _differ(motion.speeds_mph, 3)
        yield telling.stated(f"{at}.speed_mph", v.speed_mph, sources.get(f"{v.id} speed"), conflict)
    for name, place in (("origin", v.origin), ("target", v.target)):
        if place is not None:
            yield telling.stated(f"{at}.{name}", place, motion.sources.get(name))
    if v.from_stop:
        stop = motion.deed("stopped")
        yield telling.inferred(f"{at}.from_stop", True, "maneuvers.started_from_stop", stop.cue if stop else None)


def _heading(telling: Telling, v: VehicleFacts, read: Read) -> Iterator[Fact]:
    field, first = f"vehicles.{v.id}.heading", read.crash.vehicles[0]
    if v.heading is None:
        return
    if v.heading_stated:
        conflict = _differ(read.draft.motions[v.id].headings)
        yield telling.stated(field, v.heading, read.settled.sources.get(f"{v.id} heading"), conflict)
    elif v is first and not read.crash.oriented:
        yield default(field, v.heading, "the first vehicle heads along its road, north if none is told")
    else:
        yield telling.inferred(field, v.heading, "relative.heading")


def _differ(heard: Sequence[Heard], slack: int = 0) -> bool:
    """Whether the best witnesses tell different values; numbers may be off by the slack."""
    best = max((h.weight for h in heard), default=0)
    values = [h.value for h in heard if h.weight == best]
    if slack:
        return bool(values) and max(values) - min(values) > slack
    return len(set(values)) > 1


def _maneuver(telling: Telling, v: VehicleFacts, cue: Cue | None) -> Iterator[Fact]:
    field = f"vehicles.{v.id}.maneuver"
    if v.maneuver_stated:
        yield telling.stated(field, v.maneuver, cue)
    elif cue:
        yield telling.inferred(field, v.maneuver, cue.rule, cue)
    else:
        yield default(field, v.maneuver, "who is told to do nothing else drives straight on")


# ------------------------------------------------------------------ contacts and conditions
def _contact(telling: Telling, at: str, contact: ContactFacts, read: Read) -> Iterator[Fact]:
    names = {o.id: o.word for o in read.crash.others}
    struck = names.get(contact.struck, contact.struck)
    told = [b for b in read.draft.blows if {b.actor, b.other} == {contact.striker, struck}]
    cue = told[0].cue if told else None
    for role, name in (("striker", contact.striker), ("struck", contact.struck)):
        known = contact.stated and cue
        yield telling.stated(f"{at}.{role}", name, cue) if known else telling.inferred(f"{at}.{role}", name, "infer")
    may = {"striker": contact.striker_may, "struck": contact.struck_may}
    areas: tuple[tuple[str, str, Area], ...] = (
        ("striker", contact.striker, contact.striker_area), ("struck", struck, contact.struck_area),
    )  # fmt: skip
    for role, name, area in areas:
        yield _area(telling, f"{at}.{role}_area", area, _telling_area(told, name), len(may[role]))


def _telling_area(told: Sequence[Blow], name: str) -> list[Blow]:
    """The tellings of a contact that say where one of both was touched."""
    return [b for b in told if (b.actor_area if b.actor == name else b.other_area)]


def _area(telling: Telling, field: str, area: Area, told: Sequence[Blow], open_sides: int) -> Fact:
    cue = told[0].cue if told else None
    if cue and open_sides == 1:
        return telling.stated(field, area, cue)
    rule = "sides.corner" if cue else "sides.from headings and maneuvers"
    return telling.inferred(field, area, rule, cue)


def _conditions(telling: Telling, read: Read) -> Iterator[Fact]:
    crash = read.crash
    for name, value in (("light", crash.light), ("weather", crash.weather), ("surface", crash.surface)):
        if value is None:
            continue
        if name in read.sky:
            yield telling.stated(f"conditions.{name}", value, read.sky[name])
        else:
            yield telling.inferred(f"conditions.{name}", value, "surface follows weather", read.sky.get("weather"))
