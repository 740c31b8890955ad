"""Sentences of contacts: who strikes whom with which sides. A part of the writer."""

from __future__ import annotations

import re
from functools import cache
from random import Random
from typing import Any

from mini.generator import clauses_contact as told
from mini.generator.grammar import SLOTS, Told, choose, clause_of, clauses, families
from mini.generator.world import Contact, Crash

MUTUAL = re.compile(
    r"(?<!to )(?:each other|one another)(?!, \{S\})"
    r"|^(?!.*(?:\bhit|\bstr[iu]c?k|\bram|\bslammed|\binto (?:it|\{T\}|the \{ta\})|sideswip\w+ (?:it|\{T\})|receiving"
    r"|taking|still moving|coming fast|kept moving|\bput its|[Ss]crap)).*"
    r"(?:\bmet (?:the \{|\{T\})|\bbetween\b|\bin (?:contact|collision)\b|(?:^|, )(?:The two|Both|The vehicles|They)\b"
    r"|\{S\} and \{T\}|\{S\} and the \{ta\}|\{S\}'s \{sa\} side and|(?:collision|contact) of the \{sa\} of \{S\} with"
    r"|^(?:Contact|The impact|The collision|The crash) was (?:of )?(?:the )?\{sa\} of \{S\} (?:to|with)"
    r"|\b(?:in|involved in|had|got into) (?:an? )?(?:another )?(?:collision|accident|crash|wreck|contact|impact),?"
    r"[^.]* with \{T\}|\bcame into (?:contact|collision) with \{T\}$|\bvs\. \{T\}$)",
    re.IGNORECASE,
)
"""Clauses of a contact, their choices made, that do not tell who strikes; where a front meets a side or a back, that
tells it."""
AGAIN = re.compile(
    r"\{S\}[^.;]*\b(?:was (?:then )?"
    r"(?:pushed|forced|redirected|deflected|knocked|shoved|sent|spun|launched|hurled|bumped"
    r"|thrown|driven)|got knocked|also|went on to|second|next (?:impact|contact|collision)|further|another|rebounded"
    r"|ricochet|glanced off|in turn|did not stop there|after the first)"
    r"|\b(?:push|forc|threw|throw|sent|shov|carried|knock)\w*[^{]*\{S\}"
    r"|^\[?(?:As a result|From the impact|Because of|Pushed|On the rebound|This |That impact|The (?:crash|\[first))",
    re.IGNORECASE,
)
"""Clauses of a later contact which say that the striker was in the one before."""
MANNED = re.compile(
    r"(?:drivers?|operator|occupants|passengers?|owner)\]? (?:of|in) \{T\}"
    r"|\{T\}'s \[?(?:driver|operator|occupants|passenger)|\{T\} \[?(?:saw|never saw|says|said|reported)"
    r"|through its driver|not \[?(?:see|expect)[^{]*\{S\}",
    re.IGNORECASE,
)
"""Clauses of somebody in the struck vehicle."""
OF_BOTH = re.compile(r"\b(?:both|the two|they|either driver|drivers|vehicles)\b", re.IGNORECASE)
"""Words before and behind a clause that tell of two vehicles."""
ANGLED = re.compile(r"[TL]\]?-type|\bangle", re.IGNORECASE)
"""Clauses of those that meet crosswise."""
UNLED = re.compile(r"(?:POI|I|We|Who|Striking|Event|Second impact|Sideswipe)\b|[^.;{]*:")
"""Clauses before which no further words stand."""
GOES_ON = re.compile(r"\b(?:kept going|carried on|went on|continued)\b")
"""Words behind a clause that go on with whoever it names first."""
CYCLES = re.compile(r"saddlebag|\bforks?\b|handlebar", re.IGNORECASE)
BODIES = re.compile(r"\b(?:door\w*|cab|hood|trunk|tailgate|hatch|box|sill|roof|pillar|windshield)\b", re.IGNORECASE)
"""Parts that only motorcycles have, and that they have not."""
ORDERS = ("striker", "struck", "place")
"""What a clause of a contact names first: the striker or its side, the struck as its subject, where that is hit."""
TRIES = 40


