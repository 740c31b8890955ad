"""Paths, paces, impacts, routes and meetings, each by itself."""

from __future__ import annotations

import math

import numpy as np
import pytest
from crash_scenes import network
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.planner.course import find_course
from sgcad_core.planner.encounter import meet
from sgcad_core.planner.ground import Drag, slow
from sgcad_core.planner.impact import MASS_KG, Body, body, collide, mass_kg
from sgcad_core.planner.motion import ACCELERATION_MPS2, BRAKING_MPS2, Motion, Pace, drive
from sgcad_core.planner.path import bezier, draw, ramp
from sgcad_core.planner.route import find_route
from sgcad_core.specs import Actor

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


# ------------------------------------------------------------------ pace
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


# ------------------------------------------------------------------ impact
pose = st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-3, 3))
velocity = st.tuples(st.floats(-20, 20), st.floats(-20, 20))
mass = st.floats(80, 15000)


def moving(where: tuple[float, float, float], way: tuple[float, float], mass_kg: float, spin: float = 0.0) -> Body:
    made = body(where, CAR, mass_kg)
    made.vx, made.vy, made.spin = *way, spin
    return made


def momentum(*bodies: Body) -> tuple[float, float, float]:
    """East, north, and about the origin."""
    x, y = (sum(v / b.inverse_mass for b, v in zip(bodies, way, strict=True)) for way in (
        [b.vx for b in bodies], [b.vy for b in bodies]))  # fmt: skip
    turning = sum((b.x * b.vy - b.y * b.vx) / b.inverse_mass + b.spin / b.inverse_inertia for b in bodies)
    return x, y, turning


@settings(max_examples=150, deadline=None)
@given(pose, velocity, mass, velocity, mass, st.floats(0, 6.2), st.floats(-4, 4), st.floats(0, 1))
def test_an_impact_keeps_momentum_and_gains_no_energy(where, v1, m1, v2, m2, towards, spin, restitution):
    normal = (math.cos(towards), math.sin(towards))
    a = moving(where, v1, m1, spin)
    b = moving((where[0] + 2.5 * normal[0], where[1] + 2.5 * normal[1], 0.4), v2, m2)
    before, energy = momentum(a, b), a.energy + b.energy
    collide(a, b, (where[0] + 1.2 * normal[0], where[1] + 1.2 * normal[1]), normal, restitution)
    assert momentum(a, b) == pytest.approx(before, abs=1e-6 * (m1 + m2) * 20)
    assert a.energy + b.energy <= energy * (1 + 1e-9) + 1e-6


def test_two_that_part_exchange_nothing():
    a, b = moving((0.0, 0.0, 0.0), (5.0, 0.0), 1500.0), moving((4.7, 0.0, 0.0), (9.0, 0.0), 1500.0)
    assert not collide(a, b, (2.35, 0.0), (1.0, 0.0), 0.1)
    assert (a.vx, b.vx) == (5.0, 9.0)


def test_what_a_vehicle_tows_adds_to_its_mass():
    assert mass_kg("car", CAR) == MASS_KG["car"]
    assert mass_kg("pickup", (11.1, 2.0)) > MASS_KG["pickup"] + 400
    assert mass_kg("truck", (20.0, 2.5)) > 15000


def test_who_strikes_a_fixed_body_head_on_stops():
    a, tree = moving((0.0, 0.0, 0.0), (15.0, 0.0), 1500.0), body((2.6, 0.0, 0.0), (0.5, 0.5), None)
    assert collide(a, tree, (2.35, 0.0), (1.0, 0.0))
    assert a.speed < 1e-9
    assert tree.speed == 0
    assert tree.energy == 0


@settings(max_examples=60, deadline=None)
@given(velocity, st.floats(-4, 4), st.floats(0.5, 8), st.floats(0.5, 8))
def test_whatever_slides_is_at_rest_in_the_time_that_is_left(v, spin, along, across):
    """Friction of any size: where the ground alone would not do it in four seconds, it is made to, but for a creep."""
    one, step, energies = moving((0.0, 0.0, 0.3), v, 1500.0, spin), 0.01, [math.inf]
    for k in range(420):
        slow(one, Drag(along, across), step, max(4.0 - k * step, 0.1))
        energies.append(one.energy)
        assert energies[-1] <= energies[-2]
    assert one.speed < 0.1
    assert abs(one.spin) < 0.05


def test_a_body_stops_as_soon_as_its_friction_says():
    one = moving((0.0, 0.0, 0.0), (10.0, 0.0), 1500.0)
    for _ in range(100):
        slow(one, Drag(5.0, 7.0), 0.01, 4.0)
    assert one.vx == pytest.approx(5.0)
    assert one.vy == one.spin == 0


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


# ------------------------------------------------------------------ meetings
def straight_motion(start: tuple[float, float], heading: float, speed: float) -> Motion:
    way = np.array([math.cos(heading), math.sin(heading)])
    path = draw(np.array([np.array(start) - 60 * way, np.array(start) + 60 * way]))
    time, station = drive(path, Pace(speed), 60.0)
    return Motion(path, time, station, CAR, np.zeros(len(path.s_m)), 0.0)


def test_two_that_cross_meet_on_the_wanted_sides():
    east, north = straight_motion((0, 0), 0.0, 12.0), straight_motion((0, 0), math.pi / 2, 12.0)
    for wanted in (("front", "left"), ("right", "front")):
        found = meet(east, north, wanted)
        assert found is not None
        assert found.sides == wanted
    assert meet(east, north, ("left", "front")) is None


def test_two_that_never_come_near_do_not_meet():
    assert meet(straight_motion((0, 0), 0.0, 12.0), straight_motion((0, 30), 0.0, 12.0), None) is None
