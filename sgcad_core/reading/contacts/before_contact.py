"""What a segment tells of the time before the first contact, and what of the time behind it.

Knows segments and the sentence of the first contact; no vehicle and no fact.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from sgcad_core.reading.actors.vehicles import MENTION
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Segment, Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.sentence_roles import HIT, Role

RETOLD: frozenset[Role] = frozenset({"interview"})
"""Roles of sentences in which the crash is told once more."""


def offset_fronts(statements: Iterable[Statement], vehicles: Collection[str]) -> Iterator[tuple[str, Source]]:
    """Vehicles whose fronts met with a part of their widths, each with where that is told."""
    for told in statements:
        if rule("course_impacts.offset").search(told.text):
            source = Source(told.number, "", "course_impacts.offset")
            yield from ((vehicle, source) for vehicle in vehicles if vehicle in MENTION.findall(told.text))


def is_late(segment: Segment, impact: int, late: bool) -> bool:
    """Whether what follows a segment in its sentence comes after the contact that the segment, or one before it, tells:
    "hit V1, after which V2 left the road", but not "hit V1 while V2 left the road"."""
    if segment.number != impact or segment.role in RETOLD:
        return False
    return (late or HIT.search(segment.text) is not None) and not rule("course_evasion.meanwhile").search(segment.text)


def split(segment: Segment, impact: int) -> tuple[str, str]:
    """A segment's text before and behind the first contact."""
    text = segment.text
    later = rule("course_evasion.afterwards").search(text)
    if text.startswith(("was made to", "was pushed", "was sent", "were made to")):
        return "", text
    rest = rule("course_rest.rest").search(text)
    if later:
        at = min(later.start(), rest.start() if rest else later.start())
        return text[:at], text[at:]
    hit = next((m for m in HIT.finditer(text) if not rule("motion_reader.no_hit").search(text[: m.start()])), None)
    if segment.number == impact or (segment.role == "impact" and segment.number < impact):
        return (text[: hit.start()], text[hit.start() :]) if hit else (text, "")
    if segment.number < impact:
        return (text[: rest.start()], text) if rest and segment.role == "rest" else (text, "")
    if segment.role == "interview" or (segment.role == "avoidance" and _if_evading(text)):
        return text[: hit.start()] if hit else text, text[rest.start() :] if rest else ""
    if segment.role in ("rest",):
        return "", text
    return text[: hit.start()] if hit else _if_evading(text), text


def _if_evading(text: str) -> str:
    """A text behind the impact that retells an evasion before it; else ""."""
    avoids = rule("course_evasion.to_avoid").search(text) or rule("course_evasion.saw_it_come").search(text)
    return text if avoids or rule("course_evasion.none").search(text) else ""
