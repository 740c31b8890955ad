"""Who touches nobody and is told ahead stands there: in the lane, in front of all that drive in it, clear of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import gaps_where_near
from sgcad_core.planner.company import led_by
from sgcad_core.planner.lines.actor_course import find_course
from sgcad_core.planner.plan import plan
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Evasion, NearCrash, size_m
from tests.sgcad_core.planner.crash_scenes import network

HIT = Contact(striker="V2", struck="V1", striker_area="front", struck_area="back")


def car(name, maneuver, **more):
    return Actor.model_validate(
        {"id": name, "kind": "car", "road": "S", "direction": "forward", "exit_road": "N", "maneuver": maneuver} | more
    )


def walker(**more):
    return car("P1", "straight", kind="pedestrian", exit_road=None, **more)


def planned(layout, *actors):
    behavior = BehaviorSpec(actors=actors, contacts=(HIT,))
    made = plan(behavior, network(layout))
    assert made.realised, made.notes
    return {one.actor: np.column_stack((one.x_m, one.y_m, one.heading_rad)) for one in made.trajectories}


def stations(layout, actor, poses):
    path = find_course(network(layout), actor).path
    away = np.hypot(*(poses[:, None, :2] - path.points[None]).transpose(2, 0, 1))
    return path.s_m[away.argmin(axis=1)], away.min(axis=1)


@settings(max_examples=12, deadline=None)
@given(
    layout=st.sampled_from(["four_leg", "straight", "straight_wide", "curve", "tee_wide"]),
    first=st.sampled_from(["stopped", "slowing"]), speed=st.integers(10, 45), count=st.integers(1, 3),
)  # fmt: skip
def test_standing_traffic_is_ahead_in_the_lane_and_touched_by_nobody(layout, first, speed, count):
    road, exit_ = {"straight_wide": ("E", "W"), "curve": ("E", "W")}.get(layout, ("S", "N"))
    ways = {"road": road, "exit_road": exit_}
    actors = [car("V1", first, **ways), car("V2", "straight", speed_mph=speed, **ways)]
    actors += [car(f"V{n + 3}", "stopped", **ways) for n in range(count)]
    seen = planned(layout, *actors)
    ahead = -math.inf
    for name in ("V1", *(a.id for a in actors[2:])):
        at, aside = stations(layout, actors[0], seen[name])
        assert at.max() > ahead
        ahead = at.max()
        assert name == "V1" or aside.max() < 0.3
    size = size_m(actors[0])
    for one in seen:
        for other in seen.keys() - {one, "V1", "V2"}:
            assert gaps_where_near(seen[one], size, seen[other], size, 1.0).min() > 0.2


@settings(max_examples=8, deadline=None)
@given(layout=st.sampled_from(["four_leg", "straight"]), first=st.sampled_from(["stopped", "slowing"]))
def test_a_pedestrian_crosses_ahead_of_the_one_that_waits(layout, first):
    one = car("V1", first)
    seen = planned(layout, one, car("V2", "straight"), walker())
    waits, crosses = stations(layout, one, seen["V1"])[0], seen["P1"]
    line = find_course(network(layout), one).path.points
    away = np.hypot(*(crosses[:, None, :2] - line[None]).transpose(2, 0, 1)).min(axis=1)
    assert away.min() < 1.0 < away.max()
    assert stations(layout, one, crosses)[0][away.argmin()] > waits.max() + size_m(one)[0] / 2
    assert gaps_where_near(crosses, size_m(walker()), seen["V1"], size_m(one), 1.0).min() > 0.2


def test_room_before_the_junction_is_left_for_those_ahead():
    alone = planned("four_leg", car("V1", "stopped"), car("V2", "straight"))
    behind = planned("four_leg", car("V1", "stopped"), car("V2", "straight"), car("V3", "stopped"))
    assert behind["V1"][0, 1] < alone["V1"][0, 1] - 4.0


def test_one_that_is_pushed_from_behind_leaves_the_queue_its_place_before_the_junction():
    queue = (car("V3", "stopped"), car("V4", "stopped"))
    behind = planned("four_leg", car("V1", "stopped"), car("V2", "straight", speed_mph=35), *queue)
    edge = -2.0 - size_m(queue[0])[0] / 2
    assert max(behind[name][0, 1] for name in ("V3", "V4")) < edge


@pytest.mark.parametrize(("actor", "leader"), [
    (car("V3", "stopped"), "V1"), (car("V3", "stopped", lane=2), None), (car("V3", "parked"), None),
    (car("V3", "straight"), None), (car("V3", "stopped", road="N"), None), (walker(), "V1"),
])  # fmt: skip
def test_who_stands_ahead_of_whom(actor, leader):
    behavior = BehaviorSpec(actors=(car("V1", "stopped"), car("V2", "straight"), actor), contacts=(HIT,))
    found = led_by(behavior, actor)
    assert (found and found.id) == leader


def test_one_that_slows_ahead_of_a_near_miss_drives_ahead_and_stops_first():
    near = NearCrash(conflict=HIT, evasions=(Evasion(actor="V2", maneuver="braking"),))
    actors = (car("V1", "slowing"), car("V2", "straight"), car("V3", "slowing"))
    made = plan(BehaviorSpec(actors=actors, contacts=(), near_crash=near), network("straight"))
    seen = {one.actor: np.column_stack((one.x_m, one.y_m, one.heading_rad)) for one in made.trajectories}
    speed = {one.actor: one.speed_mps for one in made.trajectories}
    size = size_m(actors[0])
    assert gaps_where_near(seen["V1"], size, seen["V3"], size, 60.0).min() > 2.0
    at = {name: stations("straight", actors[0], poses)[0] for name, poses in seen.items()}
    assert (at["V3"] > at["V1"]).all()
    assert speed["V3"][0] > 3.0
    assert np.flatnonzero(speed["V3"] < 0.5)[0] <= np.flatnonzero(speed["V1"] < 0.5)[0]
