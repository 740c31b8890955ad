"""The legs of a junction that the told paths of its vehicles use. Knows no road network format."""

from __future__ import annotations

from collections.abc import Iterable

from sgcad_core.kinds import ALLEY, DRIVEWAY, RAMP, junction_kind
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.inference.inference_state import QUARTER_DEG
from sgcad_core.reading.motion.motion_record import DRIVES
from sgcad_core.reading.motion.relative_headings import contact_turn
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import between, turned
from sgcad_core.records.specs import Compass, Maneuver

_ONWARD = ("straight", "slowing", "negotiating_curve")
OFF_ROAD = (*DRIVES, RAMP, "shoulder")
"""Where vehicles come from that may tell of the street which they join, not of where they were."""


def legs_used(facts: RoadFacts, faced: bool = False) -> tuple[Compass, ...]:
    """Bearings of legs that vehicles come from, or turn into, by headings and turns that the text states.

    A vehicle that goes straight on needs no leg ahead: it may have been struck before. Two that cross each other's way
    where four legs are told do. The road that a driveway meets goes on to both sides, and a stem lies where the text
    says. `faced`: also legs of vehicles whose heading follows from their turn and the sides that touched, and of
    vehicles that cross at a junction without a told number of legs.
    """
    junction, crash = facts.junction, facts.crash
    legs: list[Compass] = [junction.stem] if junction.stem and junction.stem_stated else []
    known = [v for v in crash.vehicles if v.heading_stated or (faced and _faced(v, crash))]
    driving = [v for v in known if v.heading and v.maneuver != "parked"]
    ways = [(v.heading, _meant(v)) for v in driving if v.heading and not (v.heading_stated and _joined(v, facts))]
    for heading, maneuver in ways:
        legs.append(turned(heading, 180))
        legs += [turned(heading, QUARTER_DEG[maneuver])] if maneuver in QUARTER_DEG else []
    if junction.kind in (DRIVEWAY, ALLEY):
        legs += [heading for heading in _along(driving, facts) if turned(heading, 180) in legs]
    if junction_kind(junction.kind).crossing and (junction.stated or faced):
        legs += _crossing(crash)
    return tuple(dict.fromkeys(legs))


def _crossing(crash: CrashFacts) -> list[Compass]:
    """Headings of the first two that touch, if both are told to go straight on and their ways cross squarely."""
    first = crash.contacts[0] if crash.contacts and crash.contacts[0].stated else None
    pair = [crash.vehicle(name) for name in (first.striker, first.struck)] if first else []
    found = ahead(v for v in pair if v)
    square = len(found) == 2 and between(found[0], found[1]) % 180 == 90
    return found if square else []


def ahead(vehicles: Iterable[VehicleFacts]) -> list[Compass]:
    """Headings of those that are told to go straight on, and which way."""
    sure = [v for v in vehicles if v.heading_stated and v.maneuver_stated and v.maneuver == "straight"]
    return [v.heading for v in sure if v.heading]


def turns_off(v: VehicleFacts) -> bool:
    """Whether the text tells that a vehicle turned or, standing or slowing, was about to."""
    return v.maneuver_stated and _meant(v) in QUARTER_DEG


def _along(driving: list[VehicleFacts], facts: RoadFacts) -> list[Compass]:
    """Headings of those that surely drive on a street, not on what joins it."""
    streets = {road.axis for road in facts.streets}
    beside = {name for road in facts.roads if road not in facts.streets for name in road.vehicles}
    known = [v for v in driving if v.heading and axis_of(v.heading) in streets and v.id not in beside]
    found = [v.heading for v in known if v.heading and v.origin not in OFF_ROAD]
    return found if len({axis_of(heading) for heading in found}) == 1 else []


def _faced(v: VehicleFacts, crash: CrashFacts) -> bool:
    """Whether the front of one that drove on met squarely the side of a vehicle that turned, all of it told."""
    first = crash.contacts[0] if crash.contacts else None
    by = crash.vehicle(first.striker) if first and first.struck == v.id and first.areas_stated else None
    if not (first and by and by.heading and v.heading and v.maneuver_stated and v.maneuver in QUARTER_DEG):
        return False
    square = (first.striker_area, first.struck_area) in (("front", "left"), ("front", "right"))
    if not square or not by.heading_stated or by.maneuver not in _ONWARD:
        return False
    return between(by.heading, v.heading) == contact_turn("front", first.struck_area)


def _meant(v: VehicleFacts) -> Maneuver:
    """The turn that a vehicle made or, standing or slowing, was about to make; else what it did."""
    if v.meant and v.maneuver in ("stopped", "slowing"):
        return v.meant
    return v.maneuver if v.maneuver_stated else "straight"


def _joined(v: VehicleFacts, facts: RoadFacts) -> bool:
    """Whether the heading of one that came from off the road may be that of the road which it joined."""
    streets = {road.axis for road in facts.streets}
    return v.origin in OFF_ROAD and v.heading is not None and axis_of(v.heading) in streets
