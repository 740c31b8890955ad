"""Resolved sentences cut into segments, each with the vehicles that are its subject.

A segment runs from one subject to the next. A mention is a subject where a verb follows it and no preposition stands
before it ("behind V2", "struck V2"), or where a relative clause or participle begins ("V2, which was stopped").
Pronouns take the subject of the sentence before. Knows no motion words.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from sgcad_core.reading.actors.drivers import NO_DRIVERS, drivers
from sgcad_core.reading.actors.vehicles import MENTION, Roster
from sgcad_core.reading.language import rule
from sgcad_core.reading.text.normalise import NUMBERS, Role, Sentence
from sgcad_core.reading.text.sentence_roles import role_of


class Segment(NamedTuple):
    """A stretch of a sentence about some vehicles; `text` starts behind the mention, lower case."""

    subjects: tuple[str, ...]
    text: str
    role: Role
    number: int
    """Of the sentence."""
    at: int = 0
    """Where in the sentence it begins."""


class Statement(NamedTuple):
    """A sentence with every vehicle named by its number, and the vehicle it is mainly about."""

    text: str
    role: Role
    number: int
    subject: str | None
    several: bool = False
    """Whether "they" at its start means all vehicles, not the driver of one."""
    earlier: str | None = None
    """The vehicle that the sentence before is about."""
    paragraph: int = 0


_SUBJECT = rule("clauses.subject")
_VERB = rule("clauses.verb")
_BESIDE = rule("clauses.beside")
_PRONOUN = rule("clauses.pronoun")


def resolve_sentences(sentences: Iterable[Sentence], roster: Roster) -> tuple[Statement, ...]:
    """Sentences with vehicles resolved; "the other vehicle" and "this vehicle" follow the subject."""
    told: list[Statement] = []
    current: str | None = None
    several = True
    sentences = tuple(sentences)
    resolved = [roster.resolve(s.text) for s in sentences]
    called = NO_DRIVERS if roster.counted else drivers(resolved, roster)
    for s, text in zip(sentences, resolved, strict=True):
        text = text if roster.counted else called.resolve(text)
        text = _others(text, roster, current, s.role)
        role = role_of(text) if s.role in ("other", "road") and text != s.text else s.role
        # one account in order: no vehicle is at rest for good before the contact
        unmet = all(t.role != "impact" for t in told)
        early = role in ("rest", "health") and unmet
        stops = role == "rest" and rule("clauses.stops").search(text) and any(one.role == "impact" for one in sentences)
        before = unmet and (stops or (role == "other" and _begins_with_somebody(text)))
        if before or (roster.counted and (early or (role == "other" and _SUBJECT.search(text)))):
            role = "approach"
        earlier, current = current, _main_subject(text, current, role, roster)
        told.append(Statement(text, role, s.number, current, several, earlier, s.paragraph))
        several = _of_several(text, several)
    return tuple(told)


def _begins_with_somebody(text: str) -> bool:
    """Whether a vehicle or a pronoun is what a sentence is about."""
    return bool(_PRONOUN.match(text) or _SUBJECT.match(text))


def _of_several(text: str, before: bool) -> bool:
    """Whether a following "they" means several vehicles: the last subject was all, a list, or absent."""
    if _PRONOUN.match(text):
        return before
    if rule("clauses.everybody").search(text) or rule("clauses.list").search(text):
        return True
    return before and not MENTION.search(text)


def _others(text: str, roster: Roster, current: str | None, role: Role) -> str:
    """ "the other vehicle" as a number, where two vehicles leave no doubt."""
    subject = next((v for v in MENTION.findall(text) if v in roster.ids), None) or current
    other = roster.other(subject) if subject else None
    if other:
        text = rule("clauses.other_vehicle").sub(other, text)
    if current and role not in ("codes", "factors"):
        text = rule("clauses.this_vehicle").sub(current, text)
    return text


def _main_subject(text: str, current: str | None, role: Role, roster: Roster) -> str | None:
    """The vehicle that a pronoun in the next sentence means; a number outside the roster counts as none."""
    if _PRONOUN.match(text) and current:
        return current
    first = next((m for m in MENTION.finditer(text) if m[0] in roster.ids), None)
    if not first:
        return current
    opening = text[: first.start()]
    early = len(opening.split()) <= 8 or role in ("codes", "factors")
    return first.group() if early or current is None else current


def segments(statements: Iterable[Statement], roster: Roster) -> tuple[Segment, ...]:
    """Every stretch of text with its subjects, in order; text before the first subject is left out."""
    found: list[Segment] = []
    for t in statements:
        found += _cut(t, roster)
    return tuple(found)


def _cut(statement: Statement, roster: Roster) -> list[Segment]:
    starts = subject_starts(statement, roster)
    ends = [at for at, _, _ in starts[1:]] + [len(statement.text)][: len(starts)]
    found = []
    for n, ((place, begin, subjects), end) in enumerate(zip(starts, ends, strict=True)):
        text = _own(statement.text[begin:end].lower().strip(" ,"), n)
        told = rule("clauses.before_it").search(statement.text[:place])  # "before V1 started": it had not
        if subjects:
            found.append(Segment(subjects, f"before {text}" if told else text, statement.role, statement.number, begin))
    return [*_opening(statement, starts), *found, *(also for one in found for also in _alike(one, roster))]


def _alike(segment: Segment, roster: Roster) -> Iterator[Segment]:
    """The same segment for another vehicle: "V2 was southbound, and so was V1"."""
    same = rule("clauses.so_was").search(segment.text)
    if same and (vehicle := same["v"].upper()) in roster.ids:
        yield segment._replace(subjects=(vehicle,), text=segment.text[: same.start()])


def _own(text: str, before: int) -> str:
    """Without what a main subject `before` does on behind a relative clause: "hit V1, which stood, and drove on"."""
    aside = rule("clauses.stood_aside").match(text) if before else None
    return text[: aside.end()] if aside else text


def _opening(statement: Statement, starts: list[tuple[int, int, tuple[str, ...]]]) -> list[Segment]:
    """What a participle tells of the subject that follows it: "While turning right, V1 was struck"."""
    first = MENTION.search(statement.text)
    before = statement.text[: first.start()] if first else ""
    if not first or not rule("clauses.opening").fullmatch(before):
        return []
    whole = bool(starts) and starts[0][0] == first.start()
    owner = (first[0],) if rule("clauses.part_touched").match(statement.text[first.end() :]) else ()
    subjects = starts[0][2] if whole else owner
    return [Segment(subjects, before.lower().strip(" ,"), statement.role, statement.number, 0)] if subjects else []


def subject_starts(statement: Statement, roster: Roster) -> list[tuple[int, int, tuple[str, ...]]]:
    """(place of the mention, begin of its text, vehicles) of each subject."""
    text = statement.text
    starts: list[tuple[int, int, tuple[str, ...]]] = []
    pronoun = _PRONOUN.match(text)
    if pronoun and statement.subject:
        everyone = (
            len(roster.ids) == 2 and rule("clauses.they").search(pronoun.group()) and _means_all(statement, pronoun)
        )
        starts.append((0, pronoun.end(), roster.ids if everyone else (statement.subject,)))
    elif statement.subject and not MENTION.search(text) and rule("clauses.headless").match(text):
        starts.append((0, 0, (statement.subject,)))
    inside = 0
    for m in _subjects(text):
        if m.start() < inside:
            continue
        inside = m.end() + _place_length(text[m.end() :])
        subjects = _whom(m, roster)
        stranger = m.group("stranger") or (not subjects and m.group("one") in roster.bystanders)
        if (subjects or stranger) and _is_subject(text, m):
            resumed = _resumed(text, m, starts)
            starts += [(m.start(), m.end(), subjects), *resumed]
        else:
            inside = 0
    return sorted(starts, key=lambda start: start[0]) if starts else starts


def _place_length(behind: str) -> int:
    """Length of the words that locate a subject before its verb: vehicles named in them are no subjects."""
    place = rule("clauses.located").match(behind)
    within = place is not None and "," not in place.group() and " and " not in place.group()
    return place.end() if place and within and _VERB.match(" " + behind[place.end() :]) else 0


def _resumed(
    text: str, aside: re.Match[str], before: list[tuple[int, int, tuple[str, ...]]]
) -> list[tuple[int, int, tuple[str, ...]]]:
    """Where the subject goes on behind one that only stands beside it: "passed V3 parked there and turned left"."""
    beside = _BESIDE.search(text[max(0, aside.start() - 60) : aside.start()])
    if not before or not (beside or rule("clauses.told_aside").match(text, aside.end())):
        return []
    stop = next((m.start() for m in _SUBJECT.finditer(text, aside.end())), len(text))
    onward = rule("clauses.resumes").search(text, aside.end(), stop)
    return [(onward.start(), onward.end(), before[-1][2])] if onward else []


def _subjects(text: str) -> Iterator[re.Match[str]]:
    """Mentions that may be subjects; of "V2, and V2" and "behind V2 and V3 was", which are no lists, the last alone."""
    for m in _SUBJECT.finditer(text):
        named = list(MENTION.finditer(text, m.start(), m.end())) if m.group("list") else []
        again = len(named) > 1 and len({n[0] for n in named}) == 1
        alone = named and rule("clauses.one_alone").match(text, m.end()) and _BESIDE.search(text[: m.start()])
        yield (_SUBJECT.match(text, named[-1].start()) or m) if again or alone else m


def _means_all(statement: Statement, pronoun: re.Match[str]) -> bool:
    return statement.several or bool(rule("clauses.both_behind").match(statement.text[pronoun.end() :]))


def _whom(match: re.Match[str], roster: Roster) -> tuple[str, ...]:
    if match.group("stranger"):
        return ()
    if match.group("both"):
        if len(roster.ids) > 2 and rule("clauses.the_two").match(match.group()):
            return _last_two(match, roster)
        told = None if roster.counted else rule("clauses.how_many").match(match.group())
        return (
            roster.ids
            if len(roster.ids) > 1 and (not told or NUMBERS[told["number"].lower()] == len(roster.ids))
            else ()
        )
    return tuple(dict.fromkeys(v for v in MENTION.findall(match.group()) if v in roster.ids))


def _last_two(both: re.Match[str], roster: Roster) -> tuple[str, ...]:
    """Resolves "both" where there are more than two: the two named last before it in its sentence, else all."""
    named = [v for v in MENTION.findall(both.string[: both.start()]) if v in roster.ids]
    last = tuple(dict.fromkeys(reversed(named)))[:2]
    return last if len(last) > 1 else roster.ids


def _is_subject(text: str, match: re.Match[str]) -> bool:
    before = text[max(0, match.start() - 60) : match.start()]
    if match.group("stranger") and rule("clauses.is_a").search(before):
        return False
    behind = rule("clauses.aside").sub("", text[match.end() :])
    if rule("clauses.driver_told").search(before) and rule("clauses.tells_of_himself").match(behind):
        return True
    if _BESIDE.search(before):
        if rule("clauses.of_neighbor").search(before) and behind.startswith(" that "):
            return False
        stands = rule("clauses.stands_beside").match(behind)
        if stands and rule("clauses.in_front_of_it").search(before) and MENTION.search(text[: match.start()]):
            return False  # who is ahead of V1 stands there, not V1: "V2 was in front of V1 stopped at the light"
        return bool(rule("clauses.relative").match(behind) or stands)
    if rule("clauses.driver_of").search(before):
        return _acts(behind) and not (behind.startswith(" and ") and rule("clauses.touched_part").search(before))
    if rule("clauses.preposition").search(before):
        if rule("clauses.yielded").search(before) and rule("clauses.located_doing").match(behind):
            return True
        if rule("clauses.evaded").search(before):
            return False  # who evades it goes on: "in an attempt to avoid V2 turned left"
        reported = rule("clauses.reports").search(before) and not rule("clauses.then").match(behind)
        return bool(rule("clauses.participle").match(behind)) or bool(reported and _VERB.match(behind))
    return _acts(behind)


def _acts(behind: str) -> bool:
    """Whether a verb follows a mention, at once or behind words that say where the vehicle is."""
    located = (rule("clauses.located"), rule("near_events.located"))
    return bool(_VERB.match(behind)) or any(_VERB.match(place.sub("", behind)) for place in located)
