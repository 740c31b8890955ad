"""A blow off the center turns a body, and what two that hold each other lack is given back once they part."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.planner.aftermath.blow import blow, lacking, most_restitution, part
from sgcad_core.planner.aftermath.ground_friction import Drag
from sgcad_core.planner.aftermath.impact import Body, Impact, body
from sgcad_core.planner.aftermath.wreck import Wreck
from sgcad_core.planner.aftermath.wreck_bodies import Mover
from sgcad_core.planner.motion import STEP_S

CAR = (4.7, 1.8)
COUNT = 160


def moving(mps: float, heading: float = 0.0, x: float = 0.0, y: float = 0.0) -> Body:
    one = body((x, y, heading), CAR, 1500.0)
    one.vx, one.vy = mps * math.cos(heading), mps * math.sin(heading)
    return one


@settings(max_examples=100, deadline=None)
@given(st.floats(2, 40), st.floats(-0.9, 0.9), st.floats(0, 0.3), st.floats(0.1, 0.6))
def test_a_pole_before_one_half_turns_a_car_to_that_side(mps, left_m, restitution, friction):
    car, pole = moving(mps), body((2.5, left_m, 0.0), (0.3, 0.3), None)
    after = blow((car, pole), ((2.35, left_m), (1.0, 0.0)), Impact(friction, restitution)).first
    assert after[2] * left_m >= 0.0
    assert abs(after[2]) > 0.1 * mps * abs(left_m) - 1e-9
    assert (car.vx, car.vy, car.spin) == (mps, 0.0, 0.0)


def test_two_that_meet_fast_head_on_are_hardly_thrown_back() -> None:
    touch, impact = ((2.35, 0.0), (1.0, 0.0)), Impact(0.5, 0.3)
    slow, fast = (blow((moving(v), moving(v, math.pi, 4.7)), touch, impact).first[0] for v in (1.0, 20.0))
    assert slow == pytest.approx(-0.3, abs=0.02)
    assert -2.5 < fast < 0.0
    assert most_restitution(3.0) > 2 * most_restitution(9.0)


def test_what_is_lacking_is_what_makes_a_body_move_as_wanted() -> None:
    one, other = moving(12.0), moving(0.0, math.pi / 2, 3.0)
    wanted = blow((one, other), ((2.35, 0.5), (1.0, 0.0)), Impact(0.5, 0.1))
    one.vx = other.vx = 6.0
    part(lacking(wanted, one, other), one, other)
    assert (one.vx, one.vy, one.spin) == pytest.approx(wanted.first)
    assert (other.vx, other.vy, other.spin) == pytest.approx(wanted.second)


def settled(pole_left_m: float, mps: float = 15.0) -> np.ndarray:
    """(n, 3) poses of a car that drives east into a pole whose center is beside the middle of its front."""
    x = -20.0 + mps * STEP_S * np.arange(COUNT)
    script = np.column_stack((x, np.zeros(COUNT), np.zeros(COUNT)))
    car = Mover("V1", body((0.0, 0.0, 0.0), CAR, 1500.0), script, Drag(4.5, 7.0))
    stands = np.tile([5.0, pole_left_m, 0.0], (COUNT, 1))
    pole = Mover("O1", body((0.0, 0.0, 0.0), (0.3, 0.3), None), stands, Drag(1.0, 1.0))
    return Wreck((car, pole), COUNT, impact=Impact(friction=0.1)).settle()[0]["V1"]


@pytest.mark.parametrize("left_m", [0.4, -0.4, 0.65, -0.65])
def test_a_car_that_meets_a_pole_off_its_middle_is_turned_about_it(left_m: float) -> None:
    turned = settled(left_m)[-1, 2]
    assert turned * left_m > 0
    assert abs(math.degrees(turned)) > 8.0


def test_the_further_off_the_middle_the_more_it_turns() -> None:
    assert settled(0.65)[-1, 2] > settled(0.3)[-1, 2] > settled(0.0)[-1, 2] - 1e-6
