"""What a report tells of drawn roads beyond their lanes: whether a limit is posted or assumed, the area, the
center line, ground beside it.

Knows the road facts and the ids of a layout's roads; no file format.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

from sgcad_core.kinds import DRIVEWAY, RAMP
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.specs import Compass, Road, RoadArea, RoadSpec, ToldRoad

_IN_TOWN = ("bike_lane", "parking", "sidewalk")


def told_roads(facts: RoadFacts, spec: RoadSpec) -> Mapping[str, ToldRoad]:
    """Road id -> what is told of it. A limit counts as posted where the report tells it of a road of that axis."""
    in_town = facts.urban or facts.crosswalk or any(what in _IN_TOWN for what in facts.beside)
    told = {road.id: _as_told(road, _facts_of(road, facts), in_town) for road in spec.roads}
    streets = [road for road in spec.roads if _facts_of(road, facts)]
    line = facts.center_line if facts.junction.kind == "none" else ""  # at a junction it may be that of either road
    side = _side_left(facts) if facts.ground else ""
    return told | {
        road.id: told[road.id]._replace(center_line=line, ground=facts.ground, ground_side=side) for road in streets
    }


def _facts_of(road: Road, facts: RoadFacts) -> list[RoadFact]:
    """Facts of the road along whose axis a leg lies (its id begins with its bearing), and those without an axis."""
    bearing = road.id.partition("_")[0]
    if road.kind == DRIVEWAY or bearing not in get_args(Compass):
        return []
    kinds = (RAMP,) if road.kind == RAMP else ("road", "freeway", "crossroads")
    return [r for r in facts.roads if r.kind in kinds and (r.axis is None or r.axis == axis_of(bearing))]  # type: ignore[arg-type]


def _as_told(road: Road, facts: list[RoadFact], in_town: bool) -> ToldRoad:
    limits = {fact.speed_limit_mph for fact in facts} - {None}
    town: RoadArea = "town" if in_town and road.kind == "road" else ""
    area: RoadArea = (
        "motorway" if any(f.kind == "freeway" for f in facts) else "rural" if any(f.rural for f in facts) else town
    )
    return ToldRoad(posted=road.speed_limit_mph in limits, area=area)


def _side_left(facts: RoadFacts) -> Compass | Literal[""]:
    """The side of the compass on which vehicles leave the road; "" where it is not told, or several are."""
    headings = {v.id: v.heading for v in facts.crash.vehicles}
    sides = {_as_compass(c.departs, headings.get(name)) for name, c in facts.crash.courses.items() if c.departs}
    (side,) = sides if len(sides) == 1 else (None,)
    return side or ""


def _as_compass(departs: str, heading: Compass | None) -> Compass | None:
    """The side of a departure; None where it hangs on a heading that is not known."""
    if departs in get_args(Compass):
        return departs  # type: ignore[return-value]
    if departs not in ("left", "right") or heading is None:
        return None
    return turned(heading, 90 if departs == "right" else -90)
