"""Near misses of things beside the lanes: the vehicle drifts to their side and passes them at the clearance."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.execution.contact import closest_approach, first_contact
from sgcad_core.planner import plan
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import CLEARANCE_M, BehaviorSpec, size_m
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.near_crash.test_near_miss import near
from tests.sgcad_core.planner.test_plan_rules import actor, track

RAIL = actor("O1", "stopped", "E", lane=1, kind="object", length_m=0.4, width_m=14.0)


def passed(layout, told, *evasions, maneuver="straight", thing=RAIL):
    driver = actor("V1", maneuver, "E", lane=1)
    behavior = BehaviorSpec(actors=(driver, thing), near_crash=near("V1 front O1 front", *evasions))
    made = plan(behavior, network(layout), courses={"V1": told}, may_skid=told.lost_control)
    sizes = {a.id: size_m(a) for a in behavior.actors}
    closest = closest_approach(made.trajectories, sizes, ("V1", "O1"))
    assert closest is not None
    assert first_contact(made.trajectories, sizes) is None
    assert closest.clearance_m == pytest.approx(CLEARANCE_M, abs=0.06)
    mine, there = track(made, "V1"), track(made, "O1")
    # the road heads west: north is on the right
    right_m = mine.y_m - mine.y_m[0]
    return mine, right_m, there.y_m[0] - mine.y_m[0], made.notes


@pytest.mark.parametrize(("side", "sign"), [("right", 1.0), ("left", -1.0)])
def test_it_drifts_to_the_told_side_and_comes_back(side, sign):
    mine, right_m, thing_m, _ = passed("straight_wide", CourseTold(departs=side))
    assert thing_m * sign > 0
    assert (sign * right_m).max() > 0.5
    assert abs(right_m[-1]) < 0.3 * (sign * right_m).max()
    assert np.ptp(mine.speed_mps) < 3.0


def test_one_that_leaves_the_road_stays_off_it():
    _, right_m, _, _ = passed("straight_wide", CourseTold(departs="right"), maneuver="departing_road_right")
    assert right_m[-1] > 1.5


def test_told_braking_is_seen():
    mine, *_ = passed("straight_wide", CourseTold(departs="right"), ("V1", "braking"))
    assert mine.speed_mps[-1] < 0.7 * mine.speed_mps[0]


@pytest.mark.parametrize(("way", "sign"), [("clockwise", -1.0), ("counterclockwise", 1.0)])
def test_one_that_spins_turns_as_told_and_stops(way, sign):
    mine, *_ = passed("straight_wide", CourseTold(lost_control=True, spin=way, spin_deg=180.0))
    turned = np.degrees(np.unwrap(mine.heading_rad)[-1] - mine.heading_rad[0])
    assert sign * turned == pytest.approx(180.0, abs=25.0)
    assert mine.speed_mps[-1] < 0.2


def test_at_a_junction_the_thing_stands_behind_it():
    thing = RAIL.model_copy(update={"road": "S", "direction": "forward"})
    driver = actor("V1", "straight", "S", lane=1)
    behavior = BehaviorSpec(actors=(driver, thing), near_crash=near("V1 front O1 front"))
    made = plan(behavior, network("four_leg"), courses={"V1": CourseTold(departs="left")})
    assert track(made, "O1").y_m[0] > 15.0
