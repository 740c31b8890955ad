"""Actors of the report against those of the scenario: vehicles, pedestrians, struck objects, and their kinds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from sgcad_core.account.inputs import ExecutedCase, is_stated
from sgcad_core.account.records import Item
from sgcad_core.kinds import actor_kind, is_vehicle_id
from sgcad_core.reading.language import of_role
from sgcad_core.roads.areas.roadside import roadsides


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
