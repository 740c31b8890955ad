"""Road users without a contact that are told ahead of one with a contact: queues, vehicles that are waited for or
avoided, pedestrians, animals.

Adds them to a behavior in the lane of the one that waits or evades; the planner places them ahead of it. Knows the
reading, no roads and no motion. What is told elsewhere than ahead is not added.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from sgcad_core.kinds import UNNUMBERED, actor_kind
from sgcad_core.reading.actors.makes import kind_of
from sgcad_core.reading.actors.people_objects import kind_of_word
from sgcad_core.reading.actors.vehicles import MENTION
from sgcad_core.reading.language import rule
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.text.normalise import Sentence
from sgcad_core.reading.text.sentence_roles import STORY_ROLES
from sgcad_core.records.specs import Actor, ActorKind, BehaviorSpec, Maneuver

_QUEUED, MOST = 2, 12
"""Vehicles that are drawn of a queue, and actors of a behavior in all."""
_PAIR = 2
"""With more vehicles than those of a contact a queue is one of the numbered ones."""
_WAITING = ("stopped", "slowing", "straight", "negotiating_curve", "turn_left", "turn_right")


class _Told(NamedTuple):
    """One who is waited for: the kind, the report's number if any, and the vehicle that waits."""

    kind: ActorKind
    name: str | None
    waits: str | None
    avoided: bool = False
    """Whether the vehicle goes round it, be it off the road."""
    letter: str = ""
    """First letter of its id; empty for a vehicle."""
    drives: bool = False
    """Whether it drives ahead and slows; else it stands."""


def with_company(behavior: BehaviorSpec, reading: Reading) -> BehaviorSpec:
    """The behavior with the road users that are told ahead of a vehicle of its contact and have none."""
    first = behavior.first_meeting
    if first is None:
        return behavior
    actors = list(behavior.actors)
    pair = [a for name in (first.struck, first.striker) for a in actors if a.id == name]
    lanes = {(a.road, a.direction, a.lane) for a in pair}
    row = [*pair, *(a for a in actors if a not in pair and (a.road, a.direction, a.lane) in lanes)]
    taken = taken_names(actors, reading)
    for told in _told(behavior, reading):
        leader = _leader(told, row)
        if leader is None or len(actors) >= MOST or told.name in {a.id for a in actors}:
            continue
        name = told.name or free_name(taken, told.letter or letter_of_vehicles(reading))
        taken.add(name)
        actors.append(_ahead(told, name, leader))
    return behavior.model_copy(update={"actors": tuple(actors)})


def _ahead(told: _Told, name: str, leader: Actor) -> Actor:
    walks = actor_kind(told.kind).walks
    stands: Maneuver = "slowing" if told.drives and leader.maneuver != "stopped" else "stopped"
    return Actor(
        id=name, kind=told.kind, road=leader.road, direction=leader.direction, lane=None if walks else leader.lane,
        exit_road=None if walks else leader.exit_road, maneuver="straight" if walks else stands,
    )  # fmt: skip


def _leader(told: _Told, row: list[Actor]) -> Actor | None:
    """The vehicle that waits or evades: as named, else the one that stands or slows; `row`: those of the contact, and
    others in their lanes."""
    able = [a for a in row if a.record.drives and (a.maneuver in _WAITING or told.avoided) and a.maneuver != "parked"]
    if told.waits is not None:
        return next((a for a in able if a.id == told.waits), None)
    return next((a for a in able if a.maneuver in ("stopped", "slowing")), next(iter(able), None))


def _told(behavior: BehaviorSpec, reading: Reading) -> Iterator[_Told]:
    """All of them in the sentences up to the first contact; a queue where no further vehicle is numbered."""
    impacts = (s.start for s in reading.sentences if s.role == "impact")
    last = max([*contact_starts(reading), *impacts], default=len(reading.narrative))
    alone = sum(a.record.drives for a in behavior.actors) <= _PAIR
    walkers = any(a.record.exposed for a in behavior.actors)
    story = [s for s in reading.sentences if s.role in (*STORY_ROLES, "road") and s.start <= last]
    vehicles = [*_leads(behavior, reading)] or [t for s in story for t in _vehicles(s, reading)]
    queues = [t for s in story for t in _queue(s)][:_QUEUED] if alone and not vehicles else []
    people = [] if walkers else [t for s in story for t in (*_people(s), *_avoided(s))][:1]
    ahead = vehicles or [t for s in story for t in _avoided_vehicles(s)]
    yield from (*ahead[:1], *queues, *people)


