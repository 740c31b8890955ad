"""Whether and on which side a vehicle leaves the road before its first contact, as its narrative tells it in order.

Reads the texts of one vehicle before that contact. The last word counts: who comes back on the road has not left it.
Knows no heading and no road.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from sgcad_core.reading.language import rule
from sgcad_core.reading.text.compass import WORDS
from sgcad_core.records.course import DepartureSide, Hand

_HANDS: dict[str, Hand] = {"left": "left", "right": "right"}
_LEANS: tuple[tuple[str, Hand], ...] = (
    ("deeds.crossing_centerline", "left"), ("deeds.departed_lane_left", "left"), ("deeds.departed_lane_right", "right"),
)  # fmt: skip
"""Rules of moves that end on one side of the road."""
_SAYS_SIDE = 45
"""Characters behind the words of leaving in which their side may stand."""


class Departure(NamedTuple):
    """The side on which the road is left, and the words and rule that tell it."""

    side: DepartureSide
    words: str
    rule: str


@dataclass
class DepartureReader:
    """What was heard so far of one vehicle."""

    found: Departure | None = None
    lean: Hand | None = None
    """To which side it moved last."""

    def hear(self, text: str) -> None:
        """Take the next text in order."""
        for _, kind, m in sorted(_events(text), key=lambda event: event[0]):
            if kind == "back":
                self.found = self.lean = None
            elif kind == "left_road":
                side = _side(text, m) or (self.found.side if self.found else self.lean) or "either"
                self.found = Departure(side, m[0], "departures.left_road")
            else:
                self.lean = _HANDS[kind]


def _events(text: str) -> Iterator[tuple[int, str, re.Match[str]]]:
    """(place, what it is, match) of all that is told of leaving the road and coming back."""
    for m in rule("departures.left_road").finditer(text):
        yield m.start(), "left_road", m
    for m in rule("course_rest.back_on_road").finditer(text):
        yield m.start(), "back", m
    for m in rule("departures.toward").finditer(text):
        yield m.start(), m["hand"].lower(), m
    for name, hand in _LEANS:
        for m in rule(name).finditer(text):
            yield m.start(), hand, m


def _side(text: str, left: re.Match[str]) -> DepartureSide | None:
    """The side that is told with the words of leaving, in or right behind them."""
    bare = rule("departures.bare_hand").match(text[left.end() :])
    ends = rule("departures.clause_end").search(text, left.end(), left.end() + _SAYS_SIDE)
    window = text[left.start() : ends.start() if ends else left.end() + _SAYS_SIDE]
    for m in rule("course_rest.side_named").finditer(window):
        word = (m["side"] or m["to"] or m["other"] or m["sent"]).lower()
        if side := _HANDS.get(word) or (None if m["bound"] else WORDS.get(word)):
            return side
    if within := rule("departures.named_edge").search(left[0]):
        word = within["side"].lower()
        return _HANDS.get(word) or WORDS.get(word)
    return _HANDS[bare["hand"].lower()] if bare else None
