"""A vehicle that is told to turn out of control one way does not do so the other way."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.planner.lines import box_angles
from sgcad_core.records.course import CourseTold, Spin


def role(yaws: Spin | None, *, may_skid: bool = True) -> SimpleNamespace:
    """What the angles ask of an actor that drives straight on."""
    actor = SimpleNamespace(maneuver="straight", record=SimpleNamespace(thing=False))
    return SimpleNamespace(told=CourseTold(yaws=yaws), may_skid=may_skid, actor=actor, size=(4.7, 1.8),
                           place=SimpleNamespace(aside_m=0.0))  # fmt: skip


@given(st.floats(-math.pi, math.pi))
def test_the_box_ends_at_the_same_angle(angle: float) -> None:
    for yaws in ("clockwise", "counterclockwise", None):
        turned = box_angles._as_told(role(yaws), angle)  # type: ignore[arg-type]
        assert math.cos(turned - angle) == pytest.approx(1.0)
        assert abs(turned) <= 1.5 * math.pi


@pytest.mark.parametrize(("yaws", "deg", "turned"), [
    ("clockwise", 170, -190), ("counterclockwise", 170, 170), ("counterclockwise", -100, 260), ("clockwise", 40, 40),
    (None, -170, -170),
])  # fmt: skip
def test_a_far_turn_goes_the_told_way_round(yaws: Spin | None, deg: float, turned: float) -> None:
    found = box_angles._as_told(role(yaws), math.radians(deg))  # type: ignore[arg-type]
    assert math.degrees(found) == pytest.approx(turned)
    assert box_angles._as_told(role(yaws, may_skid=False), math.radians(deg)) == math.radians(deg)  # type: ignore[arg-type]


def test_a_skid_the_other_way_costs_more() -> None:
    cost = {
        yaws: next(t.cost for t in box_angles._turned(role(yaws), 1.0, 0.0) if t.skids)  # type: ignore[arg-type]
        for yaws in ("counterclockwise", "clockwise", None)
    }
    assert cost["counterclockwise"] < cost[None] < cost["clockwise"]


def test_one_that_is_told_to_turn_out_of_control_first_slips_a_little_that_way() -> None:
    first = box_angles._straight(role("clockwise"))[0]  # type: ignore[arg-type]
    assert first.skids
    assert -math.radians(45) < first.angle_rad < 0.0
    assert [t.angle_rad for t in box_angles._straight(role(None))] == [0.0]  # type: ignore[arg-type]
    steered = [
        next(t.cost for t in box_angles._turned(role(yaws), 1.0, 0.0) if not t.skids)  # type: ignore[arg-type]
        for yaws in ("counterclockwise", None)
    ]
    assert steered[0] > steered[1]
