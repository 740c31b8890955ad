"""Sentences of contacts: striker, struck and the sides of both. A part of the writer."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from research.generator.clauses import contact_clauses
from research.generator.crash.world import Contact, Crash
from research.generator.grammar import StatedFacts, choose, clause_of
from research.generator.phrase_labels import has, plain
from research.generator.records import Group
from sgcad_core.kinds import actor_kind

ORDERS = ("striker", "struck", "place")
"""What a clause of a contact names first: the striker or its side, the struck as its subject, where that is hit."""
TRIES = 40


class ImpactsMixin:
    """Sentences of contacts; needs the writer's fields."""

    rng: Random
    crash: Crash
    held_out: bool
    stated: StatedFacts

    say: Callable[..., str]

    def impact(self, number: int, contact: Contact) -> str:
        """The sentence of a contact."""
        striker, struck = (self.crash.actors[index] for index in (contact.striker, contact.struck))
        rear = contact.striker_area == "front" and contact.struck_area == "back"
        follows = self.held_out or self.crash.config == "rear_end"
        swipe = {contact.striker_area, contact.struck_area} <= {"left", "right"}
        later = number > 0
        options, areas = (contact_clauses.THEN if later else contact_clauses.IMPACT), True
        if swipe and self.rng.random() < 0.6:
            options = contact_clauses.SWIPE
        elif rear and follows and self.rng.random() < 0.3:
            options = contact_clauses.THEN_REAR if later else contact_clauses.IMPACT_REAR
        elif self.rng.random() < 0.06 and not later:
            options, areas = contact_clauses.IMPACT_BARE, False
        if not struck.vehicle:
            options, areas = contact_clauses.FIXED, True
        sides = ("left", "right", "left", "right") if options is contact_clauses.SWIPE else None
        sa = contact.striker_area if sides else self._area(contact.striker_area, striker.kind)
        ta = contact.struck_area if sides else self._area(contact.struck_area, struck.kind)
        head_first = contact.striker_area == "front" != contact.struck_area
        clause = self._contact(options, number, alike=not head_first and struck.vehicle)
        named = "{S}" in clause or "{T}" in clause
        if (named and not has(clause, "mutual")) or (areas and head_first):
            self.stated.add(f"contact.{number}")
        walks = actor_kind(struck.kind).exposed  # no clause tells its side
        self.stated |= {f"{'side' if walks else 'areas'}.{number}"} if areas else set()
        touching = {"sa": contact.striker_area, "ta": contact.struck_area} if areas else {}
        clause = clause if self.held_out else self._framed(clause, contact)
        return self.say([clause], contact.striker, contact.struck, touching, sa=sa, ta=ta)

    def _contact(self, options: Group, number: int, alike: bool) -> str:
        """A clause of a contact. In training its choices are made, it is true of the actors that it means, and where
        sides do not tell the striker (`alike`) each order of words comes as often as the others, as far as there are
        such clauses: most name the striker first, and the rest would hardly be learned.
        """
        clauses = options.side(self.held_out)
        if self.held_out:
            return self.rng.choice(clauses)
        false, order = self._false(number, alike), self.rng.choice(ORDERS) if alike else None
        found = ""
        for _ in range(TRIES):
            made = choose(self.rng, self.rng.choice(clauses))
            if any(has(made, label) for label in false):
                continue
            found = made
            if order in (None, order_of(made)):
                break
        return found or made

    def _false(self, number: int, alike: bool) -> list[str]:
        """Labels of clauses of a contact that need what is not there."""
        contact, before = self.crash.contacts[number], self.crash.contacts[:number]
        earlier = {index for other in before for index in (other.striker, other.struck)}
        false = ["manned"] if self.crash.actors[contact.struck].maneuver == "parked" else []
        crosswise = contact.struck_area in ("left", "right") and not alike
        false += [] if crosswise else ["crosswise"]
        if number:
            false += ["again"] * (contact.striker not in earlier) + ["fresh"] * (contact.struck in earlier)
        return false

    def _framed(self, clause: str, contact: Contact) -> str:
        """A clause of a contact, now and then with a few words before or behind it that are true of both."""
        struck = self.crash.actors[contact.struck]
        two = struck.vehicle and struck.maneuver not in ("parked", "stopped")
        tail = f" {clause_of(self.rng, contact_clauses.TAILS, False)}" if self.rng.random() < 0.12 else ""
        if (not two and has(tail, "both")) or (has(tail, "on_striker") and order_of(clause) != "striker"):
            tail = ""
        if contact.struck_area not in ("left", "right") and has(tail, "crosswise"):
            tail = ""
        if self.rng.random() >= 0.15 or has(clause, "unled"):
            return clause + tail
        lead = clause_of(self.rng, contact_clauses.LEADS, False)
        return clause + tail if not two and has(lead, "both") else f"{lead}, {clause[:1].lower()}{clause[1:]}{tail}"

    def _area(self, area: str, kind: str) -> str:
        """Words for a side; in training, of motorcycles or of all others."""
        strange = [] if self.held_out else ["body" if kind == "motorcycle" else "cycle"]
        return plain(clause_of(self.rng, contact_clauses.AREA[area].without(self.held_out, strange), self.held_out))


def order_of(clause: str) -> str:
    """Which of `ORDERS` a clause of a contact, its choices made, has."""
    return next((order for order in ORDERS[1:] if has(clause, order)), ORDERS[0])
