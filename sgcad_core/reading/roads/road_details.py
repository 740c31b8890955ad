"""Curves and speed limits, with the direction of travel or the road that they hold for, and rural areas.

A limit is told by a word ("the limit is 45", "posted 35", "a 40 mph zone"), or stands alone where a road is described
("Elm Street: one lane each way, 30 mph").

Reads resolved sentences. Knows no junction and no lane.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Literal, NamedTuple

from sgcad_core.reading.language import Rule, of_role, rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.roads.road_mentions import axis_in, axis_of
from sgcad_core.reading.roads.street_names import StreetNames, street_names
from sgcad_core.reading.text.compass import compass_of, turned
from sgcad_core.reading.text.sentence_roles import CRASH_ROLES, STORY_ROLES
from sgcad_core.reading.text.speeds import Speed
from sgcad_core.records.specs import CenterLine, Compass, Ground


class Curve(NamedTuple):
    """A bend as one drives along `toward` (None: the direction is not told)."""

    side: Literal["left", "right"]
    toward: Compass | None
    source: Source


_CURVE = rule("road_details.curve")
_BARE_CURVE = rule("road_details.bare_curve")
_RURAL = rule("roads.rural")


def curves(
    statements: Sequence[Statement], headings: Mapping[str, Compass], left_on: str | None = None
) -> tuple[Curve, ...]:
    """Curves in order. One without a told side has the first vehicle leave the road on its outside: it goes right where
    that vehicle leaves on the left (`left_on`), else left."""
    story = [t for t in statements if t.role in STORY_ROLES]
    found = tuple(c for t in story for c in _curves(t, headings))
    bare = [Source(t.number, m[0], _BARE_CURVE.id) for t in story if (m := _BARE_CURVE.search(t.text))]
    side: Literal["left", "right"] = "right" if left_on == "left" else "left"
    return found or tuple(Curve(side, None, source) for source in bare[:1])


def _curves(statement: Statement, headings: Mapping[str, Compass]) -> Iterator[Curve]:
    if by_way := list(_curves_by_way(statement)):
        yield from by_way
        return
    for m in _CURVE.finditer(statement.text):
        side = next(filter(None, m.groups())).lower()
        if rule("road_details.nearby").search(statement.text[: m.start()]):
            continue
        source = Source(statement.number, m[0], _CURVE.id)
        yield Curve("left" if side == "left" else "right", _driven(statement, m.start(), m.end(), headings), source)


def _curves_by_way(statement: Statement) -> Iterator[Curve]:
    """The sides that a curve has for directions of travel that are named with them."""
    if not rule("road_details.curve_word").search(statement.text):
        return
    coming = rule("road_details.curve_from")
    ways = [(m, m["hand"] or m["hand2"], compass_of(m["from"] or m["from2"])) for m in coming.finditer(statement.text)]
    for m, hand, way in ways:
        if way:
            side: Literal["left", "right"] = "left" if hand.lower() == "left" else "right"
            yield Curve(side, turned(way, 180), Source(statement.number, m[0], coming.id))
    if ways:
        return
    for by in (rule("road_details.curve_for"), rule("road_details.curve_as")):
        found = [(m, way) for m in by.finditer(statement.text) if (way := compass_of(m["way"]))]
        for m, way in found:
            yield Curve("left" if m["hand"].lower() == "left" else "right", way, Source(statement.number, m[0], by.id))
        if found:
            return


def _driven(statement: Statement, start: int, end: int, headings: Mapping[str, Compass]) -> Compass | None:
    """The direction of travel in which the curve has that side."""
    before = [v for v in rule("common.vehicle").findall(statement.text[:start]) if v in headings]
    behind = rule("road_details.for_vehicle").match(statement.text[end:])
    if behind and behind[1] in headings:
        return headings[behind[1]]
    if before:
        return headings[before[-1]]
    way = [
        compass_of(m[1])
        for m in rule("road_details.way").finditer(statement.text[:start])
        if m[1].lower().endswith("bound")
    ]
    return way[-1] if way else None


MPH_PER_KMPH = 0.621371
LOWEST_MPH, HIGHEST_MPH = 5, 85


class SpeedLimit(NamedTuple):
    """A posted limit; axis and cross None: it holds for every road."""

    mph: int
    axis: Compass | None
    cross: bool
    source: Source


_LIMIT = rule("road_details.limit")
_ADVISED = rule("road_details.advised")
_SIDE_WORD = rule("road_details.side_word")


def speed_limits(statements: Iterable[Statement], headings: Mapping[str, Compass]) -> tuple[SpeedLimit, ...]:
    """Every posted limit in order, mph (a limit in km/h only is converted to the nearest 5 mph)."""
    story = [t for t in statements if t.role in STORY_ROLES]
    names = street_names(story, headings)
    return tuple(limit for t in story for limit in _limits(t, headings, names))


def _limits(statement: Statement, headings: Mapping[str, Compass], names: StreetNames) -> Iterator[SpeedLimit]:
    text = statement.text
    stated = _stated(text, names)
    for index, value in enumerate(stated):
        before = text[stated[index - 1].end if index else 0 : value.start]
        behind = text[value.end : stated[index + 1].start if index + 1 < len(stated) else len(text)]
        if LOWEST_MPH <= value.mph <= HIGHEST_MPH:
            axis, cross = _whose(before, behind, headings, names)
            yield SpeedLimit(value.mph, axis, cross, Source(statement.number, value.words, value.rule))


# ------------------------------------------------------------------ values
def _stated(text: str, names: StreetNames) -> list[Speed]:
    """Limits of a sentence in order: those told by a word, else those that stand where a road is described."""
    found = [*_with_units(text), *_by_words(text, of_role("posted"))] or list(_described(text, names))
    found += _by_words(text, of_role("posted_again")) if found else ()
    kept: list[Speed] = []
    for value in sorted(found, key=lambda one: one.start):
        if not kept or value.start >= kept[-1].end:
            kept.append(value)
    return kept


def _with_units(text: str) -> Iterator[Speed]:
    """Speeds behind a word for a limit; those in km/h only where none is in mph."""
    start = _LIMIT.search(text)
    values = list(rule("road_details.value").finditer(text, start.start())) if start else []
    values = [m for m in values if not _ADVISED.search(text[: m.start()])]
    for m in [m for m in values if m[2].lower() == "mph"] or values:
        mph = int(m[1]) if m[2].lower() == "mph" else 5 * round(int(m[1]) * MPH_PER_KMPH / 5)
        yield Speed(mph, m.start(), m.end(), m[0], _LIMIT.id)


def _by_words(text: str, rules: Iterable[Rule]) -> Iterator[Speed]:
    """Numbers that a word next to them makes a limit."""
    for told in rules:
        for m in told.finditer(text):
            if not _ADVISED.search(text[: m.start()]):
                group = next(name for name, value in m.groupdict().items() if value)
                yield Speed(int(m[group]), m.start(group), m.end(group), m[0], told.id)


def _described(text: str, names: StreetNames) -> Iterator[Speed]:
    """Speeds in a sentence about a road without vehicles, or in brackets behind a road or with its lanes."""
    place = rule("speed_limits.alone")
    if not rule("common.vehicle").search(text) and not rule("speed_limits.driving").search(text):
        if rule("speed_limits.road").search(text) or next(names.in_text(text), None):
            yield from (Speed(int(m["mph"]), m.start(), m.end(), m[0], place.id) for m in place.finditer(text))
        return
    for bracket in rule("speed_limits.bracket").finditer(text):
        of_road = rule("speed_limits.road").search(bracket[0])
        if of_road or rule("speed_limits.behind_road").search(text[: bracket.start()]):
            inside = place.finditer(text, bracket.start(), bracket.end())
            yield from (Speed(int(m["mph"]), m.start(), m.end(), m[0], place.id) for m in inside)


# ------------------------------------------------------------------ of which road
def _whose(
    before: str, behind: str, headings: Mapping[str, Compass], names: StreetNames
) -> tuple[Compass | None, bool]:
    """ "... for the westbound lane" behind the value, else the subject before it."""
    tail = rule("road_details.for_whom").match(behind)
    tail = None if behind.startswith(",") and names.axis(before) else tail
    nearest = [before.rpartition(";")[2]] if ";" in before else []
    for whole in ([tail[1]] if tail else []) + nearest + [before]:
        named = names.axis(whole) if tail and whole is tail[1] else _named(whole, names)
        if axis := named or axis_in(whole.rpartition("(")[2]):
            return axis, False
        part = rule("speed_limits.aside").sub(" ", whole)
        if rule("road_details.everywhere").search(part):
            return None, False
        axis = axis_in(part) or _axis_of(part, headings)
        if axis or _SIDE_WORD.search(part):
            return axis, bool(_SIDE_WORD.search(part))
    return axis_in(behind.partition(";")[0]), False


def _named(part: str, names: StreetNames) -> Compass | None:
    """The street that a value is said to be on, else the first that is named."""
    on = rule("speed_limits.on").search(part)
    return (names.axis(part[on.start() :]) if on else None) or names.axis(part)


def _axis_of(part: str, headings: Mapping[str, Compass]) -> Compass | None:
    ways = [compass_of(m[1]) for m in rule("road_details.way").finditer(part)]
    named = [headings[v] for v in rule("common.vehicle").findall(part) if v in headings]
    axes = {axis_of(w) for w in ways if w} or {axis_of(h) for h in named}
    return next(iter(axes)) if len(axes) == 1 else None


def rural_source(statements: tuple[Statement, ...]) -> Source | None:
    """Where the text says that the crash was in the country."""
    story = (t for t in statements if t.role in CRASH_ROLES)
    return next((Source(t.number, m[0], _RURAL.id) for t in story if (m := _RURAL.search(t.text))), None)


def painted_and_beside(story: Sequence[str]) -> tuple[CenterLine, tuple[Ground, ...]]:
    """The told marking between the directions, "" where none is told, or both a solid and a broken one; and the kinds
    of ground that are named beside the roads."""
    lines = [r.yields["line"] for r in of_role("center_line") if any(map(r.search, story))]
    grounds = [r.yields["ground"] for r in of_role("ground_beside") if any(map(r.search, story))]
    return lines[0] if len(lines) == 1 else "", tuple(dict.fromkeys(grounds))
