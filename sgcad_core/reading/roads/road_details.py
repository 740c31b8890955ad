"""Curves, with the direction of travel that they hold for.

Reads resolved sentences. Knows no junction and no lane.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Literal, NamedTuple

from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.compass import compass_of, turned
from sgcad_core.reading.text.sentence_roles import STORY_ROLES
from sgcad_core.records.specs import Compass


class Curve(NamedTuple):
    """A bend as one drives along `toward` (None: the direction is not told)."""

    side: Literal["left", "right"]
    toward: Compass | None
    source: Source


_CURVE = rule("road_details.curve")
_BARE_CURVE = rule("road_details.bare_curve")


def curves(told: Sequence[Statement], headings: Mapping[str, Compass]) -> tuple[Curve, ...]:
    """Curves in order; one without a told side is taken to the left of the first vehicle."""
    story = [t for t in told if t.role in STORY_ROLES]
    found = tuple(c for t in story for c in _curves(t, headings))
    bare = [Source(t.number, m[0], _BARE_CURVE.id) for t in story if (m := _BARE_CURVE.search(t.text))]
    return found or tuple(Curve("left", None, source) for source in bare[:1])


def _curves(told: Statement, headings: Mapping[str, Compass]) -> Iterator[Curve]:
    if by_way := list(_curves_by_way(told)):
        yield from by_way
        return
    for m in _CURVE.finditer(told.text):
        side = next(filter(None, m.groups())).lower()
        if rule("road_details.nearby").search(told.text[: m.start()]):
            continue
        source = Source(told.number, m[0], _CURVE.id)
        yield Curve("left" if side == "left" else "right", _driven(told, m.start(), m.end(), headings), source)


def _curves_by_way(told: Statement) -> Iterator[Curve]:
    """The sides that a curve has for directions of travel that are named with them."""
    if not rule("road_details.curve_word").search(told.text):
        return
    coming = rule("road_details.curve_from")
    ways = [(m, m["hand"] or m["hand2"], compass_of(m["from"] or m["from2"])) for m in coming.finditer(told.text)]
    for m, hand, way in ways:
        if way:
            side: Literal["left", "right"] = "left" if hand.lower() == "left" else "right"
            yield Curve(side, turned(way, 180), Source(told.number, m[0], coming.id))
    if ways:
        return
    for by in (rule("road_details.curve_for"), rule("road_details.curve_as")):
        found = [(m, way) for m in by.finditer(told.text) if (way := compass_of(m["way"]))]
        for m, way in found:
            yield Curve("left" if m["hand"].lower() == "left" else "right", way, Source(told.number, m[0], by.id))
        if found:
            return


def _driven(told: Statement, start: int, end: int, headings: Mapping[str, Compass]) -> Compass | None:
    """The direction of travel in which the curve has that side."""
    before = [v for v in rule("common.vehicle").findall(told.text[:start]) if v in headings]
    behind = rule("road_details.for_vehicle").match(told.text[end:])
    if behind and behind[1] in headings:
        return headings[behind[1]]
    if before:
        return headings[before[-1]]
    way = [
        compass_of(m[1]) for m in rule("road_details.way").finditer(told.text[:start]) if m[1].lower().endswith("bound")
    ]
    return way[-1] if way else None
