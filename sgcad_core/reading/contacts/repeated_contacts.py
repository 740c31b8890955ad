"""Contacts of two vehicles that touched before: told to be further ones, or on sides that the one before had not.

Reads mentions of contacts and resolved sentences; knows no thing beside the road.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.contacts.crash_course import UNREAD, ImpactRead
from sgcad_core.reading.inference.inference_state import end_of
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.records.course import ImpactTold
from sgcad_core.records.specs import Area

_SOON = 2
"""Sentences behind a contact in which a further one of the same two is told in the next paragraph, too."""


def repeated_contacts(
    statements: Sequence[Statement], roster: Roster, contact_mentions: Sequence[ContactMention], first: ContactMention
) -> Iterator[ImpactRead]:
    """Second contacts of pairs that touched before, one of each pair."""
    by_number = {t.number: t for t in statements}
    slapped: set[int] = set()
    for t in statements:
        slap = rule("course_impacts.slap").search(t.text)
        if slap and t.number >= first.number and t.role not in UNREAD and not slapped:
            slapped.add(t.number)
            yield _slap(t, first)
    begun = {frozenset((first.actor, first.other)): first}
    told: set[frozenset[str]] = set()
    for b in contact_mentions:
        pair = frozenset((b.actor, b.other))
        if b.other not in roster.ids or b.role == "interview" or pair in told:
            continue
        before = begun.setdefault(pair, b)
        if b is not before and b.number not in slapped and _is_further(b, before, by_number):
            told.add(pair)
            impact = ImpactTold(b.actor, b.other, end_of(b.actor_area), end_of(b.other_area))
            yield ImpactRead(impact, b.source, b.at)


def _is_further(mention: ContactMention, before: ContactMention, by_number: Mapping[int, Statement]) -> bool:
    """Whether a mention tells a contact beside the one before of the same two."""
    sides = mention.areas_of(before.actor)
    other_sides = sides != (before.actor_area, before.other_area) and None not in sides
    here = by_number[mention.number]
    if 0 <= mention.number - before.number <= _SOON:
        told = other_sides and rule("course_impacts.again").search(here.text)
        return bool(told) or _once_more(here.text, mention, before) or _on_other_sides(sides, mention, before)
    told_here = here.paragraph == by_number[before.number].paragraph
    return told_here and not mention.summary and _on_other_sides(sides, mention, before)


def _on_other_sides(sides: tuple[str | None, str | None], mention: ContactMention, first: ContactMention) -> bool:
    """Whether a later sentence tells of sides of which one cannot be that of the first contact: of 236 such sentences
    of coded reports without any word for a further contact, 233 tell of one."""
    before = (first.actor_area, first.other_area)
    if mention.number <= first.number or None in (*sides, *before):
        return False
    return any(not set(str(a).split("/")) & set(str(b).split("/")) for a, b in zip(sides, before, strict=True))


def _once_more(text: str, mention: ContactMention, first: ContactMention) -> bool:
    """Whether a mention says that it is a further contact of the same two, on whatever sides."""
    return mention.number > first.number and rule("course_impacts.once_more").search(text) is not None


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
