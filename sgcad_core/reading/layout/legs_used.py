"""The legs of a junction that the told paths of its vehicles use, and a layout that has them. Knows no road network
format."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from sgcad_core.kinds import ALLEY, DRIVEWAY, RAMP, junction_kind
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.inference.inference_state import QUARTER_DEG
from sgcad_core.reading.motion.motion_record import DRIVES
from sgcad_core.reading.motion.relative_headings import contact_turn
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import between, turned
from sgcad_core.records.specs import Compass, Leg, Maneuver, RoadLayout

_MOST_LEGS = 8
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


# ------------------------------------------------------------------ a layout that has them
def with_used_legs(facts: RoadFacts, layout: RoadLayout, told: Callable[[Compass], Leg | None]) -> RoadLayout:
    """The layout with a leg wherever the text has a vehicle come from or turn into: one that no vehicle uses is laid
    there, else one more is added. `told`: the leg of the street that the text tells at a bearing."""
    if len(layout.legs) < 3 or layout.accesses or facts.junction.kind == RAMP:
        return layout
    used, legs = legs_used(facts), list(layout.legs)
    came = {turned(v.heading, 180) for v in facts.crash.vehicles if v.heading}
    for bearing in used:
        if any(_near(leg.bearing, bearing) for leg in legs):
            continue
        spare = [leg for leg in legs if not any(_near(leg.bearing, one) for one in used)]
        apart = {leg.bearing: (leg.bearing in came, abs(between(leg.bearing, bearing) - 180)) for leg in spare}
        moved = min(spare, key=lambda leg: apart[leg.bearing], default=None)
        if moved and len(legs) == 3:
            legs[legs.index(moved)] = told(bearing) or moved.model_copy(update={"bearing": bearing, "skew_deg": 0})
        elif len(legs) < _MOST_LEGS:
            legs.append(told(bearing) or _facing(legs, bearing))
    for bearing in _behind(facts, legs):
        legs.append(told(bearing) or _facing(legs, bearing))
    return layout.model_copy(update={"legs": tuple(legs)})


def _behind(facts: RoadFacts, legs: list[Leg]) -> list[Compass]:
    """Bearings from which a vehicle comes that drives straight on into a driveway with no road opposite."""
    if facts.junction.kind not in (DRIVEWAY, ALLEY):
        return []
    ways = [v.heading for v in facts.crash.vehicles if v.heading and v.maneuver in _ONWARD and not v.origin]
    into = [way for way in ways if any(leg.bearing == way for leg in legs)]
    behind = [turned(way, 180) for way in into if not any(_near(leg.bearing, turned(way, 180)) for leg in legs)]
    return list(dict.fromkeys(behind))[: _MOST_LEGS - len(legs)]


def _near(one: Compass, other: Compass) -> bool:
    return between(one, other) in (0, 45, 315)


def _facing(legs: list[Leg], bearing: Compass) -> Leg:
    """A leg that goes on from the one opposite; without one a road with a lane each way."""
    opposite = next((leg for leg in legs if leg.bearing == turned(bearing, 180)), None)
    if opposite is None:
        return Leg(bearing=bearing, lanes_in=1, lanes_out=1)
    lanes = {"lanes_in": opposite.lanes_out, "lanes_out": opposite.lanes_in}
    return opposite.model_copy(update={"bearing": bearing, "turns_in": (), "curve": "none", **lanes})
