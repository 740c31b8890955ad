"""Whether and on which side a vehicle leaves the road before its first contact, as its narrative tells it in order; and
which ones leave the scene behind it.

Reads the texts of one vehicle before that contact. The last word counts: who comes back on the road has not left it.
The moves on the way there are kept in their order. Knows no heading and no road.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from sgcad_core.reading.actors.people_objects import Lies
from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.language import Rule, rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.compass import WORDS
from sgcad_core.records.course import DepartureSide, Hand, Move, MoveKind, Spin

_HANDS: dict[str, Hand] = {"left": "left", "right": "right"}
_LEANS: tuple[tuple[str, Hand], ...] = (
    ("deeds.crossing_centerline", "left"), ("deeds.departed_lane_left", "left"), ("deeds.departed_lane_right", "right"),
)  # fmt: skip
"""Rules of moves that end on one side of the road."""
_SAYS_SIDE = 45
"""Characters behind the words of leaving in which their side may stand."""
_UNSIDED = (None, "either")


class Departure(NamedTuple):
    """The side on which the road is left, and the words and rule that tell it."""

    side: DepartureSide
    words: str
    rule: str


class MoveHeard(NamedTuple):
    """One move with its words, the rule that read it, and where in its text it stands."""

    move: Move
    words: str
    rule: str
    at: int


def hand_of_thing(word: str, texts: Sequence[str]) -> Hand | None:
    """The hand of a vehicle on which texts tell a thing of that name to lie; left of a median where none is told."""
    told = [m for text in texts for m in rule("departures.thing_hand").finditer(text)]
    for names, side in (("first", "before"), ("thing", "behind")):
        for m in told:
            if m[names] and m[names].lower().rpartition(" ")[2] in word:
                return "right" if m[side].lower() == "right" else "left"
    return "left" if any(m["between"] and m["between"].lower() in word for m in told) else None


def lies_in_road(word: str, texts: Sequence[str]) -> Lies | None:
    """Whether texts tell that a thing of that name lies in the road, or across it."""
    for m in (m for text in texts for m in rule("departures.lies_in_road").finditer(text)):
        if m["thing"].lower() in word.lower().split():
            return "across" if m["how"].lower() == "across" else "in"
    return None


@dataclass
class DepartureReader:
    """What was heard so far of one vehicle."""

    found: Departure | None = None
    lean: Hand | None = None
    """To which side it moved last."""

    def hear(self, text: str) -> list[MoveHeard]:
        """Take the next text in order. Returns the moves that it tells."""
        told: list[MoveHeard] = []
        for at, kind, name, m in sorted(_events(text), key=lambda event: event[0]):
            if name == "departures.enters" and not self.found:
                continue
            told.append(MoveHeard(Move(kind, self._taken(text, kind, name, m)), m[0].strip(), name, at))
        return told

    def _taken(self, text: str, kind: MoveKind, name: str, m: re.Match[str]) -> DepartureSide | Spin | None:
        """The side of a move, which is then the last one known."""
        if kind == "yaws":
            return "counterclockwise" if (m["way"] or m["turns"]).lower().startswith("counter") else "clockwise"
        if kind == "returns":
            self.found = self.lean = None
            return None
        if kind == "departs":
            usual: DepartureSide = "right" if rule("departures.pulls_over").search(text[: m.start()]) else "either"
            side = _side(text, m) or (self.found.side if self.found else self.lean) or usual
            self.found = Departure(side, m[0], name)
            return side
        self.lean = dict(_LEANS).get(name) or _HANDS[m["hand"].lower()]
        return self.lean


def _events(text: str) -> Iterator[tuple[int, MoveKind, str, re.Match[str]]]:
    """(place, what it is, rule, match) of all that is told of leaving the road and coming back."""
    kinds: tuple[tuple[Rule, MoveKind], ...] = (
        (rule("departures.left_road"), "departs"), (rule("course_rest.back_on_road"), "returns"),
        (rule("departures.returns"), "returns"), (rule("departures.enters"), "returns"),
        (rule("departures.toward"), "steers"),
        (rule("departures.yaws"), "yaws"),
    )  # fmt: skip
    for wording, kind in kinds:
        for m in wording.finditer(text):
            if kind != "returns" or not rule("departures.tried").search(text[: m.start()]):
                yield m.start(), kind, wording.id, m
    for name, _ in _LEANS:
        for m in rule(name).finditer(text):
            yield m.start(), "crosses" if name == "deeds.crossing_centerline" else "steers", name, m


def wandering(told: Sequence[MoveHeard]) -> list[MoveHeard]:
    """The moves of a vehicle, each once, where they lead to more than one side in turn; else none."""
    kept: list[MoveHeard] = []
    for one in told:
        last = next(
            (other.move for other in reversed(kept) if (other.move.kind == "yaws") == (one.move.kind == "yaws")), None
        )
        if last is None or not _again(last, one.move):
            kept.append(one)
    ways = [way for one in kept if (way := _way(one.move))]
    return kept if any(_turns(a, b) for a, b in pairwise(ways)) else []


def _turns(before: str, way: str) -> bool:
    """Whether two moves in a row lead to different sides; a hand and a compass point may be the same side."""
    if before == way or "either" in (before, way):
        return False
    return "back" in (before, way) or (before in _HANDS) == (way in _HANDS)


def _again(before: Move, move: Move) -> bool:
    """Whether a move only says once more what the one before it told."""
    return before.kind == move.kind and (before.side == move.side or move.side in _UNSIDED)


def _way(move: Move) -> str | None:
    """To which hand or compass point a move leads, "back" or "either"; a yaw leads nowhere."""
    if move.kind == "yaws":
        return None
    if move.kind == "returns":
        return "back"
    return "left" if move.kind == "crosses" else move.side or "either"


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


def left_scene(statements: Sequence[Statement], roster: Roster, impact: int) -> Iterator[tuple[str, Source]]:
    """Vehicles of a report without numbers that drive away from the subject, and where that is told: not before the
    sentence `impact`."""
    left = rule("departures.left_scene")
    for t in statements if roster.counted else ():
        for m in left.finditer(t.text) if t.number >= impact and t.role not in ("codes", "factors") else ():
            who = m["who"] or m["stays"] or ""
            vehicle = who if who in roster.ids else roster.other(roster.ids[0]) if m["other"] else None
            if vehicle in roster.ids[1:] and vehicle is not None:
                yield vehicle, Source(t.number, m[0], left.id)
