"""Who is who in a report that numbers nobody: every phrase of somebody becomes the number of one actor.

"The test vehicle was stopped when a white van hit it. The van left." becomes "V1 was stopped when a white van (V2) hit
it. V2 left.", so that everything behind works on numbers. The subject of the report is V1, the others follow in the
order in which they are named; a text that has any number stays as it is. People and animals count here too:
`Roster.called` tells their own letters. Knows what phrases mean, not what anybody does.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from sgcad_core.language import rule, values
from sgcad_core.narrative.makes import BODY_WORDS, kind_of
from sgcad_core.narrative.traced import Traced, joined

_PHRASE = rule("references.phrase")
_STATES: dict[str, str] = values("state")
_ORDERS: dict[str, int] = values("order")
_PART_OF = {"which was ahead": "ahead", "which was behind": "behind", "which was oncoming": "opposite"}
PARTS: dict[str, str] = values("beside_part") | {w: _PART_OF[s] for w, s in _STATES.items() if s in _PART_OF}
"""Words that tell where beside the subject a vehicle is: "the lead car" is ahead of it."""
_USERS: dict[str, str] = values("road_user")
_MOST = 8
"""Actors of a report that numbers nobody; further ones stay as they are written."""
_NEAR = 40
"""Characters before a phrase in which a word may say that it is of a stranger."""
_ANY = ("vehicle", "motorist")
"""Heads that may mean any vehicle."""
_NO_VEHICLE = ("pedestrian", "bicycle", "animal")
_TRUCK_PARTS, _TRUCKS = ("cab", "flatbed", "tractor"), ("truck", "pickup")
"""Words for a part of a truck that also name vehicles of their own."""
_CARS = ("car", "sedan", "coupe", "hatchback", "passenger car", "passenger vehicle")


@dataclass
class Actor:
    """Somebody who was named: `heads` are the nouns used, `order` which one of its kind it is said to be."""

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


@dataclass(frozen=True)
class Phrase:
    """One noun phrase; `head` lower case."""

    match: re.Match[str]

    @property
    def definite(self) -> bool:
        return (self.match["det"] or "the").lower() in ("the", "this", "its")

    @property
    def head(self) -> str:
        word = next(filter(None, (self.match[k] for k in ("automated", "attendant", "user", "body"))), None)
        return (word or self.match.string[self.match.start("make") : self.match.end()]).lower()

    @property
    def modifiers(self) -> list[str]:
        return [word.strip(",").lower() for word in self.match["mods"].split()]

    @property
    def order(self) -> int | None:
        """Which of its kind: "the second van", "another car"; None where the words do not tell."""
        if (self.match["det"] or "").lower() == "another":
            return 2
        return next((_ORDERS[m] for m in self.modifiers if m in _ORDERS), None)

    @property
    def part(self) -> str | None:
        """Where beside the subject: "the lead car" is ahead of it."""
        return next((PARTS[m] for m in self.match.group().lower().split() if m in PARTS), None)

    @property
    def kind(self) -> str:
        """Kind of road user; "vehicle" where the head may be any."""
        user = self.match["user"]
        if user:
            return _USERS[user.lower()]
        words = self.match.group().lower()
        return "vehicle" if self.head.endswith(_ANY) and not _is_car(self.head) else kind_of(words, None)[0]

    @property
    def branded(self) -> bool:
        """Whether a company's name says whose it is: "the Acme vehicle"."""
        return bool(rule("references.branded").match(self.match["mods"]))

    @property
    def stands(self) -> bool:
        """Whether the words before or behind say that it is parked or stopped."""
        told = any(_STATES.get(m, "").endswith(("stopped", "parked")) for m in self.modifiers)
        return told or bool(rule("references.stands").match(self.match.string, self.match.end()))

    @property
    def clauses(self) -> str:
        """What its modifiers tell of its motion, as clauses behind it."""
        told = [_STATES[m] for m in self.modifiers if _STATES.get(m)]
        return f", {told[0]}" if told else ""


def _is_car(head: str) -> bool:
    return head in _CARS


