"""A vehicle that is told to turn out of control one way does not do so the other way."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.encounter.meeting_place import Place
from sgcad_core.planner.lines import box_angles
from sgcad_core.planner.lines.actor_course import find_course
from sgcad_core.records.course import CourseTold, Spin, sense_of
from sgcad_core.records.specs import Area
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_plan_rules import actor

COURSE = find_course(network("straight"), actor("V1", "straight", "S", "N"))


def role(yaws: Spin | None, *, may_skid: bool = True, side: Area = "front") -> Role:
    """One that drives straight on, to what stands ahead."""
    return Role(actor("V1", "straight", "S", "N"), COURSE, (4.7, 1.8), Place(100.0, 0.0, 0.0, 0.0), side,
                may_skid=may_skid, told=CourseTold(yaws=yaws))  # fmt: skip


@given(st.floats(-math.pi, math.pi))
def test_the_box_ends_at_the_same_angle(angle: float) -> None:
    for yaws in ("clockwise", "counterclockwise", None):
        turned = box_angles._as_told(role(yaws), angle)
        assert math.cos(turned - angle) == pytest.approx(1.0)
        assert abs(turned) <= 1.5 * math.pi


@pytest.mark.parametrize(("yaws", "deg", "turned"), [
    ("clockwise", 170, -190), ("counterclockwise", 170, 170), ("counterclockwise", -100, 260), ("clockwise", 40, 40),
    (None, -170, -170),
])  # fmt: skip
def test_a_far_turn_goes_the_told_way_round(yaws: Spin | None, deg: float, turned: float) -> None:
    found = box_angles._as_told(role(yaws), math.radians(deg))
    assert math.degrees(found) == pytest.approx(turned)
    assert box_angles._as_told(role(yaws, may_skid=False), math.radians(deg)) == math.radians(deg)


def test_a_skid_the_other_way_costs_more() -> None:
    cost = {
        yaws: next(t.cost for t in box_angles._turned(role(yaws), 1.0, 0.0) if t.skids)
        for yaws in ("counterclockwise", "clockwise", None)
    }
    assert cost["counterclockwise"] < cost[None] < cost["clockwise"]


def test_one_that_is_told_to_turn_out_of_control_first_slips_a_little_that_way() -> None:
    first = box_angles._straight(role("clockwise"))[0]
    assert first.skids
    assert -math.radians(45) < first.angle_rad < 0.0
    assert [t.angle_rad for t in box_angles._straight(role(None))] == [0.0]
    steered = [
        next(t.cost for t in box_angles._turned(role(yaws), 1.0, 0.0) if not t.skids)
        for yaws in ("counterclockwise", None)
    ]
    assert steered[0] > steered[1]


@pytest.mark.parametrize(("yaws", "side", "deg"), [
    ("counterclockwise", "right", 90), ("clockwise", "left", -90), ("clockwise", "back", -180),
    ("counterclockwise", "left", 270), ("clockwise", "right", -270),
])  # fmt: skip
def test_a_told_skid_turns_until_the_told_side_leads(yaws: Spin, side: Area, deg: float) -> None:
    found = box_angles.told_skids(role(yaws, side=side))
    assert math.degrees(found[0].angle_rad) == pytest.approx(deg)
    assert all(t.told and t.skids and sense_of(yaws) * t.angle_rad > 0.0 for t in found)


def test_nothing_skids_as_told_without_a_told_turn() -> None:
    assert box_angles.told_skids(role(None)) == []
    assert box_angles.told_skids(role("clockwise", may_skid=False)) == []
