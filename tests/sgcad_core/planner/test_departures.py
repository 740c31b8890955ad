"""The side on which a road is left, how far beside the lane that is, and what is struck there."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.encounter.meeting_place import Place
from sgcad_core.planner.lines.actor_course import find_course
from sgcad_core.planner.lines.departures import aside_m, departs, departure_sides, in_a_mouth, on_the_road, side_of
from sgcad_core.planner.lines.told_moves import with_room
from sgcad_core.planner.plan import plan
from sgcad_core.records.course import CourseTold, RestTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Leg, RoadLayout
from sgcad_core.roads.layout import road_spec
from sgcad_core.units import MPS_PER_MPH
from tests.sgcad_core.planner.crash_scenes import network


def roads(bend=("none", "none"), **leg):
    """A road with one lane each way; `bend`: as one drives in from the south and from the north."""
    legs = tuple(
        Leg.model_validate({"bearing": b, "lanes_in": 1, "lanes_out": 1, "curve": c} | leg)
        for b, c in zip("SN", bend, strict=True)
    )
    spec = road_spec(RoadLayout(legs=legs))
    return parse_net(compile_network(plain_xml(spec), spec).net_xml or "")


CAR = Actor(id="V1", kind="car", road="S", direction="forward", exit_road="N", maneuver="straight")
TREE = Actor(id="O1", kind="object", road="S", direction="forward", maneuver="stopped")
ALONE = BehaviorSpec(actors=(CAR,), contacts=())
HITS_TREE = BehaviorSpec(
    actors=(CAR, TREE), contacts=(Contact(striker="V1", struck="O1", striker_area="front", struck_area="front"),)
)


def sides(graph, told):
    line = find_course(graph, CAR)
    return departure_sides(line, (line.start_m + line.end_m) / 2, told)


@pytest.mark.parametrize(("told", "expected"), [
    ("left", (1,)), ("right", (-1,)), ("E", (-1,)), ("NW", (1,)), ("N", (-1, 1)), ("either", (-1, 1)),
])  # fmt: skip
def test_hands_and_compass_words_are_sides_of_the_way(told, expected):
    assert sides(roads(), told) == expected


@pytest.mark.parametrize(("bend", "first"), [(("right", "left"), 1), (("left", "right"), -1)])
def test_a_bend_is_left_on_its_outside(bend, first):
    assert sides(roads(bend), "either")[0] == first


def test_the_way_off_to_the_left_ends_in_the_median_where_there_is_one():
    plain, divided = find_course(roads(), CAR), find_course(roads(median="grass"), CAR)
    assert aside_m(plain, 1) > plain.left_edge_m
    assert divided.own_left_m < aside_m(divided, 1) < divided.left_edge_m
    assert aside_m(divided, -1) < -divided.right_edge_m
    assert not on_the_road(divided, np.array([aside_m(divided, 1), aside_m(divided, -1)])).any()
    assert on_the_road(divided, np.array([0.0])).all()


def test_a_center_turn_lane_is_no_median():
    line = find_course(roads(center_turn_lane=True), CAR)
    assert line.median_m < 0.5
    assert aside_m(line, 1) > line.left_edge_m


def test_the_lines_between_two_directions_are_on_the_road():
    line = find_course(roads(), CAR)
    between = line.own_left_m + line.median_m / 2
    assert 0.0 < line.median_m < 0.6
    assert on_the_road(line, np.array([between])).all()


def test_a_barrier_is_met_beyond_the_road_even_where_a_rest_on_the_other_side_is_told():
    far = RestTold(where="off_road", side="right", facing_deg=180.0)
    wall = TREE.model_copy(update={"length_m": 0.6, "width_m": 14.0, "firm": True})
    leaving = CAR.model_copy(update={"maneuver": "departing_road_left"})
    crash = HITS_TREE.model_copy(update={"actors": (leaving, wall)})
    told = {"V1": CourseTold(departs="left", spin="clockwise", rest=far)}
    graph = roads(lanes_in=2, lanes_out=2)
    found = plan(crash, graph, courses=told)
    assert found.contact is not None
    at = next(t for t in found.trajectories if t.actor == "V1")
    x = at.x_m[round(found.contact.t_s / 0.05)]
    line = find_course(graph, leaving)
    assert float(line.path.poses([line.start_m])[0, 0]) - x > line.left_edge_m


def test_what_is_told_last_counts_before_the_maneuver():
    assert side_of("departing_road_right", None) == "right"
    assert side_of("departing_road_right", "left") == "left"
    assert side_of("straight", None) is None
    assert not departs("stopped", "left")
    assert departs("straight", "left")


@pytest.mark.parametrize(("told", "way"), [("right", 1), ("left", -1)])
def test_the_thing_that_is_struck_stands_beside_the_road(told, way):
    made = plan(HITS_TREE, roads(), courses={"V1": CourseTold(departs=told)})
    assert made.realised
    tree = next(t for t in made.trajectories if t.actor == "O1")
    assert way * float(tree.x_m[0]) > 3.6
    assert made.oddity < 0.4


def test_without_a_contact_the_road_is_left_before_the_vehicle_rolls_over():
    told = CourseTold(departs="right", rolls=True)
    (car,) = plan(ALONE, roads(), courses={"V1": told}).trajectories
    rolled = np.abs(car.rolls) > math.radians(45)
    assert rolled[-1]
    assert float(car.x_m[int(rolled.argmax())]) > 3.6
    (kept,) = plan(ALONE, roads(), courses={"V1": replace(told, departs=None)}).trajectories
    assert float(kept.x_m.max()) < 3.6


@settings(max_examples=40, deadline=None)
@given(st.sampled_from([("tee", "W"), ("four_leg", "S"), ("tee_wide", "S")]), st.floats(-60, 60), st.floats(-9, 9))
def test_beside_the_road_at_a_junction_is_the_mouth_of_another_road(where, ahead_m, left_m):
    layout, road = where
    course = find_course(network(layout), CAR.model_copy(update={"road": road, "exit_road": None}))
    crossed = next(p for p in course.passages if p.is_junction)
    station = (crossed.entry_m + crossed.exit_m) / 2 + ahead_m
    found = bool(in_a_mouth(course, np.array([station]), np.array([left_m]))[0])
    off_m = max(left_m - course.left_edge_m, -left_m - course.right_edge_m)
    if off_m < -0.01:
        assert not found, "on the road"
    elif off_m > 0.01:
        assert found == (crossed.entry_m - 2.0 < station < crossed.exit_m + 2.0)


@pytest.mark.parametrize("surface", ["dry", "wet", "snow", "ice"])
@pytest.mark.parametrize("mph", [35, 55])
def test_a_told_speed_is_driven_off_the_road_whatever_the_surface(surface, mph):
    car = CAR.model_copy(update={"speed_mph": mph})
    spec = HITS_TREE.model_copy(update={"actors": (car, TREE), "surface": surface})
    made = plan(spec, roads(), courses={"V1": CourseTold(departs="right")})
    assert made.realised
    (driven,) = (t for t in made.trajectories if t.actor == "V1")
    times, x, y = (np.array(v) for v in (driven.t_s, driven.x_m, driven.y_m))
    before = times[1:] <= made.contact.t_s
    speed = (np.hypot(np.diff(x), np.diff(y)) / np.diff(times))[before]
    assert np.abs(speed - mph * MPS_PER_MPH).min() < 0.05 * mph * MPS_PER_MPH
    assert float(x[1:][before][-1]) > 3.6


def test_a_road_that_is_long_enough_or_dry_keeps_the_place_of_the_departure():
    place, told = Place(100.0, 0.0, 0.0, 0.0), CourseTold(departs="right")
    role = Role(CAR, find_course(roads(), CAR), (4.5, 1.8), place, told=told)
    assert with_room(role) is role
    icy = replace(role, surface="ice", actor=CAR.model_copy(update={"speed_mph": 55}))
    assert with_room(icy).place.station_m > 100.0
    assert with_room(replace(icy, place=role.place._replace(station_m=300.0))).place.station_m == 300.0


@pytest.mark.parametrize("firm", [True, False])
def test_a_vehicle_that_rolls_over_goes_on_past_what_it_struck(firm):
    tree = TREE.model_copy(update={"firm": firm})
    told = CourseTold(departs="right", rolls=True, roll_quarters=4)
    made = plan(replace_thing(HITS_TREE, tree), roads(), courses={"V1": told})
    car = made.trajectories[0]
    assert made.realised
    assert made.contact is not None
    k = round(made.contact.t_s / 0.05)
    least_m = 4.0 if firm else 10.0  # glancing off what is firm takes about half of its speed
    assert math.hypot(car.x_m[-1] - car.x_m[k], car.y_m[-1] - car.y_m[k]) > least_m, "it stops dead"


def replace_thing(behavior, thing):
    """The behavior with another thing that is struck."""
    return behavior.model_copy(update={"actors": (behavior.actors[0], thing)})


@pytest.mark.parametrize("beyond", [True, False])
@pytest.mark.parametrize("behavior", [HITS_TREE, ALONE])
def test_one_that_passes_a_junction_first_leaves_the_road_behind_it(behavior, beyond):
    told = CourseTold(departs="right", rolls=True, beyond=beyond)
    made = plan(behavior, network("four_leg"), courses={"V1": told})
    car = next(t for t in made.trajectories if t.actor == "V1")
    line = find_course(network("four_leg"), CAR)
    off = np.flatnonzero(car.x_m > 2 * line.lane_width_m)
    assert (car.y_m[off[0]] > 10.0) == beyond
    assert car.y_m[0] < -10.0


@pytest.mark.parametrize("behavior", [HITS_TREE, ALONE])
def test_one_whose_road_ends_at_a_junction_goes_on_straight_over_it(behavior):
    ahead = behavior.model_copy(update={
        "actors": tuple(a.model_copy(update={"exit_road": None}) for a in behavior.actors),
    })  # fmt: skip
    graph = network("tee")
    told = {} if behavior.contacts else {"V1": CourseTold(departs="N", rolls=True)}
    made = plan(ahead, graph, courses=told)
    car = next(t for t in made.trajectories if t.actor == "V1")
    line = find_course(graph, ahead.actors[0])
    assert line.turn is not None
    assert car.y_m[0] < -15.0 < 8.0 < car.y_m[-1], "it stays before the junction"
    assert abs(car.x_m[-1] - car.x_m[0]) < 10.0


def test_a_vehicle_that_comes_to_rest_at_what_it_struck_does_so() -> None:
    off = {"V1": CourseTold(departs="right", rest=RestTold(against="tree"))}
    actors = (CAR.model_copy(update={"maneuver": "departing_road_right"}), TREE.model_copy(update={"firm": True}))
    made = plan(HITS_TREE.model_copy(update={"actors": actors}), roads(), courses=off)
    car, tree = made.trajectories
    assert made.realised
    assert math.dist(car.pose[-1, :2], tree.pose[-1, :2]) < 4.7 / 2 + 0.3 + 1.5
    assert not [note for note in made.notes if "come to rest at" in note]


def test_beside_the_road_a_vehicle_gets_slower_and_never_speeds_up() -> None:
    off = {"V1": CourseTold(departs="left")}
    actors = (CAR.model_copy(update={"maneuver": "departing_road_left"}), TREE)
    graph = roads(("left", "right"))
    made = plan(HITS_TREE.model_copy(update={"actors": actors}), graph, courses=off)
    car = made.trajectories[0]
    hit = round(made.contact.t_s / 0.05)
    speed = np.hypot(*np.diff(car.pose[:hit, :2], axis=0).T) / 0.05
    slowest = np.minimum.accumulate(speed)
    assert (speed - slowest).max() < 0.3, "the box swings a little about its rear axle"
    assert speed[-1] < speed[0] - 0.5
