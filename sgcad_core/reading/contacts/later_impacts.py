"""Contacts behind the first one: with things beside the road, and of the same two vehicles once more.

Contacts of other vehicles are read with the first one (`sgcad_core.reading.contacts.contacts`), further ones of the
same two by `repeated_contacts`; here they are put in order with what else was hit. Reads resolved sentences; knows no
road.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.contacts.contact_records import GROUND, ContactMention
from sgcad_core.reading.contacts.crash_course import UNREAD, CoursesRead, ImpactRead
from sgcad_core.reading.contacts.repeated_contacts import repeated_contacts
from sgcad_core.reading.contacts.rest_words import touched_at_rest
from sgcad_core.reading.inference.inference_state import end_of, side_met
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Segment, Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.area_phrases import area_of, plain
from sgcad_core.reading.text.normalise import NUMBERS
from sgcad_core.reading.text.sentence_roles import HIT, Role
from sgcad_core.records.course import ImpactTold
from sgcad_core.records.specs import Area

_SLACK = 12
"""Characters by which a word may stand earlier in a sentence's one form than in the sentence."""
_NEAR = 60
"""Characters behind a thing within which the side that struck it is told, unless another contact is told first."""
MOST_OF_A_KIND = 3
"""Things of one kind in one clause that are drawn at most."""
_RETOLD: tuple[Role, ...] = ("interview", "injury")


def later_impacts(
    statements: Sequence[Statement],
    segments: Sequence[Segment],
    roster: Roster,
    contact_mentions: Sequence[ContactMention],
) -> tuple[ImpactRead, ...]:
    """Contacts with things and second contacts of the same two, in order. `segments`: of `acting_segments`."""
    first = next((b for b in contact_mentions if b.other in roster.ids), None)
    places = {t.number: plain(t, roster).lower() for t in statements}
    told = [read for b in contact_mentions if (read := _of_mention(b, roster))]
    alone = first is None and bool(contact_mentions) and _of_mention(contact_mentions[0], roster) is not None
    acts = [read for segment in segments for read in _things(segment)]
    things = _in_order(places, acts, told, alone=alone)
    things = [x for x in things if not touched_at_rest(places.get(x.source.number, ""), _place(x, places)[1])]
    once = list(_once(things, {t.number: t.paragraph for t in statements}))
    begins = alone and acts and once and _key(once[0]) == _key(acts[0]) == _key(told[0])
    if begins and acts[0].impact.actor_area is None:  # the first contact has its side
        once[0] = once[0]._replace(impact=replace(once[0].impact, actor_area=None))
    again = list(repeated_contacts(statements, roster, contact_mentions, first)) if first else []
    people = list(_people(roster, contact_mentions, first is None))
    found = sorted([*once, *again, *people], key=lambda read: _place(read, places))
    pairs = _first_places(contact_mentions, roster)
    own = {first.actor, first.other} if first else set()
    return tuple(
        read if read in again and {read.impact.actor, read.impact.other} == own else _ranked(read, places, pairs)
        for read in found
    )


def things_struck(
    statements: Sequence[Statement], segments: Sequence[Segment], roster: Roster
) -> tuple[ContactMention, ...]:
    """Contacts with things that verbs other than those of touching tell ("backed into a fence"), of vehicles with
    numbers."""
    if roster.counted:
        return ()
    roles = {t.number: t.role for t in statements}
    return tuple(
        ContactMention(one.impact.actor, one.impact.other, one.impact.actor_area, None, one.source.number,
                       roles[one.source.number], words=one.source.words)
        for one in later_impacts(statements, segments, roster, ())
    )  # fmt: skip


def _place(read: ImpactRead, texts: Mapping[int, str]) -> tuple[int, int]:
    """Where an impact is told: the number of its sentence, and the place of the struck one's word in it."""
    number, other = read.source.number, read.impact.other.lower()
    text = texts.get(number, "")
    at = text.find(other, max(read.at, 0))
    return number, at if at >= 0 else max(text.find(other), 0)


