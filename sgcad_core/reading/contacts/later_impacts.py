"""Contacts behind the first one: with things beside the road, and of the same two vehicles once more.

Contacts of other vehicles are read with the first one (`sgcad_core.reading.contacts.contacts`); here they are put in
order with what else was hit. Reads resolved sentences; knows no road.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.contacts.contact_records import GROUND, ContactMention
from sgcad_core.reading.contacts.crash_course import UNREAD, CoursesRead, ImpactRead
from sgcad_core.reading.contacts.rest_words import touched_at_rest
from sgcad_core.reading.inference.inference_state import end_of, side_met
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Segment, Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.area_phrases import area_of, plain
from sgcad_core.reading.text.normalise import NUMBERS
from sgcad_core.reading.text.sentence_roles import Role
from sgcad_core.records.course import ImpactTold
from sgcad_core.records.specs import Area

_SLACK = 12
"""Characters by which a word may stand earlier in a sentence's one form than in the sentence."""
MOST_OF_A_KIND = 3
"""Things of one kind in one clause that are drawn at most."""
_RETOLD: tuple[Role, ...] = ("interview", "injury")


def later_impacts(
    statements: Sequence[Statement],
    segments: Sequence[Segment],
    roster: Roster,
    contact_mentions: Sequence[ContactMention],
) -> tuple[ImpactRead, ...]:
    """Contacts with things and second contacts of the same pair, in order. `segments`: of `acting_segments`."""
    first = next((b for b in contact_mentions if b.other in roster.ids), None)
    places = {t.number: plain(t, roster).lower() for t in statements}
    things = _in_order(
        places,
        [read for segment in segments for read in _things(segment)],
        [read for b in contact_mentions[not first :] if (read := _of_mention(b, roster))],
    )
    things = [x for x in things if not touched_at_rest(places.get(x.source.number, ""), _place(x, places)[1])]
    again = list(_again(statements, roster, contact_mentions, first)) if first else []
    people = list(_people(roster, contact_mentions, first is None))
    found = sorted([*_once(things), *again, *people], key=lambda read: _place(read, places))
    pairs = _first_places(contact_mentions, roster)
    return tuple(_ranked(read, places, pairs) if read not in again else read for read in found)


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


def _in_order(texts: Mapping[int, str], acts: Sequence[ImpactRead], mentions: Sequence[ImpactRead]) -> list[ImpactRead]:
    """Both readings of things in the order of the text; one that both have is the act, which knows its vehicle. A
    sentence may tell further contacts with the same thing, on other sides."""
    sides: dict[tuple[int, str, str], list[Area | None]] = {}
    for read in mentions:
        sides.setdefault(_key(read), []).append(read.impact.actor_area)
    found = [_with_side(read, sides) for read in acts]
    seen = {(*_key(read), read.impact.actor_area) for read in found}
    acted = {(read.source.number, read.impact.other) for read in acts}
    for read in mentions:
        area = read.impact.actor_area
        again = len(set(sides[_key(read)])) > 1 and area is not None and (*_key(read), area) not in seen
        if again or (read.source.number, read.impact.other) not in acted:
            found.append(read)
    return sorted(found, key=lambda read: _place(read, texts))


def _key(read: ImpactRead) -> tuple[int, str, str]:
    """The sentence of a contact, and the two that touch."""
    return read.source.number, read.impact.actor, read.impact.other


def _with_side(read: ImpactRead, sides: Mapping[tuple[int, str, str], Sequence[Area | None]]) -> ImpactRead:
    """An act with the side that the same contact has by its verb of touching, the first one, where it has none of its
    own."""
    side = read.impact.actor_area or next(iter(sides.get(_key(read), ())), None)
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


def _once(things: Sequence[ImpactRead]) -> Iterator[ImpactRead]:
    """Impacts without retellings: the same object again in a later paragraph is the same impact;
    on another side in the same sentence it is a further one."""
    last: dict[tuple[str, str], tuple[int, Area | None]] = {}
    for read in things:
        key, area = (read.impact.actor, read.impact.other), read.impact.actor_area
        number, (before, side) = read.source.number, last.get(key, (-1, None))
        one_more = rule("course_impacts.one_more").search(read.source.words) is not None
        further = number == before and (one_more or (None not in (area, side) and area != side))
        if key not in last or number - before == 1 or further:
            yield read
        last[key] = number, area


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
    behind = segment.text[m.end() : m.end() + 60]
    own = rule("contact_words.with_its").search(behind)
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
        text = by_number[b.number].text
        told = (other_sides and rule("course_impacts.again").search(text)) or _once_more(text, b, first)
        told = told or _on_other_sides(sides, b, first)
        if further and near and told:
            impact = ImpactTold(b.actor, b.other, end_of(b.actor_area), end_of(b.other_area))
            yield ImpactRead(impact, b.source)
            return


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
