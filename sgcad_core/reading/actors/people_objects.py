"""People and objects without a vehicle number: pronouns, directions of walking, kinds, ids.

Only what a vehicle of the report hits becomes an actor; non-contact cars, buses and police officers do not.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

from sgcad_core.kinds import actor_kind, kind_of_letter
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.text.compass import OPPOSITE_HAND, between, compass_of, turned
from sgcad_core.records.course import Hand
from sgcad_core.records.specs import ActorKind, Area, Compass

Lies = Literal["in", "across"]
"""How a thing lies in the road."""


class WalkDirection(NamedTuple):
    """How one goes: from the driver's left or right, or in a direction of the compass; None: not told."""

    hand: str | None = None
    way: Compass | None = None


def with_people(statements: Iterable[Statement]) -> Iterator[Statement]:
    """Sentences with "V1 struck him" as "V1 struck the pedestrian" where a person without a number was named before."""
    last: str | None = None
    for t in statements:
        him = rule("contact_words.him").search(t.text)
        before = t.text[: him.start()] if him else t.text
        named = [m["object"] for m in rule("contact_words.road_user").finditer(before)]
        last = named[-1].lower() if named else last
        if him and last:
            t = t._replace(text=f"{t.text[: him.start()]}{him['verb']} the {last}{t.text[him.end() :]}")
        yield t


def walk_of(word: str, statements: Iterable[Statement]) -> WalkDirection:
    """The first direction of walking that sentences with this word tell."""
    for t in statements:
        if t.role not in ("codes", "factors") and word in t.text:
            walk = _told(t.text[t.text.index(word) :])
            if walk != WalkDirection():
                return walk
    return WalkDirection()


def _told(text: str) -> WalkDirection:
    if across := rule("walkers.across").search(text):
        return WalkDirection(way=compass_of(across["way"]))
    if hand := rule("walkers.from_hand").search(text):
        return WalkDirection(hand=hand["hand"].lower())
    if rule("walkers.from_median").search(text):
        return WalkDirection(hand="left")
    if goes := rule("walkers.walks").search(text) or rule("walkers.goes").search(text):
        return WalkDirection(way=compass_of(goes["way"]))
    side = rule("walkers.from_side").search(text)
    came = compass_of(side["way"]) if side else None
    return WalkDirection(way=turned(came, 180) if came else None)


def side_facing(walk: WalkDirection, driver: Compass | None) -> Area | None:
    """The side of a pedestrian that faces a driver on a heading; None where neither hand nor heading tells it."""
    if walk.hand:
        return OPPOSITE_HAND[walk.hand]
    if walk.way is None or driver is None:
        return None
    turn = between(driver, walk.way)
    along: dict[int, Area] = {0: "back", 180: "front"}
    return along.get(turn, "right" if turn < 180 else "left")


@dataclass(frozen=True)
class OtherFacts:
    """A pedestrian (P1), cyclist (B1) or object (O1): the word is the report's own."""

    id: str
    kind: ActorKind
    word: str
    hand: Hand | None = None
    """On which hand of the vehicle that meets it a thing along the road lies, where that is told."""
    lies: Lies | None = None
    """Whether a thing lies in the road, or across it, where that is told."""


def others(
    contact_mentions: Iterable[ContactMention], vehicles: tuple[str, ...], parked: int = 0
) -> tuple[OtherFacts, ...]:
    """People and objects without a number that are hit, each word once, in order; `parked`: O ids taken."""
    words: list[str] = []
    for mention in contact_mentions:
        if mention.other not in vehicles and mention.other not in words and mention.role not in ("interview", "injury"):
            words.append(mention.other)
    found: list[OtherFacts] = []
    for word in words:
        letter, kind = kind_of_word(word)
        number = sum(f.id.startswith(letter) for f in found) + 1 + (parked if letter == "O" else 0)
        found.append(OtherFacts(f"{letter}{number}", kind, word))
    return tuple(found)


def is_person(word: str) -> bool:
    """Whether an actor without a number is a road user, not an object."""
    return not actor_kind(kind_of_word(word)[1]).thing


def kind_of_word(word: str) -> tuple[str, ActorKind]:
    for road_user in of_role("road_user"):
        if road_user.search(word):
            return road_user.yields["letter"], road_user.yields["kind"]
    return "O", kind_of_letter("O")
