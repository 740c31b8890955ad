"""Actors and contacts of the report against those of the scenario: vehicles, people and objects with their kinds, the
first contact, later ones, struck objects, near crashes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from sgcad_core.account.inputs import ExecutedCase, is_stated
from sgcad_core.account.records import Item
from sgcad_core.case.records import ObservedContact
from sgcad_core.execution.contact import avoided, closest_approach
from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import actor_kind, is_vehicle_id
from sgcad_core.metrics.labels.course_label_match import BRAKES_MPS, STEERS_M
from sgcad_core.metrics.labels.observed_crash import VehicleMotion
from sgcad_core.metrics.rest_error import AGAINST_M, against_errors
from sgcad_core.reading.contacts.contact_records import GROUND, ContactFacts
from sgcad_core.reading.language import of_role
from sgcad_core.records.acts import steering_of
from sgcad_core.records.course import ImpactTold
from sgcad_core.records.specs import Area
from sgcad_core.roads.areas.roadside import roadsides
from sgcad_core.units import MPS_PER_MPH

_OPEN_SIDES = 4
_EPS_S = 1e-6
_EVADES_BEHIND_S = 2.5
"""Time behind the nearest approach of a near crash in which an evasion may still be seen."""
_SPEED_SHARE, _SPEED_MPH = 0.1, 5.0
"""Tolerance of a told speed at the contact: reports give spans of 10 mph."""
_STANDS_MPS, _STILL = 0.5, 10
"""Speed of what stands, and the samples (0.5 s) before the contact in which it does."""


def actor_items(made: ExecutedCase) -> Iterator[Item]:
    """Vehicles of the report, what they strike, and the kinds that are stated."""
    kinds = {actor.id: actor.type for actor in made.scenario.actors}
    for vehicle in made.reading.crash.vehicles:
        named = " ".join(str(w) for w in (vehicle.year, vehicle.make, vehicle.model) if w)
        text = f"{vehicle.id}{f', a {named}' if named else ''}"
        there = vehicle.id in made.tracks
        yield made.item(there, f"vehicles.{vehicle.id}", vehicle.id, why="not in the scenario", text=text)
    for other in made.reading.crash.others:
        there = other.id in made.tracks or _is_driven_over(made, f"others.{other.id}.word", other.word)
        text = f"{other.id}, a {other.word}"
        yield made.item(there, f"others.{other.id}.word", other.word, why="not in the scenario", text=text)
    for vehicle in made.reading.crash.vehicles:
        yield from _kind(made, vehicle.id, kinds)


def _is_driven_over(made: ExecutedCase, field: str, word: str) -> bool:
    """Whether a thing is ground beside a road that a vehicle reaches, one that its sentence names if it names any."""
    kinds = {rule.yields["ground"] for rule in of_role("ground_beside") if rule.search(word)}
    strips = [strip for strip in roadsides(made.graph) if strip.kind in kinds]
    fact = made.told.get(field)
    telling = [s for s in made.reading.sentences if fact and s.start == fact.start]
    named = {name for sentence in telling for name in made.reading.named_in(sentence)}
    ids = [name for name in made.tracks if is_vehicle_id(name) and (name in named or not named)]
    vehicles = [(made.tracks[name].pose, made.sizes[name]) for name in ids]
    return any(strip.is_reached(pose, size) for strip in strips for pose, size in vehicles)


def _kind(made: ExecutedCase, name: str, kinds: Mapping[str, str]) -> Iterator[Item]:
    fact = made.told.get(f"vehicles.{name}.kind")
    if name not in kinds:
        return
    if fact and is_stated(fact):
        told, seen = str(fact.value), kinds[name]
        same = actor_kind(told).taken_for == actor_kind(seen).taken_for
        yield made.item(same, fact.field, told, seen, why=f"a {seen} drives there")
    towing = made.told.get(f"vehicles.{name}.trailer")
    if towing and is_stated(towing):
        longer = made.sizes[name][0] > actor_kind(kinds[name]).length_m + 1 or any(a[0] == "T" for a in made.tracks)
        yield made.item(longer, towing.field, True, why="it tows nothing")


def at_contact_items(made: ExecutedCase) -> Iterator[Item]:
    """What is told of vehicles at their first contact: a speed, and that one stands there after its maneuver."""
    for who, course in made.reading.crash.courses.items():
        if who not in made.tracks:
            continue
        before = made.tracks[who].speed_mps[: VehicleMotion(made.crash, who).hit]
        fact = made.told.get(f"vehicles.{who}.speed_mph")
        if course.speed_at_impact and fact is not None and isinstance(fact.value, int | float) and len(before):
            seen = float(before[-1]) / MPS_PER_MPH
            right = abs(seen - fact.value) <= max(_SPEED_SHARE * fact.value, _SPEED_MPH)
            why = f"it drives {seen:.0f} mph at its first contact"
            yield made.item(right, fact.field, fact.value, round(seen), why=why)
        if course.stops:
            still = len(before) > _STILL and float(before[-_STILL:].max()) < _STANDS_MPS < float(before.max())
            text, why = f"{who} stops in the way", "it does not come to a stop before its first contact"
            yield made.item(still, f"vehicles.{who}.stops", True, why=why, text=text)


def contact_items(made: ExecutedCase) -> Iterator[Item]:
    """One item per contact of the report, in the order of the text; for a near crash whether it is one."""
    crash = made.reading.crash
    if crash.near_crash:
        yield from _near_crash(made)
        return
    stated = [(n, c) for n, c in enumerate(crash.contacts) if c.stated or _thing(made, c)]
    last = -1.0
    for number, contact in stated:
        pair = _pair(contact.striker, contact.struck)
        times = [t for t, a, b in made.crash.touches if _pair(a, b) == pair]
        yield _came_about(made, number, contact, times, last)
        yield from _sides(made, number, contact, times)
        last = max(last, times[0]) if times and not crash.unnumbered else last
    for number, impact in enumerate(crash.impacts):
        yield from _impact(made, number, impact)
    yield from _resting(made)


def _pair(a: str, b: str) -> frozenset[str]:
    return frozenset((a, b))


def _thing(made: ExecutedCase, contact: ContactFacts) -> bool:
    """Whether the struck actor is an object or a person: such contacts are inferred records of stated words."""
    return any(other.id == contact.struck for other in made.reading.crash.others)


def _came_about(made: ExecutedCase, number: int, contact: ContactFacts, times: list[float], last: float) -> Item:
    field, pair = f"contacts.{number}.striker", (contact.striker, contact.struck)
    text = f"{_ordinal(number)}: {contact.striker} strikes {_called(made, contact.struck)}"
    first = made.execution.contact
    seen = f"{first.actor} and {first.other} touch first" if first else "nobody touches"
    if not times:
        gone = [name for name in pair if name not in made.tracks]
        why = f"{' and '.join(gone)} not in the scenario" if gone else "the two do not touch"
        return made.item(False, field, contact.striker, seen, why=why, text=text)
    if number == 0 and first and _pair(first.actor, first.other) != _pair(*pair) and not _before(made, first):
        return made.item(False, field, contact.striker, seen, why=f"not the first contact: {seen}", text=text)
    if times[-1] < last - _EPS_S:
        return made.item(False, field, contact.striker, f"{times[0]:.1f} s", why="comes before the others", text=text)
    return made.item(True, field, contact.striker, text=text)


def _ordinal(number: int) -> str:
    return "first contact" if number == 0 else f"contact {number + 1}"


def _called(made: ExecutedCase, name: str) -> str:
    return next((f"{name} ({o.word})" for o in made.reading.crash.others if o.id == name), name)


def _before(made: ExecutedCase, first: ObservedContact) -> bool:
    """Whether this is a contact with an object that the report has before the first one of two vehicles."""
    early = {impact.actor for impact in made.reading.crash.impacts if impact.before}
    return any({first.actor, first.other} & early and name[0] not in "VT" for name in (first.actor, first.other))


def _sides(made: ExecutedCase, number: int, contact: ContactFacts, times: list[float]) -> Iterator[Item]:
    """Items for the sides that touch; sides that the words leave open are skipped."""
    may = {contact.striker: contact.striker_may, contact.struck: contact.struck_may}
    names = {contact.striker: "striker_area", contact.struck: "struck_area"}
    declared = {contact.striker: contact.striker_area, contact.struck: contact.struck_area}
    seen = _areas(made.touch(times[0], (contact.striker, contact.struck))) if times else {}
    for who, allowed in may.items():
        if len(allowed) == _OPEN_SIDES or not who.startswith("V"):
            continue
        side: Area | None = seen.get(who)
        why = f"the {side} touches" if side else "the two do not touch"
        text = f"{_ordinal(number)}: {' or '.join(allowed)} of {who}"
        field = f"contacts.{number}.{names[who]}"
        yield made.item(side in allowed, field, declared[who], side, why=why, text=text)


def _areas(seen: ObservedContact) -> dict[str, Area]:
    return {seen.actor: seen.actor_area, seen.other: seen.other_area}


def _impact(made: ExecutedCase, number: int, impact: ImpactTold) -> Iterator[Item]:
    """A contact behind the first one, or with a thing, and the sides that touch in it."""
    letter = _letter(impact.other)
    vehicle = made.reading.crash.vehicle(impact.other) is not None
    met = [
        (t, a, b) for t, a, b in made.crash.touches
        if impact.actor in (a, b) and (impact.other in (a, b) if vehicle else {a[0], b[0]} >= {letter, impact.actor[0]})
    ]  # fmt: skip
    again = vehicle and any(_pair(c.striker, c.struck) == _pair(impact.actor, impact.other)
                            for c in made.reading.crash.contacts)  # fmt: skip
    further = met[int(again) :]
    text = f"{impact.actor} strikes {impact.other}{' once more' if again else ''}"
    why = "the two touch once only" if met and again else "does not come about"
    yield made.item(bool(further), f"impacts.{number}.other", impact.other, why=why, text=text)
    for who, told, name in (
        (impact.actor, impact.actor_area, "actor_area"),
        (impact.other, impact.other_area if vehicle else None, "other_area"),
    ):
        if told is not None:
            seen = [_areas(made.touch(t, (a, b))).get(who) for t, a, b in further]
            side = next((area for area in seen if area == told), seen[0] if seen else None)
            field, words = f"impacts.{number}.{name}", f"{text}: {told} of {who}"
            yield made.item(side == told, field, told, side, why=f"the {side} touches" if side else why, text=words)


def _resting(made: ExecutedCase) -> Iterator[Item]:
    """One item for each vehicle that is told to rest against a thing, or at it; none for what is driven over."""
    words = {other.id: _last_word(other.word) for other in made.reading.crash.others}
    for who, course in made.reading.crash.courses.items():
        field, told = f"vehicles.{who}.rest.against", course.rest.against
        if told is None or who not in made.tracks or _last_word(told) in GROUND:
            continue
        met = {b if a == who else a for _, a, b in made.crash.touches if who in (a, b)}
        named = [x for x in met if x[0] == _letter(told) and words.get(x, _last_word(told)) == _last_word(told)]
        end, size = made.tracks[who].pose[-1:], made.sizes[who]
        off = [float(against_errors(end, size, made.tracks[x].pose[-1], made.sizes[x])[0]) for x in named]
        beyond = min(off, default=0.0)
        why = f"it comes to rest {beyond + AGAINST_M:.1f} m from it" if named else "it touches none"
        yield made.item(bool(named) and beyond <= 0.0, field, told, why=why, text=f"{who} rests at the {told}")


def _last_word(thing: str) -> str:
    return thing.replace("-", " ").split()[-1]


def _letter(word: str) -> str:
    """The first letter of the ids of such a thing or person."""
    return next((str(user.yields["letter"]) for user in of_role("road_user") if user.search(word)), "O")


def _near_crash(made: ExecutedCase) -> Iterator[Item]:
    near, told = made.scenario.near_crash, made.reading.crash.near_crash
    pair = made.reading.crash.contacts[0] if made.reading.crash.contacts else None
    if told is None or pair is None:
        return
    text = f"near crash of {pair.striker} and {pair.struck}"
    closest = closest_approach(made.execution.trajectories, made.sizes, (pair.striker, pair.struck))
    yield from _evasion_items(made, closest.t_s) if closest else ()
    if not told.stated:
        return
    seen = f"{closest.clearance_m:.1f} m" if closest else "nobody near"
    has = near is not None and avoided(near, made.execution.contact, closest)
    why = f"they come to {seen}" if not made.execution.contact else "somebody touches"
    yield made.item(has, "contacts.0.striker", pair.striker, seen, why=why, text=text)


def _evasion_items(made: ExecutedCase, nearest_s: float) -> Iterator[Item]:
    """One item for each told evasion of a vehicle in the scenario; `nearest_s`: when the two come nearest."""
    for fact in made.reading.facts:
        if not fact.field.startswith("near_crash.") or (who := fact.field.split(".")[1]) not in made.tracks:
            continue
        told = str(fact.value)
        missed = [words for words, seen in _deeds(made, who, told, nearest_s) if not seen]
        why = f"it hardly {' and '.join(missed)}"
        yield made.item(not missed, fact.field, told, why=why, text=f"{who} {told.replace('_', ' ')}")


def _deeds(made: ExecutedCase, who: str, told: str, nearest_s: float) -> Iterator[tuple[str, bool]]:
    """The parts of an evasion in words, and whether each is seen."""
    track = made.tracks[who]
    near = track.t_s <= nearest_s + _EVADES_BEHIND_S
    if "braking" in told:
        yield "brakes", _most_rise(-track.speed_mps[near]) > BRAKES_MPS
    hand = steering_of(told)  # type: ignore[arg-type]
    if hand is not None:
        aside = VehicleMotion(made.crash, who).aside
        aside = aside[near[: len(aside)]]
        ways = {"left": (1.0,), "right": (-1.0,)}.get(hand, (1.0, -1.0))
        yield "steers aside", any(_most_rise(way * aside) > STEERS_M for way in ways)


def _most_rise(values: Floats) -> float:
    """The most by which (n,) values rise from one to a later one; 0 of none."""
    return float((values - np.minimum.accumulate(values)).max(initial=0.0))
