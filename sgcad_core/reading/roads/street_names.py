"""Axes of named streets: "northbound on Pine", "Route 7 goes east and west", "V2 was on Elm Street".

A street is known by the first words of its name, without "Street" or "Road", or by its number. Of two streets with one
told axis, the other runs along the heading of the other vehicles. Reads resolved sentences. Knows no junction and no
lane.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.roads.road_mentions import axis_in, axis_of
from sgcad_core.reading.text.compass import compass_of
from sgcad_core.reading.text.sentence_roles import STORY_ROLES
from sgcad_core.records.specs import Compass

_REACH = 90
"""Characters behind a name in which its direction may be told."""
_KNOWN = (rule("street_names.typed"), rule("street_names.numbered"), rule("street_names.behind_on"))


class StreetMention(NamedTuple):
    """A street's name in a text."""

    name: str
    start: int
    end: int


class StreetNames(NamedTuple):
    """The streets of a report with their axes: N, NE, E or SE."""

    axes: Mapping[str, Compass]
    pattern: re.Pattern[str] | None

    def in_text(self, text: str) -> Iterator[StreetMention]:
        """Every name in a text, in order."""
        return _in_text(self.pattern, text)

    def axis(self, text: str) -> Compass | None:
        """The axis of the first street that is named in a text."""
        first = next(self.in_text(text), None)
        return self.axes.get(first.name) if first else None


def street_names(statements: Iterable[Statement], headings: Mapping[str, Compass]) -> StreetNames:
    """The named streets, each with the axis that most of what is said of it gives."""
    story = [t.text for t in statements if t.role in STORY_ROLES]
    names = _names(story)
    pattern = _pattern(names)
    votes: dict[str, Counter[Compass]] = {}
    for text in story:
        found = list(_in_text(pattern, text))
        for at, one in enumerate(found):
            stop = found[at + 1].start if at + 1 < len(found) else len(text)
            for axis, weight in _told(text, one, stop, headings):
                votes.setdefault(one.name, Counter())[axis] += weight
    axes = {name: most for name, count in votes.items() if (most := _most(count))}
    driven = {axis_of(way) for way in headings.values()}
    left = driven - set(axes.values())
    if len(names) == 2 and len(axes) == len(left) == 1:
        axes |= {name: next(iter(left)) for name in names - set(axes)}
    return StreetNames(axes, pattern)


def driven_on(statements: Iterable[Statement]) -> dict[str, str]:
    """The name of the street that each vehicle is first told to drive on, of those of which one is told."""
    story = [t.text for t in statements if t.role in STORY_ROLES]
    pattern, found = _pattern(_names(story)), dict[str, str]()
    for text in story:
        for one in _in_text(pattern, text):
            if driver := rule("street_names.driven").search(text[: one.start]):
                found.setdefault(driver["vehicle"], one.name)
    return found


def _names(story: Iterable[str]) -> set[str]:
    return {m["name"].lower() for text in story for known in _KNOWN for m in known.finditer(text)}


def _pattern(names: Iterable[str]) -> re.Pattern[str] | None:
    """The pattern of known streets; None where none is named."""
    known = tuple(sorted(names, key=len, reverse=True))
    return rule("street_names.known").given(names=known) if known else None


def _in_text(pattern: re.Pattern[str] | None, text: str) -> Iterator[StreetMention]:
    if pattern is not None:
        for m in pattern.finditer(text):
            yield StreetMention(m["name"].lower(), m.start(), m.end())


def _most(count: Counter[Compass]) -> Compass | None:
    """The axis with most votes; None of two that have as many."""
    (first, most), *rest = count.most_common(2)
    return None if rest and rest[0][1] == most else first


def _told(text: str, one: StreetMention, stop: int, headings: Mapping[str, Compass]) -> Iterator[tuple[Compass, int]]:
    """What is said of a street where it is named: axes, each with a weight."""
    before = text[: one.start]
    if travel := rule("street_names.along").match(before):
        way = compass_of(travel["way"])
        yield from [(axis_of(way), 2)] if way else []
    elif (driver := rule("street_names.driven").search(before)) and driver["vehicle"] in headings:
        yield axis_of(headings[driver["vehicle"]]), 1
    if adjective := rule("street_names.adjective").search(before):
        axis = axis_in(adjective[0]) or _only_axis([adjective[0]])
        yield from [(axis, 2)] if axis else []
    behind = rule("street_names.clause").match(text[one.end : min(stop, one.end + _REACH)])
    if behind:
        axis = axis_in(behind[0])
        ways = [m["way"] or m["bound"] for m in rule("street_names.lanes_toward").finditer(behind[0])]
        axis = axis or _only_axis(ways)
        yield from [(axis, 2)] if axis else []


def _only_axis(words: Sequence[str]) -> Compass | None:
    axes = {axis_of(way) for word in words if (way := compass_of(word))}
    return next(iter(axes)) if len(axes) == 1 else None
