"""Contacts in the order of the text: striker, struck and areas.

A sentence is first brought to one form ("V1's front" -> "the front of V1"), then every verb of hitting is read with its
subject, voice and object. Interviews come last: they exchange numbers. Infers no area.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from sgcad_core.reading.actors.people_objects import with_people
from sgcad_core.reading.actors.vehicles import MENTION, Roster
from sgcad_core.reading.contacts.contact_nouns import (
    area_against_area,
    area_behind,
    clause,
    damaged,
    door_of,
    involved,
    is_noun,
    mutual,
    paired_areas,
    struck_pair,
    subject_area,
    together,
    touches,
    unnamed_pair,
    with_damage,
    with_damages,
    with_striker,
    without_agent,
)
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.contacts.contact_things import (
    any_object,
    behind_things,
    listed,
    listed_things,
    lone_thing,
    off_the_ground,
    thing_acts,
    thing_hit,
)
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement, subject_starts
from sgcad_core.reading.text.area_phrases import Zone, area_by, area_if_told, area_of, plain
from sgcad_core.reading.text.sentence_roles import HIT

_NEAR = 80
"""Characters behind a verb within which the side that struck a thing is told."""


def contact_mentions(statements: Iterable[Statement], roster: Roster) -> tuple[ContactMention, ...]:
    """Every contact told, in order: the crash's own sentences first, other witnesses behind them."""
    crash: list[ContactMention] = []
    retold: list[ContactMention] = []
    statements = tuple(statements if roster.counted else with_people(statements))
    for t in statements:
        if t.role in ("codes", "factors", "police", "health", "formal"):
            continue
        told = t.role in ("impact", "approach", "avoidance", "rest", "opening", "road", "conditions", "other")
        (crash if told else retold).extend(_sentence(t, roster))
    first = min((b.number for b in crash if b.other in roster.ids), default=0)
    early = [b for b in retold if b.number < first and b.other in roster.ids]
    found = off_the_ground((*early, *crash, *(b for b in retold if b not in early)))
    return with_damages(found, statements, roster) or _only_named(statements, roster)


def _only_named(statements: Iterable[Statement], roster: Roster) -> tuple[ContactMention, ...]:
    """Contacts of a report that says only which vehicles collided."""
    found = (replace(b, mutual=True, summary=True) for t in statements for b in involved(t, plain(t, roster)))
    return tuple(b for b in found if len({b.actor, b.other} & set(roster.ids)) == 2)


def _sentence(statement: Statement, roster: Roster) -> list[ContactMention]:
    text = plain(statement, roster)
    found: list[ContactMention] = []
    starts = subject_starts(statement._replace(text=text), roster)
    parts = list(rule("contact_words.both_parts").finditer(text))
    for m in HIT.finditer(text):
        if any(p.start() < m.start() <= p.end() for p in parts):
            continue
        mention = _contact_mention(statement, text, m, starts, roster)
        if mention:
            behind = text[m.end() :]
            told = [mention, *listed(mention, behind), *listed_things(mention, behind), *behind_things(mention, behind)]
            told += _also(mention, _subjects(statement, text[: m.start()], m, starts))
            found += [replace(b, at=_place(text, b.other, m.start())) for b in told]
    nouns = tuple(touches(statement, text))
    found += [replace(b, at=b.at or _place(text, b.other)) for b in nouns]
    found = sorted(found, key=lambda b: b.at) if any(b.at for b in nouns) else found
    found = [with_striker(b, text) for b in found] or unnamed_pair(statement, text, roster)
    told_by_verbs = {frozenset((b.actor, b.other)) for b in found}
    found += [b for b in without_agent(statement, text, roster) if frozenset((b.actor, b.other)) not in told_by_verbs]
    found += [b for b in together(statement, text) if frozenset((b.actor, b.other)) not in told_by_verbs]
    return [b for b in found if b.actor in roster.ids and b.actor != b.other]


def _also(mention: ContactMention, subjects: tuple[str, ...]) -> Iterator[ContactMention]:
    """The same contact of the verb's further subjects, each a striker as well, or struck as well."""
    if mention.mutual or (mention.other if mention.passive else mention.actor) not in subjects:
        return
    for v in subjects:
        if v not in (mention.actor, mention.other):
            yield replace(mention, other=v) if mention.passive else replace(mention, actor=v)


def _place(text: str, word: str, verb: int = 0) -> int:
    """Where the first mention of a word behind a verb stands, else the verb."""
    at = text.lower().find(word.lower(), verb)
    return verb if at < 0 else at


