"""Ways up to what runs along the road, and past a slower vehicle in the lane beside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.encounter.maneuver_choices import drifts
from sgcad_core.planner.encounter.meeting_place import Place
from sgcad_core.planner.encounter.ways_off_road import departures
from sgcad_core.planner.lines.actor_course import find_course
from sgcad_core.planner.lines.departures import rail_m
from sgcad_core.records.course import CourseTold
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_departures import CAR


def role(layout: str, **more: object) -> Role:
    course = find_course(network(layout), CAR)
    return Role(CAR, course, (4.7, 1.8), Place((course.start_m + course.end_m) / 2, 0.0, 0.0, 0.0), **more)


@pytest.mark.parametrize(("departs", "hand"), [("left", 1), ("right", -1)])
def test_a_vehicle_comes_to_a_rail_from_its_lane_or_the_next_one(departs, hand):
    one = role("freeway", side="front", other_long_m=0.6, told=CourseTold(departs=departs))
    ways = [line for line in departures(one, fine=True) if line.left_m]
    assert {np.sign(line.left_m) for line in ways} == {hand}
    assert {line.before_m for line in ways} <= {0.0, -hand * one.course.lane_width_m}
    assert any(line.yaw_rad * hand > 0 for line in ways)
    steepest = max(abs(line.left_m) / line.length_m for line in ways)
    assert steepest > 0.2


def test_a_rail_in_the_median_leaves_the_other_direction_free():
    course = role("freeway").course
    assert course.own_left_m < rail_m(course, 1, 0.6) < course.own_left_m + course.median_m - 0.5
    assert rail_m(course, -1, 0.6) < -course.right_edge_m


def test_one_that_overtakes_is_in_the_lane_beside_before_it_meets_a_flank():
    actor = CAR.model_copy(update={"maneuver": "overtaking"})
    one = replace(role("straight", side="front", other_side="left", other_mps=8.0), actor=actor)
    first = drifts(one)[0]
    assert first.end_m < one.place.station_m - 5.0
    assert first.left_m == pytest.approx(one.course.lane_width_m, abs=0.2)
