"""Actors named so far in a report without numbers, and the actor that a phrase means. Knows no motion."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from itertools import count

from sgcad_core.reading.actors.makes import BODY_WORDS, MAKES, is_large, kind_of, no_vehicle
from sgcad_core.reading.language import rule, values

_STATES: dict[str, str] = values("state")
_ORDERS: dict[str, int] = values("order")
_PART_OF = {"which was ahead": "ahead", "which was behind": "behind", "which was oncoming": "opposite"}
PARTS: dict[str, str] = values("beside_part") | {w: _PART_OF[s] for w, s in _STATES.items() if s in _PART_OF}
"""Words that tell where beside the subject a vehicle is: "the lead car" is ahead of it."""
_USERS: dict[str, str] = values("road_user")
_STANDING = ("stopped", "parked")
_MOST = 8
"""Actors of a report without numbers; further ones stay as they are written."""
_ANY = ("vehicle", "motorist")
"""Heads that may mean any vehicle."""
TRUCK_PARTS, _TRUCKS = ("cab", "flatbed", "tractor"), ("truck", "pickup")
"""Words for a part of a truck that also name vehicles of their own."""
_CARS = ("car", "sedan", "coupe", "hatchback", "passenger car", "passenger vehicle")


@dataclass
class Actor:
    """An actor that was named: `heads` are the nouns used, `order` which one of its kind it is said to be."""

    number: int
    kind: str
    heads: set[str]
    order: int = 1
    subject: bool = False
    announced: bool = False
    at: int = 0
    """Where it was named last."""
    part: str | None = None
    """Where it is said to be beside the subject: ahead, behind, opposite, beside."""
    stands: bool = False
    """Whether it is told to be parked or stopped."""
    names: set[str] = field(default_factory=set)
    """Proper names in what it was called: of makers, models, companies."""


@dataclass(frozen=True)
class Phrase:
    """One noun phrase; `head` lower case."""

    match: re.Match[str]

    @property
    def definite(self) -> bool:
        """Whether the phrase names a known actor: "the", "this", a possessive, or no determiner."""
        return (self.match["det"] or "the").lower() in ("the", "this", "that", "its", "his", "her", "their")

    @property
    def head(self) -> str:
        """The noun of the phrase, lower case."""
        word = next(filter(None, (self.match[k] for k in ("automated", "attendant", "user", "body"))), None)
        return (word or self.match.string[self.match.start("make") : self.match.end()]).lower()

    @property
    def modifiers(self) -> list[str]:
        """The words between determiner and noun, lower case."""
        return [word.strip(",").lower() for word in self.match["mods"].split()]

    @property
    def order(self) -> int | None:
        """Which of its kind: "the second van", "another car"; None where the words do not tell."""
        if (self.match["det"] or "").lower() == "another":
            return 2
        return next((_ORDERS[m] for m in (*self.modifiers, *self.head.split()) if m in _ORDERS), None)

    @property
    def part(self) -> str | None:
        """Where beside the subject: "the lead car" is ahead of it."""
        told = next((PARTS[m] for m in self.match.group().lower().split() if m in PARTS), None)
        return told or ("ahead" if rule("references.up_ahead").match(self.match.string, self.match.end()) else None)

    @property
    def kind(self) -> str:
        """Kind of road user; "vehicle" where the head may be any."""
        user = self.match["user"]
        if user:
            return _USERS[user.lower()]
        words = self.match.group().lower()
        return "vehicle" if self.head.endswith(_ANY) and self.head not in _CARS else kind_of(words, None)[0]

    @property
    def branded(self) -> bool:
        """Whether a company's name marks the vehicle: "the Acme vehicle"."""
        return bool(rule("references.branded").match(self.match["mods"]))

    @property
    def names(self) -> set[str]:
        """Proper names among its words, in lower case."""
        words = self.match.group()[len(self.match["det"] or "") :].split()
        return {w.lower() for w in words if w[0].isupper() and not w.isupper()} - set(BODY_WORDS)

    @property
    def stands(self) -> bool:
        """Whether the words before or behind say that it is parked or stopped."""
        told = any(_STATES.get(m, "").endswith(_STANDING) for m in (*self.modifiers, *self.head.split()))
        return told or bool(rule("references.stands").match(self.match.string, self.match.end()))

    @property
    def clauses(self) -> str:
        """What its modifiers tell of its motion, as clauses behind it, closed where the sentence leaves it."""
        told = [_STATES[m] for m in self.modifiers if _STATES.get(m)]
        told += [_STATES[m] for m in self.head.split()[:-1] if _STATES.get(m, "").endswith(_STANDING)]
        closed = rule("references.goes_on").match(self.match.string, self.match.end())
        return f", {told[0]}{',' if closed else ''}" if told else ""