def _first_places(contact_mentions: Sequence[ContactMention], roster: Roster) -> list[tuple[int, int]]:
    """Where the first contact of each pair of vehicles is told; summaries give no order."""
    found: dict[frozenset[str], tuple[int, int]] = {}
    for b in contact_mentions:
        if b.other in roster.ids and not b.summary:
            found.setdefault(frozenset((b.actor, b.other)), (b.number, b.at))
    return list(found.values())


def _ranked(read: ImpactRead, texts: Mapping[int, str], pairs: Sequence[tuple[int, int]]) -> ImpactRead:
    """An impact with the number of contacts of vehicles that are told before it."""
    place = _place(read, texts)
    after = sum(pair < place for pair in pairs) if pairs else 1
    return read._replace(impact=replace(read.impact, after=after))


def _of_mention(mention: ContactMention, roster: Roster) -> ImpactRead | None:
    """A thing that a verb of touching tells; None of vehicles, of people and of the ground."""
    person = any(user.search(mention.other) for user in of_role("road_user"))
    if mention.other in roster.ids or person or mention.other == "ground" or mention.role in _RETOLD:
        return None
    area = side_met(mention.actor_area)
    impact = ImpactTold(mention.actor, _word(mention.other), area)
    return ImpactRead(impact, mention.source)


def _in_order(
    texts: Mapping[int, str], acts: Sequence[ImpactRead], mentions: Sequence[ImpactRead], *, alone: bool
) -> list[ImpactRead]:
    """Both readings of things in the order of the text; one that both have is the act, which knows its vehicle. A
    sentence may tell further contacts with the same thing, on other sides. `alone`: the first mention is the first
    contact of all."""
    sides: dict[tuple[int, str, str], list[Area | None]] = {}
    for read in mentions:
        sides.setdefault(_key(read), []).append(read.impact.actor_area)
    before: Counter[tuple[int, str, str]] = Counter()
    found = []
    for read in acts:
        found.append(_with_side(read, sides, before[_key(read)]))
        before[_key(read)] += 1
    seen = {(*_key(read), read.impact.actor_area) for read in found}
    acted = {(read.source.number, read.impact.other) for read in acts}
    for read in mentions[alone:]:
        area = read.impact.actor_area
        again = len(set(sides[_key(read)])) > 1 and area is not None and (*_key(read), area) not in seen
        if again or (read.source.number, read.impact.other) not in acted:
            found.append(read)
    return sorted(found, key=lambda read: _place(read, texts))


def _key(read: ImpactRead) -> tuple[int, str, str]:
    """The sentence of a contact, and the two that touch."""
    return read.source.number, read.impact.actor, read.impact.other


def _with_side(
    read: ImpactRead, sides: Mapping[tuple[int, str, str], Sequence[Area | None]], before: int
) -> ImpactRead:
    """An act with the side that the same contact has by its verb of touching, where it has none of its own. `before`:
    contacts with things of that name that the sentence tells before it; of fewer verbs than things the last one counts.
    """
    told = sides.get(_key(read), ())
    side = read.impact.actor_area or (told[min(before, len(told) - 1)] if told else None)
    return read._replace(impact=replace(read.impact, actor_area=side))


def with_resting_contacts(impacts: Sequence[ImpactRead], read: CoursesRead, last: int = 1) -> tuple[ImpactRead, ...]:
    """The impacts with those that a rest implies: a vehicle at rest against a tree has struck it last.

    `last`: the number of contacts of vehicles.
    """
    struck = {(one.impact.actor, _word(one.impact.other)) for one in impacts}
    found = list(impacts)
    for vehicle, course in read.courses.items():
        prop, source = course.rest.against, read.sources.get(f"{vehicle} rest.against")
        if prop and source and prop not in GROUND and (vehicle, _word(prop)) not in struck:
            impact = ImpactTold(vehicle, _word(prop), after=max(last, 1))
            found.append(ImpactRead(impact, source))
    return tuple(found)