class ImpactsMixin:
    """Sentences of contacts; needs the writer's fields."""

    rng: Random
    crash: Crash
    held_out: bool
    told: Told

    say: Any

    def impact(self, number: int, contact: Contact) -> str:
        """The sentence of a contact."""
        striker, struck = (self.crash.actors[index] for index in (contact.striker, contact.struck))
        rear = contact.striker_area == "front" and contact.struck_area == "back"
        follows = self.held_out or self.crash.config == "rear_end"
        swipe = {contact.striker_area, contact.struck_area} <= {"left", "right"}
        later = number > 0
        options, areas = (told.THEN if later else told.IMPACT), True
        if swipe and self.rng.random() < 0.6:
            options = told.SWIPE
        elif rear and follows and self.rng.random() < 0.3:
            options = told.THEN_REAR if later else told.IMPACT_REAR
        elif self.rng.random() < 0.06 and not later:
            options, areas = told.IMPACT_BARE, False
        if not struck.vehicle:
            options, areas = clauses(_FIXED), True
        sides = ("left", "right", "left", "right") if options is told.SWIPE else None
        sa = contact.striker_area if sides else self._area(contact.striker_area, striker.kind)
        ta = contact.struck_area if sides else self._area(contact.struck_area, struck.kind)
        head_first = contact.striker_area == "front" != contact.struck_area
        clause = self._contact(options, number, alike=not head_first)
        named = "{S}" in clause or "{T}" in clause
        if (named and not MUTUAL.search(clause)) or (areas and head_first):
            self.told.add(f"contact.{number}")
        walks = struck.kind in ("pedestrian", "bicycle")  # no clause tells its side
        self.told |= {f"{'side' if walks else 'areas'}.{number}"} if areas else set()
        touching = {"sa": contact.striker_area, "ta": contact.struck_area} if areas else {}
        return self.say([self._framed(clause, struck.vehicle)], contact.striker, contact.struck, touching, sa=sa, ta=ta)

    def _contact(self, options: list[str], number: int, alike: bool) -> str:
        """A clause of a contact, its choices made. Where sides do not tell who strikes (`alike`), every order of words
        trains equally often, since most clauses name the striker first and the rest would hardly be learned."""
        options = families(options, self.held_out)
        clause = self.rng.choice(options)
        if self.held_out:
            return clause
        contact, before = self.crash.contacts[number], self.crash.contacts[:number]
        false = [MANNED] if self.crash.actors[contact.struck].maneuver == "parked" else []
        if alike or contact.struck_area not in ("left", "right"):
            false.append(ANGLED)
        if number and all(contact.striker not in (first.striker, first.struck) for first in before):
            false.append(AGAIN)
        order = self.rng.choice(ORDERS) if alike else None
        for _ in range(TRIES):
            if order in (None, order_of(clause)) and not any(found.search(clause) for found in false):
                break
            clause = self.rng.choice(options)
        return choose(self.rng, clause)

    def _framed(self, clause: str, two: bool) -> str:
        """A clause of a contact, in training now and then with a few words before or behind it; `two`: vehicles."""
        if self.held_out:
            return clause
        if self.rng.random() < 0.15 and not UNLED.match(clause):
            lead = choose(self.rng, self.rng.choice(told.LEADS))
            clause = f"{lead}, {clause[:1].lower()}{clause[1:]}" if two or not OF_BOTH.search(lead) else clause
        if self.rng.random() < 0.12:
            tail = choose(self.rng, self.rng.choice(told.TAILS))
            strange = (not two and OF_BOTH.search(tail)) or (order_of(clause) != "striker" and GOES_ON.search(tail))
            return clause if strange else f"{clause} {tail}"
        return clause

    def _area(self, area: str, kind: str) -> str:
        options = told.AREA[area] if self.held_out else _parts(area, kind == "motorcycle")
        return clause_of(self.rng, options, self.held_out)


_OF_STRUCK = re.compile(r"(?:The |\[?The \[?(?:driver|operator|occupants|passengers?)[^{]*)?")
"""What may stand before the struck as a subject, or before somebody in it."""


@cache
def order_of(clause: str) -> str:
    """Which of `ORDERS` a clause of a contact has."""
    first = next((slot for slot in SLOTS.finditer(clause) if slot[1] in ("S", "sa", "T", "ta")), None)
    if first is None or first[1] in ("S", "sa"):
        return "striker"
    return "struck" if _OF_STRUCK.fullmatch(clause[: first.start()]) else "place"


@cache
def _parts(area: str, cycle: bool) -> list[str]:
    """Words that train for a side, of motorcycles or of all others."""
    strange = BODIES if cycle else CYCLES
    return [part for part in families(told.AREA[area], False) if not strange.search(part)]


_FIXED = """
The {sa} of {S} [struck|impacted|contacted|hit] {T}
{S} [struck|impacted|hit] {T} with its {sa}
{S}'s {sa} [struck|impacted] {T}
{T} was [struck|hit] by the {sa} of {S}
~With its {sa} {S} ran into {T}
"""
