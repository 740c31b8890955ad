"""Speed limits and curves, with the road or the direction of travel that they hold for.

Reads resolved sentences. Knows no junction and no lane.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Literal, NamedTuple

from sgcad_core.language import rule
from sgcad_core.narrative.clauses import Statement
from sgcad_core.narrative.compass import compass_of
from sgcad_core.narrative.mentions import axis_in, axis_of
from sgcad_core.narrative.motion import Cue
from sgcad_core.narrative.roles import STORY_ROLES
from sgcad_core.specs import Compass

MPH_PER_KMPH = 0.621371


class SpeedLimit(NamedTuple):
    """A posted limit; axis and cross None: it holds for every road."""

    mph: int
    axis: Compass | None
    cross: bool
    cue: Cue


class Curve(NamedTuple):
    """A bend as one drives along `toward` (None: the direction is not told)."""

    side: Literal["left", "right"]
    toward: Compass | None
    cue: Cue


_LIMIT = rule("road_details.limit")
_VALUE = rule("road_details.value")
_ADVISED = rule("road_details.advised")
_SIDE_WORD = rule("road_details.side_word")
_WAY = rule("road_details.way")


def speed_limits(told: Iterable[Statement], headings: Mapping[str, Compass]) -> tuple[SpeedLimit, ...]:
    """Every posted limit in order, mph (a limit in km/h only is converted to the nearest 5 mph)."""
    story = [t for t in told if t.role in STORY_ROLES]
    return tuple(limit for t in story for limit in _limits(t, headings))


def _limits(told: Statement, headings: Mapping[str, Compass]) -> Iterator[SpeedLimit]:
    text = told.text
    start = _LIMIT.search(text)
    if not start:
        return
    values = [m for m in _VALUE.finditer(text, start.start()) if not _ADVISED.search(text[: m.start()])]
    stated = [m for m in values if m[2].lower() == "mph"] or values
    for index, m in enumerate(stated):
        mph = int(m[1]) if m[2].lower() == "mph" else 5 * round(int(m[1]) * MPH_PER_KMPH / 5)
        before = text[stated[index - 1].end() if index else 0 : m.start()]
        behind = text[m.end() : stated[index + 1].start() if index + 1 < len(stated) else len(text)]
        if 5 <= mph <= 85:
            axis, cross = _whose(before, behind, headings)
            yield SpeedLimit(mph, axis, cross, Cue(told.number, m[0], _LIMIT.id))


def _whose(before: str, behind: str, headings: Mapping[str, Compass]) -> tuple[Compass | None, bool]:
    """ "... for the westbound lane" behind the value, else the subject before it."""
    tail = rule("road_details.for_whom").match(behind)
    for part in ([tail[1]] if tail else []) + [before]:
        if rule("road_details.everywhere").search(part):
            return None, False
        axis = axis_in(part) or _axis_of(part, headings)
        if axis or _SIDE_WORD.search(part):
            return axis, bool(_SIDE_WORD.search(part))
    return None, False


def _axis_of(part: str, headings: Mapping[str, Compass]) -> Compass | None:
    ways = [compass_of(m[1]) for m in _WAY.finditer(part)]
    named = [headings[v] for v in rule("common.vehicle").findall(part) if v in headings]
    axes = {axis_of(w) for w in ways if w} or {axis_of(h) for h in named}
    return next(iter(axes)) if len(axes) == 1 else None


_CURVE = rule("road_details.curve")
_NEARBY = rule("road_details.nearby")
_BARE_CURVE = rule("road_details.bare_curve")


def curves(told: Sequence[Statement], headings: Mapping[str, Compass]) -> tuple[Curve, ...]:
    """Curves in order; one whose side is not told is taken to the left of the first vehicle."""
    story = [t for t in told if t.role in STORY_ROLES]
    found = tuple(c for t in story for c in _curves(t, headings))
    bare = [Cue(t.number, m[0], _BARE_CURVE.id) for t in story if (m := _BARE_CURVE.search(t.text))]
    return found or tuple(Curve("left", None, cue) for cue in bare[:1])


def _curves(told: Statement, headings: Mapping[str, Compass]) -> Iterator[Curve]:
    if by_way := list(_curves_by_way(told)):
        yield from by_way
        return
    for m in _CURVE.finditer(told.text):
        side = next(filter(None, m.groups())).lower()
        if _NEARBY.search(told.text[: m.start()]):
            continue
        cue = Cue(told.number, m[0], _CURVE.id)
        yield Curve("left" if side == "left" else "right", _driven(told, m.start(), m.end(), headings), cue)


def _curves_by_way(told: Statement) -> Iterator[Curve]:
    """The sides that a curve has for directions of travel that are named with them."""
    if not rule("road_details.curve_word").search(told.text):
        return
    for by in (rule("road_details.curve_for"), rule("road_details.curve_as")):
        found = [(m, way) for m in by.finditer(told.text) if (way := compass_of(m["way"]))]
        for m, way in found:
            yield Curve("left" if m["hand"].lower() == "left" else "right", way, Cue(told.number, m[0], by.id))
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
    way = [compass_of(m[1]) for m in _WAY.finditer(told.text[:start]) if m[1].lower().endswith("bound")]
    return way[-1] if way else None
