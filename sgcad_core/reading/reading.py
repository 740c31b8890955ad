"""A crash report read once: five stages from the text to what happened, then inference.

    normalise   one spelling for mentions, units and directions; every character keeps its place
    sentences   in order, each with what it is for (approach, impact, injury, ...)
    mentions    who is who: vehicles by number, descriptions, "the other vehicle", "this driver"
    clauses     whose deed is it: stretches of sentences with their subjects
    events      motions, contacts and conditions, each as told
    infer       what follows: maneuvers, headings, sides, roads, junction

`read` is the one entry, and `Reading` is all that anyone else consults: writers, validators, results. Places are
character offsets in the narrative that was given. Knows no road network and no file format.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from sgcad_core.reading.actors.references import numbers_somebody
from sgcad_core.reading.actors.rename_ids import renamed
from sgcad_core.reading.actors.vehicles import Roster, roster
from sgcad_core.reading.actors.walkers import walk_of
from sgcad_core.reading.contacts.contact_telling import Blow
from sgcad_core.reading.contacts.contacts import blows
from sgcad_core.reading.contacts.crash_course import CoursesRead, courses_told, cut_by_deeds
from sgcad_core.reading.contacts.crash_roles import role_facts
from sgcad_core.reading.contacts.later_impacts import later_impacts, with_props
from sgcad_core.reading.contacts.near_crash import before_evasion, near_miss, near_misses, tells_hit
from sgcad_core.reading.crash_facts import CrashFacts, crash_of
from sgcad_core.reading.inference.gaps import Gap, foreign, several, thin, untold, without_actors
from sgcad_core.reading.inference.infer_facts import settle
from sgcad_core.reading.inference.inference_state import Draft
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Segment, Statement, segments, tell
from sgcad_core.reading.motion.motion_reader import motions
from sgcad_core.reading.motion.motion_record import Deed, Motion
from sgcad_core.reading.motion.signal_states import SignalState, SignalTold, signal_states
from sgcad_core.reading.provenance.course_provenance import course_provenance
from sgcad_core.reading.provenance.crash_provenance import Read, Telling, crash_provenance
from sgcad_core.reading.provenance.road_provenance import road_provenance
from sgcad_core.reading.roads.road_facts import RoadFacts, roads_of
from sgcad_core.reading.text.conditions import Conditions, conditions
from sgcad_core.reading.text.driving_study_style import tells_study
from sgcad_core.reading.text.forms import account
from sgcad_core.reading.text.normalise import Sentence, normalised, split_sentences
from sgcad_core.reading.text.traced_text import Traced
from sgcad_core.records.edits import Edit
from sgcad_core.records.facts import Fact


@dataclass(frozen=True)
class Reading:
    """What a narrative tells. Speeds and limits are in mph, as reports tell them; headings are compass words."""

    narrative: str
    """The text that was read."""
    sentences: tuple[Sentence, ...]
    """With their places in that text or, of a `Traced` one, in the text as it was first written."""
    crash: CrashFacts
    """Headings that nobody tells are turned to fit the roads."""
    roads: RoadFacts
    signals: Mapping[str, SignalState] = field(default_factory=dict)
    """What the traffic signal showed to a vehicle, by its id, where that is told."""
    lost_control: bool = False
    """Whether somebody skidded, slid, spun or could not hold the road; who it was is often left to the reader."""
    facts: tuple[Fact, ...] = ()
    """All of that as records with their sentences: stated, inferred, or a default of the reading itself."""
    edits: tuple[Edit, ...] = ()
    """What people said otherwise; all of the above then follows them (`sgcad_core.reading.reading_with_edits`)."""
    called: Mapping[str, str] = field(default_factory=dict)
    """Of a text that numbers nobody: number that a sentence gives somebody -> id of that person, cyclist or animal."""

    def actor(self, name: str) -> str:
        """The id of whom a sentence names so."""
        return self.called.get(name, name)

    def text_of(self, sentence: Sentence) -> str:
        """A sentence as it was understood, with everybody's id in it."""
        return rule("common.vehicle").sub(lambda m: self.actor(m[0]), sentence.text) if self.called else sentence.text


def read(narrative: str | Traced) -> Reading:
    """Read a report. Never raises; an empty or foreign text gives no vehicles and no roads."""
    text = Traced.of(narrative) if isinstance(narrative, str) else narrative
    even = normalise(text)
    found = sentences(even)
    named = mentions(found, not numbers_somebody(even.text))
    return infer(text.text, found, named, events(found, named, clauses(named), of_study=tells_study(even.text)))


def crash_facts(narrative: str) -> CrashFacts:
    """Vehicles, contacts and conditions of a text that nobody has read yet."""
    return read(narrative).crash


def road_facts(narrative: str) -> RoadFacts:
    """Roads, and vehicles on them, of a text that nobody has read yet."""
    return read(narrative).roads


# ------------------------------------------------------------------ the stages
class Mentions(NamedTuple):
    """Who is in the report, and its sentences with everybody named by number."""

    who: Roster
    statements: tuple[Statement, ...]


