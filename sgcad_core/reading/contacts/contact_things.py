"""Things, animals and lists in a contact: what strikes by itself, what has no name of its own, who else is listed."""

from __future__ import annotations

import re
from dataclasses import replace

from sgcad_core.reading.actors.vehicles import MENTION, Roster
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.text.area_phrases import area_if_told
from sgcad_core.reading.text.sentence_roles import Role

_QUOTED: tuple[Role, ...] = ("interview", "injury", "restraint", "towing")
"""Roles of sentences that speak of people inside, or after the crash."""


def listed(mention: ContactMention, scope: str) -> list[ContactMention]:
    """ "V1 struck the fronts of V2, V3 and V4": the same for those that are listed behind the first one."""
    found = rule("contact_words.vehicle_list").match(scope)
    if mention.passive or not found or found["first"] != mention.other:
        return []
    named = rule("contact_words.listed_vehicle").finditer(found["others"])
    return [
        replace(mention, other=m["v"], other_area=area_if_told(m["area"]) or mention.other_area)
        for m in named if m["v"] != mention.actor
    ]  # fmt: skip


def listed_things(mention: ContactMention, scope: str) -> list[ContactMention]:
    """ "V1 struck a rock and then a post": the same for the things that are listed behind the first one."""
    thing = None if mention.passive or MENTION.fullmatch(mention.other) else rule("contact_words.object").match(scope)
    found: list[ContactMention] = []
    while thing:
        thing = rule("course_impacts.further").match(scope, thing.end())
        if thing:
            found.append(replace(mention, other=thing["thing"].lower()))
    return found


def lone_thing(scope: str) -> bool:
    """Whether what is struck is a thing, and no vehicle is named before the clause ends."""
    thing = rule("contact_words.object").match(scope)
    end = rule("contact_words.clause_end").search(scope)
    return bool(thing) and not MENTION.search(scope[: end.start()] if end else scope)


def behind_things(mention: ContactMention, scope: str) -> list[ContactMention]:
    """ "V1 struck a sign, a fence, and the left side of V2": the vehicle that a list of things ends with."""
    found = None if mention.passive or mention.other.startswith("V") else rule("contact_words.thing_list").match(scope)
    if not found or found["v"] == mention.actor:
        return []
    return [replace(mention, other=found["v"], other_area=area_if_told(found["area"]))]


def thing_hit(statement: Statement, thing: re.Match[str], scope: str, verb: str) -> ContactMention | None:
    """ "A tree was struck by the front of V1"."""
    by = rule("contact_words.by").search(scope)
    if not by:
        return None
    area = area_if_told(by["area"])
    return ContactMention(
        by["v"], thing["object"].lower(), area, None, statement.number, statement.role, False, verb.lower()
    )


def thing_acts(before: str, roster: Roster) -> re.Match[str] | None:
    """The thing or animal that is the subject of a verb of touching."""
    if roster.counted:
        return rule("contact_words.thing_moves").search(before)
    return rule("contact_words.thing_acts").search(before) or rule("contact_words.thing_enters").search(before)


def any_object(statement: Statement, scope: str, roster: Roster) -> str | None:
    """A thing without a name of its own; beside vehicle numbers no vehicle, no person and no part of either."""
    anything = rule("contact_words.any_object").match(scope)
    if anything is None or roster.counted:
        return anything["object"].lower() if anything else None
    known = statement.role in _QUOTED or rule("contact_words.no_thing").search(anything[0])
    return None if known else anything["object"].lower()


def off_the_ground(told: tuple[ContactMention, ...]) -> tuple[ContactMention, ...]:
    """Without contacts with the ground, where anything else was touched: it is no thing that stands there."""
    return tuple(b for b in told if b.other != "ground") or told