@dataclass
class Cast:
    """Everybody named so far."""

    actors: list[Actor] = field(default_factory=list)
    automated: bool = False
    """Whether the subject has words of its own, so that no other phrase means it as long as another actor fits."""

    def subject(self) -> Actor | None:
        return next((a for a in self.actors if a.subject), None)

    def add(self, phrase: Phrase, subject: bool, announced: bool) -> Actor | None:
        if len(self.actors) == _MOST:
            return None
        actor = Actor(len(self.actors) + 1, phrase.kind, {phrase.head}, phrase.order or 1, subject, announced)
        self.actors.append(actor)
        return actor

    def meant(self, phrase: Phrase) -> Actor | None:
        """Whom a definite phrase means: the last one that its words fit, best fit first; None: nobody so far."""
        others = sorted((a for a in self.actors if not (a.subject and self.automated)), key=lambda a: -a.at)
        others = [a for a in others if phrase.part in (None, a.part)] or [a for a in others if not a.part]
        fitting = [a for a in others if phrase.head in a.heads] or [a for a in others if _fits(a, phrase)]
        fitting = fitting or [a for a in others if phrase.head in _TRUCK_PARTS and a.kind in _TRUCKS]
        if phrase.stands and (standing := [a for a in fitting if a.stands]):
            fitting = standing
        if phrase.order is not None:
            ordered = [a for a in fitting if a.order == phrase.order]
            return next(iter(ordered), None) or (fitting[0] if fitting and "other" in phrase.modifiers else None)
        subject = self.subject()
        if subject and self.automated and phrase.branded and phrase.kind == "vehicle":
            return subject
        if fitting or subject is None:
            return fitting[0] if fitting else None
        return subject if _may_be_subject(subject, phrase) or self._own(phrase) else None

    def _own(self, phrase: Phrase) -> bool:
        """Whether "the truck" is the automated vehicle: a large one, where no other vehicle was named."""
        large = phrase.kind in ("truck", "bus") and not phrase.match["make"] and not _beside(phrase)
        return self.automated and large and all(a.subject or a.kind in _NO_VEHICLE for a in self.actors)

    def open(self, phrase: Phrase) -> Actor | None:
        """Whom the opening of the report announced and nobody has told of since, if the words fit."""
        return next((a for a in self.actors if a.announced and _fits(a, phrase)), None)


def _fits(actor: Actor, phrase: Phrase) -> bool:
    """Whether the words of a phrase may mean an actor."""
    if phrase.head in actor.heads or phrase.kind == actor.kind:
        return True
    vehicle = actor.kind not in _NO_VEHICLE
    if phrase.kind == "vehicle" or actor.kind == "vehicle":
        return vehicle and phrase.kind not in _NO_VEHICLE
    return phrase.head == "truck" and actor.kind in ("truck", "pickup")


def _may_be_subject(subject: Actor, phrase: Phrase) -> bool:
    """Whether "the vehicle" or "the shuttle" is the report's own."""
    if _beside(phrase):
        return False
    return phrase.kind == "vehicle" or any(head.endswith(phrase.head) for head in subject.heads)


def _beside(phrase: Phrase) -> bool:
    """Whether a phrase says of a vehicle that it is one beside the report's own."""
    return bool(phrase.part or rule("references.elsewhere").match(phrase.match.string, phrase.match.end()))


# ------------------------------------------------------------------ numbering
def numbers_somebody(text: str) -> bool:
    """Whether a normalized report numbers anybody."""
    return bool(rule("common.vehicle").search(text))


def number_actors(text: Traced) -> Traced:
    """The normalized text with everybody named by number; unchanged if there is any number."""
    if numbers_somebody(text.text):
        return text
    automated = _automated(text.text)
    cast = Cast([Actor(1, "vehicle", set(), subject=True)] if automated else [], automated)
    return numbered(text, Numbering(cast))


def numbered(text: Traced, numbering: Numbering) -> Traced:
    """The text with a number for everybody whom the numbering takes, block by block."""
    blocks = [_numbered(block, numbering) for block in text.split_at("\n\n")]
    return joined(blocks, "\n\n")