@dataclass
class NamedActors:
    """All actors named so far."""

    actors: list[Actor] = field(default_factory=list)
    automated: bool = False
    """Whether the subject has words of its own, so that no other phrase means it as long as another actor fits."""
    taken: frozenset[int] = frozenset()
    """Numbers that the report gives."""

    def subject(self) -> Actor | None:
        """The report's own vehicle, once it is named."""
        return next((a for a in self.actors if a.subject), None)

    def add(self, phrase: Phrase, subject: bool, announced: bool) -> Actor | None:
        """Adds an actor for a phrase; None where the most that are numbered are there."""
        if len(self.actors) == _MOST:
            return None
        number = next(n for n in count(1) if n not in self.taken and all(a.number != n for a in self.actors))
        actor = Actor(number, phrase.kind, {phrase.head}, phrase.order or 1, subject, announced)
        self.actors.append(actor)
        return actor

    def meant(self, phrase: Phrase) -> Actor | None:
        """The actor of a definite phrase: the last one that its words fit, best fit first; None: none so far."""
        if (subject := self.subject()) and self.automated and self._by_name(phrase) == [subject]:
            return subject
        others = sorted((a for a in self.actors if not (a.subject and self.automated)), key=lambda a: -a.at)
        others = [a for a in others if phrase.part in (None, a.part)] or [
            a for a in others if not (a.part or a.subject)
        ]
        fitting = [a for a in others if phrase.head in a.heads] or [a for a in others if _fits(a, phrase)]
        fitting = fitting or [a for a in others if phrase.head in TRUCK_PARTS and a.kind in _TRUCKS]
        if phrase.stands and (standing := [a for a in fitting if a.stands]):
            fitting = standing
        if phrase.part == "ahead" and not phrase.stands and (moving := [a for a in fitting if not a.stands]):
            fitting = [a for a in moving if not a.subject] or fitting  # who drives ahead, not who is parked
        if phrase.order is not None:
            ordered = [a for a in fitting if a.order == phrase.order]
            return next(iter(ordered), None) or (
                fitting[0] if fitting and "other" in (*phrase.modifiers, *phrase.head.split()) else None
            )
        if subject and self.automated and phrase.branded and phrase.kind == "vehicle":
            return subject
        if fitting or subject is None:
            return fitting[0] if fitting else None
        return subject if _may_be_subject(subject, phrase) or self._own(phrase) else None

    def _by_name(self, phrase: Phrase) -> list[Actor]:
        """Vehicles that were called by a name of the phrase."""
        return [a for a in self.actors if a.names & phrase.names and not no_vehicle(a.kind)]

    def _own(self, phrase: Phrase) -> bool:
        """Whether "the truck" is the automated vehicle: a large one, where no other vehicle was named."""
        large = is_large(phrase.kind) and not phrase.match["make"] and not phrase.modifiers and not _beside(phrase)
        return self.automated and large and all(a.subject or no_vehicle(a.kind) for a in self.actors)

    def open(self, phrase: Phrase) -> Actor | None:
        """The actor that the opening announced and no later sentence named, if the words fit."""
        return next((a for a in self.actors if a.announced and _fits(a, phrase)), None)


def _fits(actor: Actor, phrase: Phrase) -> bool:
    """Whether the words of a phrase may mean an actor."""
    if phrase.head in actor.heads:
        return True
    if (makes := _makes(phrase.names)) and (known := _makes(actor.names)):
        if not makes & known:
            return False
        if not phrase.match["body"]:  # "the Acme" behind "an Acme Aster", whatever kind of vehicle that is
            return True
    if phrase.kind == actor.kind:
        return True
    vehicle = not no_vehicle(actor.kind)
    if phrase.kind == "vehicle" or actor.kind == "vehicle":
        return vehicle and not no_vehicle(phrase.kind)
    return phrase.head == "truck" and actor.kind in ("truck", "pickup")


def _makes(names: set[str]) -> set[str]:
    """The makes among proper names."""
    return {MAKES[name] for name in names if name in MAKES}


def _may_be_subject(subject: Actor, phrase: Phrase) -> bool:
    """Whether "the vehicle" or "the shuttle" is the report's own."""
    if _beside(phrase):
        return False
    return phrase.kind == "vehicle" or any(head.endswith(phrase.head) for head in subject.heads)


def _beside(phrase: Phrase) -> bool:
    """Whether a phrase says of a vehicle that it is one beside the report's own."""
    return bool(phrase.part or rule("references.elsewhere").match(phrase.match.string, phrase.match.end()))
