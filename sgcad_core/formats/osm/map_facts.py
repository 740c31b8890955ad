"""What a report tells of a place's roads, held against the map: legs, control, lanes, limits, one-way streets.

Only told facts count, and only where the map tells something too. Knows no map file.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from sgcad_core.kinds import FOUR_LEG, T, junction_kind
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import NAMES
from sgcad_core.records.place import LaidLeg, MapLeg, MapPlace, PlaceFact
from sgcad_core.records.specs import Compass
from sgcad_core.roads.lane_total_readings import allowed_totals

_LIMIT_MPH = 3


def kind_told(facts: RoadFacts) -> bool:
    """Whether the text tells how many roads meet."""
    return facts.junction.stated and (facts.junction.kind in (T, FOUR_LEG) or junction_kind(facts.junction.kind).round)


def road_of(facts: RoadFacts, bearing: Compass) -> RoadFact | None:
    return next((road for road in facts.streets if road.axis == axis_of(bearing)), None)


def told_totals(road: RoadFact | None) -> frozenset[int]:
    """Totals that the told lanes of a street allow, of both directions or of one; empty where none are told."""
    if road is None:
        return frozenset()
    lanes = road.lanes
    found = set(allowed_totals(road, False)) if lanes.total or lanes.each_way or lanes.toward else set[int]()
    return frozenset(found)


def lanes_agree(told: frozenset[int], leg: MapLeg) -> bool:
    """Whether the map's lanes are a told number, with or without lanes for turns alone and the center lane."""
    total = leg.lanes_in + leg.lanes_out
    turning = sum(turn in ("left", "right", "left_right") for turn in leg.turns_in)
    return not leg.lanes_known or bool({total, total - turning, total + leg.center_turn_lane} & told)


def compared(facts: RoadFacts, laid: Sequence[LaidLeg], real: MapPlace) -> Iterator[PlaceFact]:
    """Every told fact that the map can be held against."""
    yield from _legs_compared(facts, real)
    yield from _roads_compared(facts, laid, real)


def _legs_compared(facts: RoadFacts, real: MapPlace) -> Iterator[PlaceFact]:
    junction = facts.junction
    if not kind_told(facts) or len(real.legs) < 3:
        return
    record = junction_kind(junction.kind)
    if record.round or real.circle_lanes:
        seen = "a roundabout" if real.circle_lanes else f"a junction of {len(real.legs)} legs"
        yield _fact("circle", "junction", record.called, seen, bool(record.round) == bool(real.circle_lanes))
    if not record.round:
        yield _fact("legs", "junction", str(record.legs), str(len(real.legs)), record.legs == len(real.legs))


def _roads_compared(facts: RoadFacts, laid: Sequence[LaidLeg], real: MapPlace) -> Iterator[PlaceFact]:
    """Control of the junction; lanes, limit and direction of each told street."""
    controls = {one.leg.control for one in laid} - {"none"}
    told = facts.junction.control
    if "control" in facts.junction.where and controls and len(real.legs) > 2:
        signed = [one for one in laid if one.leg.lanes_in]
        every = controls == {"stop"} and all(one.leg.control == "stop" for one in signed)
        seen = "all_way_stop" if every else sorted(controls)[0]
        yield _fact("control", "junction", told, seen, told == seen or told in controls)
    for road in facts.streets:
        here = [one.leg for one in laid if axis_of(one.bearing) == road.axis]
        if here:
            yield from _street_compared(road, here)


def _street_compared(road: RoadFact, legs: Sequence[MapLeg]) -> Iterator[PlaceFact]:
    name = next((leg.street for leg in legs if leg.street), "") or f"the street {NAMES[road.axis or 'N']}"
    totals, known = told_totals(road), [leg for leg in legs if leg.lanes_known]
    if totals and known:
        seen = " and ".join(dict.fromkeys(f"{leg.lanes_in + leg.lanes_out}" for leg in known))
        told = " or ".join(map(str, sorted(totals)))
        yield _fact("lanes", name, told, seen, any(lanes_agree(totals, leg) for leg in known))
    limits = sorted({leg.limit_mph for leg in legs if leg.limit_mph})
    if road.speed_limit_mph and limits:
        near = any(abs(limit - road.speed_limit_mph) <= _LIMIT_MPH for limit in limits)
        yield _fact("limit", name, f"{road.speed_limit_mph} mph", f"{' and '.join(map(str, limits))} mph", near)
    if road.lanes.one_way is not None:
        alone = any(not (leg.lanes_in and leg.lanes_out) for leg in legs)
        words = {True: "one way", False: "both ways"}
        yield _fact("one_way", name, words[road.lanes.one_way], words[alone], alone == road.lanes.one_way)


def _fact(field: Any, subject: str, told: str, on_map: str, agrees: bool) -> PlaceFact:
    return PlaceFact(field=field, subject=subject, told=told, on_map=on_map, agrees=agrees)
