"""Contacts that a sentence tells by nouns: "the impact was between ...", "V1 received an impact to its rear".

Also the area pairs that stand behind a verb ("front to left side"). Reads sentences in the one form of
`sgcad_core.reading.text.area_phrases.plain`. Knows no subjects: every vehicle is named.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from sgcad_core.reading.actors.vehicles import MENTION, Roster
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.text.area_phrases import Zone, area_if_told, area_of, plain

_PUSHES = (("v1", "v2", "a2"), ("v3", "v4", "a4"), ("v5", "v6", "a6"))
"""Groups of a pushed vehicle, the vehicle it is pushed into, and the area."""
_BOTH_PARTS = rule("contact_words.both_parts")
"""Both sides before the verb: "V1's front and V2's back made contact", told in the place of a verb."""
_NOTHING = rule("contact_nouns.nothing")


def touches(statement: Statement, text: str) -> Iterator[ContactMention]:
    """Every contact that nouns tell in a sentence, in the order of their certainty."""
    pairs = (
        rule("contact_words.between"),
        _BOTH_PARTS,
        rule("contact_nouns.named"),
        rule("contact_nouns.caused"),
    )
    for m in (m for pattern in pairs for m in pattern.finditer(text)):
        if not _NOTHING.search(text[: m.start()]):
            front = "front" if rule("contact_nouns.head_on").match(text[m.end() :]) else None
            told = _mention(
                statement, m["v1"], m["v2"], area_if_told(m["a1"]) or front, area_if_told(m["a2"]) or front, "between"
            )
            yield replace(told, at=m.end()) if m.re == _BOTH_PARTS.pattern else told
    for m in rule("contact_nouns.between_thing").finditer(text):
        if not _NOTHING.search(text[: m.start()]):
            yield _mention(
                statement,
                m["v"] or m["v2"],
                m["object"].lower(),
                area_if_told(m["area"] or m["area2"]),
                None,
                "between",
            )
    for m in rule("contact_words.pushed").finditer(text):
        a, b, area = next((m[v], m[w], m[z]) for v, w, z in _PUSHES if m[v])
        yield _mention(statement, a, b, "front", area_if_told(area) or "back", "pushed")
    for m in rule("contact_nouns.received").finditer(text):
        yield _mention(statement, m["v1"], m["v2"], area_if_told(m["a1"]), area_if_told(m["a2"]), "received", True)
    for m in rule("contact_nouns.took").finditer(text):
        area = area_if_told(m["a0"]) or area_if_told(m["a1"]) or area_of(m["how"])
        yield _mention(statement, m["v1"], m["v2"], area, area_if_told(m["a2"]), "took", True)


def without_agent(statement: Statement, text: str, roster: Roster) -> Iterator[ContactMention]:
    """ "Contact was made with the left side of V1", "... resulting in a collision": who else met is told before."""
    for m in rule("contact_nouns.made_with").finditer(text):
        area = area_if_told(m["a1"]) or area_if_told(m["own"])
        other = m["v2"] or _before(statement, text[: m.start()], m["v1"], roster)
        if other and not _NOTHING.search(text[: m.start()]):
            if m["v2"] or m["v1"] == roster.ids[0]:
                yield _mention(statement, m["v1"], other, area, area_if_told(m["a2"]), "made_with", True)
            else:
                yield _mention(statement, other, m["v1"], None, area, "made_with")
    for m in rule("contact_nouns.resulted").finditer(text):
        before = text[: m.start()] if MENTION.search(text[: m.start()]) else text
        named = [v for v in MENTION.findall(before) if v in roster.ids]
        actor = named[-1] if named else None
        other = _before(statement, before, actor, roster) if actor else None
        if actor and other and not _NOTHING.search(text[: m.start()]):
            front, back = ("front", "back") if m["how"] else (None, None)
            yield _mention(statement, actor, other, front, back, "resulted")


def _before(statement: Statement, before: str, vehicle: str, roster: Roster) -> str | None:
    """The other vehicle that the words before name last, else the one that the sentence before is about."""
    named = [v for v in MENTION.findall(before) if v != vehicle and v in roster.ids]
    earlier = statement.earlier if statement.earlier != vehicle else None
    return named[-1] if named else roster.other(vehicle) or earlier


def together(statement: Statement, text: str) -> Iterator[ContactMention]:
    """ "... came together, the front of V1 to the left side of V2": no verb, so only where no verb tells more."""
    for m in rule("contact_nouns.together").finditer(text):
        if not _NOTHING.search(text[: m.start()]):
            yield _mention(statement, m["v1"], m["v2"], area_if_told(m["a1"]), area_if_told(m["a2"]), "together")
    for m in rule("contact_nouns.into").finditer(text):
        if not _NOTHING.search(text[: m.start()]):
            yield _mention(statement, m["v1"], m["v2"], "front" if m["how"] else None, area_if_told(m["a2"]), "into")


def involved(statement: Statement, text: str) -> Iterator[ContactMention]:
    """ "V1 was in a collision involving V2": of use only where nothing tells how."""
    for m in rule("contact_nouns.involved").finditer(text):
        yield _mention(statement, m["v1"], m["v2"], None, None, "involved")


def _mention(
    statement: Statement,
    first: str,
    second: str,
    area: Zone | None,
    other_area: Zone | None,
    words: str,
    by: bool = False,
) -> ContactMention:
    """`by` the second one: the first one was struck."""
    if by:
        return ContactMention(second, first, other_area, area, statement.number, statement.role, True, words, noun=True)
    return ContactMention(first, second, area, other_area, statement.number, statement.role, words=words, noun=True)


def door_of(actor: str, before: str, scope: str) -> str | None:
    """The words for a door or mirror that struck `actor`, where a sentence names no owner: it belongs to another
    vehicle."""
    part = rule("contact.a_part").search(before)
    struck = rule("contact_words.active_object").match(scope) if part else None
    return part["area"] if part and struck and struck["v"] == actor else None


def paired_areas(scope: str) -> tuple[Zone | None, Zone | None] | None:
    """Both areas of "front to left side" and of "head-on", the subject's first."""
    if rule("contact_nouns.head_on").match(scope):
        return "front", "front"
    pair = rule("contact_words.paired").search(scope)
    if not pair or pair.start() > 60 or "with" in pair.group():
        return None
    return area_if_told(pair["a1"]), area_if_told(pair["a2"])


