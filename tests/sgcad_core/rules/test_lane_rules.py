"""Wrong side, shoulder, speed and headway over ranges: a finding turns at the lane's edge and at the limit."""

from __future__ import annotations

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sgcad_core.metrics.lane_places import EDGE_M
from sgcad_core.rules.records import LIMITS
from sgcad_core.units import MPS_PER_MPH
from tests.effort import many
from tests.sgcad_core.rules.drives import found, lanes, scene, status

HALF_M = lanes("road").edges["S"].lanes[-1].width_m / 2
POSTED = 45 * MPS_PER_MPH


def aside(left_m: float) -> dict[str, object]:
    return {"way": "S -N", "at": [[-200, 18], [60, 18]], "aside": [[-150, 0], [-110, left_m], [-70, left_m], [-30, 0]]}


@given(st.floats(0.0, 3.4))
@settings(max_examples=many(15, 200), deadline=None)
def test_the_wrong_side_begins_where_the_center_is_over_the_middle(left_m: float) -> None:
    assume(abs(left_m - HALF_M - EDGE_M) > 0.15)
    assert status(scene("road", V1=aside(left_m)), "wrong_side") == (
        "broken" if left_m > HALF_M + EDGE_M else "kept"
    )  # fmt: skip


@given(st.floats(0.0, 12.0))
@settings(max_examples=many(15, 200), deadline=None)
def test_the_lanes_end_where_the_center_is_over_the_edge_line(right_m: float) -> None:
    assume(abs(right_m - HALF_M - EDGE_M) > 0.15)
    made = scene("road", V1=aside(-right_m))
    assert status(made, "off_road") == ("broken" if right_m > HALF_M + EDGE_M else "kept")
    if right_m > 6.0:
        assert found(made, "off_road")[0].measured == pytest.approx(right_m - HALF_M, abs=0.3)


@given(st.floats(-4.0, 6.0))
@settings(max_examples=many(15, 200), deadline=None)
def test_a_posted_limit_is_exceeded_beyond_its_tolerance(over: float) -> None:
    most = max(LIMITS.over_limit_mps, LIMITS.over_limit_share * POSTED)
    assume(abs(over - most) > 0.02)
    speed = POSTED + over
    made = scene("road", V1={"way": "S -N", "at": [[-150, speed], [60, speed]]})
    assert status(made, "speed_limit") == ("broken" if over > most else "kept")
    assert found(made, "speed_limit")[0].measured == pytest.approx(speed, abs=0.05)


@given(st.floats(5.0, 45.0))
@settings(max_examples=many(8, 200), deadline=None)
def test_an_assumed_limit_is_never_exceeded_and_never_kept(speed: float) -> None:
    made = scene("untold", V1={"way": "S -N", "at": [[-150, speed], [60, speed]]})
    assert {f.status for f in found(made, "speed_limit")} == {"unknown"}
    assert "assumed" in found(made, "speed_limit")[0].note


@given(st.floats(0.4, 2.5), st.floats(8.0, 19.0))
@settings(max_examples=many(15, 200), deadline=None)
def test_following_is_measured_from_front_to_front(headway: float, speed: float) -> None:
    assume(abs(headway - LIMITS.headway_s) > 0.05 and headway * speed > 6.0)
    ahead = headway * speed
    made = scene("road", V1={"way": "S -N", "at": [[-180, speed], [-60, speed]]},
                 V2={"way": "S -N", "at": [[-180 + ahead, speed], [-60 + ahead, speed]]})  # fmt: skip
    assert status(made, "following_distance") == ("broken" if headway < LIMITS.headway_s else "kept")
    assert found(made, "following_distance")[0].measured == pytest.approx(headway, abs=0.05)


def test_a_bicycle_may_use_the_shoulder() -> None:
    made = scene("road", B1={"way": "S -N", "at": [[-100, 5], [0, 5]], "aside": [[-300, -2.6], [300, -2.6]]})
    assert status(made, "off_road", "B1") == "kept"
