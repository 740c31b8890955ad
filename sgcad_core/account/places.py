"""Stated roads against compiled ones: axes, lanes, limits, curves; the junction and its control; conditions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

from sgcad_core.account.inputs import ExecutedCase, is_stated
from sgcad_core.account.motion import Comparison
from sgcad_core.account.records import Item
from sgcad_core.kinds import ALLEY, DRIVEWAY, PARKING_LOT, RAMP, junction_kind, unsupported_kind
from sgcad_core.reading.provenance.road_provenance import road_names
from sgcad_core.reading.roads.road_facts import RoadFact
from sgcad_core.reading.text.compass import COMPASS, angle_of, compass_of_angle
from sgcad_core.records.facts import Value
from sgcad_core.records.specs import Compass
from sgcad_core.roads.areas.closures import tapers
from sgcad_core.roads.compiled_facts import CompiledRoad, headings_agree, junctions, junctions_as_told
from sgcad_core.roads.lane_graph import network_figures
from sgcad_core.roads.lane_total_readings import allowed_totals, may_be_of_one_half

TOLERANCE_DEG = 35.0
"""Between a road as drawn and the compass direction that the report names, as the validator `road_narrative` has it."""
LIMIT_MPH = 3.0
CURVED_RAD = math.radians(10.0)
_TOLD_BY = {
    "legs": "junction.kind", "circle": "junction.kind", "control": "junction.control",
    "limit": ".speed_limit_mph", "one_way": ".one_way", "lanes": ".lanes_total",
}  # fmt: skip
"""Ends of the names of the facts that tell what is held against a map."""
_WAYS: dict[str, Compass] = {
    "northbound": "N", "southbound": "S", "eastbound": "E", "westbound": "W", "northeastbound": "NE",
    "southeastbound": "SE", "northwestbound": "NW", "southwestbound": "SW",
}  # fmt: skip


def place_items(made: ExecutedCase) -> Iterator[Item]:
    """One item per stated fact of roads, junction and conditions that the scenario can be compared with."""
    roads = dict(zip(road_names(made.reading.roads), made.reading.roads.roads, strict=True))
    for fact in made.reading.facts:
        parts = fact.field.split(".")
        if not is_stated(fact) or len(parts) < 2:
            continue
        seen = None
        if parts[0] == "roads" and parts[1] in roads:
            seen = _road(made, roads[parts[1]], parts[2], fact.value)
        elif fact.field in _JUNCTION:
            seen = _JUNCTION[fact.field](made, fact.value)
        elif parts[0] == "conditions":
            seen = _condition(made, parts[1], fact.value)
        if seen is not None:
            yield made.item(seen.has, fact.field, fact.value, seen.instead, why=seen.why)
    for kind in made.reading.roads.junction.unsupported:
        called = unsupported_kind(kind).called
        yield made.item(False, "junction.place", kind, why=unsupported_kind(kind).remedy, text=f"the place: {called}")


def map_items(made: ExecutedCase) -> Iterator[Item]:
    """One item per told fact that the map of the real place can be held against: as there, or contradicted by it."""
    place = made.network.place
    for fact in place.facts if place and place.found else ():
        where = next((f for f in made.reading.facts if is_stated(f) and f.field.endswith(_TOLD_BY[fact.field])), None)
        yield Item(
            kind="has" if fact.agrees else "contradicts", field=f"place.on_map.{fact.field}", subject=fact.subject,
            value=fact.told, seen=None if fact.agrees else fact.on_map, text=fact.text,
            reason="" if fact.agrees else "the scenario has it as the report tells",
            start=where.start if where else None, end=where.end if where else None,
        )  # fmt: skip


# ------------------------------------------------------------------ roads
def _road(made: ExecutedCase, road: RoadFact, name: str, value: Value) -> Comparison | None:
    here = [d for d in made.drawn if road.axis is None or d.along(road.axis, TOLERANCE_DEG, either=True)]
    if name == "axis":
        return Comparison(bool(here), ", ".join(d.id for d in made.drawn), "no road runs that way")
    if name in ("lanes_total", "lanes_each_way"):
        return _lanes(made, road, here, name, int(value)) if isinstance(value, int) else None
    if name.startswith("lanes_") and isinstance(value, int):
        return _lanes_one_way(made, here, name.removeprefix("lanes_"), value)
    if name.startswith("curve_"):
        return Comparison(any(_curved(d) for d in here), "straight", "the road is straight")
    if name == "speed_limit_mph" and isinstance(value, int | float):
        limits = sorted({round(s) for d in here for s in d.speeds_mph})
        fits = any(abs(limit - value) <= LIMIT_MPH for limit in limits)
        return Comparison(fits, ", ".join(map(str, limits)), f"the limit is {limits or 'open'}")
    return _lane_kind(made, here, name, value)


def _lanes(made: ExecutedCase, road: RoadFact, here: list[CompiledRoad], name: str, value: int) -> Comparison:
    """A lane total with all readings that its words allow: of one carriageway, or of both where that is open."""
    wanted = allowed_totals(road, made.pictured) or {value, 2 * value if name == "lanes_each_way" else value}
    counts = {d.total for d in here}
    if name == "lanes_each_way" or may_be_of_one_half(road, made.reading.crash):
        counts |= {n for d in here for n in (d.forward, d.backward)}
        wanted = wanted | {value}
    seen = ", ".join(f"{d.id} {d.forward}+{d.backward}" for d in here[:4])
    return Comparison(bool(counts & wanted), seen, f"drawn: {seen or 'no such road'}")


def _lanes_one_way(made: ExecutedCase, here: list[CompiledRoad], way: str, value: int) -> Comparison | None:
    if way not in _WAYS:
        return None
    counts = sorted({d.lanes_towards(_WAYS[way], TOLERANCE_DEG) for d in here} - {0})
    told = sum(name.startswith("turn_lanes") for name in made.told)
    fits = any(value <= n <= value + told + made.pictured for n in counts)
    return Comparison(fits, ", ".join(map(str, counts)), f"drawn: {counts or 'none'} that way")


def _curved(road: CompiledRoad) -> bool:
    turns = [abs(math.remainder(b - a, 2 * math.pi)) for a, b in pairwise(road.headings)]
    return bool(turns) and max(sum(turns), *turns) > CURVED_RAD


def _lane_kind(made: ExecutedCase, here: list[CompiledRoad], name: str, value: Value) -> Comparison | None:
    """One-way, center turn lane, turn lanes, median; each carriageway of a divided road is one-way."""
    spec = made.network.spec
    ids = {d.id for d in here}
    roads = [road for road in spec.roads if road.id in ids] if spec else []
    if name == "one_way":
        one = any(not d.forward or not d.backward for d in here)
        one |= any(r.median not in ("none", "painted") for r in roads)
        both = any(d.forward and d.backward for d in here)
        return Comparison(one if value else both or len(here) > 1, None, "it is drawn the other way")
    if not roads:
        return None
    if name == "center_turn_lane":
        return Comparison(any(r.center_turn_lane for r in roads), None, "no such lane is drawn")
    if name.startswith("turn_lanes_") and isinstance(value, tuple | list):
        turns = [turn for r in roads for turn in (*r.turns_forward, *r.turns_backward)]
        return Comparison(all(side in turns for side in value), None, "no lane is for that turn alone")
    if name == "divided" and value:
        parted = len({r.id for r in roads if not (r.lanes_forward and r.lanes_backward)}) > 1
        return Comparison(parted or any(r.median != "none" for r in roads), None, "no median is drawn")
    return None


# ------------------------------------------------------------------ the junction
def _kind(made: ExecutedCase, value: Value) -> Comparison | None:
    kind, spec = str(value), made.network.spec
    drawn = {ALLEY if road.alley else road.kind for road in spec.roads} if spec else set()
    legs = max((len(found) for found in junctions(made.graph)), default=0)
    if kind in (DRIVEWAY, ALLEY, RAMP):
        return Comparison(kind in drawn, f"{legs} legs", f"no {kind} is drawn") if spec else None
    if kind == PARKING_LOT:
        return None
    record = junction_kind(kind)  # type: ignore[arg-type]
    if record.round:
        return Comparison(bool(made.graph.circles), "none", "no roundabout is drawn")
    if record.legs <= 2:
        return Comparison(network_figures(made.graph).intersections == 0, f"{legs} legs", "a junction is drawn")
    return Comparison(legs == record.legs, f"{legs} legs", f"the junction drawn has {legs} legs")


def _control(made: ExecutedCase, value: Value) -> Comparison | None:
    spec = made.network.spec
    if spec is None:
        return None
    drawn = {node.control for node in spec.nodes} - {"none"}
    fits = str(value) in drawn or (value in ("stop", "yield") and "all_way_stop" in drawn)
    seen = ", ".join(sorted(drawn)) or "none"
    return Comparison(fits, seen, f"the junction drawn has {seen}")


def _stem(made: ExecutedCase, value: Value) -> Comparison | None:
    if value not in COMPASS:
        return None
    legs = [leg for found in junctions_as_told(made.graph, made.network.place) if len(found) > 2 for leg in found]
    fits = any(headings_agree(angle_of(value), leg, TOLERANCE_DEG + 15) for leg in legs)
    seen = ", ".join(sorted({compass_of_angle(leg) for leg in legs}))
    return Comparison(fits, seen, f"legs lie {seen or 'nowhere'}")


def _condition(made: ExecutedCase, name: str, value: Value) -> Comparison | None:
    behavior = made.scenario.behavior
    seen = getattr(behavior, name, None) if behavior else None
    return None if behavior is None else Comparison(seen == value, seen, f"the scenario has {seen or 'none'}")


def _closed_lane(made: ExecutedCase, value: Value) -> Comparison:
    """The side on which lanes are closed, in driving direction."""
    sides = {"right" if taper.side < 0 else "left" for taper in tapers(made.graph)}
    return Comparison(value in sides, ", ".join(sorted(sides)) or "none", "no such lane is closed")


_JUNCTION: dict[str, Callable[[ExecutedCase, Value], Comparison | None]] = {
    "junction.kind": _kind, "junction.control": _control, "junction.stem": _stem,
    "place.closed_lane": _closed_lane,
    "place.median_opening": lambda made, _: Comparison(bool(made.graph.openings), None, "no opening is drawn"),
}  # fmt: skip