class Events(NamedTuple):
    """What the text tells: every vehicle's motion, every contact; light, weather and surface; what signals showed."""

    draft: Draft
    sky: Conditions
    signals: Mapping[str, SignalTold]


def normalise(narrative: Traced) -> Traced:
    """Of a form the account alone, in one spelling; characters keep their places."""
    return normalised(account(narrative))


def sentences(text: Traced) -> tuple[Sentence, ...]:
    """Sentences with roles."""
    return split_sentences(text)


def mentions(found: tuple[Sentence, ...], counted: bool = False) -> Mentions:
    """The vehicles, and the sentences with all that refers to them resolved; `counted`: the report numbers nobody."""
    who = roster((s.text for s in found), counted)
    told = tell(found, who)
    if who.counted and (gone := bystanders(blows(told, who) or near_misses(told, who), who)):
        who = who.without(gone)
        told = tell(found, who)
    return Mentions(who, told)


def bystanders(told: tuple[Blow, ...], who: Roster) -> tuple[str, ...]:
    """Those who touch nobody, where somebody touches the subject; nobody where that is not told. A subject that is only
    whoever was described first is no better than the others."""
    met = {v for blow in told for v in (blow.actor, blow.other)}
    named = next((v for v in who.vehicles if not v.described or v.id in met), None)
    subject = named.id if named else None
    return tuple(v for v in who.ids if v not in met) if subject in met and len(met) > 1 else ()


def clauses(named: Mentions) -> tuple[Segment, ...]:
    """Stretches of sentences with their subjects."""
    return segments(named.statements, named.who)


def events(found: tuple[Sentence, ...], named: Mentions, cut: tuple[Segment, ...], *, of_study: bool = False) -> Events:
    """Motions, contacts (of a near crash those that did not come about), conditions."""
    who, struck = named.who, blows(named.statements, named.who)
    near = None if struck else near_miss(named.statements, cut, who, of_study=of_study)
    hits = near.blows if near else struck
    subject = who.ids[0] if who.ids else None
    met = (
        b.number for b in hits if subject in (b.actor, b.other) and {b.actor, b.other} <= set(who.ids) and not b.summary
    )
    moved = motions(named.statements, before_evasion(cut) if of_study else cut, who, next(met, None))
    deeds = cut_by_deeds(named.statements, who)
    course = CoursesRead() if near else courses_told(named.statements, deeds, who, _coded_loss(moved))
    impacts = () if near else with_props(later_impacts(named.statements, deeds, who, struck), course)
    walks = {b.other: walk_of(b.other, named.statements) for b in hits if b.other not in who.ids}
    missed = frozenset(frozenset((b.actor, b.other)) for b in near_misses(named.statements, who))
    draft = Draft(who, moved, hits, course, impacts, near, walks, missed)
    return Events(draft, conditions(found), signal_states(cut))


def _coded_loss(moved: Mapping[str, Motion]) -> dict[str, Deed]:
    """Who lost control by the codes of a critical event."""
    return {v: deed for v, motion in moved.items() if (deed := motion.deed("code:lost_control"))}


def infer(narrative: str, found: tuple[Sentence, ...], named: Mentions, seen: Events) -> Reading:
    """What follows from what is told."""
    settled = settle(seen.draft)
    called = {old: new for old, new in named.who.called.items() if old != new}
    roads = roads_of(named.statements, named.who, crash_of(seen.draft, settled, seen.sky))
    telling, as_read = Telling(found), Read(seen.draft, settled, roads.crash, dict(seen.sky.sources))
    lights = [telling.stated(f"vehicles.{v}.signal", told.state, told.cue) for v, told in seen.signals.items()]
    course = course_provenance(telling, seen.draft)
    roles = role_facts(telling, named.statements, roads.crash)
    facts = (*crash_provenance(telling, as_read), *lights, *roles, *course, *road_provenance(telling, roads))
    states = {called.get(vehicle, vehicle): told.state for vehicle, told in seen.signals.items()}
    roads, facts = renamed(roads, called), tuple(renamed(fact, called) for fact in facts)
    crash = replace(roads.crash, gap=_gap(narrative, found, named, roads.crash))
    lost = bool(rule("meeting.lost").search(narrative))
    return Reading(narrative, found, crash, replace(roads, crash=crash), states, lost, facts, called=called)


def _gap(narrative: str, found: tuple[Sentence, ...], named: Mentions, crash: CrashFacts) -> Gap | None:
    """What keeps the text from being drawn."""
    gap = foreign(account(Traced.of(narrative)).text) or several(narrative)
    if gap or not crash.vehicles:
        return gap or without_actors(narrative, found)
    if crash.near_crash or (tells_study(narrative) and not any(map(tells_hit, named.statements))):
        return None
    alone = len(crash.vehicles) == 1 and not crash.contacts
    subject = crash.vehicles[0].id
    mine = (c.stated and subject in (c.striker, c.struck) for c in crash.contacts)
    if named.who.counted or alone:
        return untold(narrative, mine)
    told = any(c.stated for c in crash.contacts) or any(v.heading_stated for v in crash.vehicles)
    return None if told else thin(narrative)
