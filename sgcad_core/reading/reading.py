"""A crash report read once: five stages from the text to the events of the crash, then inference.

    normalise   one spelling for mentions, units and directions; every character keeps its place
    sentences   in order, each with what it is for (approach, impact, injury, ...)
    mentions    actors resolved: vehicles by number, descriptions, "the other vehicle", "this driver"
    clauses     stretches of sentences with their subjects
    events      motions, contacts and conditions, each as told
    infer       what follows: maneuvers, headings, sides, roads, junction

`read` is the one entry, and `Reading` is all that writers, validators and results use. Places are
character offsets in the narrative that was given. Knows no road network and no file format.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from sgcad_core.reading.actors.part_numbers import counts_itself
from sgcad_core.reading.actors.people_objects import is_person, walk_of
from sgcad_core.reading.actors.rename_ids import renamed
from sgcad_core.reading.actors.vehicles import Roster, read_roster
from sgcad_core.reading.contacts.acting_segments import acting_segments
from sgcad_core.reading.contacts.contact_records import AREAS, ContactMention
from sgcad_core.reading.contacts.contacts import contact_mentions
from sgcad_core.reading.contacts.crash_course import before_near_miss, courses_told
from sgcad_core.reading.contacts.crash_roles import role_facts
from sgcad_core.reading.contacts.later_impacts import later_impacts, things_struck, with_resting_contacts
from sgcad_core.reading.contacts.near_crash import before_evasion, drifts_to, near_miss, near_misses, tells_hit
from sgcad_core.reading.contacts.rest_words import at_struck
from sgcad_core.reading.contacts.road_departure import hand_of_thing, lies_in_road
from sgcad_core.reading.contacts.untouched_events import untouched_event
from sgcad_core.reading.crash_facts import CrashFacts, crash_of, with_turned_signals
from sgcad_core.reading.inference.gaps import (
    Gap,
    contact_untold,
    motion_untold,
    other_language,
    several_reports,
    too_thin,
    without_actors,
)
from sgcad_core.reading.inference.infer_facts import infer_crash
from sgcad_core.reading.inference.inference_state import CrashTold
from sgcad_core.reading.inference.roll_order import with_roll_order
from sgcad_core.reading.inference.untold_moves import with_untold_moves
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Segment, Statement, resolve_sentences, segments
from sgcad_core.reading.motion.motion_reader import read_motions
from sgcad_core.reading.motion.motion_record import ManeuverCue, VehicleMotion
from sgcad_core.reading.motion.signal_states import SignalTold, signal_states
from sgcad_core.reading.provenance.crash_provenance import (
    FactBuilder,
    StageResults,
    course_provenance,
    crash_provenance,
)
from sgcad_core.reading.provenance.road_provenance import road_provenance
from sgcad_core.reading.provenance.timeline import timeline_of
from sgcad_core.reading.roads.road_facts import RoadFacts, roads_of
from sgcad_core.reading.text.conditions import Conditions, conditions
from sgcad_core.reading.text.normalise import Sentence, normalised, split_sentences
from sgcad_core.reading.text.report_styles import account, tells_study
from sgcad_core.reading.text.traced_text import TracedText
from sgcad_core.records.edits import Edit
from sgcad_core.records.facts import Fact
from sgcad_core.records.second_reader import Unsure
from sgcad_core.records.timeline import Act
from sgcad_core.records.words import SignalState


@dataclass(frozen=True)
class Reading:
    """What a narrative tells. Speeds and limits are in mph, as reports tell them; headings are compass words."""

    narrative: str
    """The text that was read."""
    sentences: tuple[Sentence, ...]
    """With their places in that text or, of a `TracedText` one, in the text as it was first written."""
    crash: CrashFacts
    """Untold headings are turned to fit the roads."""
    roads: RoadFacts
    signals: Mapping[str, SignalState] = field(default_factory=dict)
    """What the traffic signal showed to a vehicle, by its id, where that is told."""
    lost_control: bool = False
    """Whether a vehicle skidded, slid, spun or could not hold the road; the text often leaves open which one."""
    facts: tuple[Fact, ...] = ()
    """All of that as records with their sentences: stated, inferred, or a default of the reading itself."""
    edits: tuple[Edit, ...] = ()
    """What people said otherwise; all of the above then follows them (`sgcad_core.reading.reading_with_edits`)."""
    timeline: tuple[Act, ...] = ()
    """States and acts of all road users in the order of the crash; maneuvers and starts from a stop follow from it."""
    called: Mapping[str, str] = field(default_factory=dict)
    """Of a text without vehicle numbers: number in a sentence -> id of that person, cyclist or animal."""
    unsure: tuple[Unsure, ...] = ()
    """Answers that the learned reader of numbered reports holds to be wrong too often."""

    def actor(self, name: str) -> str:
        """The id of the actor that a sentence names so."""
        return self.called.get(name, name)

    def named_in(self, sentence: Sentence) -> set[str]:
        """The ids of the actors that a sentence names by number."""
        return {self.actor(m[0]) for m in rule("common.vehicle").finditer(sentence.text)}

    def text_of(self, sentence: Sentence) -> str:
        """A sentence as it was understood, with every actor's id in it."""
        return rule("common.vehicle").sub(lambda m: self.actor(m[0]), sentence.text) if self.called else sentence.text