def _contact_mention(
    statement: Statement, text: str, m: re.Match[str], starts: list[tuple[int, int, tuple[str, ...]]], roster: Roster
) -> ContactMention | None:
    before, behind = text[: m.start()], text[m.end() :]
    passive = bool(rule("contact_words.passive").search(before)) and not rule("contact.made_contact").match(m.group())
    passive = passive or bool(rule("contact.reduced").match(m.group() + behind))
    befell = rule("contact_words.to_hit").search(before) or (
        roster.counted and rule("near_events.unavoidable").search(before)
    )
    if not befell and (rule("contact_words.near_miss").search(before) or is_noun(before, m.group(), behind)):
        return None
    nxt = HIT.search(behind)
    scope = behind[: nxt.start()] if nxt else behind
    thing = (
        (rule("contact_words.thing_was").search(before) or rule("contact_words.person_was").search(before))
        if passive
        else None
    )
    if thing:
        return thing_hit(statement, thing, scope, m.group())
    moves = thing_acts(before, roster)
    if moves and not passive and (hit := _hit_by_thing(statement, moves, scope, m.group(), roster)):
        return hit
    subjects = _subjects(statement, before, m, starts)
    alone = len(roster.ids) == 1 and rule("contact.own_area").search(before)
    subjects = subjects or (roster.ids if alone else ())  # "a deer came from the left where the front struck it"
    if not subjects:
        return None
    struck_by = passive and rule("contact_words.by").search(scope)
    third = rule("contact_words.active_object").match(scope)
    if len(subjects) > 1 and not (lone_thing(scope) or struck_by or (third and third["v"] not in subjects)):
        return mutual(statement, subjects, m.group(), before, scope)
    actor, actor_area = subjects[0], subject_area(before, subjects[0])
    if actor not in MENTION.findall(before):
        actor = _meant_by_pronoun(statement, actor, scope, roster)
    other = None if passive or not roster.counted else roster.other(actor)
    if other and (part := door_of(actor, before, scope)):
        actor, actor_area = other, area_of(part)
    if passive:
        return _passive(statement, actor, actor_area, scope, m.group(), roster)
    told = _active(statement, actor, actor_area, scope, m.group(), roster)
    if not told or told.other in roster.ids:
        return with_damage(told, scope)
    parts = (before, f"{scope}." if nxt else scope)  # a part right before the next verb is what touches there
    return replace(told, actor_area="front") if any(map(rule("contact_words.wheel_end").search, parts)) else told


def _meant_by_pronoun(statement: Statement, actor: str, scope: str, roster: Roster) -> str:
    """Resolves "it" as striker or struck: never the vehicle that the sentence itself names behind the verb."""
    whom = MENTION.search(scope)
    return (_the_other(statement, actor, roster) or actor) if whom and whom.group() == actor else actor


def _hit_by_thing(
    statement: Statement, thing: re.Match[str], scope: str, verb: str, roster: Roster
) -> ContactMention | None:
    """ "The gate closed and made contact with the front of V1"."""
    whom, area = _object(statement, "", scope, roster)
    if whom not in roster.ids and rule("contact_words.own_front").match(scope):
        named = MENTION.findall(thing.string) or (roster.ids if len(roster.ids) == 1 else [None])
        whom, area = named[-1], "front"
    if whom not in roster.ids or whom is None:
        return None
    return ContactMention(
        whom, thing["object"].lower(), area, None, statement.number, statement.role, False, verb.lower()
    )


def _subjects(
    statement: Statement, before: str, m: re.Match[str], starts: list[tuple[int, int, tuple[str, ...]]]
) -> tuple[str, ...]:
    """The vehicles that are the subject of this verb."""
    caused = rule("contact_words.caused").search(before)
    if caused:
        return (caused["v"],)
    fitting = [s for at, _, s in starts if at < m.start()]
    if fitting and not fitting[-1]:  # somebody else is the subject, unless the verb has one of its own
        own = rule("contact_words.right_before").search(before)
        goes_on = rule("contact_words.and_then").search(before)
        earlier = next((s for s in reversed(fitting) if s), ())
        return (own["v"],) if own else earlier if goes_on else ()
    if fitting:
        return fitting[-1]
    mentions = MENTION.findall(before)
    if mentions:
        return (mentions[-1],)
    return (statement.subject,) if statement.subject else ()


