"""Road facts completed to a layout: every lane, leg and control that the text leaves open gets a default.

Legs lie at bearings from the hub; traffic that heads north comes in on leg S and leaves on leg N. Knows no
geometry and no file format.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from sgcad_core.kinds import ALLEY, DRIVEWAY, PARKING_LOT, RAMP, T
from sgcad_core.reading.junctions.junction import JunctionFacts
from sgcad_core.reading.layout.answered_layout import answered_layout
from sgcad_core.reading.layout.joining_roads import across_drive, drive_heading, ramp_alone, stem_drawn
from sgcad_core.reading.layout.lanes_used import lanes_added, least_lanes, with_told_lanes
from sgcad_core.reading.layout.layout_places import (
    circle_lanes,
    offset,
    parking_lot,
    skewed,
    with_approaches,
    with_closed,
    with_edges,
    with_opening,
)
from sgcad_core.reading.layout.leg_parts import curve_of, kind_of, median_of, usual_limit
from sgcad_core.reading.layout.legs_used import with_used_legs
from sgcad_core.reading.layout.parted_roads import with_parted_roads
from sgcad_core.reading.motion.motion_record import DRIVES
from sgcad_core.reading.roads.carriageway import Carriageway, DirectionLanes, carriageway
from sgcad_core.reading.roads.lanes import LaneFacts
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import between, turned
from sgcad_core.records.specs import Compass, Leg, RoadLayout, Turn

_RIGHT: tuple[Turn, ...] = ("right",)
_THROUGH: tuple[Turn, ...] = ("through",)
_LEFT: tuple[Turn, ...] = ("left",)


@dataclass(frozen=True)
class Defaults:
    """What a layout takes where the text says nothing."""

    lanes_each_way: int = 1
    speed_limit_mph: int | None = None


def layout_of_facts(
    facts: RoadFacts,
    defaults: Defaults | None = None,
    *,
    as_counted: bool = False,
    laid: Callable[[RoadLayout], RoadLayout] | None = None,
) -> RoadLayout:
    """The layout that carries the facts and every vehicle's path. Never fails.

    `as_counted`: without the lanes that roads get beside those that the text counts. `laid`: makes another layout of
    that of the text, such as one on the legs of a real junction, before roads get these lanes.

    A driveway that a vehicle uses is a leg of the hub; beside a named junction driveways are left out.
    """
    return _Builder(with_parted_roads(facts), defaults or Defaults()).layout(as_counted, laid)


def lane_notes(facts: RoadFacts) -> tuple[str, ...]:
    """Notes on lanes that the roads of a layout get for its vehicles, beside those that are told or usual."""
    return _Builder(with_parted_roads(facts), Defaults()).added()


@dataclass(frozen=True)
class _Builder:
    facts: RoadFacts
    defaults: Defaults

    def layout(self, as_counted: bool, laid: Callable[[RoadLayout], RoadLayout] | None = None) -> RoadLayout:
        """The whole layout, places and answered values laid over the roads."""
        used = with_used_legs(self.facts, self._roads_alone(), self._told_leg)
        roads = answered_layout(self.facts, with_approaches(self.facts, used))
        roads = laid(roads) if laid else roads
        roads = roads if as_counted else with_told_lanes(self.facts, roads)
        return with_opening(self.facts, with_closed(self.facts, with_edges(self.facts, roads)))

    def added(self) -> tuple[str, ...]:
        """Notes on lanes that the roads get beside those told or usual, since vehicles are told to use them."""
        used = with_used_legs(self.facts, self._roads_alone(), self._told_leg)
        return lanes_added(self.facts, answered_layout(self.facts, with_approaches(self.facts, used)))

    def _roads_alone(self) -> RoadLayout:
        main, cross = self._two_roads()
        junction = self.facts.junction
        if junction.kind in ("none", RAMP) and (ramp := ramp_alone(self.facts)):
            return RoadLayout(legs=ramp)
        if junction.kind == "none":
            return RoadLayout(legs=self._plain(main))
        if junction.kind == PARKING_LOT:
            return parking_lot(self.facts, main.axis or "N")
        if junction.kind == RAMP:
            return RoadLayout(legs=self._merge(main))
        if junction.kind in (DRIVEWAY, ALLEY):
            return RoadLayout(legs=self._with_driveway(main))
        stem = self._stem(main) if junction.kind == T else None
        if stem and axis_of(stem) == main.axis and cross.axis != main.axis:
            main, cross = cross, main
        crossing = tuple(skewed(self.facts, leg) for leg in self._crossing(cross, main, stem))
        if junction.offset and len(crossing) == 2:
            return offset(self._through(main, crossing[0].bearing), *crossing)
        legs = self._through(main, stem) + crossing
        return RoadLayout(legs=legs, circle_lanes=circle_lanes(self.facts, legs))

    # -------------------------------------------------------------- roads
    def _two_roads(self) -> tuple[RoadFact, RoadFact]:
        """The main road and the one that crosses it, told or made up at a right angle."""
        streets = [r for r in self.facts.streets if r.axis]
        main = self._main(streets) if streets else RoadFact(self._lead_axis(), "road", LaneFacts(), ())
        main = across_drive(main, streets, drive_heading(self.facts))
        axis = main.axis or "N"
        others = [r for r in streets if r.axis != axis]
        cross = next((r for r in others if r.vehicles), others[0] if others else None)
        made_up = RoadFact(axis_of(turned(axis, 90)), "road", LaneFacts(), (), cross=True)
        return main, cross or made_up

    def _main(self, streets: list[RoadFact]) -> RoadFact:
        """The first road told; beside a ramp the road that the ramp joins."""
        if self.facts.junction.kind != RAMP:
            return streets[0]
        ramp = {v for r in self.facts.roads if r.kind == RAMP for v in r.vehicles}
        joined = [r for r in streets if r.cross] + [r for r in streets if set(r.vehicles) - ramp]
        return joined[0] if joined else streets[0]

    def _lead_axis(self) -> Compass:
        vehicles = self.facts.crash.vehicles
        driving = [v.heading for v in vehicles if v.heading and v.origin not in DRIVES]
        return axis_of(driving[0] if driving else "N")

    def _carriageway(self, road: RoadFact) -> Carriageway:
        axis = road.axis or "N"
        along = [v for v in self.facts.crash.vehicles if v.heading and axis_of(v.heading) == axis]
        lead = along[0].heading if along and along[0].heading else axis
        used: dict[Compass, int] = {}
        for v in along:
            if v.heading and v.origin not in DRIVES:
                used[v.heading] = max(used.get(v.heading, 1), least_lanes(v, self.facts.crash))
        default = 2 if road.lanes.divided else self.facts.junction.circle_lanes or 1
        numbered = any(v.lane for v in self.facts.crash.vehicles if v in along or v.id in road.vehicles)
        default = max(default, self.defaults.lanes_each_way)
        both = len({v.heading for v in along if v.heading_stated and v.maneuver != "parked"}) > 1
        return carriageway(road.lanes, axis, lead, used, default, numbered=numbered, against=both)

    # -------------------------------------------------------------- legs
    def _plain(self, road: RoadFact) -> tuple[Leg, ...]:
        axis = road.axis or "N"
        lanes = self._carriageway(road)
        ends = (turned(axis, 180), axis)
        return tuple(_plain_leg(self._leg(road, lanes, end, at_junction=False), lanes, end, ends) for end in ends)

    def _through(self, road: RoadFact, stem: Compass | None) -> tuple[Leg, ...]:
        axis = road.axis or "N"
        ends = (turned(axis, 180), axis)
        return tuple(self._leg(road, self._on_leg(road, end), end, far=stem is not None) for end in ends)

    def _on_leg(self, road: RoadFact, end: Compass) -> Carriageway:
        return self._carriageway(replace(road, lanes=road.lanes.on_leg(end)))

    def _crossing(self, road: RoadFact, main: RoadFact, stem: Compass | None) -> tuple[Leg, ...]:
        axis = road.axis or "N"
        if stem is None:
            return tuple(self._leg(road, self._on_leg(road, end), end) for end in (turned(axis, 180), axis))
        at = stem if axis_of(stem) != main.axis else turned(main.axis or "N", 90)
        there = road if axis_of(at) == axis else RoadFact(axis_of(at), road.kind, road.lanes, road.vehicles)
        return (self._leg(road, self._carriageway(there), at),)

    def _with_driveway(self, main: RoadFact) -> tuple[Leg, ...]:
        stem = self._stem(main)
        control, alley = self._leg_control(stem), self.facts.junction.kind == ALLEY
        drive = Leg(bearing=stem, lanes_in=1, lanes_out=1, kind=DRIVEWAY, control=control, alley=alley)
        return (*self._through(main, stem), drive)

    def _merge(self, main: RoadFact) -> tuple[Leg, ...]:
        """A one-lane ramp that joins from behind on the right, or where its vehicle comes from, or leaves ahead."""
        flow = self._main_flow(main)
        ramp = next((r for r in self.facts.roads if r.kind == RAMP), None)
        count = (ramp.lanes.total or 1) if ramp else 1
        if self.facts.leaves:
            off = Leg(bearing=turned(flow, 45), lanes_in=0, lanes_out=count, kind=RAMP)
            return (*self._through(main, off.bearing), off)
        at = self.facts.junction.stem
        if at is None or axis_of(at) == main.axis or between(flow, at) not in (135, 225):
            at = turned(flow, 135)
        legs = tuple(self._widened(leg, main, flow) for leg in self._through(main, at))
        return (*legs, Leg(bearing=at, lanes_in=count, lanes_out=0, kind=RAMP, control=self._leg_control(at)))

    def _widened(self, leg: Leg, main: RoadFact, flow: Compass) -> Leg:
        """Behind the merge the road has the merging lane, told or left over by its total."""
        lanes = self._carriageway(main)
        spare = (lanes.total or 0) - sum(way.approach for way in lanes.ways.values())
        widens = leg.bearing == flow and (spare == 1 or self.facts.merge_lane)
        return leg.model_copy(update={"lanes_out": min(leg.lanes_out + 1, 8)}) if widens else leg

    def _main_flow(self, main: RoadFact) -> Compass:
        """The direction of the traffic that the ramp joins."""
        axis = main.axis or "N"
        here = [v for v in self.facts.crash.vehicles if v.heading and axis_of(v.heading) == axis]
        straight = [v for v in here if v.origin != RAMP] or here
        return straight[0].heading if straight and straight[0].heading else axis

    def _stem(self, main: RoadFact) -> Compass:
        """The side leg's bearing, never on the main road unless the story's cross road lies there."""
        comes, stem = drive_heading(self.facts), stem_drawn(self.facts, self._main_flow(main))
        if comes and axis_of(stem) == main.axis != axis_of(comes):
            return turned(comes, 180)
        if axis_of(stem) == main.axis and self.facts.junction.kind != T:
            return turned(self._main_flow(main), 90)
        return stem

    def _leg(
        self, road: RoadFact, lanes: Carriageway, bearing: Compass, far: bool = False, at_junction: bool = True
    ) -> Leg:
        """One leg. Towards the hub its turn lanes count; `far`: a T, where no turn lanes face the other way."""
        inward = turned(bearing, 180)
        coming, going = lanes.way(inward), lanes.way(bearing)
        lanes_in, lanes_out = coming.approach, going.through
        if lanes.stated and lanes.total and lanes_in and lanes_out and not far:
            lanes_in = max(lanes_in, _facing(lanes, coming, going))
        return Leg(
            bearing=bearing, lanes_in=lanes_in, lanes_out=lanes_out,
            turns_in=_turns(coming, lanes_in) if at_junction else (),
            center_turn_lane=lanes.center_turn_lane and bool(lanes_in and lanes_out),
            median=median_of(road, lanes_in, lanes_out), kind=kind_of(road), alley=road.kind == ALLEY,
            curve=curve_of(road, inward),
            control=self._leg_control(bearing) if at_junction and lanes_in else "none",
            speed_limit_mph=road.speed_limit_mph or usual_limit(road) or self.defaults.speed_limit_mph,
        )  # fmt: skip

    def _told_leg(self, bearing: Compass) -> Leg | None:
        """A leg of the street that is told to lie on that axis; None where none is."""
        road = next((r for r in self.facts.streets if r.axis == axis_of(bearing)), None)
        return self._leg(road, self._carriageway(road), bearing) if road else None

    def _leg_control(self, bearing: Compass) -> Literal["none", "signal", "flashing", "stop", "yield"]:
        junction = self.facts.junction
        if junction.control == "all_way_stop":
            return "stop"
        if junction.control in ("signal", "flashing"):
            return junction.control
        if junction.control in ("stop", "yield") and bearing in self._stopped(junction):
            return junction.control
        return "none"

    def _stopped(self, junction: JunctionFacts) -> tuple[Compass, ...]:
        """Legs under a sign: as told, else the stem, else the crossing road."""
        if junction.stopped:
            return junction.stopped
        if junction.stem:
            return (junction.stem,)
        _, cross = self._two_roads()
        axis = cross.axis or "E"
        return axis, turned(axis, 180)


def _plain_leg(leg: Leg, lanes: Carriageway, bearing: Compass, ends: tuple[Compass, Compass]) -> Leg:
    """On a plain road what comes in goes out: an odd total has its wider side in the lead's direction."""
    here, ahead = lanes.way(turned(bearing, 180)), lanes.way(bearing)
    inward, outward = here.approach, ahead.approach
    if lanes.total and lanes.total % 2 and inward + outward == lanes.total + 1 and not lanes.center_turn_lane:
        inward, outward = (inward, outward - 1) if bearing == ends[0] else (inward - 1, outward)
    return leg.model_copy(update={"lanes_in": inward, "lanes_out": outward})


def _facing(lanes: Carriageway, coming: DirectionLanes, going: DirectionLanes) -> int:
    """Lanes towards the hub on the leg that faces a leg with a left-turn lane: the road keeps its total.

    Where both directions have left-turn lanes, each leg has its own and the total counts both.
    """
    facing = going.left_turn and not coming.left_turn
    return (lanes.total or 0) - going.through if facing else 0


def _turns(way: DirectionLanes, lanes_in: int) -> tuple[Turn, ...]:
    """Lane uses from the right curb where turn lanes are known; the links fill what no exit serves."""
    left, right = way.left_turn, way.right_turn
    middle = way.approach - left - right
    if not (left or right) or middle < 1 or lanes_in != way.approach:
        return ()
    uses: list[Turn] = [*_RIGHT * right, *_THROUGH * middle, *_LEFT * left]
    if not right:
        uses[0] = "through_right"
    if not left:
        uses[-1] = "left_through"
    return tuple(uses)
