"""UN R157's models, against the times and formulas of the regulation."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from plugins.driver._careful import Careful
from plugins.driver._fuzzy import FuzzyParameters, critical, proactive
from plugins.driver.reference import Reference
from tests.plugins.driver.seats import ride, task, user, view

SAY = FuzzyParameters()
FULL = 0.774 * 9.81


def first_braking(rows, least=0.05):
    return float(rows[rows[:, 3] < -least][0, 0])


def test_a_standing_car_is_braked_for_three_quarters_of_a_second_after_two_seconds_to_collision():
    """At 20 m/s and 100 m the time to collision is 2 s at 3 s; perceived long before, so the foot comes at 3.75 s."""
    rows = ride(Reference().take_over(task(20.0)), task(20.0), lambda t: [user(x=100.0 + 4.7)])
    assert first_braking(rows) == pytest.approx(3.75, abs=0.11)


def test_full_braking_is_reached_in_six_tenths_of_a_second_at_the_given_jerk():
    rows = ride(Reference().take_over(task(20.0)), task(20.0), lambda t: [user(x=104.7)])
    onset = first_braking(rows)
    jerk = -np.diff(rows[rows[:, 0] >= onset][:5, 3]) / 0.05
    assert jerk == pytest.approx(12.65, rel=1e-6)
    full = rows[rows[:, 3] <= -FULL + 1e-6][0, 0]
    assert full - onset == pytest.approx(0.6, abs=0.06)
    assert rows[:, 3].min() == pytest.approx(-FULL)


def test_a_risk_is_evaluated_for_four_tenths_of_a_second_from_a_third_of_a_metre_on():
    """A car beside the strip comes over at 1 m/s from 1 s on: 0.375 m at 1.375 s, evaluated at 1.775 s."""
    seen = Careful(task(20.0))
    for k in range(60):
        t = k * 0.05
        came = max(t - 1.0, 0.0)
        course = -math.pi / 2 if t > 1.0 else 0.0
        at = user(x=20.0 * t + 30.0, y=8.0 - came, speed=1.0 if t > 1.0 else 0.0, course=course)
        if seen._perceived(view(task(20.0), t, 20.0 * t, others=[at])):
            break
    assert t == pytest.approx(1.0 + 0.375 + 0.4, abs=0.11)


def test_who_passes_aside_is_no_risk():
    rows = ride(Reference().take_over(task(20.0)), task(20.0), lambda t: [user(x=100.0, y=3.5)])
    assert rows[:, 3] == pytest.approx(0.0, abs=1e-6)


def test_without_danger_the_reports_driver_goes_on():
    rows = ride(Reference(model="fuzzy").take_over(task(15.0)), task(15.0), lambda t: [])
    assert rows[:, 2] == pytest.approx(15.0)


@pytest.mark.parametrize(
    ("gap", "expected"),
    [
        # own 20, other 20: safe 15 + 50 - 28.571 + 2 = 38.429, unsafe 15 + 33.333 - 28.571 = 19.762; margin 2
        (41.0, 0.0),
        (21.0, 1.0),
        (2 + (38.429 + 19.762) / 2, 0.5),
    ],
)
def test_the_proactive_metric_is_the_published_formula(gap, expected):
    assert proactive(gap, 20.0, 20.0, SAY) == pytest.approx(expected, abs=1e-3)


def test_the_critical_metric_is_the_published_formula():
    """Own 20, other 10, steady: safe 7.5 + 12.5 = 20, unsafe 7.5 + 8.333 = 15.833."""
    assert critical(20.1, 20.0, 10.0, 0.0, SAY) == 0.0
    assert critical(15.8, 20.0, 10.0, 0.0, SAY) == 1.0
    assert critical((20 + 15.8333) / 2, 20.0, 10.0, 0.0, SAY) == pytest.approx(0.5, abs=1e-3)
    assert critical(1.0, 10.0, 10.0, 0.0, SAY) == 0.0


@given(gap=st.floats(0, 200), own=st.floats(0, 40), other=st.floats(0, 40), a=st.floats(-8, 3))
def test_both_metrics_stay_within_0_and_1_and_fall_with_the_gap(gap, own, other, a):
    for metric in (lambda g: proactive(g, own, other, SAY), lambda g: critical(g, own, other, a, SAY)):
        near, far = metric(gap), metric(gap + 5.0)
        assert 0.0 <= far <= near <= 1.0


def test_the_fuzzy_driver_brakes_gently_where_he_sees_it_coming():
    """A slower car far ahead: comfortable braking, and no contact."""
    rows = ride(
        Reference(model="fuzzy").take_over(task(20.0)), task(20.0), lambda t: [user(x=90.0 + 10 * t, speed=10.0)], 14.0
    )
    assert rows[:, 3].min() >= -4.01
    assert (90.0 + 10 * rows[:, 0] - rows[:, 1]).min() > 4.7


# ------------------------------------------------------------------ cut-ins, as the authors' own program ends them
LENGTH, WIDTH, BESIDE_M = 4.3, 1.9, 1.6
CRASHES = [(15, 8, 2.0, 5), (25, 8, 2.0, 5), (15, 8, 1.5, 10), (15, 12, 1.5, 5), (25, 12, 1.0, 20), (35, 5, 1.0, 5),
           (20, 16, 2.0, 20), (20, 16, 1.5, 15)]  # fmt: skip
"""Speed of the ego, how much slower the other is, its lateral speed (m/s), the gap (m): random ones of 672."""
AVOIDED = [(25, 5, 2.0, 10), (15, 12, 0.5, 5), (30, 16, 0.5, 20), (15, 8, 1.5, 60), (15, 12, 2.0, 30), (35, 2, 0.5, 60),
           (30, 8, 0.5, 20), (35, 12, 1.0, 40)]  # fmt: skip


def touches(model, own, slower, aside_mps, gap):
    """Whether the ego runs into one who cuts in from the left and then stays before it."""
    made = task(own)

    def cutting_in(t):
        y = max(BESIDE_M + WIDTH - aside_mps * t, 0.0)
        ahead_mps, left_mps = own - slower, -aside_mps if y > 0 else 0.0
        speed, course = math.hypot(ahead_mps, left_mps), math.atan2(left_mps, ahead_mps)
        x = gap + LENGTH + ahead_mps * t
        return user(x=x, y=y, speed=speed, course=course, length=LENGTH, width=WIDTH)._replace(heading_rad=0.0)

    made = dataclasses.replace(made, ego=made.ego._replace(length_m=LENGTH, width_m=WIDTH))
    rows = ride(Reference(model=model).take_over(made), made, lambda t: [cutting_in(t)], 34.0)
    there = np.array([(cutting_in(t).x_m, cutting_in(t).y_m) for t in rows[:, 0]])
    return bool(((np.abs(there[:, 0] - rows[:, 1]) < LENGTH) & (there[:, 1] < WIDTH)).any())


@pytest.mark.parametrize("cut_in", CRASHES)
def test_the_fuzzy_driver_meets_those_that_its_authors_driver_meets(cut_in):
    assert touches("fuzzy", *cut_in)


@pytest.mark.parametrize("cut_in", AVOIDED)
def test_the_fuzzy_driver_avoids_those_that_its_authors_driver_avoids(cut_in):
    assert not touches("fuzzy", *cut_in)


def test_who_stays_in_the_lane_that_it_came_into_is_braked_for():
    """At 2 m/s sideways its course leads through the lane, but a car that comes into a lane means to stay there."""
    assert not touches("careful", 15, 5, 2.0, 15)


def test_after_braking_the_fuzzy_driver_does_not_speed_up_towards_who_made_him_brake():
    made = task(20.0)
    leader = [user(x=60.0 + 12.0 * t, speed=12.0) for t in np.arange(0, 20, 0.05)]
    rows = ride(Reference(model="fuzzy").take_over(made), made, lambda t: [leader[round(t / 0.05)]], 19.0)
    assert first_braking(rows) > 0
    assert (np.diff(rows[rows[:, 0] >= first_braking(rows), 2]) <= 1e-9).all()
