"""Headings that are only relative to one another, turned to fit the roads that the text tells."""

from __future__ import annotations

from dataclasses import replace

from sgcad_core.kinds import JOINING, RAMP
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import DRIVES
from sgcad_core.reading.roads.road_mentions import RoadMention, axis_of
from sgcad_core.reading.text.compass import between, compass_of, turned


def turned_to_roads(
    crash: CrashFacts, mentions: tuple[RoadMention, ...], statements: tuple[Statement, ...]
) -> CrashFacts:
    """Headings that are only relative to one another, turned so that V1 drives on the road and in the lanes told."""
    streets = [m for m in mentions if m.axis and m.kind not in JOINING]
    joined = [m for m in streets if m.relation == "other"] if any(m.kind == RAMP for m in mentions) else []
    axis = next((m.axis for m in joined + streets), None)
    lead = next((v for v in crash.vehicles if v.heading and v.origin not in (*DRIVES, RAMP)), None)
    place = next(
        (
            m
            for t in statements
            if t.role in ("opening", "impact", "road") and (m := rule("roads.place").search(t.text))
        ),
        None,
    )
    told_way = compass_of(place[1]) if place else None
    told_way = told_way if told_way and axis in (None, axis_of(told_way)) else None
    way = told_way or axis
    if crash.oriented or not way or not lead or not lead.heading or (not place and axis_of(lead.heading) == axis):
        return crash
    turn = between(lead.heading, way)
    return replace(
        crash, vehicles=tuple(turned_vehicle(v, turn) for v in crash.vehicles), oriented=told_way is not None
    )


def turned_vehicle(v: VehicleFacts, clockwise_deg: int) -> VehicleFacts:
    """The vehicle with its headings turned."""
    heading = turned(v.heading, clockwise_deg) if v.heading else None
    return replace(v, heading=heading, exit_heading=turned(v.exit_heading, clockwise_deg) if v.exit_heading else None)
