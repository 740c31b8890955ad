"""Near crashes: the contact that nearly happened, the evasions, the clearance.

A sentence that tells a near miss is read without its "nearly" and "to avoid" as if it told the contact, so that the
reader of contacts reads these as well. A report that tells a contact tells no near crash.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.contacts.contacts import contact_mentions
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Segment, Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.sentence_roles import CRASH_ROLES, Role, is_impact
from sgcad_core.records.course import HANDS, Hand
from sgcad_core.records.specs import EvasiveManeuver

_READ: frozenset[Role] = CRASH_ROLES | {"other"}
_NEAR = 1
"""What is done in so many sentences before and behind the near miss may be its evasion."""
_M = {"inch": 0.0254, "inches": 0.0254, "foot": 0.3048, "feet": 0.3048, "ft": 0.3048, "cm": 0.01}
_NUMBERS = {"a": 1, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6}
_RANGE_M = (0.1, 10.0)
_AVOIDS = ("near_events.act", "near_events.went_back")


class EvasionTold(NamedTuple):
    """The maneuver by which one vehicle avoided the contact."""

    vehicle: str
    maneuver: EvasiveManeuver
    source: Source

    def beside(self, change: int) -> EvasiveManeuver | None:
        """The maneuver beside a change of lanes, 1 to the left, -1 to the right: without the steering that is that
        change, None where it is no more; with its hand where it leads back from it."""
        hand = {1: "left", -1: "right"}.get(change)
        if hand and self.maneuver.endswith(f"steering_{hand}") and self.source.words.lower().startswith(_MOVES):
            return "braking" if self.maneuver.startswith("braking") else None
        if not hand or self.source.rule != RETURNS or not self.maneuver.endswith("steering"):
            return self.maneuver
        return f"{self.maneuver}_{'right' if change > 0 else 'left'}"  # type: ignore[return-value]


class NearMiss(NamedTuple):
    """A contact that did not come about, as told."""

    contact_mentions: tuple[ContactMention, ...] = ()
    """Contacts that would have happened; none where two vehicles come together and no more is told."""
    evasions: tuple[EvasionTold, ...] = ()
    clearance_m: float | None = None


@dataclass(frozen=True)
class NearCrashFacts:
    """Marks the first contact of a crash's facts as avoided, with evasions and clearance.

    Untold sides are inferred like those of a contact; untold evasions are left to the planner.
    """

    evasions: tuple[tuple[str, EvasiveManeuver], ...] = ()
    clearance_m: float | None = None
    stated: bool = True
    """False: two come together, and how they did not touch is not told."""


def near_miss(
    statements: Sequence[Statement], segments: Sequence[Segment], roster: Roster, *, of_study: bool
) -> NearMiss | None:
    """The near crash of a report that tells no contact; None where it tells none either.

    `of_study`: what a study watched is told because two came near each other, whether the text says so or not.
    """
    missed = near_misses(statements, roster)
    no_crash = of_study or not any(rule("near_events.crash").search(t.text) for t in statements)
    if not missed or not no_crash:
        denied = [t for t in statements if rule("near_events.denied").search(t.text)]
        silent = not any(tells_hit(t) for t in statements if t not in denied)
        together = silent and (of_study or (no_crash and denied))
        return _together(segments, roster) if together and len(roster.ids) > 1 else None
    first = missed[0]
    pair = (first.actor, first.other)
    clearance = next((m for t in statements if t.role in _READ and (m := told_clearance_m(t.text))), None)
    return NearMiss(missed, evaded(segments, first.number, pair, roster.ids[0]), clearance)


def drifts_to(near: NearMiss, statements: Sequence[Statement], hand: Hand | None) -> tuple[NearMiss, Hand | None]:
    """The near miss of a thing, and the hand on which it lies; `hand`: as far as that is told.

    What steers to that hand, or steers without avoiding anything, leads to the thing: it is no evasion.
    """
    texts = {t.number: t.text for t in statements}
    kept = []
    for evasion in near.evasions:
        side = next((h for h in HANDS if evasion.maneuver.endswith(f"steering_{h}")), None)
        avoids = rule("near_events.avoids").search(texts.get(evasion.source.number, ""))
        if side is None or (avoids and side != hand):
            kept.append(evasion)
        else:
            hand = hand or side
    return near._replace(evasions=tuple(kept)), hand


def _together(segments: Sequence[Segment], roster: Roster) -> NearMiss:
    """Two that come together, with what they do to avoid each other."""
    watched = roster.ids[0]
    acts = [s for s in segments if rule(RETURNS).search(s.text) or (watched in s.subjects and _acts(s))]
    found = (e for s in acts for e in evaded([s], s.number, roster.ids[:2], watched))
    return NearMiss(evasions=tuple({e.vehicle: e for e in found}.values()))


def near_misses(statements: Iterable[Statement], roster: Roster) -> tuple[ContactMention, ...]:
    """Contacts that nearly came about, in the order of the text."""
    found: list[ContactMention] = []
    for t in statements:
        if t.role in _READ:
            found += _missed(t, roster)
    return tuple(found)


def tells_hit(statement: Statement) -> bool:
    """Whether a sentence tells a contact, even where its vehicles cannot be read."""
    return is_impact(rule("near_events.no_hit").sub(" ", statement.text))


def _missed(statement: Statement, roster: Roster) -> tuple[ContactMention, ...]:
    text = statement.text
    for near in of_role("near_miss"):
        text = near.sub(lambda m, to=near.yields["to"]: m[0] if _could_not(m) else m.expand(to), text)
    if text != statement.text:
        return contact_mentions(
            [statement._replace(text=text, role="impact" if is_impact(text) else statement.role)], roster
        )
    return ()


def _acts(segment: Segment) -> bool:
    return bool(rule("near_events.act").search(segment.text))


def before_evasion(
    segments: Iterable[Segment], near: NearMiss | None = None, watched: str | None = None
) -> tuple[Segment, ...]:
    """Segments cut before the evasion: the rest is the approach of the vehicle.

    Braking to avoid a contact is no maneuver before it; that of one who is nearly struck, or of another vehicle than
    the `watched` one, is, unless it avoids anything.
    """
    hits = near.contact_mentions if near else ()
    struck = {hit.other for hit in hits} - {hit.actor for hit in hits}
    return tuple(
        _before_evasion(s, yields=set(s.subjects) <= struck or watched not in (None, *s.subjects)) for s in segments
    )


def _before_evasion(segment: Segment, *, yields: bool) -> Segment:
    act, back = (rule(name).search(segment.text) for name in _AVOIDS)
    if act and yields and not rule("near_events.avoids").search(segment.text, act.start()):
        act = None
    act = min(filter(None, (act, back)), key=lambda m: m.start(), default=None)
    text = segment.text[: act.start()] if act else segment.text
    return segment._replace(text=text, role="approach" if segment.role in _READ else segment.role)


def _could_not(match: re.Match[str]) -> bool:
    return bool(rule("near_events.could_not").search(match.string[: match.start()]))


def evaded(segments: Sequence[Segment], number: int, pair: tuple[str, ...], watched: str) -> tuple[EvasionTold, ...]:
    """Evasions of a pair in a sentence or beside it, one maneuver each.

    Of vehicles other than the `watched` one only acts done to avoid count, and going back into a lane: others brake for
    reasons of their own.
    """
    found: dict[str, EvasionTold] = {}
    for segment in sorted(segments, key=lambda s: (abs(s.number - number), s.number)):
        if abs(segment.number - number) > _NEAR or segment.role not in _READ:
            continue
        for vehicle in segment.subjects:
            told = vehicle == watched or any(rule(act).search(segment.text) for act in _AVOIDS)
            if vehicle in pair and vehicle not in found and told and (how := _maneuver(segment)):
                found[vehicle] = EvasionTold(vehicle, *how)
    return tuple(found.values())


def _maneuver(segment: Segment) -> tuple[EvasiveManeuver, Source] | None:
    """The evasive maneuver that a stretch of text tells of its subject."""
    told = {word: m for e in of_role("evasion") for word in e.yields if (m := e.search(segment.text))}
    if not told:
        return None
    first = min(told.values(), key=lambda m: m.start())
    source = Source(segment.number, first.group(), "near_events.evasion")
    if back := told.get("returns"):
        way = back["way"] or back["way2"] or back["hand"]
        maneuver: EvasiveManeuver = f"steering_{way}" if way else "steering"  # type: ignore[assignment]
        source = source._replace(rule=RETURNS)
        return (_BRAKING[maneuver] if "brakes" in told else maneuver), source
    if "steers" not in told:
        return ("braking" if "brakes" in told else "accelerating"), source
    side = told["steers"]["side"] or told["steers"]["lane"]
    sides: dict[str, EvasiveManeuver] = {"left": "steering_left", "right": "steering_right"}
    maneuver = sides.get(side or "", "steering")
    return (_BRAKING[maneuver] if "brakes" in told else maneuver), source


_MOVES = ("chang", "mov", "pull", "drift")
"""Beginnings of verbs of steering that tell a change of lanes as well."""
RETURNS = "near_events.went_back"
"""Rule of an evasion back into the lane from which its vehicle began to change."""
_BRAKING: dict[EvasiveManeuver, EvasiveManeuver] = {
    "steering": "braking_and_steering", "steering_left": "braking_and_steering_left",
    "steering_right": "braking_and_steering_right",
}  # fmt: skip


def told_clearance_m(text: str) -> float | None:
    """How near they came in metres, where a sentence tells it and it is between 0.1 and 10 m."""
    m = rule("near_events.clearance").search(text)
    if not m:
        return None
    number = _NUMBERS.get(m["number"].lower()) or float(m["number"])
    meters = round(number * _M.get(m["unit"].lower(), 1.0), 2)
    return meters if _RANGE_M[0] <= meters <= _RANGE_M[1] else None
