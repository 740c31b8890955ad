"""Whose move brings two vehicles together that are both told to keep to their lanes: the striker's.

Vehicles that come against each other on one road meet front to front or left to left only where one is over the middle
of the road; vehicles side by side touch only where one changes lanes. Of 107 crashes of coded reports whose text leaves
open who moved, it was the one that is told to strike in 101 (CISS, those to learn from). Where one alone is told to
lose control, to steer or to leave the road, it is that one. An assumption in any case: the maneuver is not told.
"""

from __future__ import annotations

from dataclasses import replace

from sgcad_core.kinds import FOUR_LEG, PARKING_LOT, RAMP, ROUNDABOUT, T
from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.inference.inference_state import CrashInferred, CrashTold
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.reading.text.compass import against, between
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import Maneuver

OVER_MIDDLE, BESIDE, ACROSS = "infer.over_middle", "infer.beside", "infer.across"
_ONWARD: tuple[Maneuver, ...] = ("straight", "negotiating_curve", "slowing")
_ALONG_DEG = (0, 45, 315)
_APART = (RAMP, ROUNDABOUT, PARKING_LOT)
"""Where vehicles come together without a change of lanes."""
_CROSSED = (FOUR_LEG, T)
"""Junctions in which one that turns left crosses the way of those that come against it."""


def with_untold_moves(roads: RoadFacts, told: CrashTold, inferred: CrashInferred) -> RoadFacts:
    """The roads with a crash in which the vehicle makes the move that its first contact needs; `inferred` is told.

    Only where sides and directions are told.
    """
    crash = roads.crash
    first = next(iter(crash.contacts), None)
    pair = [v for v in crash.vehicles if first and v.id in (first.striker, first.struck)]
    if first is None or len(pair) != 2 or crash.near_crash or crash.unnumbered:
        return roads
    if len(first.striker_may) > 1 or len(first.struck_may) > 1 or not _ways_told(told, *pair):
        return roads
    if any(v.maneuver not in _ONWARD for v in pair):
        return roads
    mover = _turner(roads, first, pair) or _mover(crash, first, pair)
    maneuver, by = _move(roads, first, mover, next(v for v in pair if v is not mover))
    if maneuver is None:
        return roads
    inferred.maneuvers[mover.id] = maneuver
    inferred.told_maneuvers.discard(mover.id)
    before = inferred.sources.get(f"{mover.id} maneuver")
    inferred.sources[f"{mover.id} maneuver"] = before._replace(rule=by) if before else Source(0, "", by)
    moved = replace(mover, maneuver=maneuver, maneuver_stated=False)
    vehicles = tuple(moved if v is mover else v for v in crash.vehicles)
    return replace(roads, crash=replace(crash, vehicles=vehicles))


def _ways_told(told: CrashTold, one: VehicleFacts, other: VehicleFacts) -> bool:
    """Whether the text tells the way of both, or of one against the other."""
    relations = ((v.id, met) for v in (one, other) for _, _, met, _ in told.motions[v.id].relations)
    return (one.heading_stated and other.heading_stated) or any({v, met} == {one.id, other.id} for v, met in relations)


def _turner(roads: RoadFacts, first: ContactFacts, pair: list[VehicleFacts]) -> VehicleFacts | None:
    """The one of two that come against each other whose right flank is met in a junction by the front of the other one:
    it turned left across the other one's way, which shows that flank to it (24 of 26 such reports, CISS)."""
    sides = {first.striker: first.striker_area, first.struck: first.struck_area}
    if roads.junction.kind not in _CROSSED or sorted(sides.values()) != ["front", "right"]:
        return None
    return next(v for v in pair if sides[v.id] == "right")


def _mover(crash: CrashFacts, first: ContactFacts, pair: list[VehicleFacts]) -> VehicleFacts:
    """The one that alone is told to have left its way, else the striker."""
    courses = [crash.driven.get(v.id, CourseTold()) for v in pair]
    strays = [v for v, c in zip(pair, courses, strict=True) if c.lost_control or c.steers or c.departs or c.moves]
    return strays[0] if len(strays) == 1 else next(v for v in pair if v.id == first.striker)


def _move(
    roads: RoadFacts, first: ContactFacts, mover: VehicleFacts, other: VehicleFacts
) -> tuple[Maneuver | None, str]:
    """The move and the rule of it; None where none follows."""
    own, theirs = first.striker_area, first.struck_area
    if first.striker != mover.id:
        own, theirs = theirs, own
    if mover.heading is None or other.heading is None:
        return None, ""
    kind = roads.junction.kind
    course = roads.crash.driven.get(mover.id, CourseTold())
    turned = course.lost_control or course.steers == "left"  # any side may come to the fore
    if against(mover.heading, other.heading) and kind == "none" and (turned or {own, theirs} <= {"front", "left"}):
        return "crossing_centerline", OVER_MIDDLE
    if against(mover.heading, other.heading) and kind in _CROSSED and (own, theirs) == ("right", "front"):
        return "turn_left", ACROSS
    if between(mover.heading, other.heading) in _ALONG_DEG and kind not in _APART and not _same_lane(mover, other):
        if (own, theirs) == ("right", "left") and not _lies(mover, other, 1):
            return "lane_change_right", BESIDE
        if (own, theirs) == ("left", "right") and not _lies(mover, other, -1):
            return "lane_change_left", BESIDE
    return None, ""


def _same_lane(mover: VehicleFacts, other: VehicleFacts) -> bool:
    return mover.lane is not None and mover.lane == other.lane


def _lies(mover: VehicleFacts, other: VehicleFacts, side: int) -> bool:
    """Whether the told lanes have the other vehicle on the other side than the one that touched."""
    if mover.lane is None or other.lane is None or (mover.lane < 0) != (other.lane < 0):
        return False
    return (other.lane - mover.lane) * side > 0
