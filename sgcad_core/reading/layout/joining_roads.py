"""Roads that vehicles come from beside the street: which axis is a driveway's, and a crash on a ramp alone.

Reads road facts; draws legs. Knows no text.
"""

from __future__ import annotations

from dataclasses import replace

from sgcad_core.kinds import ALLEY, DRIVEWAY, JOINING, RAMP
from sgcad_core.reading.inference.inference_state import QUARTER_DEG
from sgcad_core.reading.layout.lanes_used import least_lanes
from sgcad_core.reading.layout.leg_parts import curve_of
from sgcad_core.reading.motion.motion_record import DRIVES
from sgcad_core.reading.roads.lanes import LaneFacts
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.specs import Compass, Leg


def drive_heading(facts: RoadFacts) -> Compass | None:
    """Where those head who come out of a driveway, if no other vehicle is told to head along that axis.

    A vehicle from a driveway crosses the street or turns into it, so the street lies across.
    """
    if facts.junction.kind not in (DRIVEWAY, ALLEY):
        return None
    told = [v for v in facts.crash.vehicles if v.heading and v.heading_stated]
    street = {axis_of(v.heading) for v in told if v.origin not in DRIVES and v.heading}
    return next(
        (v.heading for v in told if v.origin in DRIVES and v.heading and axis_of(v.heading) not in street), None
    )


def across_drive(street: RoadFact, streets: list[RoadFact], heading: Compass | None) -> RoadFact:
    """The street across a driveway: another one than the driveway's axis, or what was told of that as lying across."""
    if heading is None or street.axis != axis_of(heading):
        return street
    told = replace(street.lanes, toward={}, turns={}, own=None)
    other = next((r for r in streets if r.axis != street.axis), None)
    if other is None:
        return replace(street, axis=axis_of(turned(heading, 90)), lanes=told, curve=())
    return replace(other, lanes=told) if other.lanes == LaneFacts() and (told.total or 0) > 2 else other


def stem_drawn(facts: RoadFacts, flow: Compass) -> Compass:
    """The bearing of a side road as told, else where the turn lane leads of one that drives with the flow, else as
    inferred, or right of it."""
    stem = facts.junction.stem
    if stem and (facts.junction.stem_stated or any(v.maneuver in QUARTER_DEG for v in facts.crash.vehicles)):
        return stem
    words = {v.lane_word for v in facts.crash.vehicles if v.heading == flow}
    if "left_turn" in words and "right_turn" not in words:
        return turned(flow, -90)
    return stem or turned(flow, 90)


def ramp_alone(facts: RoadFacts) -> tuple[Leg, ...]:
    """A one-way ramp without the road that it leaves or joins, where all vehicles are told to be on it; else none."""
    ramp = next((r for r in facts.roads if r.kind == RAMP), None)
    vehicles = facts.crash.vehicles
    if ramp is None or not vehicles or not all(v.origin == RAMP or v.id in ramp.vehicles for v in vehicles):
        return ()
    elsewhere = any(r.vehicles for r in facts.roads if r.kind not in JOINING) and not facts.leaves
    ways = {v.heading for v in vehicles if v.heading}
    if elsewhere or len(ways) != 1 or any(v.maneuver == "merge" for v in vehicles):
        return ()
    flow = ways.pop()
    count = ramp.lanes.total or max(least_lanes(v, facts.crash) for v in vehicles)
    ends = (turned(flow, 180), flow)
    limit = ramp.speed_limit_mph
    return tuple(
        Leg(
            bearing=end, lanes_in=count * (end != flow), lanes_out=count * (end == flow), kind=RAMP,
            curve=curve_of(ramp, turned(end, 180)), speed_limit_mph=limit,
        )
        for end in ends
    )  # fmt: skip
