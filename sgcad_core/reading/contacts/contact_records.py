"""Contacts as records: as one sentence tells them, and as they stand for the crash."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import get_args

from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.area_phrases import Zone
from sgcad_core.reading.text.sentence_roles import HIT, Role
from sgcad_core.records.specs import Area, Maneuver

AREAS: tuple[Area, ...] = get_args(Area)
GROUND = ("curb", "island", "median", "ditch", "ground")
"""What a vehicle drives over: no body that stops it."""


def leading_end(maneuver: Maneuver) -> Area:
    """The end of a vehicle that comes first, with which it strikes things where no side is told."""
    return "back" if maneuver == "backing" else "front"


@dataclass(frozen=True)
class ContactFacts:
    """One contact; `struck` may be an object or other road user of `CrashFacts.others`."""

    striker: str
    struck: str
    striker_area: Area
    struck_area: Area
    areas_stated: bool
    """Whether the text names both sides, and no corner."""
    stated: bool = True
    """False: the pair is inferred, the text tells no contact."""
    striker_may: tuple[Area, ...] = AREAS
    """Sides that the text allows: both of a corner, all four where it names none."""
    struck_may: tuple[Area, ...] = AREAS


@dataclass(frozen=True)
class ContactMention:
    """A contact as told: `other` is a vehicle id or the object's word; an area not told is None."""

    actor: str
    other: str
    actor_area: Zone | None
    other_area: Zone | None
    number: int
    role: Role
    passive: bool = False
    words: str = ""
    mutual: bool = False
    """They collided: the text names no striker."""
    noun: bool = False
    """Statement by nouns ("the impact was between ..."), not by a verb of hitting."""
    summary: bool = False
    """The text says only which two collided, wherever it stands; it gives no order in time."""
    at: int = 0
    """Where the struck one stands in its sentence, in characters of the plain form (`area_phrases.plain`)."""

    def areas_of(self, vehicle: str) -> tuple[Zone | None, Zone | None]:
        """The area of one of both vehicles, then that of the other."""
        own = self.actor_area, self.other_area
        return own if self.actor == vehicle else own[::-1]

    @property
    def source(self) -> Source:
        """Where it was read."""
        return Source(
            self.number, "" if self.noun else self.words, f"contact_nouns.{self.words}" if self.noun else HIT.id
        )


def with_areas(mention: ContactMention, retold: Iterable[ContactMention]) -> ContactMention:
    """The mention with areas that it lacks taken from other mentions of the same pair."""
    for other in retold:
        if {other.actor, other.other} != {mention.actor, mention.other}:
            continue
        mine, theirs = other.areas_of(mention.actor)
        mention = replace(mention, actor_area=mention.actor_area or mine, other_area=mention.other_area or theirs)
    return mention
