"""Where a vehicle is beside its lane, as marks of evasion and of changes of lane see it."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.metrics.labels.course_label_match import vehicle_marks
from sgcad_core.metrics.labels.course_labels import CourseLabel, VehicleLabel
from sgcad_core.metrics.labels.motion_label_match import Path
from sgcad_core.metrics.labels.observed_crash import Crash, VehicleMotion, ahead_of
from sgcad_core.planner import plan
from sgcad_core.records.specs import Actor, BehaviorSpec
from tests.sgcad_core.planner.crash_scenes import network


def driven(name: str, road: str, exit_road: str, aside_m: float = 0.0) -> VehicleMotion:
    """One who keeps its lane from one road into another, and at the end moves to the left."""
    actor = Actor(id="V1", kind="car", road=road, direction="forward", exit_road=exit_road, maneuver="straight")
    track = plan(BehaviorSpec(actors=(actor,), contacts=()), network(name)).trajectories[0]
    pose = np.column_stack((track.x_m, track.y_m, track.heading_rad))
    left = np.linspace(0.0, aside_m, 20)[:, None] * np.column_stack((-np.sin(pose[-20:, 2]), np.cos(pose[-20:, 2])))
    pose[-20:, :2] += left
    return VehicleMotion(Crash({"V1": Path(track.t_s, pose, (4.7, 1.8))}, network(name)), "V1")


@pytest.mark.parametrize(
    ("name", "road", "exit_road"), [("curve", "W", "E"), ("curve", "E", "W"), ("four_leg", "S", "N")]
)
def test_who_keeps_the_lane_through_a_curve_or_a_junction_moves_to_neither_side(name, road, exit_road):
    one = driven(name, road, exit_road)
    assert np.abs(one.aside - one.aside[0]).max() < 0.3


@pytest.mark.parametrize("aside_m", [1.2, -1.2])
def test_what_is_steered_aside_is_seen_in_a_curve(aside_m):
    one = driven("curve", "W", "E", aside_m)
    assert one.aside[-1] - one.aside[-21] == pytest.approx(aside_m, abs=0.3)


def test_a_lane_that_ends_at_a_tee_goes_on_straight():
    one = driven("tee", "S", "E")
    edge, lane = one.home
    assert np.array_equal(ahead_of(network("tee"), edge, lane), lane.shape)
    assert np.array_equal(one.aside, one.off_line)


def test_of_one_that_touches_nothing_the_whole_way_counts():
    one = driven("curve", "W", "E", 1.2)
    assert one.turns_from == 0
    moved = 0.9 * np.sin(np.linspace(0.0, np.pi, len(one.path.t_s)))  # out of its lane and back
    pose = one.path.pose + moved[:, None] * np.column_stack(
        (-np.sin(one.path.pose[:, 2]), np.cos(one.path.pose[:, 2]), 0.0 * moved)
    )
    there = VehicleMotion(Crash({"V1": Path(one.path.t_s, pose, (4.7, 1.8))}, network("curve")), "V1")
    label = CourseLabel("", {"V1": VehicleLabel(maneuver="lane_change_left")}, ())
    assert vehicle_marks(label, there.crash)["V1"]["maneuver_any"] == 1.0
