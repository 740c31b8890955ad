"""Vehicles that are told to leave the scene drive on behind their contact, round all that stands there."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.geometry.plane import gaps_where_near
from sgcad_core.planner.plan import plan
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, size_m
from tests.sgcad_core.planner.crash_scenes import network


def car(name, maneuver, **more):
    ways = {"road": "S", "direction": "forward", "exit_road": "N", "maneuver": maneuver}
    return Actor.model_validate({"id": name, "kind": "car"} | ways | more)


def driven(layout, contact, *actors, leaves=True):
    """Track by actor, of a crash of which V2 leaves."""
    behavior = BehaviorSpec(actors=actors, contacts=(contact,))
    told = {"V2": CourseTold(leaves=leaves, slight=True), "V1": CourseTold(slight=True)}
    made = plan(behavior, network(layout), courses=told)
    assert made.realised, made.notes
    return {one.actor: one for one in made.trajectories}, made


def poses(track):
    return np.column_stack((track.x_m, track.y_m, track.heading_rad))


REAR_END = Contact(striker="V2", struck="V1", striker_area="front", struck_area="back")
SIDESWIPE = Contact(striker="V2", struck="V1", striker_area="right", struck_area="left")


@pytest.mark.parametrize(("contact", "actors"), [
    (REAR_END, (car("V1", "stopped"), car("V2", "straight"))),
    (REAR_END, (car("V1", "stopped"), car("V2", "straight"), car("V3", "stopped"))),
    (REAR_END, (car("V1", "slowing"), car("V2", "straight"))),
])  # fmt: skip
def test_it_drives_on_past_all_that_stands_and_comes_back_into_its_lane(contact, actors):
    seen, made = driven("four_leg", contact, *actors)
    left, first = seen["V2"], made.contact.t_s
    assert left.speed_mps[-1] > 3.0
    assert left.y_m[-1] > max(one.y_m[-1] for name, one in seen.items() if name != "V2") + 5.0
    assert abs(left.x_m[-1] - left.x_m[0]) < 0.5
    apart = left.t_s > first + 1.5
    for name in seen.keys() - {"V2"}:
        gaps = gaps_where_near(poses(left), size_m(actors[0]), poses(seen[name]), size_m(actors[0]), 1.0)
        assert gaps[apart].min() > -0.04


def test_one_that_still_rolls_does_not_stop():
    seen, made = driven("straight_wide", SIDESWIPE, *(
        car("V1", "straight", road="E", exit_road="W", lane=1),
        car("V2", "lane_change_right", road="E", exit_road="W", lane=2),
    ))  # fmt: skip
    left = seen["V2"]
    assert left.speed_mps[left.t_s > made.contact.t_s].min() > 5.0


def test_one_that_brushes_another_one_stops_further_on_in_its_lane():
    seen, made = driven("straight_wide", SIDESWIPE, *(
        car("V1", "stopped", road="E", exit_road="W", lane=1),
        car("V2", "straight", road="E", exit_road="W", lane=2),
    ), leaves=False)  # fmt: skip
    left = seen["V2"]
    assert left.speed_mps[-1] < 0.1
    assert left.speed_mps[left.t_s > made.contact.t_s + 0.5][0] > 3.0
    assert left.heading_rad[-1] == pytest.approx(left.heading_rad[0], abs=0.01)


def test_one_that_grazes_an_oncoming_one_that_stands_does_so_at_a_small_angle_and_comes_back():
    seen, made = driven("four_leg", Contact(striker="V2", struck="V1", striker_area="left", struck_area="left"), *(
        car("V1", "stopped"), car("V2", "straight", road="N", exit_road="S"),
    ), leaves=False)  # fmt: skip
    left = seen["V2"]
    at = int(np.searchsorted(left.t_s, made.contact.t_s))
    assert abs(left.heading_rad[at] - left.heading_rad[0]) < np.radians(8.0)
    assert abs(left.heading_rad[-1] - left.heading_rad[0]) < np.radians(12.0)
    assert left.y_m[-1] < left.y_m[at] - 5.0


def test_one_that_is_not_told_to_leave_stays():
    seen, _ = driven("four_leg", REAR_END, car("V1", "stopped"), car("V2", "straight"), leaves=False)
    assert seen["V2"].speed_mps[-1] < 0.1
