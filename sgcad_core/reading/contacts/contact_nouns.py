"""Contacts that a sentence tells by nouns: "the impact was between ...", "V1 received an impact to its rear".

Also the area pairs that stand behind a verb ("front to left side"). Reads sentences in the one form of
`sgcad_core.reading.text.area_phrases.plain`. Knows no subjects: every vehicle is named.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from sgcad_core.reading.language import rule
from sgcad_core.reading.text.area_phrases import Zone, area_of


class NounContact(NamedTuple):
    """Two vehicles and the areas that met; `by` the other: whether the first one was struck."""

    first: str
    second: str
    first_area: Zone | None
    second_area: Zone | None
    words: str
    by: bool = False


_PUSHES = (("v1", "v2", "a2"), ("v3", "v4", "a4"), ("v5", "v6", "a6"))
"""Groups of a pushed vehicle, the vehicle it is pushed into, and the area."""
_NOTHING = rule("contact_nouns.nothing")


def touches(text: str) -> Iterator[NounContact]:
    """Every contact that nouns tell in a sentence, in the order of their certainty."""
    told = (
        rule("contact_words.between"),
        rule("contact_words.both_parts"),
        rule("contact_nouns.named"),
        rule("contact_nouns.caused"),
    )
    for m in (m for pattern in told for m in pattern.finditer(text)):
        if not _NOTHING.search(text[: m.start()]):
            front = "front" if rule("contact_nouns.head_on").match(text[m.end() :]) else None
            yield NounContact(m["v1"], m["v2"], _maybe(m["a1"]) or front, _maybe(m["a2"]) or front, "between")
    for m in rule("contact_nouns.between_thing").finditer(text):
        if not _NOTHING.search(text[: m.start()]):
            yield NounContact(m["v"] or m["v2"], m["object"].lower(), _maybe(m["area"] or m["area2"]), None, "between")
    for m in rule("contact_words.pushed").finditer(text):
        a, b, area = next((m[v], m[w], m[z]) for v, w, z in _PUSHES if m[v])
        yield NounContact(a, b, "front", _maybe(area) or "back", "pushed")
    for m in rule("contact_nouns.received").finditer(text):
        yield NounContact(m["v1"], m["v2"], _maybe(m["a1"]), _maybe(m["a2"]), "received", True)
    for m in rule("contact_nouns.took").finditer(text):
        yield NounContact(
            m["v1"], m["v2"], _maybe(m["a0"]) or _maybe(m["a1"]) or area_of(m["how"]), _maybe(m["a2"]), "took", True
        )


def together(text: str) -> Iterator[NounContact]:
    """ "... came together, the front of V1 to the left side of V2": no verb, so only where no verb tells more."""
    for m in rule("contact_nouns.together").finditer(text):
        if not _NOTHING.search(text[: m.start()]):
            yield NounContact(m["v1"], m["v2"], _maybe(m["a1"]), _maybe(m["a2"]), "together")
    for m in rule("contact_nouns.into").finditer(text):
        if not _NOTHING.search(text[: m.start()]):
            yield NounContact(m["v1"], m["v2"], "front" if m["how"] else None, _maybe(m["a2"]), "into")


def involved(text: str) -> Iterator[NounContact]:
    """ "V1 was in a collision involving V2": of use only where nothing tells how."""
    for m in rule("contact_nouns.involved").finditer(text):
        yield NounContact(m["v1"], m["v2"], None, None, "involved")


def door_of(actor: str, before: str, scope: str) -> str | None:
    """The words for a door or mirror that struck `actor`, where a sentence names no owner: it belongs to another
    vehicle."""
    part = rule("contact.a_part").search(before)
    struck = rule("contact_words.active_object").match(scope) if part else None
    return part["area"] if part and struck and struck["v"] == actor else None


def _maybe(words: str | None) -> Zone | None:
    return area_of(words) if words else None


def paired_areas(scope: str) -> tuple[Zone | None, Zone | None] | None:
    """Both areas of "front to left side" and of "head-on", the subject's first."""
    if rule("contact_nouns.head_on").match(scope):
        return "front", "front"
    pair = rule("contact_words.paired").search(scope)
    if not pair or pair.start() > 60 or "with" in pair.group():
        return None
    return _maybe(pair["a1"]), _maybe(pair["a2"])


def struck_pair(scope: str, area: Zone | None, other_area: Zone | None) -> tuple[Zone | None, Zone | None]:
    """ "V2 was struck by V1, front to left side": the front, where only one is, belongs to the striking vehicle."""
    against = rule("contact_words.against").search(scope)
    by = rule("contact_words.by").search(scope)
    if against and by and by["v"] == against["v1"]:
        return _maybe(against["a2"]), _maybe(against["a1"])
    pair = None if against or area or other_area else paired_areas(scope)
    if not pair:
        return area, other_area
    return (pair[1], pair[0]) if _strikes_first(pair) else pair


def _strikes_first(pair: tuple[Zone | None, Zone | None]) -> bool:
    """Whether the first of two areas is the striker's front."""
    return (pair[0] or "").startswith("front") or not (pair[1] or "").startswith("front")


def is_noun(before: str, word: str, behind: str) -> bool:
    """ "the impact", "at impact", "of contact": no verb."""
    nouns = ("impact", "contact", "hit", "impacts", "contacts", "hits", "strike")
    if word.lower() not in nouns or rule("contact_words.caused").search(before):
        return False
    return bool(rule("contact.noun_before").search(before))


def subject_area(before: str, subject: str) -> Zone | None:
    """Area in "the front of V1 ..." if the nearest mention of the subject has one."""
    found = list(rule("contact.subject_area").given(vehicle=subject).finditer(before))
    if found and found[-1]["area"] and not rule("contact.place_before").search(before[: found[-1].start("area")]):
        return area_of(found[-1]["area"])
    own = rule("contact.own_area").search(before) or rule("contact.with_before").search(before)
    return area_of(own["area"]) if own else None