def _active(
    statement: Statement, actor: str, area: Zone | None, scope: str, verb: str, roster: Roster
) -> ContactMention | None:
    pair, near = paired_areas(scope), scope[:_NEAR]
    scope = clause(rule("contact_words.aside").sub(" ", scope))
    first = rule("contact_words.own_first").match(scope)
    if first and (first["own"] == actor if first["own"] else MENTION.findall(scope)[:1] != [actor]):
        area, scope = area_of(first["area"]) or area, " " + scope[first.end() :]
    own = rule("contact_words.with_its").search(scope)
    if own and rule("contact.made_contact").match(verb) and rule("contact.touched").match(scope):
        own = None  # "made contact with the left door": its owner is told elsewhere
    area = area_of(own["area"]) if own else area
    rest = scope[: own.start()] + scope[own.end() :] if own else scope
    other, other_area = _object(statement, actor, rest, roster)
    if other is None or (not roster.counted and rule("contact_words.stranger_object").match(rest)):
        return None
    if (named := rule("contact.with_area_of").search(scope)) and named["v"] != other and scope[: named.start()].strip():
        actor, area = named["v"], area_of(named["area"])
    if other not in roster.ids and (hurt := rule("contact_words.own_on_thing").search(near)):
        area = area or area_of(hurt["plane"] or hurt["area"])
    if rule("contact.rear_end").match(verb) or rule("contact.from_behind").search(scope):
        area, other_area = area or "front", "back"
    if rule("contact.backs_into").match(verb):
        area = area or "back"
    if pair and area is None:
        area, other_area = pair
    mention = ContactMention(actor, other, area, other_area, statement.number, statement.role, False, verb.lower())
    return area_against_area(mention, scope)


def _object(statement: Statement, actor: str, scope: str, roster: Roster) -> tuple[str | None, Zone | None]:
    """What was hit, and where."""
    m = rule("contact_words.active_object").match(scope)
    thing = rule("contact_words.object").match(scope)
    if m and not (thing and thing.end() < m.start("v") and thing["object"].lower() != "trailer"):
        area = area_if_told(m["area"]) or area_behind(scope[m.end() :])
        return _not_itself(m["v"], actor, roster, statement), area
    towed = ("trailer", "parked") if len(roster.ids) > 1 else ("parked",)
    if thing and thing["object"].lower() not in towed:
        return thing["object"].lower(), None
    if (
        rule("contact_words.pronoun_object").match(scope)
        or rule("contact_words.the_area").match(scope)
        or rule("contact.nothing").match(scope)
    ):
        only = rule("contact_words.the_area").match(scope)
        return _the_other(statement, actor, roster), area_if_told(only["area"]) if only else area_behind(
            scope
        ) or damaged(statement, roster)
    late = MENTION.search(scope)
    if late and late.group() != actor and late.start() < 60:
        named = rule("contact.area_of_vehicle").given(vehicle=late.group()).search(scope)
        return late.group(), area_if_told(named["area"]) if named else area_behind(scope[late.end() :])
    return any_object(statement, scope, roster), None


def _the_other(statement: Statement, actor: str, roster: Roster) -> str | None:
    """The vehicle that "it" means: of two the other one, else another of the sentence, else the unnumbered subject."""
    subject = next((v for v in roster.ids[:1] if roster.counted and v != actor), None)
    named = (v for v in MENTION.findall(statement.text) if v != actor and v in roster.ids)
    return roster.other(actor) or next(named, subject or (statement.earlier if statement.earlier != actor else None))


def _not_itself(named: str, actor: str, roster: Roster, statement: Statement) -> str | None:
    """The named vehicle; where it would strike itself the other one of two, or the subject of the sentence before."""
    if named != actor:
        return named
    return roster.other(actor) if roster.counted else _the_other(statement, actor, roster)


def _passive(
    statement: Statement, actor: str, area: Zone | None, scope: str, verb: str, roster: Roster
) -> ContactMention | None:
    by = rule("contact_words.by").search(scope)
    where = rule("contact_words.on_the").search(scope[: by.start()] if by else scope) or rule(
        "contact.area_first"
    ).match(scope)
    area = area or (area_of(where["area"]) if where else None)
    other = by["v"] if by else roster.other(actor)
    if by and rule("contact.by_stranger").search(scope[: by.start()]):
        return None
    if not by and not roster.counted and (thing := rule("contact_words.by_thing").search(scope)):
        return ContactMention(
            actor, thing["object"].lower(), area, None, statement.number, statement.role, False, verb.lower()
        )
    other_area = area_if_told(by["area"]) if by else area_by(scope)
    own = rule("contact_words.with_its").search(scope[by.end() :] if by else scope)
    other_area = other_area or (area_of(own["area"]) if own else None)
    if rule("contact.rear_end").match(verb) or rule("contact.from_behind").search(scope):
        area, other_area = area or "back", other_area or "front"
    if other is None:
        return None
    area, other_area = struck_pair(scope, area, other_area)
    area = area or (area_behind(scope[by.end() :]) if by and not own else None)
    other = _not_itself(other, actor, roster, statement) or other
    return ContactMention(other, actor, other_area, area, statement.number, statement.role, True, verb.lower())
