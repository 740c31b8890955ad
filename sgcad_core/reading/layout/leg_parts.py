"""What a told road gives its legs: median, limit, kind and bend. Knows no lanes and no junction."""

from __future__ import annotations

from typing import Literal

from sgcad_core.kinds import ALLEY, DRIVEWAY, JOINING, RAMP
from sgcad_core.reading.roads.road_facts import RoadFact
from sgcad_core.reading.text.compass import OPPOSITE_HAND, turned
from sgcad_core.records.specs import Compass, Median, RoadKind


def median_of(road: RoadFact, lanes_in: int, lanes_out: int) -> Median:
    """What lies between the directions of a road that has both."""
    if not lanes_in or not lanes_out:
        return "none"
    if road.lanes.median:
        return road.lanes.median
    if road.lanes.divided:
        return "grass" if road.kind == "freeway" else "raised"
    return "none"


def usual_limit(road: RoadFact) -> int | None:
    """The statutory limit that most states post on freeways, on rural roads and in alleys, mph; None elsewhere."""
    return {"freeway": 60, RAMP: None, DRIVEWAY: None, ALLEY: 15}.get(road.kind, 50 if road.rural else None)


def kind_of(road: RoadFact) -> RoadKind:
    """The kind of a leg of this road."""
    return DRIVEWAY if road.kind == ALLEY else road.kind if road.kind in JOINING else "road"


def curve_of(road: RoadFact, inward: Compass) -> Literal["none", "left", "right"]:
    """The bend on a leg as one drives towards the hub: told for that direction, or seen from the other end."""
    told = dict(road.curve)
    if inward in told:
        return told[inward]
    back = told.get(turned(inward, 180))
    return OPPOSITE_HAND[back] if back else "none"
