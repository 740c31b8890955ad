"""Fronts that meet head on in a small part of them glance off each other: both go on, pushed apart."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import box_gaps
from sgcad_core.planner.aftermath.crush import corner_of, glance, meet_in_part, slanted
from sgcad_core.planner.aftermath.ground_friction import Drag
from sgcad_core.planner.aftermath.impact import IMPACTS, USUAL, Body, Impact, body
from sgcad_core.planner.aftermath.wreck import Wreck
from sgcad_core.planner.aftermath.wreck_bodies import Mover, separation
from sgcad_core.planner.motion import STEP_S

CAR = (4.7, 1.8)
SLANTED = Impact(0.1, 0.1, math.radians(45.0))
COUNT = 160
SLANTS = [impact for impact in IMPACTS if impact.glance_rad]


def oncoming(beside_m: float, mps: float = 20.0, closer_m: float = 0.02) -> tuple[Body, Body]:
    """Two cars head on, the second one `beside_m` to the left of the first, as they come to touch."""
    a, b = body((0.0, 0.0, 0.0), CAR, 1500.0), body((4.7 - closer_m, beside_m, math.pi), CAR, 1500.0)
    a.vx, b.vx = mps, -mps
    return a, b


def energy(*bodies: Body) -> float:
    return sum(one.energy for one in bodies)


@settings(max_examples=100, deadline=None)
@given(st.floats(0.95, 1.6), st.sampled_from([-1.0, 1.0]), st.floats(5.5, 40.0), st.sampled_from(SLANTS))
def test_those_that_glance_go_on_apart_and_lose_energy(beside, side, mps, impact):
    a, b = oncoming(side * beside, mps)
    before = energy(a, b)
    assert glance(a, b, separation(a, b), impact)
    assert energy(a, b) <= before * (1 + 1e-9)
    assert a.vx + b.vx == pytest.approx(0.0, abs=1e-6)
    assert a.vy + b.vy == pytest.approx(0.0, abs=1e-6)
    assert a.vx > 0.0  # it goes on
    assert a.vy * side < 0.0  # away from the other one


@pytest.mark.parametrize(("beside", "met"), [(0.0, False), (0.7, False), (1.0, True), (1.5, True)])
def test_only_fronts_that_meet_in_part_glance(beside: float, met: bool) -> None:
    a, b = oncoming(beside)
    poses = [(np.array([one.x, one.y, one.heading]), one.size) for one in (a, b)]
    assert meet_in_part(*poses) is met
    assert glance(a, b, separation(a, b), SLANTED) is met


def test_the_side_of_a_vehicle_and_a_gentle_touch_do_not_glance() -> None:
    a, b = oncoming(1.2)
    b.heading = math.pi / 2
    assert corner_of(a, b, separation(a, b).normal) is None
    slow, locked = oncoming(1.2, 2.0), oncoming(1.2)
    assert not glance(*slow, separation(*slow), SLANTED)
    assert not glance(*locked, separation(*locked), USUAL)


@given(st.sampled_from([-1.0, 1.0]), st.floats(0.0, 1.5))
def test_a_slanted_normal_keeps_its_length_and_turns_to_the_touched_half(left, slant):
    a, _ = oncoming(0.0)
    x, y = slanted(a, (2.35, left), (1.0, 0.0), slant)
    assert math.hypot(x, y) == pytest.approx(1.0)
    assert math.atan2(y, x) == pytest.approx(math.copysign(slant, left))


def settled(impact: Impact) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) poses of two cars whose fronts meet in a third of their width at 20 m/s each."""
    x = -20.0 + 20.0 * STEP_S * np.arange(COUNT)
    still = np.zeros(COUNT)
    movers = [
        Mover(name, body((0.0, 0.0, 0.0), CAR, 1500.0), script, Drag(4.5, 7.0))
        for name, script in (
            ("V1", np.column_stack((x, still, still))),
            ("V2", np.column_stack((-x, still + 1.2, still + math.pi))),
        )
    ]
    poses, _ = Wreck(movers, COUNT, impact=impact).settle()
    return poses["V1"], poses["V2"]


def test_cars_that_glance_pass_each_other_and_locked_ones_stop_where_they_met() -> None:
    locked, passed = settled(Impact(0.5, 0.1)), settled(SLANTED)
    assert locked[0][-1, 0] < locked[1][-1, 0]
    assert passed[0][-1, 0] > passed[1][-1, 0] + CAR[0]
    gaps = box_gaps(passed[0], CAR, passed[1], CAR)
    assert gaps[-1] > 0.0
    assert gaps.min() > -0.35  # what a corner crushes
