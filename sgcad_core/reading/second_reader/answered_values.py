"""What a model's answers to a whole report claim, field by field, in the terms of
`sgcad_core.reading.second_reader.field_claims`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

from sgcad_core.reading.second_reader.field_claims import (
    UNKNOWN_P,
    Claim,
    Claims,
    by_axis,
    by_id,
    control_of,
    curves_of,
    lanes_of,
    turns_of,
)
from sgcad_core.reading.text.compass import COMPASS, turned
from sgcad_core.records.specs import Compass, Leg

if TYPE_CHECKING:
    from sgcad_core.records.second_reader import Answered
    from sgcad_core.records.specs import Actor, BehaviorSpec
from collections import Counter
from collections.abc import Sequence

from sgcad_core.reading.second_reader.fuse_gist import model_fact

if TYPE_CHECKING:
    from sgcad_core.reading.crash_facts import CrashFacts
    from sgcad_core.reading.junctions.control import Control
    from sgcad_core.records.facts import Fact, Value
    from sgcad_core.records.specs import Compass


def model_claims(said: Answered) -> Claims:
    """What a model's answers say, each value with probability and grounding. A null in them is no claim."""
    sure = _Certainty(said.p, said.nats, said.told)
    found: Claims = {}
    for i, actor in enumerate(said.behavior.actors):
        at = f"crash.actors[{i}]"
        found |= {key: sure.claim(value, f"{at}.{name}") for key, name, value in _actor(actor)}
        if (lane := f"lane.{actor.id}") in found:
            found[lane] = found[lane]._replace(also=_edges_of(actor, said.layout.legs))
    found |= dict(_met(said.behavior, sure))
    for key in ("light", "weather", "surface"):
        if (value := getattr(said.behavior, key)) is not None:
            found[key] = sure.claim(value, f"crash.{key}")
    return found | dict(_answered_roads(said.layout.legs, sure))


class _Certainty(NamedTuple):
    """Probability and grounding of every value by its path."""

    p: Mapping[str, float]
    nats: Mapping[str, float]
    told: Mapping[str, float]

    def claim(self, value: Any, *paths: str, joint: bool = False) -> Claim:
        """A claim that stands at some paths: as sure as the least sure of them, or (`joint`) as all together.

        A value without a probability is sure, since the grammar left no choice; even where nothing is known, as of a
        server that gives no probabilities.
        """
        some = [self.p.get(path, 1.0) if self.p else UNKNOWN_P for path in paths] or [1.0]
        told = min((self.told[path] for path in paths if path in self.told), default=UNKNOWN_P)
        return Claim(value, told, prod(some) if joint else min(some), sum(self.nats.get(path, 0.0) for path in paths))


def _actor(actor: Actor) -> Iterator[tuple[str, str, Any]]:
    yield f"kind.{actor.id}", "kind", actor.kind
    if not actor.id.startswith("V"):
        return
    if heading := _heading(actor.road):
        yield f"heading.{actor.id}", "road", heading
    yield f"maneuver.{actor.id}", "maneuver", actor.maneuver
    if actor.exit_road in COMPASS:
        yield f"exit.{actor.id}", "exit_road", actor.exit_road
    if actor.lane is not None:
        yield f"lane.{actor.id}", "lane", actor.lane
    if actor.speed_mph:
        yield f"speed.{actor.id}", "speed_mph", actor.speed_mph


def _edges_of(actor: Actor, legs: tuple[Leg, ...]) -> tuple[str, ...]:
    """Edges of its approach on which a vehicle drives."""
    bearing = actor.road.removesuffix("_outer")
    lanes = next((leg.lanes_in for leg in legs if leg.bearing == bearing), 0)
    return ("right",) * (actor.lane == 1) + ("left",) * (actor.lane == lanes)


def _heading(road: str) -> Compass | None:
    """Heading of a vehicle that comes in on a leg ("N") or on its outer piece ("N_outer")."""
    bearing = road.removesuffix("_outer")
    return turned(bearing, 180) if bearing in COMPASS else None


def _met(behavior: BehaviorSpec, sure: _Certainty) -> Iterator[tuple[str, Claim]]:
    if not behavior.contacts:
        return
    first, at = behavior.contacts[0], "crash.contacts[0]"
    yield "contact", sure.claim((first.striker, first.struck), f"{at}.striker", f"{at}.struck", joint=True)
    sides = by_id({first.striker: first.striker_area, first.struck: first.struck_area})
    yield "areas", sure.claim(sides, f"{at}.striker_area", f"{at}.struck_area", joint=True)


