"""Possible lane totals of a road by the words of a narrative.

Knows the read road facts; no network.
"""

from __future__ import annotations

from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.reading.roads.road_facts import RoadFact


def allowed_totals(road: RoadFact, pictured: bool = True) -> set[int]:
    """Totals of both directions that agree with the text; empty where it does not state one clearly.

    A divided or one-way road is skipped (one carriageway may be drawn); a center lane may be counted or not, and turn
    lanes at the junction may come in addition. Without a diagram only the turn lanes of the text are known, and lanes
    stated for each direction leave no center lane open.
    """
    lanes = road.lanes
    if road.kind != "road" or lanes.one_way or lanes.divided or lanes.one_way_toward:
        return set()
    named = lanes.total or (2 * lanes.each_way if lanes.each_way else None)
    named = named or (sum(lanes.toward.values()) if len(lanes.toward) == 2 else None)
    if not named:
        return set()
    whole = len(lanes.toward) == 2 and sum(lanes.toward.values()) == lanes.total  # turn lanes are among them
    extra = (0 if whole else sum(len(turns) for turns in lanes.turns.values())) + pictured
    both = "each" in lanes.turns or len(lanes.turns) > 1  # turn lanes either way: no place of the road has all of them
    beyond = max(map(len, lanes.turns.values())) if both else 0
    fewer = max(beyond, lanes.center_turn_lane or (may_show_other_lanes(road, pictured) and named % 2))
    return set(range(max(1, named - fewer), named + extra + 1))


def may_show_other_lanes(road: RoadFact, pictured: bool) -> bool:
    """Whether a diagram may show other lanes than the text counts; not where lanes are stated for each direction."""
    return pictured and len(road.lanes.toward) < 2


def may_be_of_one_half(road: RoadFact, crash: CrashFacts) -> bool:
    """Whether a total may be that of one carriageway: of a divided road, a highway, or with a lane beyond its half."""
    lanes = road.lanes
    if lanes.divided is False:
        return False
    used = max((abs(v.lane or 0) for v in crash.vehicles if v.id in road.vehicles), default=0)
    beyond = lanes.total is not None and used > (lanes.total + 1) // 2
    return bool(lanes.divided or lanes.highway or road.kind == "freeway" or beyond)
