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
from dataclasses import dataclass, field
from typing import NamedTuple

from sgcad_core.facts import Fact
from sgcad_core.language import rule
from sgcad_core.narrative.clauses import Segment, Statement, segments, tell
from sgcad_core.narrative.conditions import Conditions, conditions
from sgcad_core.narrative.contact import blows
from sgcad_core.narrative.course import courses_told, cut_by_deeds
from sgcad_core.narrative.course_provenance import course_provenance
from sgcad_core.narrative.crash_roles import role_facts
from sgcad_core.narrative.draft import Draft
from sgcad_core.narrative.facts import CrashFacts, crash_of
from sgcad_core.narrative.infer import settle
from sgcad_core.narrative.later_impacts import later_impacts, with_props
from sgcad_core.narrative.motion_reader import motions
from sgcad_core.narrative.provenance import Read, Telling, crash_provenance
from sgcad_core.narrative.road_provenance import road_provenance
from sgcad_core.narrative.roads import RoadFacts, roads_of
from sgcad_core.narrative.signal_states import SignalState, SignalTold, signal_states
from sgcad_core.narrative.text import Sentence, normalised, split_sentences
from sgcad_core.narrative.traced import Traced
from sgcad_core.narrative.vehicles import Roster, roster

_LOST = rule("meeting.lost")


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


def read(narrative: str | Traced) -> Reading:
    """Read a report. Never raises; an empty or foreign text gives no vehicles and no roads."""
    text = Traced.of(narrative) if isinstance(narrative, str) else narrative
    found = sentences(normalise(text))
    named = mentions(found)
    return infer(text.text, found, named, events(found, named, clauses(named)))


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
    """One spelling for everything; characters keep their places."""
    return normalised(narrative)


def sentences(text: Traced) -> tuple[Sentence, ...]:
    """Sentences with roles."""
    return split_sentences(text)


def mentions(found: tuple[Sentence, ...]) -> Mentions:
    """The vehicles, and the sentences with all that refers to them resolved."""
    who = roster(s.text for s in found)
    return Mentions(who, tell(found, who))


def clauses(named: Mentions) -> tuple[Segment, ...]:
    """Stretches of sentences with their subjects."""
    return segments(named.statements, named.who)


def events(found: tuple[Sentence, ...], named: Mentions, cut: tuple[Segment, ...]) -> Events:
    """Motions, contacts, conditions."""
    struck, deeds = blows(named.statements, named.who), cut_by_deeds(named.statements, named.who)
    course = courses_told(named.statements, deeds, named.who)
    impacts = with_props(later_impacts(named.statements, deeds, named.who, struck), course)
    draft = Draft(named.who, motions(named.statements, cut, named.who), struck, course, impacts)
    return Events(draft, conditions(found), signal_states(cut))


def infer(narrative: str, found: tuple[Sentence, ...], named: Mentions, seen: Events) -> Reading:
    """What follows from what is told."""
    settled = settle(seen.draft)
    roads = roads_of(named.statements, named.who, crash_of(seen.draft, settled, seen.sky))
    telling, as_read = Telling(found), Read(seen.draft, settled, roads.crash, dict(seen.sky.sources))
    lights = [telling.stated(f"vehicles.{v}.signal", told.state, told.cue) for v, told in seen.signals.items()]
    course = course_provenance(telling, seen.draft)
    roles = role_facts(telling, named.statements, roads.crash)
    facts = (*crash_provenance(telling, as_read), *lights, *roles, *course, *road_provenance(telling, roads))
    states = {vehicle: told.state for vehicle, told in seen.signals.items()}
    return Reading(narrative, found, roads.crash, roads, states, bool(_LOST.search(narrative)), facts)
