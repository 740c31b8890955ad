"""Several told moves before a contact: driven one after the other, at any speed that the road has room for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.metrics.labels.motion_label_match import Path
from sgcad_core.metrics.labels.observed_crash import Crash, VehicleMotion
from sgcad_core.metrics.road_departure import moves_made
from sgcad_core.planner.lines.actor_course import find_course
from sgcad_core.planner.lines.told_moves import off_and_back, unturned
from sgcad_core.planner.plan import plan
from sgcad_core.records.course import CourseTold, Move
from sgcad_core.records.specs import size_m
from tests.effort import many
from tests.sgcad_core.planner.test_departures import ALONE, CAR, HITS_TREE, roads

OFF_RIGHT, OFF_LEFT, BACK = Move("departs", "right"), Move("departs", "left"), Move("returns")
ACROSS, YAWS = Move("crosses", "left"), Move("yaws", "counterclockwise")


def made(behavior, told, graph=None):
    graph = graph or roads()
    done = plan(behavior, graph, courses={"V1": told}, may_skid=told.lost_control)
    paths = {t.actor: Path(t.t_s, t.pose, size_m(a)) for t, a in zip(done.trajectories, behavior.actors, strict=True)}
    seen = moves_made(graph, VehicleMotion(Crash(paths, graph), "V1"), told.moves, size_m(CAR)[0])
    return done, seen


@pytest.mark.parametrize(("moves", "side"), [
    ((OFF_RIGHT, BACK, OFF_LEFT), "left"),
    ((OFF_RIGHT, Move("steers", "left"), ACROSS, OFF_LEFT), "left"),
    ((Move("steers", "left"), BACK, OFF_RIGHT), "right"),
    ((ACROSS, BACK, OFF_RIGHT), "right"),
    ((OFF_LEFT, BACK, OFF_RIGHT), "right"),
])  # fmt: skip
def test_every_told_move_is_driven_before_the_tree_is_struck(moves, side):
    done, seen = made(HITS_TREE, CourseTold(departs=side, moves=moves))
    assert done.realised
    assert all(seen)


def test_a_told_yaw_shows_on_the_way_off_the_road_where_nothing_is_struck():
    told = CourseTold(departs="left", moves=(OFF_RIGHT, BACK, YAWS, OFF_LEFT), rolls=True, lost_control=True)
    done, seen = made(ALONE, told)
    assert all(seen)
    assert done.trajectories[0].t_s[-1] > 8.0


def test_a_move_that_is_not_driven_is_missed():
    graph = roads()
    done = plan(HITS_TREE, graph, courses={"V1": CourseTold(departs="left")})
    paths = {t.actor: Path(t.t_s, t.pose, (4.6, 1.8)) for t in done.trajectories}
    seen = moves_made(graph, VehicleMotion(Crash(paths, graph), "V1"), (OFF_RIGHT, BACK, OFF_LEFT), 4.6)
    assert seen == [False, False, True]


@settings(max_examples=many(4, 40), deadline=None)
@given(speed=st.integers(20, 65))
def test_moves_at_any_speed_begin_on_the_road(speed):
    car = CAR.model_copy(update={"speed_mph": speed})
    behavior = ALONE.model_copy(update={"actors": (car,)})
    done, seen = made(behavior, CourseTold(departs="left", moves=(OFF_RIGHT, BACK, OFF_LEFT), rolls=True))
    (track,) = done.trajectories
    assert all(seen)
    assert abs(float(track.y_m[0])) < 250
    assert np.abs(np.diff(track.x_m)).max() < 1.0


def test_a_divided_road_is_left_into_its_median_and_not_across_it():
    graph = roads(median="grass", lanes_in=2, lanes_out=2)
    told = CourseTold(departs="right", moves=(OFF_LEFT, BACK, OFF_RIGHT))
    done, _ = made(HITS_TREE, told, graph)
    line = find_course(graph, CAR)
    came_to = max(line.path.poses([line.start_m])[0, 0] - done.trajectories[0].x_m)
    assert line.own_left_m < came_to < line.own_left_m + line.median_m


def test_one_that_strikes_a_thing_off_the_road_and_then_a_vehicle_comes_back():
    told = {
        "V1": CourseTold(departs="left"),
        "V2": CourseTold(departs="right", moves=(ACROSS, BACK)),
        "V3": CourseTold(),
    }
    found = off_and_back(told, ["V1", "V2", "V3", "V4"])
    assert found["V1"].moves == (OFF_LEFT, BACK)
    assert (found["V2"], found["V3"]) == (told["V2"], told["V3"])
    assert off_and_back(told, []) == told


def test_courses_without_their_skids_keep_all_else():
    told = {"V1": CourseTold(yaws="clockwise", lost_control=True, departs="left"), "V2": CourseTold(brakes=True)}
    assert unturned(told) == {"V1": CourseTold(lost_control=True, departs="left"), "V2": CourseTold(brakes=True)}
