"""Facts of roads and the junction with their sentences. The first street is "main", the second "cross".

Directions are travel directions; `forward` on a road is the way of its axis (N, NE, E or SE).
"""

from __future__ import annotations

from collections.abc import Iterator

from sgcad_core.kinds import FOUR_LEG, T
from sgcad_core.reading.provenance.crash_provenance import FactBuilder
from sgcad_core.reading.roads.lane_sources import stated_values
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import COMPASS, NAMES, turned
from sgcad_core.records.facts import Fact
from sgcad_core.records.specs import Compass

_WAYS = {
    "N": "northbound", "NE": "northeastbound", "E": "eastbound", "SE": "southeastbound",
    "S": "southbound", "SW": "southwestbound", "W": "westbound", "NW": "northwestbound",
    "any": "some_way", "each": "each_way",
}  # fmt: skip
_NAMES = {"total": "lanes_total", "each_way": "lanes_each_way"}


def road_names(facts: RoadFacts) -> tuple[str, ...]:
    """What each road is called in facts: main, cross, street3 ..., driveway, ramp."""
    streets = ("main", "cross", *(f"street{n}" for n in range(3, 3 + len(facts.roads))))
    named = iter(streets)
    return tuple(next(named) if road in facts.streets else road.kind for road in facts.roads)


def road_of_bearing(facts: RoadFacts, leg: str) -> str | None:
    """The name of the road whose legs lie at a bearing, by a road id such as "N" or "N_outer"."""
    bearing = leg.split("_")[0]
    if "_access" in leg or bearing not in COMPASS:
        return None
    axis = COMPASS[COMPASS.index(bearing) % 4]
    pairs = zip(road_names(facts), facts.roads, strict=True)
    return next((name for name, road in pairs if road.axis == axis), None)


def road_provenance(builder: FactBuilder, facts: RoadFacts) -> Iterator[Fact]:
    """Facts of every road, and of the junction."""
    for name, road in zip(road_names(facts), facts.roads, strict=True):
        yield from _road(builder, f"roads.{name}", road)
    yield from _junction(builder, facts)
    yield from _approaches(builder, facts)
    if facts.opening:
        yield builder.stated("place.median_opening", True, facts.opening)
    if closed := facts.closed:
        field = "place.closed_lane"
        said = closed.side_stated
        yield (
            builder.stated(field, closed.side, closed.where)
            if said
            else builder.inferred(field, closed.side, "places.who leaves it", closed.where)
        )


def _approaches(builder: FactBuilder, facts: RoadFacts) -> Iterator[Fact]:
    """Lanes of the legs of a junction as the story lists them, leg by leg."""
    if facts.junction.kind not in (T, FOUR_LEG):
        return
    stem = facts.junction.stem
    for leg in COMPASS:
        told = facts.approaches.of(leg, stem)
        if told.source is None or (stem and leg == turned(stem, 180)) or not _lies(facts, leg):
            continue
        at = f"approaches.{NAMES[leg]}"
        for name in ("lanes_in", "turns_in", "lanes_out"):
            if value := getattr(told, name):
                yield builder.stated(f"{at}.{name}", value, told.source)


def _lies(facts: RoadFacts, leg: Compass) -> bool:
    """Whether a leg lies on one of the roads, or is told by itself."""
    axes = {road.axis for road in facts.streets}
    return (
        leg == facts.junction.stem
        or axis_of(leg) in axes
        or leg in facts.approaches.legs
        or axis_of(leg) in facts.approaches.axes
    )


def _road(builder: FactBuilder, at: str, road: RoadFact) -> Iterator[Fact]:
    if road.axis:
        named = road.where.get("axis")
        field = f"{at}.axis"
        yield builder.stated(field, road.axis, named) if named else builder.inferred(field, road.axis, "vehicles on it")
    yield from _lanes(builder, at, road)
    if road.speed_limit_mph is not None:
        yield builder.stated(f"{at}.speed_limit_mph", road.speed_limit_mph, road.where.get("speed_limit"))
    for way, side in road.curve:
        yield builder.stated(f"{at}.curve_{_WAYS[way]}", side, road.where.get(f"curve {way}"))
    if road.rural:
        yield builder.stated(f"{at}.rural", True, road.where.get("rural"))


def _lanes(builder: FactBuilder, at: str, road: RoadFact) -> Iterator[Fact]:
    for name, value in stated_values(road.lanes).items():
        if name == "own":
            continue
        kind, _, way = name.partition(" ")
        field = {"toward": f"lanes_{_WAYS.get(way)}", "turns": f"turn_lanes_{_WAYS.get(way)}"}.get(kind)
        yield builder.stated(f"{at}.{field or _NAMES.get(name, name)}", value, road.lanes.where.get(name))


def _junction(builder: FactBuilder, facts: RoadFacts) -> Iterator[Fact]:
    junction = facts.junction
    if junction.kind == "none":
        return
    named = junction.where.get("kind") if junction.stated else None
    if named:
        yield builder.stated("junction.kind", junction.kind, named)
    else:
        hint = junction.where.get("kind")
        yield builder.inferred("junction.kind", junction.kind, "junction.paths of the vehicles", hint)
    if junction.stem:
        told = junction.where.get("stem")
        field = "junction.stem"
        yield builder.stated(field, junction.stem, told) if told else builder.inferred(field, junction.stem, "paths")
    if junction.control != "none":
        yield builder.stated("junction.control", junction.control, junction.where.get("control"))
    if junction.stopped:
        yield builder.inferred("junction.stopped", junction.stopped, "control.legs", junction.where.get("control"))
