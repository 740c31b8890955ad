"""A told rollover: it lies as told, rolls the way it slides, no faster than vehicles do, and stands in every file."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flows.case_files import case_folder
from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.metrics.rest_error import attitude_of
from sgcad_core.planner.aftermath.rollover import (
    TRIPPED_S,
    barrel_costs,
    quarters_short,
    roll_angles,
    rolls_over,
    turned_over,
)
from sgcad_core.records.course import CourseTold, RestTold

attitudes = st.sampled_from(["wheels", "roof", "left", "right"])


def sliding(left_mps: float, count: int = 160) -> np.ndarray:
    """Eastbound at 12 m/s and sideways, slower and slower."""
    fade = np.linspace(1.0, 0.0, count)
    x, y = (np.concatenate(([0.0], np.cumsum(v * fade[1:] * 0.05))) for v in (12.0, left_mps))
    return np.column_stack((x, y, np.zeros(count)))


def told(attitude: str | None) -> CourseTold:
    return CourseTold(rolls=True, rest=RestTold(attitude=attitude))


@settings(max_examples=60, deadline=None)
@given(attitudes, st.floats(-8, 8), st.integers(2, 60))
def test_it_lies_as_told_and_rolls_the_way_it_slides(attitude, left_mps, hit):
    roll = roll_angles(sliding(left_mps), hit, told(attitude))
    assert attitude_of(float(roll[-1])) == attitude
    assert not roll[: hit + round(TRIPPED_S / 0.05)].any()
    assert np.abs(np.diff(roll)).max() <= math.radians(410.0) * 0.05
    assert (np.diff(np.abs(roll)) >= -1e-9).all()
    if abs(left_mps) > 1.0:
        assert (roll[-1] < 0) == (left_mps > 0)  # positive is to the right


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 12), st.sampled_from(["left", "right"]), st.floats(-8, 8))
def test_it_rolls_as_often_as_told_with_the_told_side_leading(quarters, hand, left_mps):
    course = CourseTold(rolls=True, roll_quarters=quarters, rolls_to=hand)
    roll = roll_angles(sliding(left_mps), 10, course)
    assert float(roll[-1]) == pytest.approx(quarters * math.pi / 2 * (1 if hand == "right" else -1))
    assert np.abs(np.diff(roll)).max() <= math.radians(410.0) * 0.05


@given(st.sampled_from([1, 3, 5]), st.sampled_from(["left", "right"]), st.floats(-8, 8))
def test_quarter_turns_without_a_leading_side_end_as_it_is_told_to_lie(quarters, attitude, left_mps):
    course = CourseTold(rolls=True, roll_quarters=quarters, rest=RestTold(attitude=attitude))
    assert attitude_of(float(roll_angles(sliding(left_mps), 10, course)[-1])) == attitude


@pytest.mark.parametrize(("way_m", "quarters"), [(0.1, 1), (3.5, 1), (5.2, 5), (60.0, 9)])
def test_it_rolls_no_more_often_than_its_way_allows(way_m, quarters):
    course = CourseTold(rolls=True, roll_quarters=9, rolls_to="right")
    poses = np.column_stack((np.linspace(0.0, way_m, 160), np.zeros((160, 2))))
    assert float(roll_angles(poses, 0, course)[-1]) == pytest.approx(quarters * math.pi / 2, abs=0.01)


@pytest.mark.parametrize(("way_m", "short"), [(0.1, 8), (5.2, 4), (60.0, 0)])
def test_a_way_is_short_by_the_quarter_turns_that_it_does_not_allow(way_m, short):
    poses = np.column_stack((np.linspace(0.0, way_m, 160), np.zeros((160, 2))))
    assert quarters_short(poses, 0, CourseTold(rolls=True, roll_quarters=9)) == short
    assert quarters_short(poses, 0, CourseTold(rolls=True)) == 0


def test_without_a_told_end_it_comes_to_lie_on_the_side_to_which_it_slides():
    assert attitude_of(float(roll_angles(sliding(3.0), 10, told(None))[-1])) == "left"
    assert attitude_of(float(roll_angles(sliding(-3.0), 10, told(None))[-1])) == "right"


def test_one_who_stands_where_it_is_struck_still_lies_as_told_in_the_end():
    roll = roll_angles(np.zeros((100, 3)), 20, told("roof"))
    assert attitude_of(float(roll[-1])) == "roof"


@pytest.mark.parametrize(
    ("course", "rolls"),
    [
        (CourseTold(), False), (CourseTold(rolls=True), True), (CourseTold(rest=RestTold(attitude="wheels")), False),
        (CourseTold(rest=RestTold(attitude="left")), True),
    ],
)  # fmt: skip
def test_who_rolls_over(course, rolls):
    assert rolls_over(course) == rolls


# ------------------------------------------------------------------ files
def motion(name: str, roll: np.ndarray | None) -> Trajectory:
    poses, t = sliding(2.0), np.arange(160) * 0.05
    speed = np.hypot(*np.gradient(poses[:, :2], 0.05, axis=0).T)
    return Trajectory(
        actor=name, t_s=t, x_m=poses[:, 0], y_m=poses[:, 1] + (9.0 if name == "V2" else 0.0),
        heading_rad=poses[:, 2], speed_mps=speed, roll_rad=roll,
    )  # fmt: skip


def actors() -> list[ActorInfo]:
    return [ActorInfo(id=n, type="car", length_m=4.7, width_m=1.8, maneuver="straight") for n in ("V1", "V2")]


def test_the_roll_stands_in_the_scenario_and_is_played():
    roll = roll_angles(sliding(2.0), 10, told("roof"))
    text = write_xosc(actors(), [motion("V1", roll), motion("V2", None)], None)
    first, second = play(text)
    assert np.abs(first.rolls - roll).max() < math.radians(3.0)
    assert attitude_of(float(first.rolls[-1])) == "roof"
    assert second.roll_rad is None
    assert not second.rolls.any()
    assert 'z="1.5"' in text  # a car on its roof: its origin, between the wheels, lies a car's height above the ground
    assert " r=" not in write_xosc(actors(), [motion("V1", None), motion("V2", None)], None)


def test_the_roll_is_a_column_where_somebody_rolls(tmp_path):
    roll = roll_angles(sliding(2.0), 10, told("left"))
    file = tmp_path / "trajectories.csv"
    case_folder.write_trajectories(file, [motion("V1", roll), motion("V2", None)])
    first, second = case_folder.read_trajectories(file)
    assert first.rolls == pytest.approx(roll, abs=1e-4)
    assert not second.rolls.any()
    case_folder.write_trajectories(file, [motion("V1", None)])
    assert "roll_rad" not in file.read_text()
    assert case_folder.read_trajectories(file)[0].roll_rad is None


# ------------------------------------------------------------------ what leads
def sliding_at(slip_deg: float) -> np.ndarray:
    """Eastbound, the box turned by so many degrees against its way."""
    poses = sliding(0.0)
    poses[:, 2] = math.radians(slip_deg)
    return poses


def test_a_roll_with_the_front_ahead_is_a_fault_and_one_with_a_side_ahead_is_none() -> None:
    ways = np.stack([sliding_at(slip) for slip in (0.0, 20.0, 90.0, -90.0)], axis=1)
    forward, slightly, left, right = barrel_costs(told(None), ways)
    assert forward > slightly > left == right == 0.0


@pytest.mark.parametrize(("hand", "slip_deg"), [("right", 90.0), ("left", -90.0)])
def test_the_told_side_must_lead(hand, slip_deg) -> None:
    course = CourseTold(rolls=True, rolls_to=hand)
    ways = np.stack([sliding_at(slip_deg), sliding_at(-slip_deg)], axis=1)
    right, wrong = barrel_costs(course, ways)
    assert right == 0.0 < wrong


def test_a_vehicle_that_is_not_told_to_roll_may_go_on_with_its_front_ahead() -> None:
    assert not barrel_costs(CourseTold(), sliding_at(0.0)[:, None]).any()


@pytest.mark.parametrize(("course", "sign"), [
    (CourseTold(rolls=True, rolls_to="left"), -1), (CourseTold(rolls=True, rolls_to="right"), 1),
    (CourseTold(rolls=True, rest=RestTold(attitude="left")), -1), (CourseTold(rolls=True, spin="counterclockwise"), 1),
])  # fmt: skip
def test_one_that_touches_nothing_turns_until_a_side_leads(course, sign) -> None:
    poses = turned_over(sliding(0.0), 20, course)
    assert not poses[:21, 2].any()
    assert math.degrees(float(poses[-1, 2])) * sign == pytest.approx(65.0)
    assert barrel_costs(course, poses[20:, None])[0] == 0.0


def test_it_slides_until_a_side_leads_and_rolls_then() -> None:
    turning = sliding(0.0)
    turning[:, 2] = np.radians(np.clip((np.arange(160) - 10) * 3.0, 0.0, 90.0))
    began = [int(np.flatnonzero(roll_angles(poses, 10, told("roof")))[0]) for poses in (sliding(0.0), turning)]
    assert began[0] < began[1] < 40


def test_it_rolls_behind_the_contacts_that_are_told_before_the_roll() -> None:
    for after, least in ((1, 10), (2, 60), (3, 60)):
        course = CourseTold(rolls=True, rolls_after=after, rest=RestTold(attitude="roof"))
        began = int(np.flatnonzero(roll_angles(sliding(0.0), 10, course, (10, 60, 159)))[0])
        assert began == pytest.approx(least + round(TRIPPED_S / 0.05), abs=2)