def _answered_roads(legs: tuple[Leg, ...], sure: _Certainty) -> Iterator[tuple[str, Claim]]:
    at = {leg.bearing: f"road.legs[{i}]" for i, leg in enumerate(legs)}

    def claim(value: Any, some: Iterable[Leg], *names: str) -> Claim:
        return sure.claim(value, *(f"{at[leg.bearing]}.{name}" for leg in some for name in names))

    bearings = [f"{place}.bearing" for place in at.values()]
    yield "legs", sure.claim(tuple(sorted(at)), "road.legs[]", *bearings)
    for axis, some in by_axis(legs):
        yield f"lanes.{axis}", claim(lanes_of(some), some, "lanes_in", "lanes_out")
        if turns := turns_of(some):
            places = [f"{at[leg.bearing]}.turns_in[{k}]" for leg in some for k in range(len(leg.turns_in))]
            yield f"turns.{axis}", sure.claim(turns, *places)
        yield f"median.{axis}", claim(some[0].median, some, "median")
        yield f"curve.{axis}", claim(curves_of(some), some, "curve")
        if (limit := some[0].speed_limit_mph) is not None:
            yield f"limit.{axis}", claim(limit, some[:1], "speed_limit_mph")
    yield "control", claim(control_of(legs), legs, "control")


_OF_VEHICLES = {
    "kind": "kind", "heading": "heading", "maneuver": "maneuver", "exit": "exit_heading", "lane": "lane",
    "speed": "speed_mph",
}  # fmt: skip


class TakenValue(NamedTuple):
    """A value of the model's that is taken, how likely it is right, and what the model says of the evidence for it."""

    value: Any
    p: float
    told: float
    nats: float


def as_taken(said: Claim, p: float) -> TakenValue:
    """A claim that is right with this probability."""
    return TakenValue(said.value, p, said.told, said.nats)


def controlled(legs: Sequence[tuple[Compass, Control]]) -> tuple[Control, tuple[Compass, ...]]:
    """A junction's control and the legs that it stops, of what controls each leg that is controlled."""
    if not legs:
        return "none", ()
    kind = Counter(kind for _, kind in legs).most_common(1)[0][0]
    return kind, tuple(leg for leg, _ in legs) if kind in ("stop", "yield") else ()


def facts_of(key: str, one: TakenValue, crash: CrashFacts) -> Iterator[Fact]:
    """The facts of a taken value (`sgcad_core.reading.second_reader.field_claims` names it); `crash`: with all that is
    taken."""
    name, _, of = key.partition(".")
    for field, value in _named(name, of, one.value, crash):
        yield model_fact(field, value, one.p, told=one.told >= UNKNOWN_P, nats=one.nats)


def _named(name: str, of: str, value: Any, crash: CrashFacts) -> Iterator[tuple[str, Value]]:
    if name in _OF_VEHICLES:
        yield f"vehicles.{of}.{_OF_VEHICLES[name]}", value
    elif name in ("light", "weather", "surface"):
        yield f"conditions.{name}", value
    elif name == "contact":
        yield from zip(("contacts.0.striker", "contacts.0.struck"), value, strict=True)
    elif name == "areas":
        sides = dict(value)
        roles = {"striker": crash.contacts[0].striker, "struck": crash.contacts[0].struck} if crash.contacts else {}
        yield from ((f"contacts.0.{role}_area", sides[id]) for role, id in roles.items() if id in sides)
    else:
        yield from _of_roads(name, of, value)


def _of_roads(name: str, of: str, value: Any) -> Iterator[tuple[str, Value]]:
    if name == "legs":
        yield "junction.legs", value
    elif name == "control":
        kind, stopped = controlled(value)
        yield "junction.control", kind
        if stopped:
            yield "junction.stopped", stopped
    elif name == "lanes":
        for leg, toward, away in value:
            yield f"roads.{leg}.lanes_forward", toward
            yield f"roads.{leg}.lanes_backward", away
    elif name in ("turns", "curve"):
        field = {"turns": "turn_lanes", "curve": "curve"}[name]
        yield from ((f"roads.{leg}.{field}", found) for leg, found in value or ((of, "none"),))
    else:
        yield f"roads.{of}.{'speed_limit_mph' if name == 'limit' else name}", value