def _once(things: Sequence[ImpactRead], paragraphs: Mapping[int, int]) -> Iterator[ImpactRead]:
    """Impacts without retellings: the same object again in a later paragraph is the same impact, unless it is told to
    be another one; in the same paragraph an object with a new article, or on another side, is a further one."""
    last: dict[tuple[str, str], tuple[int, Area | None]] = {}
    for read in things:
        key, words = (read.impact.actor, read.impact.other), read.source.words
        number, (before, side) = read.source.number, last.get(key, (-1, None))
        other_side = None not in (read.impact.actor_area, side) and read.impact.actor_area != side
        told_here = paragraphs.get(number) == paragraphs.get(before)
        further = told_here and (other_side or rule("course_impacts.one_more").search(words) is not None)
        further |= number - before == 1 and rule("course_impacts.same_thing").search(words) is None
        if key not in last or further or rule("course_impacts.another").search(words):
            yield read
        last[key] = number, read.impact.actor_area


def _things(segment: Segment) -> Iterator[ImpactRead]:
    """Things that vehicles hit, one by one where a list of them is told; each vehicle hits its own."""
    if segment.role in UNREAD or segment.role == "interview" or not segment.subjects:
        return
    end = 0
    verbs = (rule("course_impacts.object"), rule("course_impacts.into"))
    for m in sorted((m for verb in verbs for m in verb.finditer(segment.text)), key=lambda m: m.start()):
        if m.start() < end or _undone(segment.text, m):
            continue
        for thing in _listed(segment.text, m):
            end = thing.end()
            if thing["thing"] != "ground":
                hits = [_hit(segment, m, thing, vehicle) for vehicle in segment.subjects]
                yield from hits * _count(segment.text, m, thing)


def _count(text: str, verb: re.Match[str], thing: re.Match[str]) -> int:
    """How many things of a kind are hit: as told up to MOST_OF_A_KIND; two where several are told without a number."""
    begins = verb.start() if thing is verb else thing.start()
    end = thing.end()
    told = rule("course_impacts.counted").search(text[begins : end + text[end : end + 1].isalpha()])
    if told is None:
        return 1
    word = told["count"].lower()
    return min(int(word) if word.isdigit() else NUMBERS.get(word, 2), MOST_OF_A_KIND)


def _listed(text: str, first: re.Match[str]) -> Iterator[re.Match[str]]:
    """A thing that was hit, and those that are listed behind it."""
    found: re.Match[str] | None = first
    while found:
        yield found
        found = rule("course_impacts.further").match(text, found.end())


def _undone(text: str, m: re.Match[str]) -> bool:
    before = text[max(0, m.start() - 25) : m.start()]
    return bool(rule("course_evasion.to_avoid").search(before) or rule("course_impacts.nearly").search(before))


def _hit(segment: Segment, m: re.Match[str], thing: re.Match[str], vehicle: str) -> ImpactRead:
    behind = segment.text[m.end() : m.end() + _NEAR]
    next_verb = HIT.search(behind)
    own = rule("contact_words.with_its").search(behind[: next_verb.start()] if next_verb else behind)
    area = side_met(area_of(own["area"])) if own else None
    if rule("contact_words.wheel_end").search(behind):
        area = "front"  # a wheel is no flank
    impact = ImpactTold(vehicle, _word(thing["thing"]), area)
    at = segment.at + thing.start("thing") - _SLACK
    return ImpactRead(impact, Source(segment.number, m[0], "course_impacts.object"), at)


def _word(thing: str) -> str:
    """ "light-pole", "utility box" -> "pole", "box"."""
    return thing.replace("-", " ").split()[-1]


def _people(roster: Roster, contact_mentions: Sequence[ContactMention], alone: bool) -> Iterator[ImpactRead]:
    """Pedestrians, cyclists and animals that are struck; `alone`: the first contact of all is not among these."""
    seen: set[tuple[str, str]] = set()
    for b in contact_mentions[alone:]:
        told = b.other not in roster.ids and b.role not in _RETOLD
        if told and (b.actor, b.other) not in seen and any(user.search(b.other) for user in of_role("road_user")):
            seen.add((b.actor, b.other))
            yield ImpactRead(ImpactTold(b.actor, b.other, end_of(b.actor_area)), b.source)
