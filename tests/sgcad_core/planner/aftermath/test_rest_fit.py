"""Wrecks come to rest as told, told evasions are driven, and what cannot be is said."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.metrics.rest_error import attitude_of, rest_errors
from sgcad_core.planner import plan
from sgcad_core.planner.aftermath.ground_friction import Drag, Released, RunOut, apply_friction, run_out_paths
from sgcad_core.planner.aftermath.impact import body
from sgcad_core.planner.aftermath.rest_candidates import all_runs, loops, odd_ways
from sgcad_core.records.course import CourseTold, RestTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from sgcad_core.roads.surface import road_surface
from tests.sgcad_core.planner.crash_scenes import network

CAR = (4.7, 1.8)


def crossing() -> BehaviorSpec:
    """V1 eastbound strikes the left side of V2 southbound in the middle of a crossroads."""
    actors = (
        Actor(id="V1", kind="car", road="W", direction="forward", exit_road="E", maneuver="straight", speed_mph=30),
        Actor(id="V2", kind="car", road="N", direction="forward", exit_road="S", maneuver="straight", speed_mph=25),
    )
    return BehaviorSpec(
        actors=actors, contacts=(Contact(striker="V1", struck="V2", striker_area="front", struck_area="right"),)
    )


def planned(courses, behavior=None, name="four_leg"):
    behavior = behavior or crossing()
    made = plan(behavior, network(name), courses=courses)
    return made, {t.actor: t for t in made.trajectories}


def rest_of(track):
    return np.array([[track.x_m[-1], track.y_m[-1], track.heading_rad[-1]]])


def errors_of(told: RestTold, track, name="four_leg"):
    return rest_errors(told, rest_of(track), float(track.heading_rad[0]), road_surface(network(name))).right()


# ------------------------------------------------------------------ rest
@pytest.mark.parametrize(
    "told",
    [
        RestTold(135.0), RestTold(180.0), RestTold(None, "off_road"), RestTold(None, "road"),
        RestTold(None, "off_road", "SE"), RestTold(None, "intersection"),
    ],
)  # fmt: skip
def test_a_struck_vehicle_comes_to_rest_as_told(told: RestTold) -> None:
    made, tracks = planned({"V2": CourseTold(rest=told)})
    assert made.realised
    assert all(errors_of(told, tracks["V2"]).values()), made.notes


def test_without_a_told_rest_nothing_is_chosen() -> None:
    plain, empty = planned({})[0], planned({"V1": CourseTold(), "V2": CourseTold()})[0]
    assert all(np.array_equal(a.x_m, b.x_m) for a, b in zip(plain.trajectories, empty.trajectories, strict=True))


def test_what_cannot_be_reached_is_said_with_by_how_much() -> None:
    slow = tuple(a.model_copy(update={"speed_mph": 8}) for a in crossing().actors)
    behavior = crossing().model_copy(update={"actors": slow})
    made, _ = planned({"V1": CourseTold(rest=RestTold(270.0, "off_road", "W"))}, behavior)
    assert any(note.startswith("V1 comes to rest") for note in made.notes)


def test_a_told_rollover_is_part_of_the_motion() -> None:
    _, tracks = planned({"V2": CourseTold(rolls=True, rest=RestTold(attitude="roof"))})
    assert attitude_of(float(tracks["V2"].rolls[-1])) == "roof"
    assert tracks["V1"].roll_rad is None


def test_two_plans_of_a_told_rest_are_the_same() -> None:
    told = {"V2": CourseTold(rest=RestTold(180.0, "off_road"))}
    first, second = planned(told)[0], planned(told)[0]
    assert all(np.array_equal(a.heading_rad, b.heading_rad)
               for a, b in zip(first.trajectories, second.trajectories, strict=True))  # fmt: skip


@pytest.mark.parametrize(("spin", "way"), [("clockwise", -1.0), ("counterclockwise", 1.0)])
def test_a_struck_vehicle_spins_as_told(spin, way) -> None:
    made, tracks = planned({"V2": CourseTold(spin=spin)})
    turned = tracks["V2"].heading_rad[-1] - tracks["V2"].heading_rad[round(made.contact.t_s / 0.05)]
    assert made.realised
    assert way * turned > math.radians(8)


# ------------------------------------------------------------------ evasion
def test_told_braking_shows_before_the_contact() -> None:
    speeds = {}
    for brakes in (False, True):
        made, tracks = planned({"V1": CourseTold(brakes=brakes)})
        k = round(made.contact.t_s / 0.05)
        speeds[brakes] = tracks["V1"].speed_mps[: k - 1]
    assert speeds[True].max() == pytest.approx(30 * 0.44704, rel=0.03)
    assert speeds[True][-1] < 0.85 * speeds[True].max()
    assert speeds[False][-1] > 0.95 * speeds[False].max()
    drop = speeds[True][:-10] - speeds[True][10:]
    assert 2.0 < drop.max() / 0.5 < 0.75 * 9.81


@pytest.mark.parametrize(("hand", "way"), [("left", 1.0), ("right", -1.0)])
def test_told_steering_shows_before_the_contact(hand, way) -> None:
    made, tracks = planned({"V1": CourseTold(steers=hand)})
    k = round(made.contact.t_s / 0.05)
    assert made.realised
    assert way * (tracks["V1"].y_m[k] - tracks["V1"].y_m[0]) > 0.25  # V1 drives east: left is north


# ------------------------------------------------------------------ running out
@pytest.mark.parametrize("bend", [0.0, 0.05, -0.1])
@pytest.mark.parametrize(("turning", "rolls_s"), [(1.0, 0.0), (0.4, 0.0), (1.0, 1.5)])
def test_many_ways_at_once_end_where_each_alone_ends(bend, turning, rolls_s) -> None:
    drag, run, step, end = Drag(4.5, 7.0), RunOut(0.0, 2.0, bend, turning, rolls_s), 0.01, 4.0
    one = body((1.0, 2.0, 0.3), CAR, 1450.0)
    one.vx, one.vy, one.spin = 11.0, 2.0, 0.8
    other, slides = body((9.0, 2.0, 1.3), (9.0, 2.5), 9000.0), Drag(2.0, 5.0)
    other.vx, other.spin = -4.0, 0.2
    released = [Released(other, 0.0), Released(one, 0.0)]
    both = run_out_paths(released, [slides, drag], [[RunOut(0.0, 1.0)], [run, RunOut(0.0, 6.0)]], end, step)
    assert [ways.shape[1] for ways in both] == [1, 2]
    together = both[1][-1][0]
    for k in range(round(end / step)):
        one.x, one.y, one.heading = one.x + one.vx * step, one.y + one.vy * step, one.heading + one.spin * step
        apply_friction(one, drag, step, max(end - k * step, 0.1), run, k * step)
    assert together == pytest.approx((one.x, one.y, one.heading), abs=1e-6)


@pytest.mark.parametrize(("turning", "yaws"), [(1.0, 0.0), (0.35, 0.6), (0.6, -1.2)])
def test_a_slide_among_many_ways_ends_where_it_ends_alone(turning, yaws) -> None:
    drag, run, step, end = Drag(4.5, 7.0), RunOut(0.0, 3.0, 0.0, turning, 0.0, True, yaws), 0.01, 5.0
    one = body((1.0, 2.0, 0.3), CAR, 1450.0)
    one.vx, one.vy, one.spin = 11.0, 2.0, 1.8
    (ways,) = run_out_paths([Released(one, 0.0)], [drag], [[RunOut(0.0, 4.0, 0.03), run]], end, step)
    for k in range(round(end / step)):
        one.x, one.y, one.heading = one.x + one.vx * step, one.y + one.vy * step, one.heading + one.spin * step
        apply_friction(one, drag, step, max(end - k * step, 0.1), run, k * step)
    assert ways[-1][1] == pytest.approx((one.x, one.y, one.heading), abs=1e-6)


@pytest.mark.slow
@given(st.floats(3, 30), st.floats(-4, 4), st.floats(1.5, 7), st.floats(0.35, 1), st.floats(-1, 1))
@settings(max_examples=60, deadline=None)
def test_a_body_that_slides_turns_and_keeps_its_way(mps, spin, along, turning, drags) -> None:
    one, run = body((0.0, 0.0, 0.0), CAR, 1450.0), RunOut(0.0, along, 0.0, turning, 0.0, True, drags * 0.2 * along)
    one.vx, one.spin = mps, spin
    (ways,) = run_out_paths([Released(one, 0.0)], [Drag(4.5, 7.0)], [[run]], 40.0, 0.05)
    assert np.abs(ways[:, 0, 1]).max() < 1e-9
    assert np.diff(ways[:, 0, 0]).min() >= 0.0
    assert ways[-1] == pytest.approx(ways[-2])
    assert ways[-1, 0, 0] >= mps**2 / (2 * along) - 0.05 * mps - 0.1  # the farther the more it turns


def test_what_drags_on_its_left_turns_left_as_it_slides() -> None:
    one = body((0.0, 0.0, 0.0), CAR, 1450.0)
    one.vx = 12.0
    ways = [RunOut(0.0, 4.0, 0.0, 1.0, 0.0, True, yaws) for yaws in (-0.8, 0.0, 0.8)]
    ends = run_out_paths([Released(one, 0.0)], [Drag(4.5, 7.0)], [ways], 8.0, 0.05)[0][-1]
    assert ends[0][2] == pytest.approx(-ends[2][2])
    assert ends[1][2] == 0.0
    assert math.degrees(ends[2][2]) > 20.0


def test_no_way_to_rest_slows_so_little_that_it_crawls() -> None:
    assert min(way.along_mps2 for way in all_runs(0.0, 7.0, 15.0)) >= 1.4
    assert min(way.along_mps2 for way in all_runs(0.0, 1.6, 15.0)) >= 0.8  # on ice


def test_a_told_distance_is_gone() -> None:
    for told in (8.0, 16.0):
        made, tracks = planned({"V2": CourseTold(rest=RestTold(distance_m=told))})
        k = round(made.contact.t_s / 0.05)
        way = math.dist((tracks["V2"].x_m[k], tracks["V2"].y_m[k]), (tracks["V2"].x_m[-1], tracks["V2"].y_m[-1]))
        assert way == pytest.approx(told, rel=0.3), made.notes


def test_who_rolls_on_comes_further_before_it_brakes() -> None:
    one, drag = body((0.0, 0.0, 0.0), CAR, 1450.0), Drag(4.5, 7.0)
    one.vx = 6.0
    ways = [RunOut(0.0, 3.0), RunOut(0.0, 3.0, rolls_s=1.5)]
    ends = run_out_paths([Released(one, 0.0)], [drag], [ways], 8.0, 0.05)[0][-1]
    assert ends[1][0] - ends[0][0] == pytest.approx(9.0, abs=0.4)  # 6 m/s for 1.5 s


def test_who_rolls_over_drives_nowhere_and_hardly_steers() -> None:
    ways = all_runs(0.0, 7.0, 15.0, on_wheels=False)
    assert {way.rolls_s for way in ways} == {0.0}
    assert max(abs(way.bend_per_m) for way in ways) < max(abs(way.bend_per_m) for way in all_runs(0.0, 7.0, 15.0)) / 4
    assert any(way.rolls_s for way in all_runs(0.0, 7.0, 15.0))


def test_a_slow_wreck_brakes_instead_of_crawling_on() -> None:
    assert min(way.along_mps2 for way in all_runs(0.0, 7.0, 2.0)) > 2.0
    assert not any(way.rolls_s for way in all_runs(0.0, 7.0, 2.0))


def test_a_run_out_that_goes_round_in_a_loop_costs() -> None:
    angle = np.linspace(0.0, math.pi, 40)
    straight = np.column_stack((10 * angle, 0 * angle, 0 * angle))
    bent = np.column_stack((10 * np.sin(angle / 4), 10 - 10 * np.cos(angle / 4), angle / 4))
    round_about = np.column_stack((10 * np.sin(angle), 10 - 10 * np.cos(angle), angle))
    costs = loops(np.stack((straight, bent, round_about), axis=1), 0.1)
    assert costs[0] == costs[1] == 0.0
    assert costs[2] > 0.5


@pytest.mark.parametrize("bend", [0.1, -0.1])
def test_a_steered_run_bends_to_its_side_within_friction(bend) -> None:
    one, drag, step = body((0.0, 0.0, 0.0), CAR, 1450.0), Drag(4.5, 7.0), 0.01
    one.vx = 12.0
    for _ in range(200):
        before = (one.vx, one.vy)
        one.x, one.y, one.heading = one.x + one.vx * step, one.y + one.vy * step, one.heading + one.spin * step
        apply_friction(one, drag, step, 4.0, RunOut(0.0, 1.0, bend))
        assert math.hypot(one.vx - before[0], one.vy - before[1]) / step < 7.0 * 1.2
    assert one.y * bend > 0
    assert one.heading * bend > 0


@pytest.mark.parametrize(("mph", "facing"), [(15, 45.0), (35, 0.0), (50, 45.0)])
def test_no_more_than_half_a_turn_is_taken_to_a_told_facing(mph: int, facing: float) -> None:
    speeds = {"V1": mph, "V2": 35}
    actors = tuple(a.model_copy(update={"speed_mph": speeds[a.id]}) for a in crossing().actors)
    behavior = crossing().model_copy(update={"actors": actors})
    _, tracks = planned({"V1": CourseTold(rest=RestTold(facing))}, behavior)
    turned = np.unwrap(tracks["V1"].heading_rad)
    assert np.abs(turned - turned[0]).max() <= math.radians(200.0)


def test_ways_that_turn_on_the_spot_or_leave_the_road_before_a_rest_on_it_cost_more() -> None:
    surface = road_surface(network("straight"))
    share = np.linspace(0.0, 1.0, 60)
    along = np.column_stack((1.75 + 0 * share, 40 * share - 20, math.pi / 2 + 0 * share))
    whirled = np.column_stack((1.75 + 0 * share, 2 * share, math.pi / 2 + 2.5 * share))
    out = along + np.column_stack((8.0 * np.sin(math.pi * share), 0 * share, 0 * share))
    ways = np.stack((along, whirled, out), axis=1)
    onto = odd_ways(CourseTold(rest=RestTold(where="road")), ways, surface)
    anywhere = odd_ways(CourseTold(), ways, surface)
    assert (onto > 0.0).tolist() == [False, True, True]
    assert (anywhere > 0.0).tolist() == [False, True, False]
