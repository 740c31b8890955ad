"""Alternative readings of a crash, each one weak fact away from the one that stands, the most likely first.

For a writer whose checks doubt the reading. Stated facts are varied last and at a price, so that a stated fact gives
way only where the checks gain much by it. Knows no network and no motion.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from sgcad_core.reading.contacts.contact_records import AREAS, ContactFacts
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.specs import Maneuver

_TURNS: tuple[Maneuver, ...] = ("turn_left", "turn_right", "u_turn")
_CORNER, _OPEN_SIDE, _GUESSED, _LANE, _HEADING, _TURN, _SWAP = 0.1, 0.25, 0.2, 0.2, 0.3, 0.5, 0.7
_NEAR = 0.15
"""Of a heading in a near crash, which has no sides that touched to infer it from."""
"""Prices: what a reading must gain by its checks to be preferred."""
ONWARD = "drives straight on"


class Hypothesis(NamedTuple):
    """A crash read otherwise, in what, and at what price."""

    facts: CrashFacts
    words: str
    price: float
    open: bool = False
    """Whether the text is silent on what differs, so that nothing told gives way."""
    corner: bool = False
    """Whether it is the other side of a corner in a report without vehicle numbers: the words fit both."""
    eases: bool = False
    """Whether it is, there, the end of that corner, or the flank of a front corner that a told flank touches: those who
    fill in forms name both."""
    either: bool = False
    """Whether it is the other side of a told corner in any report."""
    heading: bool = False
    """Whether it is another heading of a parked vehicle, or of one from a driveway or the like, that no words tell."""


def hypotheses(facts: CrashFacts) -> list[Hypothesis]:
    """All readings that differ in one fact, cheapest first; none where no contact of two vehicles is read."""
    first = facts.contacts[0] if facts.contacts else None
    pair = [v for v in facts.vehicles if first and v.id in (first.striker, first.struck)]
    if first is None or len(pair) != 2:
        return []
    found = [*_sides(facts, first), *_guesses(facts, pair), *_headings(facts, pair), *_turns(facts, pair)]
    found += _swapped(facts, first)
    return sorted(found, key=lambda one: one.price)


def _sides(facts: CrashFacts, first: ContactFacts) -> Iterator[Hypothesis]:
    """The other side of a corner; any side where none is told."""
    for role in ("striker", "struck"):
        may, now = getattr(first, f"{role}_may"), getattr(first, f"{role}_area")
        price = _CORNER if len(may) <= 3 else _OPEN_SIDE
        for side in may if len(may) > 1 else ():
            if side != now:
                other = replace(first, **{f"{role}_area": side})
                words = f"the {side} of {getattr(first, role)} instead of the {now}"
                corner = facts.unnumbered and len(may) == 2
                either = len(may) == 2
                brushed = now == "front" and _told_flank(first, "struck" if role == "striker" else "striker")
                eases = corner and (side in ("front", "back") or brushed)
                yield Hypothesis(_with_first(facts, other), words, price, len(may) == len(AREAS), corner, eases, either)


def _told_flank(first: ContactFacts, role: str) -> bool:
    """Whether a flank is told of one of the two."""
    may = getattr(first, f"{role}_may")
    return len(may) == 1 and may[0] in ("left", "right")


def _guesses(facts: CrashFacts, pair: list[VehicleFacts]) -> Iterator[Hypothesis]:
    """A maneuver that is inferred, and slowing, give way to driving straight on, a lane to any lane."""
    for v in pair:
        if v.maneuver == "slowing" or (not v.maneuver_stated and v.maneuver != "straight"):
            yield _changed(facts, replace(v, maneuver="straight"), f"{v.id} {ONWARD}", _GUESSED)._replace(
                open=not v.maneuver_stated
            )
        if v.lane is not None or v.lane_word is not None:
            yield _changed(facts, replace(v, lane=None, lane_word=None), f"{v.id} in any lane", _LANE)


def _headings(facts: CrashFacts, pair: list[VehicleFacts]) -> Iterator[Hypothesis]:
    """A heading that is inferred is another one; of a near crash without any told heading, that of the second one."""
    alone = [] if facts.near_crash is None else [v for v in pair if v.id != facts.vehicles[0].id]
    for v in pair:
        if v.heading is not None and not v.heading_stated and (facts.oriented or v in alone):
            for by in (90, -90, 180):
                heading = turned(v.heading, by)
                price = _NEAR if alone else _HEADING
                other = _changed(facts, replace(v, heading=heading), f"{v.id} heads {heading}", price)
                yield other._replace(heading=v.maneuver == "parked" or v.origin is not None)


def _turns(facts: CrashFacts, pair: list[VehicleFacts]) -> Iterator[Hypothesis]:
    """The turn belongs to the other vehicle."""
    for v, other in (pair, pair[::-1]):
        if v.maneuver in _TURNS and other.maneuver not in _TURNS and not other.standing:
            straight = _changed(facts, replace(v, maneuver=other.maneuver, exit_heading=None), "", 0.0).facts
            turning = replace(other, maneuver=v.maneuver, exit_heading=v.exit_heading)
            yield _changed(straight, turning, f"{other.id} makes the turn, not {v.id}", _TURN)


def _swapped(facts: CrashFacts, first: ContactFacts) -> Iterator[Hypothesis]:
    """The vehicles' numbers were exchanged where the contact is told; where a side is stated for sure they were not."""
    if first.stated and (len(first.striker_may) == 1 or len(first.struck_may) == 1):
        return
    other = replace(first, striker=first.struck, struck=first.striker)
    words = f"{other.striker} strikes {other.struck}, not the other way round"
    yield Hypothesis(_with_first(facts, other), words, _SWAP, not first.stated)


def _with_first(facts: CrashFacts, first: ContactFacts) -> CrashFacts:
    return replace(facts, contacts=(first, *facts.contacts[1:]))


def _changed(facts: CrashFacts, vehicle: VehicleFacts, words: str, price: float) -> Hypothesis:
    vehicles = tuple(vehicle if v.id == vehicle.id else v for v in facts.vehicles)
    return Hypothesis(replace(facts, vehicles=vehicles), words, price)
