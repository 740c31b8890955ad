"""A vehicle that strikes a pole slows over a distance, gains nothing by it, and lies in nothing at the end."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import Floats, Size, box_gaps
from sgcad_core.planner.aftermath.crush import DEEPEST_M
from sgcad_core.planner.aftermath.ground_friction import Drag
from sgcad_core.planner.aftermath.impact import body
from sgcad_core.planner.aftermath.wreck import Wreck
from sgcad_core.planner.aftermath.wreck_bodies import Mover, Touch
from sgcad_core.planner.motion import STEP_S

CAR, POLE, COUNT, DRAG = (4.7, 1.8), (0.4, 0.4), 180, Drag(4.5, 7.0)


def struck(speed: float, aside: float, size: Size = POLE, of: Size = CAR) -> tuple[Floats, Floats, list[Touch]]:
    """Poses of a vehicle that drives at a thing that stays, the gaps, and the touches."""
    t = np.arange(COUNT)[:, None] * STEP_S
    script = np.array([-20.0, 0.0, 0.0]) + t * np.array([speed, 0.0, 0.0])
    stands = np.repeat([[0.0, aside, 0.0]], COUNT, axis=0)
    movers = (
        Mover("V1", body((0.0, 0.0, 0.0), of, 1450.0), script, DRAG),
        Mover("O1", body((0.0, 0.0, 0.0), size, None), stands, DRAG),
    )
    poses, touches = Wreck(movers, COUNT).settle()
    assert np.array_equal(poses["O1"], stands)
    return poses["V1"], box_gaps(poses["V1"], of, stands, size), touches


def speeds(poses: Floats) -> Floats:
    found: Floats = np.hypot(*np.diff(poses[:, :2], axis=0).T) / STEP_S
    return found


@pytest.mark.parametrize(("speed", "least"), [(10.0, 0.4), (15.0, 0.6)])
def test_a_car_crushes_at_a_pole_and_slows_over_more_than_a_sample(speed: float, least: float) -> None:
    poses, gaps, touches = struck(speed, 0.0)
    assert len(touches) == 1
    assert least < -gaps.min() <= DEEPEST_M + 0.05
    slowing = np.flatnonzero(np.abs(np.diff(speeds(poses))) > 0.1 * speed)
    assert slowing[-1] - slowing[0] >= 1
    assert np.abs(np.diff(speeds(poses))).max() < 0.7 * speed
    assert gaps[-1] > 0.0


@settings(max_examples=25, deadline=None)
@given(st.floats(6.0, 35.0), st.floats(-0.9, 0.9))
def test_no_energy_comes_of_a_crush_and_nothing_lies_in_the_pole_at_the_end(speed: float, aside: float) -> None:
    poses, gaps, _ = struck(speed, aside)
    hit = int(np.flatnonzero(gaps <= 0.0)[0])
    assert speeds(poses)[hit:].max() <= speed * (1 + 1e-9)
    assert -gaps.min() <= DEEPEST_M + 0.15
    assert gaps[-1] > 0.0
    assert speeds(poses)[-3:].max() < 0.2


def test_a_blow_off_the_middle_turns_the_car_about_the_pole() -> None:
    left, right = (struck(15.0, aside)[0] for aside in (0.6, -0.6))
    assert left[-1, 2] > 0.2
    assert right[-1, 2] == pytest.approx(-left[-1, 2], abs=0.05)


def test_walls_and_slow_touches_take_no_crush() -> None:
    assert -struck(15.0, 0.0, size=(0.5, 5.0))[1].min() < 0.06
    assert -struck(4.0, 0.0)[1].min() < 0.06
    assert -struck(15.0, 0.0, of=(1.8, 0.6))[1].min() < 0.06


@pytest.mark.parametrize("speed", [8.0, 15.6, 25.0])
@pytest.mark.parametrize("aside", [-0.6, 0.0, 0.4])
def test_a_car_comes_off_the_pole_at_once_and_does_not_creep(speed: float, aside: float) -> None:
    poses, gaps, _ = struck(speed, aside)
    hit, moving = int(np.flatnonzero(gaps <= 0.0)[0]), np.flatnonzero(speeds(poses) > 0.02)
    assert (moving[-1] - hit) * STEP_S < 1.5
    assert gaps[-1] > 0.0
