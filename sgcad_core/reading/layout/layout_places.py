"""What a story tells of places, put into a layout: edges of roads, crosswalks, roundabouts, skew and offset.

Knows no geometry and no file format.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

from sgcad_core.kinds import DRIVEWAY, FOUR_LEG, RAMP, T, junction_kind
from sgcad_core.reading.junctions.approach_lanes import Approach
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import between, turned
from sgcad_core.records.specs import Access, Compass, Leg, RoadLayout

OFFSET_M = 35.0
"""Between the two T junctions of an offset crossing: reports tell that it is offset, seldom by how much."""
MOST_AROUND = 2
"""Lanes of a roundabout; wider ones are rare and signed out by exits."""


def with_edges(facts: RoadFacts, layout: RoadLayout) -> RoadLayout:
    """The layout with what the story tells of its roads' edges."""
    return layout.model_copy(update={"legs": tuple(_edged(facts, leg, layout.legs) for leg in layout.legs)})


def _edged(facts: RoadFacts, leg: Leg, legs: tuple[Leg, ...]) -> Leg:
    """A road's leg with its edges; a crosswalk leads over all legs, on a plain road once."""
    if leg.kind != "road" or facts.junction.kind == RAMP:
        return leg
    walked = facts.crosswalk and (len(legs) > 2 or leg is legs[0])
    sides = (*facts.beside, "sidewalk") if facts.crosswalk else facts.beside
    return leg.model_copy(update={"beside": tuple(dict.fromkeys(sides)), "crosswalk": walked})


def with_approaches(facts: RoadFacts, layout: RoadLayout) -> RoadLayout:
    """The layout with the lanes that the story lists of single approaches to its junction."""
    if len(layout.legs) < 3 or facts.junction.kind not in (T, FOUR_LEG):
        return layout
    axes = Counter(axis_of(leg.bearing) for leg in layout.legs)
    stem = next((leg.bearing for leg in layout.legs if axes[axis_of(leg.bearing)] == 1), None)
    legs = tuple(_listed(leg, facts.approaches.of(leg.bearing, stem)) for leg in layout.legs)
    return layout.model_copy(update={"legs": legs})


def _listed(leg: Leg, told: Approach) -> Leg:
    if leg.kind != "road":
        return leg
    update: dict[str, Any] = {}
    if told.lanes_in and (leg.lanes_in or told.turns_in):
        update = {"lanes_in": told.lanes_in, "turns_in": told.turns_in}
    if told.lanes_out and (leg.lanes_out or told.turns_in):
        update["lanes_out"] = told.lanes_out
    return leg.model_copy(update=update)


def with_closed(facts: RoadFacts, layout: RoadLayout) -> RoadLayout:
    """The layout with the lanes that a work zone closes, beyond the middle of a plain road; one lane stays open."""
    closed = facts.closed
    ahead = next((leg for leg in layout.legs if closed and leg.bearing == closed.toward), None)
    if closed is None or ahead is None or len(layout.legs) != 2 or layout.accesses:
        return layout
    lanes = max(closed.count + 1, ahead.lanes_out)
    shut = range(1, closed.count + 1) if closed.side == "right" else range(lanes - closed.count + 1, lanes + 1)
    came = {"lanes_in": lanes}
    goes = {"lanes_out": lanes, "closed_out": tuple(shut)}
    return layout.model_copy(
        update={"legs": tuple(leg.model_copy(update=goes if leg is ahead else came) for leg in layout.legs)}
    )


def with_opening(facts: RoadFacts, layout: RoadLayout) -> RoadLayout:
    """The layout with an opening in its median; a road of which no median is told has a raised one."""
    two_way = all(leg.lanes_in and leg.lanes_out and leg.kind == "road" for leg in layout.legs)
    if facts.opening is None or len(layout.legs) != 2 or layout.accesses or not two_way:
        return layout
    parted = {"median": "raised", "center_turn_lane": False}
    legs = tuple(leg if leg.median != "none" else leg.model_copy(update=parted) for leg in layout.legs)
    return layout.model_copy(update={"legs": legs, "opening": True})


def parking_lot(facts: RoadFacts, axis: Compass) -> RoadLayout:
    """An aisle with stalls on both sides; two that cross where vehicles are told to come along both.

    A vehicle that is parked or backs out of a stall stands square to the aisle: its heading tells the axis of the aisle
    where no other vehicle drives along it.
    """
    told = [(v.maneuver, v.heading) for v in facts.crash.vehicles if v.heading and v.heading_stated]
    driven = [axis_of(heading) for maneuver, heading in told if maneuver not in ("parked", "backing")]
    stalled = [heading for stands in ("backing", "parked") for maneuver, heading in told if maneuver == stands]
    square = [axis_of(turned(heading, 90)) for heading in stalled]
    across = axis in map(axis_of, stalled) and axis not in driven
    first = [] if across else [axis]
    axes = tuple(dict.fromkeys([*first, *(driven or square[:1])]))[:2]
    ends = [end for way in axes for end in (turned(way, 180), way)]
    return RoadLayout(
        legs=tuple(Leg(bearing=end, lanes_in=1, lanes_out=1, kind=DRIVEWAY, beside=("parking",)) for end in ends)
    )


def circle_lanes(facts: RoadFacts, legs: tuple[Leg, ...]) -> int:
    """Lanes around, told or as many as the widest entry has; none but in a roundabout."""
    if not junction_kind(facts.junction.kind).round:
        return 0
    return facts.junction.circle_lanes or min(max(leg.lanes_in for leg in legs), MOST_AROUND)


def skewed(facts: RoadFacts, leg: Leg) -> Leg:
    """A leg of the crossing road as far off its bearing as the story tells."""
    return leg.model_copy(update={"skew_deg": facts.junction.skew_deg}) if leg.kind == "road" else leg


def offset(through: tuple[Leg, ...], near: Leg, far: Leg) -> RoadLayout:
    """Two T junctions in place of a crossing: the far leg of the cross road joins one leg of the through road."""
    on = through[0].bearing
    access = Access(
        leg=on, side="left" if between(on, far.bearing) == 90 else "right", distance_m=OFFSET_M, kind="road",
        lanes_in=far.lanes_in, lanes_out=far.lanes_out, control="none" if far.control == "flashing" else far.control,
    )  # fmt: skip
    return RoadLayout(legs=(*through, near), accesses=(access,))