def read(narrative: str | TracedText) -> Reading:
    """Read a report. Never raises; an empty or foreign text gives no vehicles and no roads."""
    text = TracedText.of(narrative) if isinstance(narrative, str) else narrative
    even = normalise(text)
    found = sentences(even)
    named = mentions(found, counts_itself(even.text))
    return infer(text.text, found, named, events(found, named, clauses(named), of_study=tells_study(even.text)))


# ------------------------------------------------------------------ the stages
class Mentions(NamedTuple):
    """The actors of the report, and its sentences with every actor named by number."""

    roster: Roster
    statements: tuple[Statement, ...]


class Events(NamedTuple):
    """What the text tells: every vehicle's motion, every contact; light, weather and surface; what signals showed."""

    crash_told: CrashTold
    sky: Conditions
    signals: Mapping[str, SignalTold]


def normalise(narrative: TracedText) -> TracedText:
    """The account, without the lines of a form, in one spelling; characters keep their places."""
    return normalised(account(narrative))


def sentences(text: TracedText) -> tuple[Sentence, ...]:
    """Sentences with roles."""
    return split_sentences(text)


def mentions(found: tuple[Sentence, ...], counted: bool = False) -> Mentions:
    """The vehicles, and the sentences with all references resolved; `counted`: the report has no vehicle numbers."""
    roster = read_roster((s.text for s in found), counted)
    told = resolve_sentences(found, roster)
    if roster.counted and (gone := bystanders(contact_mentions(told, roster) or near_misses(told, roster), roster)):
        roster = roster.without(gone)
        told = resolve_sentences(found, roster)
    return Mentions(roster, told)


def bystanders(told: tuple[ContactMention, ...], roster: Roster) -> tuple[str, ...]:
    """Vehicles without a contact, where one touches the subject; empty where that is not told. A subject that was only
    described first is no better than the others."""
    met = {v for mention in told for v in (mention.actor, mention.other)}
    named = next((v for v in roster.vehicles if not v.described or v.id in met), None)
    subject = named.id if named else None
    return tuple(v for v in roster.ids if v not in met) if subject in met and len(met) > 1 else ()


def clauses(named: Mentions) -> tuple[Segment, ...]:
    """Stretches of sentences with their subjects."""
    return segments(named.statements, named.roster)


def events(
    found: tuple[Sentence, ...], named: Mentions, segments: tuple[Segment, ...], *, of_study: bool = False
) -> Events:
    """Motions, contacts (of a near crash those that did not come about), conditions."""
    roster, cues = named.roster, acting_segments(named.statements, named.roster)
    struck = contact_mentions(named.statements, roster) or things_struck(named.statements, cues, roster)
    event = None if of_study else untouched_event(named.statements, roster, struck)
    near = None if struck else near_miss(named.statements, segments, roster, of_study=of_study)
    if (
        event and near
    ):  # a vehicle that avoids an animal and rolls over has a crash; one that just leaves the road, none
        event, near = (None, near) if event.kind == "departure" else (event, None)
    hits = near.contact_mentions if near else struck
    subject = roster.ids[0] if roster.ids else None
    met = (
        b.number
        for b in hits
        if subject in (b.actor, b.other) and {b.actor, b.other} <= set(roster.ids) and not b.summary
    )
    moved = read_motions(
        named.statements, before_evasion(segments, near, subject) if of_study else segments, roster, next(met, None)
    )
    course = courses_told(named.statements, cues, roster, _coded_loss(moved), event, unhit=not struck and of_study)
    things = {b.other for b in hits} - set(roster.ids)
    course = before_near_miss(course, of_thing=bool(things)) if near else course
    pairs = {frozenset((b.actor, b.other)) for b in struck if b.other in roster.ids}
    later = () if near else later_impacts(named.statements, cues, roster, struck)
    hit = [*((b.actor, b.other) for b in struck), *((read.impact.actor, read.impact.other) for read in later)]
    course = replace(course, courses=at_struck(course.courses, course.sources, hit))
    impacts = () if near else with_resting_contacts(later, course, len(pairs))
    walks = {b.other: walk_of(b.other, named.statements) for b in hits if b.other not in roster.ids}
    missed = frozenset(frozenset((b.actor, b.other)) for b in near_misses(named.statements, roster))
    hands = {word: hand for word in things if (hand := hand_of_thing(word, [t.text for t in named.statements]))}
    if near and len(things) == 1 and not is_person(thing := next(iter(things))):
        near, hand = drifts_to(near, named.statements, hands.get(thing))
        hands |= {thing: hand} if hand else {}
    lying = {word: how for word in things if (how := lies_in_road(word, [t.text for t in named.statements]))}
    crash_told = CrashTold(roster, moved, hits, course, impacts, near, walks, hands, missed, event, lying)
    return Events(crash_told, conditions(found), signal_states(segments, named.statements))


