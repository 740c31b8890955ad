"""Paths, paces, routes and meetings, each by itself."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import overlap_centers
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.encounter.encounter_search import along_sides, find_meeting
from sgcad_core.planner.lines.actor_course import find_course
from sgcad_core.planner.lines.axle_to_box import bent_before, box_path
from sgcad_core.planner.lines.maneuver_course import course_of
from sgcad_core.planner.lines.path import TURN_BACK_M, bezier, draw, ramp, turned_back, widened_bends
from sgcad_core.planner.lines.route import find_route
from sgcad_core.planner.motion import ACCELERATION_MPS2, BRAKING_MPS2, Motion, Pace, drive
from sgcad_core.records.specs import Actor
from tests.sgcad_core.planner.crash_scenes import network

CAR = (4.7, 1.8)


def actor(maneuver: str, road: str, exit_road: str | None = None, **more: object) -> Actor:
    fields = {"id": "V1", "kind": "car", "road": road, "direction": "forward", "maneuver": maneuver}
    return Actor.model_validate(fields | {"exit_road": exit_road} | more)


def corner(radius: float = 8.0) -> np.ndarray:
    """A line east, a left quarter turn, and north."""
    sweep = np.linspace(0, math.pi / 2, 12)
    arc = np.column_stack((40 + radius * np.sin(sweep), radius - radius * np.cos(sweep)))
    return np.vstack(([[0.0, 0.0]], arc, [[40 + radius, 60.0]]))


# ------------------------------------------------------------------ path
@given(st.floats(0, 50), st.floats(1, 60))
def test_a_ramp_rises_once_from_0_to_1(start, length):
    s = np.linspace(-10, 150, 400)
    rise = ramp(s, start, length)
    assert rise[0] == 0
    assert rise[-1] == 1
    assert (np.diff(rise) >= -1e-12).all()


def test_a_drawn_path_has_no_heading_jumps():
    path = draw(corner(4.0))
    assert np.abs(np.diff(path.heading_rad)).max() < 0.2
    assert path.heading_rad[[0, -1]] == pytest.approx([0, math.pi / 2], abs=0.01)


@pytest.mark.parametrize("left", [9.0, -9.0, 3.4])
def test_a_line_moved_far_inside_a_bend_does_not_fold(left):
    moved = draw(corner(6.0)).moved(left)
    assert (np.abs(np.diff(moved.heading_rad)) < 1.0).all()


def test_stations_stay_when_a_line_is_moved():
    path = draw(corner())
    assert np.array_equal(path.moved(2.0).s_m, path.s_m)
    assert path.moved(2.0).poses([10.0])[0, :2] == pytest.approx([10, 2], abs=0.01)


def test_a_bezier_keeps_both_headings():
    arc = bezier(np.array([0.0, 0.0]), 0.0, np.array([10.0, 10.0]), math.pi / 2)
    first, last = arc[1] - arc[0], arc[-1] - arc[-2]
    assert math.atan2(first[1], first[0]) == pytest.approx(0, abs=0.1)
    assert math.atan2(last[1], last[0]) == pytest.approx(math.pi / 2, abs=0.1)


@pytest.mark.parametrize("gap", [0.0, 3.6, 8.0, 14.0])
def test_a_turn_back_ends_on_the_other_line_and_is_no_tighter_than_told(gap):
    arc = turned_back(np.zeros(2), 0.3, gap * np.array([-math.sin(0.3), math.cos(0.3)]))
    run = 30 * np.array([math.cos(0.3), math.sin(0.3)])
    path = draw(np.vstack((-run, arc, arc[-1] - run)))
    assert arc[-1] == pytest.approx(gap * np.array([-math.sin(0.3), math.cos(0.3)]), abs=0.01)
    assert path.heading_rad[-1] - path.heading_rad[0] == pytest.approx(math.pi, abs=0.01)
    assert np.abs(path.curvature).max() < 1.25 / TURN_BACK_M
    left = arc @ np.array([-math.sin(0.3), math.cos(0.3)])
    assert left.min() > -0.85, "it swings out of its lane to the right"


def test_bends_that_are_too_tight_are_widened_and_no_others() -> None:
    path = draw(corner(3.0))
    easier = widened_bends(path, 1 / 9)
    assert np.abs(path.curvature).max() > 1 / 8
    assert np.abs(easier.curvature).max() <= 1 / 9
    assert widened_bends(easier, 1 / 9) is easier


@pytest.mark.parametrize("length", [4.7, 9.0, 20.0])
def test_the_rear_axle_of_a_box_rolls_where_it_points(length):
    line = widened_bends(draw(corner(10.0)), 1 / 25)
    box = box_path(line, length)
    axle = box.points - 0.3 * length * np.column_stack((np.cos(box.heading_rad), np.sin(box.heading_rad)))
    way = np.diff(axle, axis=0)
    slip = np.arctan2(way[:, 1], way[:, 0]) - (box.heading_rad[1:] + box.heading_rad[:-1]) / 2
    assert np.degrees(np.abs(slip)).max() < 10


@settings(max_examples=30, deadline=None)
@given(st.floats(-2.5, 2.5), st.floats(6, 40))
def test_who_steers_aside_has_turned_by_the_angle_and_bends_no_tighter(angle, radius):
    line = draw(np.array([[0.0, 0.0], [200.0, 0.0]]))
    turned = bent_before(line, angle, 150.0, radius)
    assert turned.poses([150.0])[0, 2] == pytest.approx(angle, abs=0.02)
    assert np.abs(turned.curvature).max() <= 1.1 / radius
    assert turned.lengths[-1] == pytest.approx(line.lengths[-1], abs=0.01)


# ------------------------------------------------------------------ pace
@settings(max_examples=40, deadline=None)
@given(st.floats(5, 35), st.floats(-3.6, 3.6), st.floats(3, 40), st.sampled_from(["dry", "wet", "snow", "ice"]))
def test_speed_follows_the_curvature_of_the_driven_line(cruise, left, length, surface):
    base = draw(corner(9.0))
    line = base.moved(left * ramp(base.s_m, 10.0, length))
    pace = Pace(cruise, grip_mps2=DRIVING.friction_mps2(surface), hard=True)
    time, station = drive(line, pace, 20.0, (line, base))
    speed = np.diff(np.interp(station, line.s_m, line.lengths)) / np.diff(time)
    bend = np.interp((station[1:] + station[:-1]) / 2, line.s_m, np.abs(line.curvature))
    assert (speed**2 * bend)[speed > 1.2].max() < 0.7 * DRIVING.friction_mps2(surface)


def test_braking_goes_on_down_to_its_least_speed() -> None:
    path = draw(np.array([[0.0, 0.0], [200.0, 0.0]]))
    pace = Pace(20.0, slow_at_m=100.0, slow_mps=14.0, least_mps=8.0, brakes=True)
    time, station = drive(path, pace, 100.0)
    at = np.array([100.0, 100.0 + pace.slows_on_m / 2, 100.0 + pace.slows_on_m, 160.0])
    speed = np.diff(np.interp([at - 0.5, at + 0.5], station, time), axis=0)[0] ** -1.0
    assert speed == pytest.approx([14.0, math.sqrt((14.0**2 + 8.0**2) / 2), 8.0, 8.0], abs=0.3)


def test_what_stops_in_the_way_stands_there_from_then_on() -> None:
    path = draw(np.array([[0.0, 0.0], [200.0, 0.0]]))
    time, station = drive(path, Pace(10.0, stops_at_m=80.0), 80.0)
    assert np.interp([0.0, 3.0], time, station) == pytest.approx([80.0, 80.0], abs=0.01)
    assert np.interp(-4.0, time, station) < 80.0 - 4.0**2


@settings(max_examples=60, deadline=None)
@given(st.floats(3, 35), st.floats(2, 9), st.booleans())
def test_a_drive_keeps_limits_and_usual_accelerations(cruise, curve, from_stop):
    path = draw(corner())
    time, station = drive(path, Pace(cruise, curve, 20.0 if from_stop else None), 45.0)
    assert (np.diff(time) > 0).all()
    assert np.interp(45.0, station, time) == pytest.approx(0, abs=1e-6)
    t = np.arange(time[0], min(time[-1], 15.0), 0.05)
    speed = np.diff(np.interp(t, time, station)) / 0.05
    assert speed.max() <= cruise * 1.02 + 0.05
    gained = np.diff(speed)[5:] / 0.05
    smooth = np.convolve(gained, np.ones(20) / 20, "valid")
    assert smooth.max() <= ACCELERATION_MPS2 + 0.6
    assert smooth.min() >= -BRAKING_MPS2 - 0.6


def test_a_shift_of_lanes_across_a_junction_is_no_curve() -> None:
    line = draw(np.array([[-150.0, 0.0], [-9.0, 0.0], [9.0, 3.6], [150.0, 3.6]]), speed_mps=18.0)
    time, station = drive(line, Pace(18.0, 6.5), 0.0)
    speed = np.diff(station) / np.diff(time)
    assert speed[np.abs(station[1:] - 150.0) < 40].min() > 14.0


def test_a_standing_start_stands_before_it():
    path = draw(corner())
    time, station = drive(path, Pace(12.0, starts_at_m=20.0), 30.0)
    assert station[0] == 20.0
    assert np.interp(-50.0, time, station) == 20.0


# ------------------------------------------------------------------ routes and courses
def test_the_exit_road_decides_the_route():
    route = find_route(network("four_leg"), actor("turn_left", "S", "E"))
    assert [w.id for w in route.ways][:2] == ["S", "-E"]


def test_a_maneuver_without_exit_road_finds_its_turn():
    ways = {
        m: find_route(network("four_leg"), actor(m, "S")).ways[1].id for m in ("turn_left", "turn_right", "straight")
    }
    assert ways == {"turn_left": "-W", "turn_right": "-E", "straight": "-N"}


def test_the_way_over_a_joint_is_found():
    route = find_route(network("driveways_at_junction"), actor("turn_right", "S_outer", "E"))
    assert [w.id for w in route.ways][:3] == ["S_outer", "S", "-E"]
    assert route.turn == 1


def test_a_missing_direction_is_driven_the_wrong_way():
    course = find_course(network("four_leg"), actor("straight", "S", direction="backward"))
    assert course.path.heading_rad[400] == pytest.approx(-math.pi / 2, abs=0.01)


def test_a_course_is_as_wide_as_its_road():
    course = find_course(network("straight_wide"), actor("straight", "E", lane=1))
    assert course.opposite_m == pytest.approx(2 * course.lane_width_m, rel=0.1)
    assert course.right_edge_m == pytest.approx(course.lane_width_m / 2)
    assert course.left_edge_m > 3 * course.lane_width_m


def test_a_backing_course_runs_against_its_lane():
    course = find_course(network("straight"), actor("straight", "S"))
    back = course.reversed()
    assert back.path.poses([-30.0])[0, :2] == pytest.approx(course.path.poses([30.0])[0, :2])
    assert back.path.poses([-30.0])[0, 2] == pytest.approx(course.path.poses([30.0])[0, 2] + math.pi)


def test_an_actor_of_another_reading_keeps_its_course_where_it_stays_the_same():
    graph, same = network("four_leg"), actor("straight", "S", "N")
    course = course_of(graph, same, 3.0)
    assert course_of(graph, actor("straight", "S", "N"), 3.0) is course
    others = [course_of(graph, actor("turn_left", "S", "W"), 3.0), course_of(graph, same, 2.0)]
    assert course not in others


# ------------------------------------------------------------------ meetings
def straight_motion(start: tuple[float, float], heading: float, speed: float) -> Motion:
    way = np.array([math.cos(heading), math.sin(heading)])
    path = draw(np.array([np.array(start) - 60 * way, np.array(start) + 60 * way]))
    time, station = drive(path, Pace(speed), 60.0)
    return Motion(path, time, station, CAR, np.zeros(len(path.s_m)), 0.0)


def test_two_that_cross_meet_on_the_wanted_sides():
    east, north = straight_motion((0, 0), 0.0, 12.0), straight_motion((0, 0), math.pi / 2, 12.0)
    for wanted in (("front", "left"), ("right", "front")):
        found = find_meeting(east, north, wanted)
        assert found is not None
        assert found.sides == wanted
    assert find_meeting(east, north, ("left", "front")) is None


def along_the_flank(found) -> float:
    """How far ahead of its middle the first one, driving east, is met, in halves of its length."""
    one, two = found.first.poses([found.first_s]), found.second.poses([found.second_s])
    return float(overlap_centers(one, CAR, two, CAR)[0, 0] - one[0, 0]) / (CAR[0] / 2)


@pytest.mark.parametrize(("part", "low", "high"), [("front", 0.4, 1.0), ("back", -1.0, -0.4)])
def test_two_touch_at_the_told_part_of_a_flank(part, low, high):
    east, north = straight_motion((0, 0), 0.0, 12.0), straight_motion((0, 0), math.pi / 2, 12.0)
    found = find_meeting(east, north, ("right", "front"), parts=(part, None))
    assert low < along_the_flank(found) < high
    for one in along_sides(east, north, ("right", "front"), 5, (part, None)):
        assert np.sign(along_the_flank(one)) == np.sign(low + high)
    assert len({round(along_the_flank(one), 2) for one in along_sides(east, north, ("right", "front"), 5)}) == 5


def test_two_that_never_come_near_do_not_meet():
    assert find_meeting(straight_motion((0, 0), 0.0, 12.0), straight_motion((0, 30), 0.0, 12.0), None) is None


@pytest.mark.parametrize(
    "change", [{"size": (4.7, 2.4)}, {"standing": True}, {"time_s": 0.1}, {"station_m": 0.5}, {"path": 0.4}]
)
def test_a_motion_that_moves_otherwise_is_no_known_one(change):
    east, north = straight_motion((0, 0), 0.0, 12.0), straight_motion((0, 0), math.pi / 2, 12.0)
    first = find_meeting(east, north, None)
    assert find_meeting(straight_motion((0, 0), 0.0, 12.0), north, None).second_s == first.second_s
    ((field, by),) = change.items()
    old = getattr(east, field)
    changed = old.moved(by) if field == "path" else old + by if isinstance(old, np.ndarray) else by
    other = replace(east, **{field: changed})
    assert other.digest != east.digest
    found = find_meeting(other, north, None)
    assert (found and (found.first_s, found.second_s)) != (first.first_s, first.second_s)
