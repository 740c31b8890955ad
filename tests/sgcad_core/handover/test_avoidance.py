"""What could still have been done, against closed answers and a brute-force sweep."""

import math

import numpy as np
import pytest

from sgcad_core.geometry.plane import Box, overlap
from sgcad_core.handover.avoidance import avoidance
from sgcad_core.handover.script import staging_for
from tests.sgcad_core.handover.scenes import LENGTH, WIDTH, crossing, rear_end

FULL = 0.85 * 9.81


def test_behind_a_standing_car_braking_must_begin_v_over_2a_before():
    found = avoidance(staging_for(rear_end(own=20.0), "V1"))
    assert found.brake_by_s == pytest.approx(20.0 / (2 * FULL), abs=0.051)
    assert found.brake_by_m == pytest.approx(20.0**2 / (2 * FULL), abs=1.1)
    assert found.required_mps2["2"] == pytest.approx(20.0 / (2 * 2.0), abs=0.05)
    assert found.required_mps2["0.5"] is None


def test_behind_a_moving_car_only_the_difference_of_speeds_counts():
    found = avoidance(staging_for(rear_end(own=20.0, other=8.0), "V1"))
    assert found.brake_by_s == pytest.approx(12.0 / (2 * FULL), abs=0.051)
    assert found.required_mps2["2"] == pytest.approx(12.0 / (2 * 2.0), abs=0.05)


def test_on_ice_braking_must_begin_earlier_than_was_looked():
    assert avoidance(staging_for(crossing(own=20.0, surface="ice"), "V1")).full_braking_mps2 == pytest.approx(0.981)


def test_steering_around_a_standing_car_needs_the_time_to_come_a_width_aside():
    """Half of a lane change of 3.5 m at 0.7 of the friction is enough to pass 1.8 m of width; never later than that."""
    found = avoidance(staging_for(rear_end(own=20.0), "V1"))
    lateral = 0.7 * FULL
    assert found.steer_by_s == pytest.approx(math.sqrt(2 * WIDTH / lateral), abs=0.16)
    assert found.steer_to == "left"


@pytest.mark.parametrize(("own", "other"), [(8.0, 14.0), (14.0, 6.0), (20.0, 20.0)])
def test_the_required_deceleration_is_what_a_sweep_of_a_millisecond_finds(own, other):
    """Of crossing cars: the least constant deceleration from 2 s before on with which the boxes never meet."""
    found = avoidance(staging_for(crossing(own, other), "V1")).required_mps2["2"]
    least = next(a for a in np.arange(0.0, FULL + 0.02, 0.02) if _misses(own, other, a))
    assert found == pytest.approx(least, abs=0.06)


def _misses(own, other, deceleration):
    start = -(WIDTH + LENGTH) / 2 + 0.02 - 2.0 * own
    for t in np.arange(0.0, 6.0, 0.001):
        ran = min(t, own / max(deceleration, 1e-9))
        x = start + own * ran - deceleration * ran**2 / 2
        y = other * (t - 2.0)
        if abs(x) < 6 and abs(y) < 6 and overlap(Box(x, 0, 0, LENGTH, WIDTH), Box(0, y, math.pi / 2, LENGTH, WIDTH)):
            return False
    return True
