"""Holds on the next layout from the roads of a narrative: bearings, directions and lanes of legs."""

from __future__ import annotations

from collections.abc import Mapping

from sgcad_core.asking.schema_holds import SOME_LANES
from sgcad_core.case.records import Hold
from sgcad_core.kinds import junction_kind
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.layout.legs_used import legs_used
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
from sgcad_core.reading.text.compass import COMPASS, turned
from sgcad_core.records.specs import Compass


def laid(facts: RoadFacts, pictured: bool) -> tuple[Hold, ...]:
    """Each leg at its bearing, clockwise from north and each at its own index, so that none is repeated.

    Only if the paths of the narrative use every leg. Without a diagram a used road continues to both sides, and of four
    stated legs the others cross it.
    """
    used, legs = set(legs_used(facts, faced=True)), {leg.bearing for leg in layout_of_facts(facts).legs}
    four = junction_kind(facts.junction.kind).crossing and facts.junction.stated and len(legs) == 4 and bool(used)
    sure = used if pictured else legs if four else {*used, *(turned(leg, 180) for leg in used)}
    ordered = sorted(legs, key=COMPASS.index) if used <= legs <= sure else ()
    return tuple(Hold(items="legs", at=i, either=({"bearing": (leg,)},)) for i, leg in enumerate(ordered))


def carrying(way: Compass) -> tuple[Hold, ...]:
    """Lanes in that direction on both legs that may lie along it."""
    return (
        Hold(items="legs", key="bearing", values=(turned(way, 180),), either=({"lanes_in": SOME_LANES},)),
        Hold(items="legs", key="bearing", values=(way,), either=({"lanes_out": SOME_LANES},)),
    )


def totals(road: RoadFact, allowed: set[int]) -> Hold:
    """Lanes of a leg in both directions that add up to a total that the text allows."""
    pairs = [(n, tuple(total - n for total in sorted(allowed) if total - n in SOME_LANES)) for n in SOME_LANES]
    either = tuple({"lanes_in": (n,), "lanes_out": away} for n, away in pairs if away)
    return along(road, either)


def along(road: RoadFact, either: tuple[Mapping[str, tuple[str | int, ...]], ...]) -> Hold:
    """Each leg that lies along a road is one of the alternatives."""
    return Hold(items="legs", key="bearing", values=ends(road), either=either)


def ends(road: RoadFact) -> tuple[str, ...]:
    """Bearings of the legs that a road may have."""
    axis = road.axis or "N"
    return axis, turned(axis, 180)
