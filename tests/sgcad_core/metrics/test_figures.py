"""Road-network, generation, displacement and criticality figures follow the paper's formulas."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.case.records import ActorInfo, Execution, Scenario, Trajectory
from sgcad_core.metrics import Thresholds, criticality, displacement, generation, measure
from sgcad_core.metrics.labels.label_match import relative_error

LIMITS = Thresholds()


@pytest.mark.parametrize(
    ("truth", "made", "error"), [(1, 1, 0), (2, 1, 0.5), (1, 3, 1), (4, 3, 0.25), (0, 0, 0), (0, 1, 1)]
)
def test_relative_error_is_capped_at_one(truth, made, error):
    assert relative_error(truth, made) == error


def test_success_is_counted_per_scenario_and_errors_per_file():
    assert generation.generation_success_rate(["generated", "refused", "exhausted", "generated"]) == 0.5
    assert generation.api_error_rate([generation.FileCounts(3, 1), generation.FileCounts(5, 1)]) == 0.25
    assert generation.generation_success_rate([]) == generation.api_error_rate([]) == 0.0


@pytest.mark.parametrize(
    ("facts", "score", "level"),
    [
        ((True, 0.5, 1.0, 1.0), 17, "critical"),
        ((True, 0.5, None, None), 10, "critical"),
        ((False, 0.5, None, 1.0), 8, "high"),
        ((False, None, 1.0, None), 4, "moderate"),
        ((False, None, None, None), 0, "low"),
        ((False, 1.0, 1.5, 2.0), 0, "low"),
    ],
)
def test_emergency_score_is_the_weighted_sum_of_what_is_met(facts, score, level):
    found = criticality.emergency_score(*facts, LIMITS)
    assert found == score
    assert criticality.emergency_level(found, LIMITS) == level


def test_interaction_intensity_counts_neighbours_in_range_with_a_floor():
    distances = np.array([[10.0, 0.2], [60.0, 50.0]])
    np.testing.assert_allclose(criticality.interaction_intensity(distances, LIMITS), [0.1, 1 + 0.02])


def trajectory(actor, x, y, heading=0.0) -> Trajectory:
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    t = np.arange(len(x)) * 0.05
    speed = np.hypot(np.gradient(x, t), np.gradient(y, t))
    return Trajectory(
        actor=actor, t_s=t, x_m=x.copy(), y_m=y.copy(), heading_rad=np.full(len(t), heading), speed_mps=speed
    )


def test_uniform_motion_is_predicted_without_error_and_braking_is_not():
    t = np.arange(161) * 0.05
    assert displacement.constant_velocity_error(trajectory("V1", 10 * t, 0 * t)) == pytest.approx((0, 0), abs=1e-9)
    braking = trajectory("V1", 10 * t - 0.5 * t**2, 0 * t)
    ade, fde = displacement.windowed_velocity_error(braking, 3.0)
    assert fde == pytest.approx(4.5, rel=0.02)
    assert 0 < ade < fde


@given(st.floats(-50, 50), st.floats(-50, 50))
def test_displacement_of_a_shifted_track_is_the_shift(dx, dy):
    track = np.column_stack((np.arange(20.0), np.zeros(20)))
    assert displacement.average_displacement_error(track, track + np.array((dx, dy))) == pytest.approx(np.hypot(dx, dy))
    assert displacement.final_displacement_error(track, track + np.array((dx, dy))) == pytest.approx(np.hypot(dx, dy))


def scene(*trajectories) -> tuple[Execution, Scenario]:
    actors = tuple(
        ActorInfo(id=t.actor, type="car", length_m=4.5, width_m=1.8, maneuver="straight") for t in trajectories
    )
    return Execution(simulator="test", trajectories=trajectories), Scenario(xosc="<x/>", actors=actors)


def test_a_rear_end_crash_is_a_collision_in_both_readings_and_json_has_no_nan():
    t = np.arange(161) * 0.05
    result = measure(*scene(trajectory("V1", np.minimum(10 * t, 46), 0 * t), trajectory("V2", 50 + 0 * t, 0 * t)))
    assert result["ego"] == "V1"
    assert result["exact"]["collision"] is True
    assert result["exact"]["time_to_collision_s"] == 0
    assert result["exact"]["collision_speed_mps"] == pytest.approx(10, abs=0.01)
    assert 0.4 < result["paper"]["collision_probability"] < 0.5
    assert result["paper"]["emergency_level"] == result["exact"]["emergency_level"] == "critical"
    json.dumps(result, allow_nan=False)


def test_the_collision_speed_of_a_braking_car_is_that_of_the_step_into_the_contact():
    """20 m/s less 8 m/s2: 4 m/s after 24 m, where it meets V2 and stays."""
    t = np.arange(161) * 0.05
    x = np.where(t <= 2, 20 * t - 4 * t**2, 24.0)
    result = measure(*scene(trajectory("V1", x, 0 * t), trajectory("V2", 28.5 + 0 * t, 0 * t)))
    assert result["exact"]["collision_speed_mps"] == pytest.approx(4.2, abs=1e-6)  # over the last 0.05 s


def test_the_share_of_frames_depends_on_the_clock_but_the_collision_does_not():
    short, long = (np.arange(n) * 0.05 for n in (121, 401))
    results = [
        measure(*scene(trajectory("V1", np.minimum(10 * t, 46), 0 * t), trajectory("V2", 50 + 0 * t, 0 * t)))
        for t in (short, long)
    ]
    assert results[0]["paper"]["collision_probability"] < results[1]["paper"]["collision_probability"] - 0.3
    assert results[0]["exact"]["emergency_score"] == results[1]["exact"]["emergency_score"]


def test_passing_cars_are_no_conflict_in_the_exact_reading():
    t = np.arange(161) * 0.05
    result = measure(*scene(trajectory("V1", 10 * t, 0 * t), trajectory("V2", 60 - 10 * t, 3.6 + 0 * t, np.pi)))
    assert result["paper"]["time_to_collision_s"] < 0.3
    assert result["exact"]["time_to_collision_s"] is None
    assert result["exact"]["time_to_collision_reason"] == "never on a collision course"
    assert result["exact"]["minimum_distance_m"] == pytest.approx(1.8)


def test_a_single_actor_has_no_conflicts():
    t = np.arange(161) * 0.05
    result = measure(*scene(trajectory("V1", 10 * t, 0 * t)))
    assert result["exact"]["collision"] is False
    assert result["paper"]["time_to_collision_s"] is None
    json.dumps(result, allow_nan=False)
