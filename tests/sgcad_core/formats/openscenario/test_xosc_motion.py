"""Speeds and trajectories as OpenSCENARIO means them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgcad_core.formats.openscenario.playing.timed_motion import TimedMotion
from tests.sgcad_core.formats.xosc_samples import at, event, follow, row, scenario, speed_action, timing, v1, world

V1 = {"V1": world(0, 0)}


# ------------------------------------------------------------------ speed
@pytest.mark.parametrize(("shape", "half"), [("linear", 15.0), ("sinusoidal", 15.0), ("cubic", 15.0)])
def test_a_change_of_speed_takes_its_time(shape, half):
    motion = v1(scenario(V1, event("e", speed_action(20, shape, "time", 2), at(1)), {"V1": 10}))
    assert [row(motion, t)[3] for t in (1.0, 2.0, 3.0, 4.0)] == pytest.approx([10, half, 20, 20])
    assert row(motion, 3.0)[0] == pytest.approx(10 + 30, abs=0.02)


@pytest.mark.parametrize(("shape", "steepest"), [("linear", 5.0), ("sinusoidal", 5.0), ("cubic", 5.0)])
def test_a_rate_is_the_steepest_change(shape, steepest):
    motion = v1(scenario(V1, event("e", speed_action(20, shape, "rate", 5), at(0.5)), {"V1": 10}))
    assert np.diff(motion.speed_mps).max() / 0.05 == pytest.approx(steepest, rel=0.01)
    assert motion.speed_mps[-1] == pytest.approx(20)


@pytest.mark.parametrize("shape", ["linear", "sinusoidal", "cubic"])
def test_a_distance_is_where_the_new_speed_is_reached(shape):
    motion = v1(scenario(V1, event("e", speed_action(0, shape, "distance", 25), at(1)), {"V1": 10}, end=at(8)))
    assert row(motion, 6.0)[0] == pytest.approx(10 + 25, abs=0.05)
    assert motion.speed_mps[-1] == 0


def test_a_step_of_speed_happens_at_once():
    motion = v1(scenario(V1, event("e", speed_action(20), at(1)), {"V1": 10}))
    assert row(motion, 1.0)[3] == 20
    assert row(motion, 2.0)[0] == pytest.approx(30)


def test_a_relative_speed_is_taken_when_the_action_starts():
    relative = speed_action(0).replace(
        '<AbsoluteTargetSpeed value="0"/>',
        '<RelativeTargetSpeed entityRef="V2" value="1.5" speedTargetValueType="factor" continuous="false"/>',
    )
    places = {"V1": world(0, 0), "V2": world(0, 9)}
    assert v1(scenario(places, event("e", relative, at(1)), {"V2": 8})).speed_mps[-1] == pytest.approx(12)


# ------------------------------------------------------------------ trajectories
LINE = [(0, 0, 0, 0), (2, 20, 0, 0), (4, 20, 30, math.pi / 2)]


def test_timed_vertices_are_met_exactly_and_interpolated():
    motion = v1(scenario(V1, event("e", follow(LINE, timing()), at(0))))
    for t, x, y, h in LINE:
        assert row(motion, t)[:3] == pytest.approx((x, y, h), abs=1e-12)
    assert row(motion, 3.0)[:3] == pytest.approx((20, 15, math.pi / 4))
    assert row(motion, 1.0)[3] == pytest.approx(10)


def test_headings_turn_along_the_shorter_arc():
    rows = [(0, 0, 0, 3.0), (2, -5, 0, -3.0), (4, -9, 0, 3.0)]
    heading = v1(scenario(V1, event("e", follow(rows, timing()), at(0)))).heading_rad
    assert np.abs(np.diff(heading)).max() < 0.02
    assert heading[20] == pytest.approx(math.pi)


def test_without_headings_the_tangent_counts_and_stands_still_with_the_actor():
    rows = [(0, 0, 0, None), (1, 10, 0, None), (3, 10, 0, None), (4, 10, 10, None)]
    motion = v1(scenario(V1, event("e", follow(rows, timing()), at(0))))
    assert row(motion, 0.5)[2] == pytest.approx(0, abs=0.8)
    assert row(motion, 2.0)[2] == pytest.approx(math.pi / 2)
    assert np.isfinite(motion.heading_rad).all()


@pytest.mark.parametrize(("reference", "start", "arrives"), [
    (timing("absolute"), 1.0, 2.0), (timing("relative"), 1.0, 3.0), (timing("relative", scale=0.5), 1.0, 2.0),
    (timing("absolute", offset=0.5), 1.0, 2.5), (timing("relative", scale=0.5, offset=1), 1.0, 3.0),
])  # fmt: skip
def test_times_are_scaled_moved_and_counted_from_where_the_domain_says(reference, start, arrives):
    motion = v1(scenario(V1, event("e", follow(LINE[:2], reference), at(start))))
    assert motion.t_s[np.flatnonzero(motion.x_m >= 20 - 1e-9)[0]] == pytest.approx(arrives)


def test_behind_its_last_vertex_an_actor_keeps_its_speed():
    motion = v1(scenario(V1, event("e", follow(LINE[:2], timing()), at(0))))
    assert row(motion, 4.0) == pytest.approx((40, 0, 0, 10))


def test_an_untimed_trajectory_is_driven_at_the_own_speed():
    corner = follow([(None, 0, 0, None), (None, 10, 0, None), (None, 10, 30, None)])
    motion = v1(scenario(V1, event("e", corner, at(1)), {"V1": 10}))
    assert row(motion, 1.0) == pytest.approx((10, 0, 0, 10)), "still where it was before the action"
    assert row(motion, 1.05) == pytest.approx((0.5, 0, 0, 10))
    assert row(motion, 2.5) == pytest.approx((10, 5, math.pi / 2, 10))


def test_the_speed_at_a_blow_is_that_before_it() -> None:
    times = np.arange(0.0, 2.01, 0.05)
    x = np.where(times < 1.0, 0.0, 8.0 * (times - 1.0))
    struck = TimedMotion(times, np.column_stack((x, 0 * x)), 0 * x, (0, 0.05))
    assert struck.speed(20) == pytest.approx(0.0)
    assert struck.speed(21) == pytest.approx(8.0)
    braking = TimedMotion(times, np.column_stack((10 * times - 2.0 * times**2, 0 * x)), 0 * x, (0, 0.05))
    assert braking.speed(20) == pytest.approx(6.0, abs=0.01)