def _queue(sentence: Sentence) -> Iterator[_Told]:
    match = rule("account.crowd").search(sentence.text) or rule("company.queue_ahead").search(sentence.text)
    if match and not rule("company.queue_elsewhere").search(sentence.text):
        yield from [_Told("car", None, named_before(sentence.text, match.start()))] * _QUEUED


def _vehicles(sentence: Sentence, reading: Reading) -> Iterator[_Told]:
    elsewhere = rule("company.elsewhere")
    for match in rule("company.waits_for").finditer(sentence.text):
        where = match["where"] or ""
        in_front = "in front of" in where or "ahead of" in where
        walks = actor_kind(kind_of(match["words"], None)[0]).walks  # told as one of the people instead
        if not walks and (in_front or not elsewhere.search(f"{match['words']} {where}")):
            yield _Told(
                vehicle_kind(match["words"]), reading.actor(match["id"]), named_before(sentence.text, match.start())
            )
    for match in rule("company.waits_for_another").finditer(sentence.text):
        here = "same" in (match["where"] or "")
        if here or not elsewhere.search(match[0].replace(" behind ", " ", 1)):
            yield _Told(vehicle_kind(match["kind"]), None, named_before(sentence.text, match.start()))


def _leads(behavior: BehaviorSpec, reading: Reading) -> Iterator[_Told]:
    """The vehicle ahead of the subject, where the subject is met from behind; it has no part in the contact."""
    first, ids = behavior.first_meeting, {a.id for a in behavior.actors}
    subject = next((v.id for v in reading.crash.vehicles), None)
    if first is None or first.struck != subject or first.struck_area != "back" or not reading.crash.unnumbered:
        return
    for sentence in reading.sentences:
        for match in rule("company.leads").finditer(sentence.text):
            name = reading.actor(match["id"] or match["ahead"] or match["behind"])
            if name not in ids:
                stands = rule("company.leads_standing").search(sentence.text)
                yield _Told(vehicle_kind(match["words"] or match["kind"] or "car"), name, subject, drives=not stands)


def _people(sentence: Sentence) -> Iterator[_Told]:
    match = rule("account.waited_for").search(sentence.text)
    if match and match["who"].lower() == "pedestrian":
        letter, kind = kind_of_word("pedestrian")
        yield _Told(kind, None, named_before(sentence.text, match.start()), letter=letter)


def _avoided(sentence: Sentence) -> Iterator[_Told]:
    """People and animals that are avoided; with words of their own they come into the road of the next one named."""
    for match in rule("company.avoided").finditer(sentence.text):
        word = (match["who"] or match["comes"]).lower()
        letter, kind = kind_of_word(word)
        if actor_kind(kind).walks:
            who = named_before(sentence.text, match.start())
            yield _Told(kind, None, who, avoided=True, letter=letter)


def _avoided_vehicles(sentence: Sentence) -> Iterator[_Told]:
    for match in rule("company.avoided_vehicle").finditer(sentence.text):
        if not rule("company.elsewhere").search(f"{match['words']} {match['where'] or ''}"):
            who = named_before(sentence.text, match.start())
            yield _Told(vehicle_kind(match["kind"]), None, who, avoided=True)


def contact_starts(reading: Reading) -> list[int]:
    """Where the sentences begin that tell of the first contact."""
    return [f.start for f in reading.facts if f.field.startswith("contacts.0") and f.start is not None]


def named_before(text: str, end: int) -> str | None:
    """The vehicle that is named last before a place in a sentence."""
    return next(reversed(MENTION.findall(text[:end])), None)


def vehicle_kind(words: str) -> ActorKind:
    """The kind of a vehicle from its words; a car where these name none."""
    kind = kind_of(words, None)[0]
    return kind if actor_kind(kind).drives else "car"


def taken_names(actors: Iterable[Actor], reading: Reading) -> set[str]:
    """The ids of the actors and of all that the report numbers."""
    return {a.id for a in actors} | {name for s in reading.sentences for name in reading.named_in(s)}


def letter_of_vehicles(reading: Reading) -> str:
    """First letter of the ids of vehicles to which the report gives no number."""
    return "V" if reading.crash.unnumbered else UNNUMBERED


def free_name(taken: set[str], letter: str) -> str:
    """The first number of a letter that is not taken."""
    return next(f"{letter}{n}" for n in range(1, 99) if f"{letter}{n}" not in taken)
