"""Vehicles without a contact beside those that have one: traffic that is yielded to, rows of parked vehicles.

Adds one vehicle on the way that is told by a compass word, "oncoming" or "cross"; the planner keeps it clear of all
others. Who is waited for ahead in the own lane is company. Knows the reading and the roads, no motion.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import NamedTuple

from sgcad_core.reading.behavior.company import (
    MOST,
    contact_starts,
    free_name,
    letter_of_vehicles,
    named_before,
    taken_names,
    vehicle_kind,
)
from sgcad_core.reading.language import rule
from sgcad_core.reading.layout.road_ways import Way, apart, exits, turn_of, ways_of
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.text.compass import angle_of, compass_of
from sgcad_core.reading.text.sentence_roles import STORY_ROLES
from sgcad_core.records.specs import Actor, BehaviorSpec, RoadSpec

_ASIDE_RAD = math.radians(50)
"""From the told heading to that of its way, at most; the same from one way straight on to the next."""
_TURNS = {**dict.fromkeys(("oncoming", "opposing", "opposite"), math.pi),
          **dict.fromkeys(("cross", "crossing"), -math.pi / 2)}  # fmt: skip
"""Ways by a word, from that of the one that yields: crossing traffic comes from the left, whose lanes are nearest."""


_IN_A_ROW = 2
"""Vehicles that are drawn of a row of parked ones."""


class _Told(NamedTuple):
    """One that is yielded to: kind, the report's number if any, who yields, and the way in a word."""

    kind: str
    name: str | None
    waits: str | None
    way: str


def with_passers_by(behavior: BehaviorSpec, reading: Reading, spec: RoadSpec) -> BehaviorSpec:
    """The behavior with the first vehicle that one of its contact yields to and that has none itself."""
    first = behavior.first_meeting
    if first is None or len(behavior.actors) >= MOST:
        return behavior
    ways = ways_of(spec)
    pair = [a for name in (first.struck, first.striker) for a in behavior.actors if a.id == name and a.record.drives]
    known = {a.id for a in behavior.actors}
    for told in _told(behavior, reading):
        waits = next((a for a in pair if a.id == told.waits), next(iter(pair), None))
        own = next((w for w in ways if waits and (w.road.id, w.direction) == (waits.road, waits.direction)), None)
        way = _way(told.way, own, ways) if own else None
        if way is None or told.name in known or (way.road.id, way.direction) in {(a.road, a.direction) for a in pair}:
            continue
        onward = min(exits(way, ways), key=lambda w: abs(turn_of(way, w)), default=None)
        straight = onward is not None and abs(turn_of(way, onward)) < _ASIDE_RAD
        name = told.name or free_name(taken_names(behavior.actors, reading), letter_of_vehicles(reading))
        joined = Actor(
            id=name, kind=vehicle_kind(told.kind), road=way.road.id,
            direction=way.direction, exit_road=onward.road.id if onward and straight else None, maneuver="straight",
        )  # fmt: skip
        return behavior.model_copy(update={"actors": (*behavior.actors, joined)})
    return behavior


def with_parked_rows(behavior: BehaviorSpec, reading: Reading, spec: RoadSpec) -> BehaviorSpec:
    """The behavior with the vehicles that are told to be parked along the subject's road, on the sides of its way."""
    subject = next(iter(behavior.actors), None)
    ways = ways_of(spec)
    own = next((w for w in ways if subject and (w.road.id, w.direction) == (subject.road, subject.direction)), None)
    told = next((m for s in reading.sentences if (m := rule("company.parked_rows").search(s.text))), None)
    if own is None or told is None or behavior.first_meeting is None:
        return behavior
    if any(actor.maneuver == "parked" for actor in behavior.actors):
        return behavior  # these are the ones that are told
    met = [w for w in ways if w.to_node == own.to_node and apart(w.end_rad, own.end_rad + math.pi) < _ASIDE_RAD]
    against = next((w for w in (*met, *ways) if w in met or (w.road.id == own.road.id and w != own)), None)
    sides = {"left": (against,), "right": (own,)}.get((told["hand"] or "").lower(), (own, against))
    actors, taken = list(behavior.actors), taken_names(behavior.actors, reading)
    for way in (way for way in sides for _ in range(_IN_A_ROW) if way and len(actors) < MOST):
        taken.add(name := free_name(taken, letter_of_vehicles(reading)))
        parked = Actor(id=name, kind="car", road=way.road.id, direction=way.direction, lane=1, maneuver="parked")
        actors.append(parked)
    return behavior.model_copy(update={"actors": tuple(actors)})


def _told(behavior: BehaviorSpec, reading: Reading) -> Iterator[_Told]:
    """All of them in the sentences up to the first contact."""
    last = max(contact_starts(reading), default=len(reading.narrative))
    for sentence in reading.sentences:
        if sentence.role not in (*STORY_ROLES, "road") or sentence.start > last:
            continue
        for match in rule("company.yields_to").finditer(sentence.text):
            if way := _way_word(match):
                yield _Told(match["words"], match["id"], named_before(sentence.text, match.start()), way)


def _way_word(match: re.Match[str]) -> str | None:
    """The way of one that is yielded to, in a word: before its noun, or behind it."""
    behind = rule("company.comes").search(match["where"] or "")
    word = match["way"] or (behind["way"] if behind else None)
    return word.lower() if word else None


def _way(word: str, own: Way, ways: tuple[Way, ...]) -> Way | None:
    """The way that a word tells, which is not that of the one that yields; None: no such one is drawn."""
    met = [w for w in ways if w != own and w.to_node == own.to_node]  # they come to the same junction
    for turn in (_TURNS[word], -math.pi / 2) if word in _TURNS else (0.0,):  # where none comes against it, across
        heading = own.end_rad + turn if word in _TURNS else _compass_rad(word)
        able = [w for w in met or ways if heading is not None and w != own and apart(w.end_rad, heading) < _ASIDE_RAD]
        if able:
            return min(able, key=lambda w: apart(w.end_rad, heading or 0.0))
    return None


def _compass_rad(word: str) -> float | None:
    point = compass_of(word)
    return None if point is None else angle_of(point)
