"""Long things run along the road: a vehicle that leaves it meets them at an angle and slides along."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from sgcad_core.geometry.plane import Box, contact_area, corners_of, overlap
from sgcad_core.planner.aftermath.rails import stands_on_road
from sgcad_core.planner.long_things import beside, corner_side, hand_of_side, is_long, meeting_angle, reach_m, turned_to
from sgcad_core.planner.plan import plan
from sgcad_core.records.course import CourseTold, RestTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from sgcad_core.roads.surface import road_surface
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_departures import CAR, roads

RAIL = Actor(
    id="O1", kind="object", road="S", direction="forward", maneuver="stopped", length_m=0.4, width_m=14.0, firm=True
)


@pytest.mark.parametrize(("size", "expected"), [
    ((0.4, 14.0), True), ((0.4, 0.4), False), ((5.0, 5.0), False), ((0.4, 3.0), False),
])  # fmt: skip
def test_a_long_thing_is_many_times_as_wide_as_deep(size, expected):
    assert is_long(size) is expected


@given(st.floats(-math.pi, math.pi))
def test_the_reach_of_a_box_is_that_of_its_farthest_corner(angle):
    corners = corners_of(np.zeros((1, 3)), (4.7, 1.8))[0]
    away = np.array([math.cos(angle), math.sin(angle)])
    assert float(reach_m((4.7, 1.8), np.array([angle]))[0]) == pytest.approx(float((corners @ away).max()))


@pytest.mark.parametrize(("side", "leaves", "expected"), [
    ("left", -1, (1,)), ("front", -1, (-1,)), ("front", 0, (-1, 1)), (None, 1, (1,)),
])  # fmt: skip
def test_it_lies_on_the_side_that_meets_it_or_where_the_road_is_left(side, leaves, expected):
    assert hand_of_side(side, leaves) == expected


@pytest.mark.parametrize("side", ["front", "left", "right"])
@pytest.mark.parametrize("way_deg", [0.0, 75.0, 200.0])
def test_the_box_meets_it_with_that_side(side, way_deg):
    pose, car, rail = np.array([3.0, -2.0, math.radians(way_deg)]), (4.7, 1.8), (0.4, 14.0)
    hand = hand_of_side(side, 1)[0]
    put = beside(pose, car, rail, float(pose[2]) + turned_to(hand, meeting_angle(side)), 0.03)
    boxes = Box.at(pose, car), Box.at(put, rail)
    assert overlap(*boxes)
    assert contact_area(*boxes) == side
    assert contact_area(*boxes[::-1]) == "front"


@given(way_deg=st.floats(-180, 180), away_deg=st.floats(-180, 180))
def test_the_side_is_that_on_which_the_box_touches_what_lies_there(way_deg, away_deg):
    size, rail = (4.7, 1.8), (0.4, 40.0)
    pose, away = np.array([3.0, -2.0, math.radians(way_deg)]), math.radians(away_deg)
    ahead, left = math.cos(away - pose[2]), math.sin(away - pose[2])
    assume(abs(abs(ahead) * size[0] - abs(left) * size[1]) > 0.2)
    put = beside(pose, size, rail, away + math.pi, 0.05)
    assert contact_area(Box.at(pose, size), Box.at(put, rail)) == corner_side(pose, size, away)


@pytest.mark.parametrize("departs", ["left", "right"])
@pytest.mark.parametrize("side", ["front", "left"])
def test_a_vehicle_that_leaves_the_road_slides_along_a_guardrail(departs, side):
    met = Contact(striker="V1", struck="O1", striker_area=side, struck_area="front")
    made = plan(
        BehaviorSpec(actors=(CAR, RAIL), contacts=(met,)), roads(median="grass"),
        courses={"V1": CourseTold(departs=departs)},
    )  # fmt: skip
    car, rail = made.trajectories
    assert made.realised
    assert made.contact is not None
    off_road = abs(math.remainder(rail.heading_rad[0], math.pi))
    assert off_road < math.radians(30), "it stands across the road"
    k = round(made.contact.t_s / 0.05)
    assert math.hypot(car.x_m[-1] - car.x_m[k], car.y_m[-1] - car.y_m[k]) > 4.0, "it stops dead"


@pytest.mark.parametrize("departs", ["left", "right"])
@pytest.mark.parametrize("side", ["front", "left", "right"])
def test_what_runs_along_the_road_stands_parallel_to_it_and_beside_its_lanes(departs, side):
    if side not in ("front", departs):
        pytest.skip("it lies on the other hand")
    met = Contact(striker="V1", struck="O1", striker_area=side, struck_area="front")
    graph = roads()
    made = plan(BehaviorSpec(actors=(CAR, RAIL), contacts=(met,)), graph, courses={"V1": CourseTold(departs=departs)})
    rail = made.trajectories[1].pose[:1]
    assert made.realised
    assert abs(math.remainder(float(rail[0, 2]), math.pi)) < math.radians(1.0)
    assert not stands_on_road(road_surface(graph), rail, (0.4, 14.0))[0]


@pytest.mark.parametrize("median", ["barrier", "raised", "grass"])
@pytest.mark.parametrize("lanes", [1, 2, 3])
def test_what_runs_along_the_median_stays_clear_of_the_lanes_beyond_it(median, lanes):
    met = Contact(striker="V1", struck="O1", striker_area="front", struck_area="front")
    graph = roads(median=median, lanes_in=lanes, lanes_out=lanes)
    made = plan(BehaviorSpec(actors=(CAR, RAIL), contacts=(met,)), graph, courses={"V1": CourseTold(departs="left")})
    assert made.realised
    assert not stands_on_road(road_surface(graph), made.trajectories[1].pose[:1], (0.4, 14.0))[0]


def test_a_vehicle_that_drifts_over_its_left_line_meets_a_curb_in_the_median():
    drifts = CAR.model_copy(update={"maneuver": "crossing_centerline"})
    curb = RAIL.model_copy(update={"length_m": 0.3, "width_m": 12.0, "firm": False, "flat": True})
    met = Contact(striker="V1", struck="O1", striker_area="front", struck_area="front")
    graph = roads(median="raised")
    made = plan(BehaviorSpec(actors=(drifts, curb), contacts=(met,)), graph, courses={"V1": CourseTold()})
    assert made.realised
    assert not stands_on_road(road_surface(graph), made.trajectories[1].pose[:1], (0.3, 12.0))[0]


def test_a_vehicle_that_leaves_the_road_on_a_side_rests_off_it_on_that_side():
    met = Contact(striker="V1", struck="O1", striker_area="front", struck_area="front")
    told = {"V1": CourseTold(departs="right", rest=RestTold(where="off_road"))}
    car = plan(BehaviorSpec(actors=(CAR, RAIL), contacts=(met,)), roads(), courses=told).trajectories[0]
    assert car.x_m[-1] > 1.75, "it rests on the road, or beyond it on the left"


def test_a_rail_that_is_struck_in_the_lanes_only_is_noted():
    rail = RAIL.model_copy(update={"road": "W"})
    rear, ahead = (
        Actor(id=name, kind="car", road="W", direction="forward", exit_road="E", maneuver="straight", speed_mph=mph)
        for name, mph in (("V1", 45), ("V2", 25))
    )
    contacts = (
        Contact(striker="V1", struck="V2", striker_area="front", struck_area="back"),
        Contact(striker="V2", struck="O1", striker_area="front", struck_area="front"),
    )
    graph = network("four_leg")
    made = plan(BehaviorSpec(actors=(rear, ahead, rail), contacts=contacts), graph)
    stands = stands_on_road(road_surface(graph), made.trajectories[2].pose[:1], (0.4, 14.0))[0]
    assert any("stands in the lanes" in note for note in made.notes) == stands


def test_a_piece_across_the_road_is_driven_over_in_the_lanes():
    piece = RAIL.model_copy(update={"firm": False, "loose": True, "length_m": 0.5, "width_m": 7.0})
    met = Contact(striker="V1", struck="O1", striker_area="front", struck_area="front")
    graph = roads()
    told = {"V1": CourseTold(rest=RestTold(where="shoulder", side="right"))}
    car, lying = plan(BehaviorSpec(actors=(CAR, piece), contacts=(met,)), graph, courses=told).trajectories
    assert road_surface(graph).off(lying.pose[:1, :2])[0][0] < 0.0
    assert abs(math.sin(float(lying.heading_rad[0]) - math.pi / 2)) < 0.2, "it does not lie across"
    assert car.y_m[-1] > lying.y_m[0] + 5.0