def _numbered(block: Traced, numbering: Numbering) -> Traced:
    pieces: list[Traced] = []
    at = 0
    for end in [m.end() for m in rule("text.end").finditer(block.text)] + [len(block.text)]:
        piece, at = block.cut(at, end), end
        formal = rule("roles.formal").search(piece.text)
        numbering.announcing = numbering.alone and bool(rule("references.announced").search(piece.text))
        pieces.append(piece if formal else piece.sub(_PHRASE, numbering.fill))
    return joined(pieces)


def _automated(text: str) -> bool:
    """Whether a report says of a vehicle that it is the automated one, or its own."""
    return any(m["automated"] for m in _PHRASE.finditer(text))


@dataclass
class Numbering:
    """Fills in numbers, phrase by phrase in the order of the text."""

    cast: Cast
    announcing: bool = False
    at: int = 0

    @property
    def alone(self) -> bool:
        """Whether nobody but the subject was named so far."""
        return all(actor.subject for actor in self.cast.actors)

    def fill(self, match: re.Match[str]) -> str:
        """What stands for a phrase: the number alone, or behind the words that first describe somebody."""
        phrase = Phrase(match)
        self.at += 1
        if self.is_nobody(phrase):
            return match.group()
        if match["attendant"]:
            return f"{'The' if match.group()[0].isupper() else 'the'} driver of V1"
        known = self._known(phrase)
        actor = known or self.cast.add(phrase, self._is_subject(phrase), self.announcing)
        if actor is None:
            return match.group()
        actor.at = self.at
        actor.stands = actor.stands or phrase.stands
        actor.announced = actor.announced and self.announcing
        actor.heads |= {phrase.head, *(m for m in phrase.modifiers if m in BODY_WORDS)}
        actor.part = actor.part or phrase.part
        return self._written(phrase, actor, known is None)

    def is_nobody(self, phrase: Phrase) -> bool:
        match = phrase.match
        before = match.string[max(0, match.start() - _NEAR) : match.start()]
        behind = rule("references.part").match(match.string, match.end())
        owner = match["automated"] or (behind and phrase.definite)
        if match["many"] and (not owner or rule("references.several").search(before)):
            return True
        if match["user"] and match["user"][0].isupper() and not match["det"]:
            return True
        if phrase.head in _TRUCK_PARTS and match.string.startswith(" of ", match.end()):
            return True
        if not match["det"] and not match["automated"]:
            return bool(match.start()) or not phrase.order
        ridden = phrase.kind in ("bicycle", "motorcycle") and rule("references.ridden").search(before)
        return bool(rule("references.stranger").search(before)) or bool(ridden and self._has(phrase.kind))

    def _has(self, kind: str) -> bool:
        return any(a.kind == kind for a in self.cast.actors)

    def _is_subject(self, phrase: Phrase) -> bool:
        if self.cast.subject():
            return False
        return bool(phrase.match["automated"]) if self.cast.automated else phrase.kind not in ("pedestrian", "animal")

    def _known(self, phrase: Phrase) -> Actor | None:
        match = phrase.match
        subject = self.cast.subject()
        if phrase.match["automated"] and subject and rule("references.aboard").match(match.string, match.end()):
            return subject
        if phrase.match["automated"] and subject and phrase.order in (None, 1) and (phrase.definite or not subject.at):
            return subject
        if phrase.definite:
            return self.cast.meant(phrase) or self.cast.open(phrase)
        return self.cast.open(phrase) if not self.announcing else None

    def _written(self, phrase: Phrase, actor: Actor, first: bool) -> str:
        match = phrase.match
        owner = "'s" if match["many"] else ""
        if (actor.subject and match["automated"]) or not first:
            return f"V{actor.number}{owner}{phrase.clauses}"
        det, words = match["det"] or "the", match.group()[len(match["det"] or "") :].strip()
        det = {"another": "a", "one": "a", "its": "the"}.get(det.lower(), det)
        return self.introduced(f"{det} {words}", f"(V{actor.number}){phrase.clauses}")

    def introduced(self, words: str, number: str) -> str:
        return f"{words} {number}"
