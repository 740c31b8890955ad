"""Contacts behind the first one: with things beside the road, and of the same two vehicles once more.

Contacts of other vehicles are read with the first one (`sgcad_core.reading.contacts.contacts`); here they are put in
order with what else was hit. Reads resolved sentences; knows no road.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.contacts.crash_course import UNREAD, CoursesRead, ImpactRead
from sgcad_core.reading.inference.inference_state import end_of
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Segment, Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.area_phrases import area_of
from sgcad_core.records.course import ImpactTold
from sgcad_core.records.specs import Area

GROUND = ("curb", "island", "median", "ditch", "ground")
"""What a vehicle drives over: no body that stops it."""


def later_impacts(
    statements: Sequence[Statement],
    segments: Sequence[Segment],
    roster: Roster,
    contact_mentions: Sequence[ContactMention],
) -> tuple[ImpactRead, ...]:
    """Contacts with things and second contacts of the same pair, in order. `segments`: of `acting_segments`."""
    first = next((b for b in contact_mentions if b.other in roster.ids), None)
    start = first.number if first else -1
    things = [read for segment in segments for read in _things(segment, start)]
    again = list(_again(statements, roster, contact_mentions, first)) if first else []
    people = list(_people(roster, contact_mentions, first)) if first else []
    found = sorted([*_once(things), *again, *people], key=lambda read: read.source.number)
    return tuple(found)


def with_resting_contacts(impacts: Sequence[ImpactRead], read: CoursesRead) -> tuple[ImpactRead, ...]:
    """The impacts with those that a rest implies: a vehicle at rest against a tree has struck it last."""
    struck = {(one.impact.actor, _word(one.impact.other)) for one in impacts}
    found = list(impacts)
    for vehicle, course in read.courses.items():
        prop = course.rest.against
        if prop and prop not in GROUND and (vehicle, _word(prop)) not in struck:
            found.append(ImpactRead(ImpactTold(vehicle, _word(prop)), read.sources[f"{vehicle} rest.against"]))
    return tuple(found)


def _once(things: Sequence[ImpactRead]) -> Iterator[ImpactRead]:
    """Impacts without retellings: the same object again in a later paragraph is the same impact."""
    last: dict[tuple[str, str], int] = {}
    for read in things:
        key = read.impact.actor, read.impact.other
        number = read.source.number
        if key not in last or number - last[key] == 1:
            yield read
        last[key] = number


def _things(segment: Segment, start: int) -> Iterator[ImpactRead]:
    """Things that a vehicle hits; `start`: the sentence of the first contact of two vehicles."""
    if segment.role in UNREAD or segment.role == "interview" or not segment.subjects:
        return
    for m in rule("course_impacts.object").finditer(segment.text):
        for thing in (m["thing"], m["next"]):
            if thing and thing not in GROUND and not _undone(segment.text, m):
                yield _hit(segment, m, thing, segment.number < start)


def _undone(text: str, m: re.Match[str]) -> bool:
    before = text[max(0, m.start() - 25) : m.start()]
    return bool(rule("course_evasion.to_avoid").search(before) or rule("course_impacts.nearly").search(before))


def _hit(segment: Segment, m: re.Match[str], thing: str, before: bool) -> ImpactRead:
    own = rule("contact_words.with_its").search(segment.text[m.end() : m.end() + 60])
    area = end_of(area_of(own["area"])) if own else None
    impact = ImpactTold(segment.subjects[0], _word(thing), area, None, before)
    return ImpactRead(impact, Source(segment.number, m[0], "course_impacts.object"))


def _word(thing: str) -> str:
    """ "light-pole", "utility box" -> "pole", "box"."""
    return thing.replace("-", " ").split()[-1]


def _people(roster: Roster, contact_mentions: Sequence[ContactMention], first: ContactMention) -> Iterator[ImpactRead]:
    """Pedestrians and cyclists struck after the first contact of the vehicles."""
    seen: set[str] = set()
    for b in contact_mentions:
        told = b.other not in roster.ids and b.number > first.number and b.role not in ("interview", "injury")
        if told and b.other not in seen and any(user.search(b.other) for user in of_role("road_user")):
            seen.add(b.other)
            yield ImpactRead(ImpactTold(b.actor, b.other, end_of(b.actor_area)), b.source)


# ------------------------------------------------------------------ the same two again
def _again(
    statements: Sequence[Statement], roster: Roster, contact_mentions: Sequence[ContactMention], first: ContactMention
) -> Iterator[ImpactRead]:
    """Second contacts of the pair that touched first."""
    pair = {first.actor, first.other}
    by_number = {t.number: t for t in statements}
    slapped: set[int] = set()
    for t in statements:
        slap = rule("course_impacts.slap").search(t.text)
        if slap and t.number >= first.number and t.role not in UNREAD and not slapped:
            slapped.add(t.number)
            yield _slap(t, first)
    for b in contact_mentions:
        sides = b.areas_of(first.actor)
        other_sides = sides != (first.actor_area, first.other_area) and None not in sides
        further = b is not first and {b.actor, b.other} == pair and b.role != "interview"
        near = 0 <= b.number - first.number <= 2 and b.number not in slapped
        if further and other_sides and near and rule("course_impacts.again").search(by_number[b.number].text):
            impact = ImpactTold(b.actor, b.other, end_of(b.actor_area), end_of(b.other_area))
            yield ImpactRead(impact, b.source)
            return


def _slap(statement: Statement, first: ContactMention) -> ImpactRead:
    """Both sides, in the order in which they are told, or given to the vehicles by name."""
    sides: list[Area | None] = [None, None]
    named = rule("course_impacts.side_of").finditer(statement.text)
    for m in named:
        who = 0 if m["who"] == first.actor else 1
        sides[who] = "left" if m["hand"].lower() == "left" else "right"
    return ImpactRead(
        ImpactTold(first.actor, first.other, sides[0], sides[1]), Source(statement.number, "", "course_impacts.slap")
    )
