"""Who is in a gore gets his place there: from the road before it, into the road or the ramp behind it.

Knows actors and ways of a spec; no text.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sgcad_core.kinds import RAMP
from sgcad_core.reading.layout.road_ways import Way, exits, turn_of, ways_of
from sgcad_core.records.specs import Actor, Contact, RoadSpec


def in_gore(
    actors: Sequence[Actor], contacts: Sequence[Contact], gore: Mapping[str, str], spec: RoadSpec
) -> list[Actor]:
    """The actors with those of `gore` (vehicle -> `places.InGore`) put into the gore of the spec's first ramp."""
    ways = ways_of(spec)
    ramp = next((w for w in ways if w.road.kind == RAMP), None)
    if not gore or ramp is None:
        return list(actors)
    things = {c.struck for c in contacts[:1] if gore.get(c.striker) == "strikes"}
    found = []
    for actor in actors:
        how = gore.get(actor.id)
        if how in ("crosses", "leaves"):
            actor = actor.model_copy(update=_across(ramp, ways, how))
        thing = actor.id in things and actor.record.thing
        if how in ("crosses", "leaves", "stands") or thing:
            actor = actor.model_copy(update={"gore": True})
        found.append(actor)
    return found


def _across(ramp: Way, ways: Sequence[Way], how: str) -> dict[str, object]:
    """Where one starts who crosses the gore of a ramp, and by which road he leaves."""
    into = [w for w in ways if any(e is ramp for e in exits(w, ways)) and w.road.kind != RAMP]
    came = min(into, key=lambda w: abs(turn_of(w, ramp)), default=None)
    if came is None:
        onward = min(exits(ramp, ways), key=lambda w: abs(turn_of(ramp, w)), default=None)
        return {} if onward is None else {"exit_road": onward.road.id}
    on = [w for w in exits(came, ways) if w.road.kind != RAMP]
    ahead = min(on, key=lambda w: abs(turn_of(came, w)), default=None)
    goes = ramp if how == "leaves" or ahead is None else ahead
    return {"road": came.road.id, "direction": came.direction, "exit_road": goes.road.id, "maneuver": "straight"}