def struck_pair(scope: str, area: Zone | None, other_area: Zone | None) -> tuple[Zone | None, Zone | None]:
    """ "V2 was struck by V1, front to left side": the front, where only one is, belongs to the striking vehicle."""
    against = rule("contact_words.against").search(scope)
    by = rule("contact_words.by").search(scope)
    if against and by and by["v"] == against["v1"]:
        return area_if_told(against["a2"]), area_if_told(against["a1"])
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
    if word.lower() == "hit" and rule("contact.own_area").search(before):
        return False
    return bool(rule("contact.noun_before").search(before))


def subject_area(before: str, subject: str) -> Zone | None:
    """Area in "the front of V1 ..." if the nearest mention of the subject has one."""
    if own := rule("contact.own_area").search(before):
        return area_of(own["area"])
    named = rule("contact.subject_area").within(vehicle=r"(?P<vehicle>V\d+)")  # one pattern for all vehicles
    found = [m for m in named.finditer(before) if m["vehicle"].upper() == subject.upper()]
    if found and found[-1]["area"] and not rule("contact.place_before").search(before[: found[-1].start("area")]):
        return area_of(found[-1]["area"])
    own = rule("contact.with_before").search(before)
    return area_of(own["area"]) if own else None


def with_striker(mention: ContactMention, text: str) -> ContactMention:
    """A mutual collision with the striker first, where the sentence names it."""
    said = rule("contact_nouns.striker").search(text) if mention.mutual or mention.noun else None
    if not said or said["v"] != mention.other:
        return mention
    return replace(
        mention, actor=mention.other, other=mention.actor, actor_area=mention.other_area, other_area=mention.actor_area
    )


def unnamed_pair(statement: Statement, text: str, roster: Roster) -> list[ContactMention]:
    """ "Front met front.", where there are but two."""
    pair = rule("contact_nouns.bare_pair").search(text) if len(roster.ids) == 2 and not MENTION.search(text) else None
    if not pair or roster.counted:
        return []
    (one, other), mine, theirs = roster.ids, area_of(pair["a1"]), area_of(pair["a2"])
    return [
        ContactMention(
            one, other, mine, theirs, statement.number, statement.role, words="bare_pair", mutual=True, noun=True
        )
    ]


