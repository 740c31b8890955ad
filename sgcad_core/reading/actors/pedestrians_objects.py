"""Road users and objects without a vehicle number: pedestrians, cyclists, poles, trees.

Only what a vehicle of the report hits becomes an actor; non-contact cars, buses and police officers do not.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from sgcad_core.reading.contacts.contact_telling import ContactMention
from sgcad_core.reading.language import of_role
from sgcad_core.records.specs import ActorKind


@dataclass(frozen=True)
class OtherFacts:
    """A pedestrian (P1), cyclist (B1) or object (O1): the word is the report's own."""

    id: str
    kind: ActorKind
    word: str


def others(
    contact_mentions: Iterable[ContactMention], vehicles: tuple[str, ...], parked: int = 0
) -> tuple[OtherFacts, ...]:
    """Everybody and everything that is hit and has no number, each word once, in order; `parked`: O ids taken."""
    words: list[str] = []
    for mention in contact_mentions:
        if mention.other not in vehicles and mention.other not in words and mention.role not in ("interview", "injury"):
            words.append(mention.other)
    found: list[OtherFacts] = []
    for word in words:
        letter, kind = _kind(word)
        number = sum(f.id.startswith(letter) for f in found) + 1 + (parked if letter == "O" else 0)
        found.append(OtherFacts(f"{letter}{number}", kind, word))
    return tuple(found)


def is_person(word: str) -> bool:
    """Whether somebody without a number is a road user, not a thing."""
    return _kind(word)[1] != "object"


def _kind(word: str) -> tuple[str, ActorKind]:
    for road_user in of_role("road_user"):
        if road_user.search(word):
            return road_user.yields["letter"], road_user.yields["kind"]
    return "O", "object"
