"""Told speeds of vehicles: "at 45 mph", "doing 35", "15 mph for V1". Knows no road and infers nothing.

A number is a speed if its unit stands behind it, or a word of driving before it. In a sentence that speaks of a limit
only the latter count.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source, VehicleMotion
from sgcad_core.records.course import Courses, CourseTold

FASTEST_MPH = 120.0
"""The most that is read as a vehicle's speed and driven; the fastest of known reports has 100."""
MILES = 0.621
"""Miles in a kilometre, as reports round it."""


class Speed(NamedTuple):
    """A speed and where it stands in a text."""

    mph: int
    start: int
    end: int
    words: str
    rule: str


_BARE = rule("speeds.bare")
_WORD_ENDS = re.compile(r"\)|(?<=\w)(?=,? )")


def speeds(text: str, before: str = "") -> Iterator[Speed]:
    """Speeds that are no limits, those in mph first, then those in km/h, then numbers without a unit."""
    of_limit = any(rule("surroundings.limit").search(words) for words in (before, text))
    for pattern, factor in ((rule("surroundings.speed"), 1.0), (rule("surroundings.kmph"), MILES), (_BARE, 1.0)):
        for m in pattern.finditer(text):
            if not of_limit or pattern is _BARE or rule("speeds.driven").search(text[: m.start()]):
                moment = rule("speeds.at_impact").match(text, m.end())
                words = text[m.start() : moment.end()] if moment else m.group()
                yield Speed(_mph(m, factor), m.start("a"), m.end(), words, pattern.id)


def with_impact_speeds(courses: Courses, sources: Mapping[str, Source]) -> Courses:
    """The courses with the mark of vehicles whose told speed is that of the contact; `sources`: "V1 speed" and more."""
    told = [name.split()[0] for name, source in sources.items() if name.endswith(" speed") and _is_of_impact(source)]
    return {**courses, **{who: replace(courses.get(who, CourseTold()), speed_at_impact=True) for who in told}}


def _is_of_impact(source: Source) -> bool:
    return any(rule("speeds.at_impact").match(source.words, m.start()) for m in _WORD_ENDS.finditer(source.words))


def _mph(m: re.Match[str], factor: float) -> int:
    high = m.groupdict().get("b") or m.group("a")
    return round(min(FASTEST_MPH, (float(m.group("a")) + float(high)) / 2 * factor))


def read_speed(motion: VehicleMotion, text: str, weight: int, before: str = "") -> None:
    """The first speed of a segment; `before`: its sentence up to there, which may speak of a limit."""
    struck = _of_striker(before, text)
    if not struck and (found := next(speeds(text, before), None)):
        motion.add_value(motion.speeds_mph, weight, found.mph, found.words, found.rule)


def read_speeds_beside(motions: Mapping[str, VehicleMotion], statements: Sequence[Statement]) -> None:
    """Speeds of vehicles whose own segments tell none: from a sentence that names no other vehicle, or right behind the
    name."""
    lacking = {v for v, motion in motions.items() if not motion.speeds_mph}
    for t in statements:
        for vehicle, speed in _owned(t) if lacking else ():
            if vehicle in lacking:
                motion = motions[vehicle]
                motion.at = t.number
                motion.add_value(motion.speeds_mph, 1, speed.mph, speed.words, speed.rule)


def _owned(statement: Statement) -> Iterator[tuple[str, Speed]]:
    """Speeds of a sentence with the vehicle that each is of, where that is plain."""
    named = list(rule("common.vehicle").finditer(statement.text))
    for speed in speeds(statement.text):
        if found := rule("speeds.for_vehicle").match(statement.text, speed.end):
            yield found["vehicle"], speed
            continue
        if rule("speeds.other").search(statement.text):
            continue
        if named and rule("speeds.somebody").search(statement.text[: named[0].start()]):
            continue
        if len({m[0] for m in named}) == 1 or _opens(statement.text, named, speed):
            yield named[0][0], speed
            continue
        if not named and statement.subject and rule("speeds.pronoun").search(statement.text):
            yield statement.subject, speed
            continue
        before = [m for m in named if m.end() <= speed.start]
        if before and rule("speeds.beside").search(statement.text[: before[-1].end()]):
            continue  # of the one that drives beside it
        if before and _of_striker(statement.text[: before[-1].end()], statement.text[before[-1].end() :]):
            continue
        if before and rule("speeds.between").fullmatch(statement.text, before[-1].end(), speed.start):
            yield before[-1][0], speed


def _of_striker(before: str, behind: str) -> bool:
    """Whether a speed behind a vehicle is that of the one that struck it: "V1 struck V2 at 18 mph"."""
    return bool(rule("speeds.struck_at").search(before) and rule("speeds.behind_struck").match(behind))


def _opens(text: str, named: Sequence[re.Match[str]], speed: Speed) -> bool:
    """Whether a speed stands before the first vehicle and belongs to it: "At 40 mph a northbound V1"."""
    before = text[: named[0].start()] if named else ""
    return speed.end <= len(before) and rule("speeds.opening").fullmatch(before) is not None
