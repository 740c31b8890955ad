"""Every sample of a motion has a place: its lane, the center turn lane, a junction, the wrong side, off the road."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import Maneuver
from sgcad_core.metrics.lane_places import Place, lane_heading, lane_steps
from sgcad_core.metrics.told_lanes import ToldLane, told_lane
from sgcad_core.metrics.untold_places import Untold, untold_places
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.layout import road_spec

LANE_M = 3.5


def drawn(*legs: dict[str, object]) -> LaneGraph:
    spec = road_spec(RoadLayout(legs=tuple(Leg.model_validate(leg) for leg in legs)))
    made = compile_network(plain_xml(spec), spec)
    assert made.net_xml, made.log
    return parse_net(made.net_xml)


def leg(bearing: str, lanes: int = 1, **more: object) -> dict[str, object]:
    return {"bearing": bearing, "lanes_in": lanes, "lanes_out": lanes, **more}


ROAD = drawn(leg("S", 2, beside=("shoulder",)), leg("N", 2, beside=("shoulder",)))
CENTER = drawn(*(leg(b, 1, center_turn_lane=True) for b in "SN"), leg("W"))
NORTH = math.pi / 2


def at(x_m: float, y_m: float = -100.0, heading_rad: float = NORTH) -> Floats:
    return np.array([[x_m, y_m, heading_rad]])


@pytest.mark.parametrize(("x_m", "heading_rad", "place", "lane"), [
    (0.5 * LANE_M, NORTH, "lane", "S_2"), (1.5 * LANE_M, NORTH, "lane", "S_1"),
    (-0.5 * LANE_M, NORTH, "opposing", "-S_2"), (-0.5 * LANE_M, -NORTH, "lane", "-S_2"),
    (2.0 * LANE_M + 1.0, NORTH, "beside", "S_0"), (9.0 * LANE_M, NORTH, "off", ""),
])  # fmt: skip
def test_a_place_is_told_by_lane_and_direction(x_m: float, heading_rad: float, place: Place, lane: str) -> None:
    steps = lane_steps(ROAD, at(x_m, heading_rad=heading_rad))
    assert (steps.places, steps.lanes) == ((place,), (lane,))


def test_behind_the_drawn_end_of_a_road_its_lanes_go_on_straight() -> None:
    assert lane_steps(ROAD, at(1.5 * LANE_M, -300.0)).places == ("beyond",)
    assert lane_steps(ROAD, at(-1.5 * LANE_M, -300.0)).places == ("opposing",)


def test_the_center_turn_lane_is_no_wrong_side_and_the_junction_has_no_sides() -> None:
    for heading in (NORTH, -NORTH):
        assert lane_steps(CENTER, at(0.0, heading_rad=heading)).places == ("center_lane",)
    assert lane_steps(CENTER, at(-2.0, 0.0, math.pi)).places == ("junction",)
    assert lane_steps(CENTER, at(0.0)).in_turn() == "center_lane S_1 0.1 s"


def test_the_direction_of_a_lane_is_known_on_it_only() -> None:
    assert lane_heading(ROAD, at(0.5 * LANE_M)[0]) == pytest.approx(NORTH)
    assert lane_heading(ROAD, at(-0.5 * LANE_M)[0]) is None


# ------------------------------------------------------------------ what is not told
TOLD = "V1 was traveling north. V2 was stopped ahead. The front of V1 struck the back of V2."


def judged(
    text: str, x_m: float, maneuver: Maneuver = "straight", kind: str = "car", lasts_s: float = 4.0
) -> list[Untold]:
    """V1 drives north for some seconds, x_m east of the middle of the road."""
    t = 0.05 * np.arange(round(lasts_s / 0.05))
    even = np.ones(len(t))
    motion = Trajectory(
        actor="V1", t_s=t, x_m=x_m * even, y_m=-150.0 + 15.0 * t, heading_rad=NORTH * even, speed_mps=15.0 * even
    )
    info = ActorInfo.model_validate({"id": "V1", "type": kind, "length_m": 4.7, "width_m": 1.8, "maneuver": maneuver})
    reading = read(text)
    return list(untold_places(ROAD, [motion], [info], reading.crash, reading.lost_control))


def test_the_wrong_side_and_the_roadside_are_counted_and_the_own_lanes_are_not() -> None:
    (wrong,) = judged(TOLD, -0.5 * LANE_M)
    assert (wrong.actor, wrong.place, wrong.seconds, wrong.starts) == ("V1", "opposing", 4.0, True)
    assert wrong.words() == "4.0 s on the wrong side of the road before its contact"
    assert [one.place for one in judged(TOLD, 9.0 * LANE_M)] == ["off"]
    assert judged(TOLD, 0.5 * LANE_M) == []


@pytest.mark.parametrize(("text", "maneuver"), [
    (TOLD, "crossing_centerline"), (TOLD, "overtaking"),
    (TOLD.replace("The front", "V1 lost control on the ice. The front"), "straight"),
])  # fmt: skip
def test_what_the_report_tells_is_not_counted(text: str, maneuver: Maneuver) -> None:
    assert judged(text, -0.5 * LANE_M, maneuver) == []


def test_a_swerve_is_told_of_the_last_seconds_only_and_bicycles_are_free() -> None:
    swerves = TOLD.replace("The front", "V1 steered left to avoid V2. The front")
    assert judged(swerves, -0.5 * LANE_M, lasts_s=4.0) == []
    assert [one.seconds for one in judged(swerves, -0.5 * LANE_M, lasts_s=6.0)] == [2.5]
    assert judged(TOLD, -0.5 * LANE_M, kind="bicycle") == []


# ------------------------------------------------------------------ told lanes
@pytest.mark.parametrize(("told", "x_m", "taken"), [
    (ToldLane(1, None), 1.5, True), (ToldLane(1, None), 0.5, False), (ToldLane(-1, None), 0.5, True),
    (ToldLane(None, "left"), 0.5, True), (ToldLane(None, "left"), 1.5, False), (ToldLane(None, "right"), 1.5, True),
    (ToldLane(None, "left", side=1), 1.5, True), (ToldLane(None, "left", side=1), 0.5, False),
    (ToldLane(None, "left_turn"), 0.5, True), (ToldLane(None, "left_turn"), 1.5, False),
    (ToldLane(None, "center_turn"), 0.5, False),
])  # fmt: skip
def test_a_told_lane_is_taken_where_the_motion_starts_in_it(told: ToldLane, x_m: float, taken: bool) -> None:
    assert told.taken(ROAD, lane_steps(ROAD, at(x_m * LANE_M))) is taken


def test_the_center_turn_lane_is_taken_in_it_only() -> None:
    assert ToldLane(None, "center_turn").taken(CENTER, lane_steps(CENTER, at(0.0)))
    assert ToldLane(None, "left_turn").taken(CENTER, lane_steps(CENTER, at(0.0)))
    assert not ToldLane(None, "right").taken(CENTER, lane_steps(CENTER, at(0.0)))


def test_one_departs_from_the_only_lane_of_a_direction() -> None:
    narrow = drawn(leg("S"), leg("N"))
    assert ToldLane(1, None, side=-1).taken(narrow, lane_steps(narrow, at(0.5 * LANE_M)))


def test_a_lane_that_a_change_cannot_leave_on_its_side_is_the_one_it_leads_into() -> None:
    vehicle = read("V1 was traveling north in the right lane and changed lanes to the left into V2.").crash.vehicles[0]
    assert told_lane(vehicle) == ToldLane(None, "right")
    into = replace(vehicle, lane_word="left")
    assert told_lane(into) == ToldLane(None, "left", side=1)
    assert told_lane(replace(into, lane=-1, lane_word=None)) == ToldLane(-1, None, side=1)
    assert told_lane(replace(into, maneuver="straight")) == ToldLane(None, "left")