def _coded_loss(moved: Mapping[str, VehicleMotion]) -> dict[str, ManeuverCue]:
    """Losses of control by the codes of a critical event."""
    return {v: cue for v, motion in moved.items() if (cue := motion.cue("code:lost_control"))}


def infer(narrative: str, found: tuple[Sentence, ...], named: Mentions, seen: Events) -> Reading:
    """What follows from what is told."""
    inferred = infer_crash(seen.crash_told)
    builder = FactBuilder(found)
    acts = timeline_of(builder, seen.crash_told, inferred)
    called = {old: new for old, new in named.roster.called.items() if old != new}
    roads = roads_of(named.statements, named.roster, crash_of(seen.crash_told, inferred, seen.sky, acts))
    roads = with_untold_moves(roads, seen.crash_told, inferred)
    as_read = StageResults(seen.crash_told, inferred, roads.crash, dict(seen.sky.sources))
    lights = [
        builder.stated(f"vehicles.{v}.{name}", value, told.source)
        for v, told in seen.signals.items()
        for name, value in (("signal", told.state), ("signal_turned", told.turned)) if value
    ]  # fmt: skip
    course = course_provenance(builder, seen.crash_told)
    roles = role_facts(builder, named.statements, roads.crash)
    facts = (*crash_provenance(builder, as_read), *lights, *roles, *course, *road_provenance(builder, roads))
    states = {called.get(vehicle, vehicle): told.state for vehicle, told in seen.signals.items()}
    roads, facts = renamed(roads, called), tuple(renamed(fact, called) for fact in facts)
    crash = replace(roads.crash, gap=_gap(narrative, found, named, roads.crash))
    lost = bool(rule("meeting.lost").search(narrative)) or any(c.lost_control for c in crash.courses.values())
    acts = tuple(renamed(act, called) for act in acts)
    crash = with_roll_order(crash, acts, narrative)
    crash = with_turned_signals(crash, {called.get(who, who) for who, told in seen.signals.items() if told.turned})
    return Reading(narrative, found, crash, replace(roads, crash=crash), states, lost, facts, (), acts, called)


def _gap(narrative: str, found: tuple[Sentence, ...], named: Mentions, crash: CrashFacts) -> Gap | None:
    """What keeps the text from being drawn."""
    gap = other_language(account(TracedText.of(narrative)).text) or several_reports(narrative)
    if gap or not crash.vehicles:
        return gap or without_actors(narrative, found)
    if crash.near_crash or crash.untouched or (tells_study(narrative) and not any(map(tells_hit, named.statements))):
        return None
    alone = len(crash.vehicles) == 1 and not crash.contacts
    subject = crash.vehicles[0].id
    mine = (c.stated and subject in (c.striker, c.struck) for c in crash.contacts)
    if named.roster.counted or alone:
        return contact_untold(narrative, mine)
    if not any(c.stated for c in crash.contacts) and not crash.oriented:
        return motion_untold(narrative)
    return too_thin() if _tells_only_the_pair(crash, found) else None


def _tells_only_the_pair(crash: CrashFacts, found: tuple[Sentence, ...]) -> bool:
    """Whether of a crash of two vehicles sides, directions, maneuvers and roads are all left open."""
    first = next(iter(crash.contacts), None)
    if first is None or crash.oriented or crash.vehicle(first.struck) is None:
        return False
    open_sides = len(first.striker_may) == len(first.struck_may) == len(AREAS)
    moved = any(v.maneuver_stated for v in crash.vehicles)
    return open_sides and not moved and not any(rule("roles.road").search(s.text) for s in found)
