"""Sentences of contacts: who strikes whom with which sides. A part of the writer."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from random import Random

from mini.generator import clauses_contact as told
from mini.generator.grammar import SLOTS, Told, choose, clause_of, clauses, families
from mini.generator.world import Contact, Crash

MUTUAL = re.compile(
    r"(?<!to )(?:each other|one another)(?!, \{S\})"
    r"|^(?!.*(?:\bhit|\bstr[iu]c?k|\bram|\bslammed|\binto (?:it|\{T\}|the \{ta\})|sideswip\w+ (?:it|\{T\})|receiving"
    r"|taking|still moving|coming fast|kept moving|\bput its|scrap|never stopped|only when|too late|the moving)).*"
    r"(?:\bmet (?:the \{|\{T\})|\bbetween\b|\bin (?:contact|collision)\b|side to side,|glancing contact"
    r"|(?:^|, )(?:The (?:two|pair|vehicles)|Both|They)\b|^Sideswipe \w+,|was met (?:on|by)|had its \w+ with"
    r"|\{S\} and \{T\}|\{S\} and the \{ta\}|\{S\}'s \{sa\} side and|(?:collision|contact) of the \{sa\} of \{S\} with"
    r"|^(?:Contact|The impact|The collision|The crash) (?:was|involved) (?:of )?(?:the )?\{sa\} of \{S\} (?:to|with)"
    r"|\b(?:in|involved in|had|got into) (?:an? )?(?:another )?(?:collision|accident|crash|wreck|contact|impact),?"
    r"[^.]* with \{T\}|\binto (?:contact|collision) with \{T\}|\bvs\. \{T\}$)",
    re.IGNORECASE,
)
"""Clauses of a contact, their choices made, that do not tell who strikes; where a front meets a side or a back, that
tells it."""
AGAIN = re.compile(
    r"\{S\}[^.;]*\b(?:was (?:then )?(?:pushed|forced|redirected|deflected|knocked|shoved|sent|spun|launched|hurled"
    r"|bumped|thrown|driven|flung|swung|propelled|carried)|got knocked|also|went on to"
    r"|next (?:impact|contact|collision)|further|another|rebounded|deflected|ricochet|glanced off|in turn"
    r"|did not stop there|after the first)"
    r"|\b(?:push|forc|threw|throw|sent|shov|carried|knock)\w*[^{]*\{S\}"
    r"|^(?:As a result|From the impact|Because of|Pushed|On the rebound|This )|^(?:That|The (?:next|first)) impact"
    r"|^The crash",
    re.IGNORECASE,
)
"""Clauses of a later contact which say that the striker was in the one before."""
FIRST = re.compile(r"\b(?:involved|drawn|dragged|nearby|in the way|spared|too)\b", re.IGNORECASE)
"""Clauses of a later contact which say that the struck was in none before."""
MANNED = re.compile(
    r"(?:drivers?|operator|occupants|passengers?|owner|man|woman) (?:of|in) \{T\}|\bdrivers\b|still moving"
    r"|\{T\}'s (?:driver|operator|occupants|passenger)|\{T\} (?:saw|never saw|says|said|reported)"
    r"|(?:through|to) its driver|not (?:see|expect)[^{]*\{S\}",
    re.IGNORECASE,
)
"""Clauses of somebody in the struck vehicle."""
OF_BOTH = re.compile(r"\b(?:both|the two|they|either|drivers|vehicles)\b", re.IGNORECASE)
"""Words before and behind a clause that tell of two vehicles in motion."""
ANGLED = re.compile(r"[TL]-type|\bangle", re.IGNORECASE)
"""Words of those that meet crosswise."""
UNLED = re.compile(
    r"(?:POI|I|We|Who|Where|What|Striking|Event|Second impact|Sideswipe|Then|Next|Finally|Again|After\w*|First|Moments"
    r"|Seconds|A moment|So it)\b|[^.;]*(?::| = | - )"
)
"""Clauses before which no further words stand."""
GOES_ON = re.compile(r"\b(?:kept going|carried on|went on|continued)\b")
"""Words behind a clause that go on with whoever it names first."""
CYCLES = re.compile(r"saddlebag|\bforks?\b|handlebar|foot ?peg|fairing|pannier|crash bar", re.IGNORECASE)
BODIES = re.compile(
    r"\b(?:door\w*|cab|hood|trunk|tailgate|hatch|box|sill|roof|pillar|windshield|window\w*|rocker|quarter|bed"
    r"|lift ?gate|deck ?lid|running board|toolbox|trailer|passenger compartment|wipers?)\b",
    re.IGNORECASE,
)
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

    say: Callable[..., str]

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
            options, areas = _FIXED, True
        sides = ("left", "right", "left", "right") if options is told.SWIPE else None
        sa = contact.striker_area if sides else self._area(contact.striker_area, striker.kind)
        ta = contact.struck_area if sides else self._area(contact.struck_area, struck.kind)
        head_first = contact.striker_area == "front" != contact.struck_area
        clause = self._contact(options, number, alike=not head_first and struck.vehicle)
        named = "{S}" in clause or "{T}" in clause
        if (named and not MUTUAL.search(clause)) or (areas and head_first):
            self.told.add(f"contact.{number}")
        walks = struck.kind in ("pedestrian", "bicycle")  # no clause tells its side
        self.told |= {f"{'side' if walks else 'areas'}.{number}"} if areas else set()
        touching = {"sa": contact.striker_area, "ta": contact.struck_area} if areas else {}
        clause = clause if self.held_out else self._framed(clause, contact)
        return self.say([clause], contact.striker, contact.struck, touching, sa=sa, ta=ta)

    def _contact(self, options: list[str], number: int, alike: bool) -> str:
        """A clause of a contact. In training its choices are made, it is true of those whom it means, and where sides
        do not tell who strikes (`alike`) each order of words comes as often as the others, as far as there are such
        clauses: most name the striker first, and the rest would hardly be learned.
        """
        options = families(options, self.held_out)
        if self.held_out:
            return self.rng.choice(options)
        false, order = self._false(number, alike), self.rng.choice(ORDERS) if alike else None
        found = ""
        for _ in range(TRIES):
            made = choose(self.rng, self.rng.choice(options))
            if any(strange.search(made) for strange in false):
                continue
            found = made
            if order in (None, order_of(made)):
                break
        return found or made

    def _false(self, number: int, alike: bool) -> list[re.Pattern[str]]:
        """What clauses of a contact may not say."""
        contact, before = self.crash.contacts[number], self.crash.contacts[:number]
        earlier = {index for other in before for index in (other.striker, other.struck)}
        false = [MANNED] if self.crash.actors[contact.struck].maneuver == "parked" else []
        crosswise = contact.struck_area in ("left", "right") and not alike
        false += [] if crosswise else [ANGLED]
        if number:
            false += [AGAIN] * (contact.striker not in earlier) + [FIRST] * (contact.struck in earlier)
        return false

    def _framed(self, clause: str, contact: Contact) -> str:
        """A clause of a contact, now and then with a few words before or behind it that are true of both."""
        struck = self.crash.actors[contact.struck]
        two = struck.vehicle and struck.maneuver not in ("parked", "stopped")
        tail = f" {choose(self.rng, self.rng.choice(told.TAILS))}" if self.rng.random() < 0.12 else ""
        if (not two and OF_BOTH.search(tail)) or (GOES_ON.search(tail) and order_of(clause) != "striker"):
            tail = ""
        if contact.struck_area not in ("left", "right") and ANGLED.search(tail):
            tail = ""
        if self.rng.random() >= 0.15 or UNLED.match(clause):
            return clause + tail
        lead = choose(self.rng, self.rng.choice(told.LEADS))
        return clause + tail if not two and OF_BOTH.search(lead) else f"{lead}, {clause[:1].lower()}{clause[1:]}{tail}"

    def _area(self, area: str, kind: str) -> str:
        options = told.AREA[area] if self.held_out else _parts(area, kind == "motorcycle")
        return clause_of(self.rng, options, self.held_out)


_OF_STRUCK = re.compile(r"(?:The (?:\w+ )?|The (?:driver|operator|man|woman|occupants|passengers?|rider) (?:of|in) )?")
"""What may stand before the struck as a subject, or before somebody in it."""


def order_of(clause: str) -> str:
    """Which of `ORDERS` a clause of a contact, its choices made, has."""
    first = next((slot for slot in SLOTS.finditer(clause) if slot[1] in ("S", "sa", "T", "ta")), None)
    if first is None or first[1] in ("S", "sa"):
        return "striker"
    return "struck" if _OF_STRUCK.fullmatch(clause[: first.start()]) else "place"


@cache
def _parts(area: str, cycle: bool) -> list[str]:
    """Words that train for a side, of motorcycles or of all others."""
    strange = BODIES if cycle else CYCLES
    return [part for part in families(told.AREA[area], False) if not strange.search(part)]


_FIXED = clauses("""
The {sa} of {S} [struck|impacted|contacted|hit] {T}
{S} [struck|impacted|hit] {T} with its {sa}
{S}'s {sa} [struck|impacted] {T}
{T} was [struck|hit] by the {sa} of {S}
~With its {sa} {S} ran into {T}
""")