def mutual(statement: Statement, subjects: tuple[str, ...], verb: str, before: str, scope: str) -> ContactMention:
    """ "V1 and V2 collided front to front"."""
    against = rule("contact_words.against").search(scope)
    if against:
        zones = {against["v1"]: area_if_told(against["a1"]), against["v2"]: area_if_told(against["a2"])}
        first, second = zones.get(subjects[0]), zones.get(subjects[1])
        return ContactMention(
            subjects[0], subjects[1], first, second, statement.number, statement.role, False, verb.lower(), True
        )
    pair = rule("contact_words.paired").search(scope)
    first, second = (area_if_told(pair["a1"]), area_if_told(pair["a2"])) if pair else (None, None)
    if not pair:
        both = rule("contact_words.with_its").search(scope) or rule("contact_words.of_both").search(before)
        first = second = area_of(both["area"]) if both else None
    if rule("contact.head_on").search(scope):
        first = second = "front"
    return ContactMention(
        subjects[0], subjects[1], first, second, statement.number, statement.role, False, verb.lower(), True
    )


def area_against_area(mention: ContactMention, scope: str) -> ContactMention:
    """The mention with the areas of "the left side of V1 against the right side of V2" behind its verb."""
    met = rule("contact_words.against").search(scope)
    if not met or {met["v1"], met["v2"]} != {mention.actor, mention.other}:
        return mention
    zones = {met["v1"]: area_if_told(met["a1"]), met["v2"]: area_if_told(met["a2"])}
    return replace(mention, actor_area=zones[mention.actor], other_area=zones[mention.other])


def clause(scope: str) -> str:
    """Up to the end of the clause, but at least as far as the first vehicle behind the verb."""
    first = MENTION.search(scope)
    end = rule("contact_words.clause_end").search(scope, first.end() if first and first.start() < 70 else 0)
    return scope[: end.start()] if end else scope


def damaged(statement: Statement, roster: Roster) -> Zone | None:
    """ "The left side of V2 was damaged when V1 contacted it": the area that the sentence begins with."""
    found = rule("contact_words.damaged").match(plain(statement, roster))
    return area_of(found["area"]) if found else None


def area_behind(text: str) -> Zone | None:
    """ "... in the left side", "... in the center of the rear bumper": the first phrase that names a side."""
    near = rule("contact.area_ends").split(clause(text)[:80])[0]
    areas = [area_of(m["area"]) for m in rule("contact.owned_area").finditer(near)]
    return next(filter(None, areas), None) if rule("contact_words.on_the").search(near) else None


def with_damage(mention: ContactMention | None, scope: str) -> ContactMention | None:
    """A contact with the struck part as the damage tells it where nothing else does: "damaging V1's rear door"."""
    if mention is None or mention.other_area is not None:
        return mention
    found = rule("contact_words.damaging").given(vehicle=mention.other).search(scope)
    return replace(mention, other_area=area_of(found["area"] or found["part"])) if found else mention


def with_damages(
    found: tuple[ContactMention, ...], statements: Iterable[Statement], roster: Roster
) -> tuple[ContactMention, ...]:
    """The contacts; that of a report without numbers which tells of one pair alone with the sides that no contact
    tells but a sentence of their damage: "V2 sustained damage to its left door"."""
    pairs = {frozenset((b.actor, b.other)) for b in found if b.other in roster.ids}
    if not roster.counted or len(pairs) != 1:
        return found
    told = {who: area for who in min(pairs) if (area := _damage(who, statements, roster))}
    silent = {who for who in told if all(b.areas_of(who)[0] is None for b in found if who in (b.actor, b.other))}
    return tuple(
        replace(
            b,
            actor_area=told[b.actor] if b.actor in silent else b.actor_area,
            other_area=told[b.other] if b.other in silent else b.other_area,
        )
        for b in found
    )


def _damage(who: str, statements: Iterable[Statement], roster: Roster) -> Zone | None:
    """The side at which the first sentence of its damage tells it; a part without a side tells none."""
    damage = rule("contact_words.damage_of").given(vehicle=who)
    texts = (plain(t, roster) for t in statements if t.role not in ("codes", "factors", "interview"))
    areas = (area_of(m["own"] or m["area"]) for text in texts for m in damage.finditer(text))
    return next(filter(None, areas), None)
