"""Values that are taken of a model's answers, as facts under the names that the rules give theirs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from sgcad_core.reading.second_reader.field_claims import UNKNOWN_P, Claim
from sgcad_core.reading.second_reader.fuse_gist import model_fact

if TYPE_CHECKING:
    from sgcad_core.reading.crash_facts import CrashFacts
    from sgcad_core.reading.junctions.control import Control
    from sgcad_core.records.facts import Fact, Value
    from sgcad_core.records.specs import Compass

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
