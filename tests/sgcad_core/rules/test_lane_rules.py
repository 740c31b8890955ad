"""Wrong side, shoulder, speed and headway over ranges: a finding turns at the lane's edge and at the limit."""

from __future__ import annotations

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sgcad_core.metrics.lane_places import EDGE_M
from sgcad_core.rules.lane_change import room_m
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


@given(st.floats(-8.0, 60.0), st.floats(8.0, 25.0))
@settings(max_examples=many(15, 200), deadline=None)
def test_a_change_of_lane_needs_the_room_of_the_one_behind(gap: float, behind: float) -> None:
    speed = 20.0
    needs = room_m(behind, speed, LIMITS)
    assume(abs(gap - needs) > 1.0)
    length = 4.8
    begins_s = (200.0 - 87.0) / speed
    start = -87.0 - length - gap - behind * begins_s
    made = scene("wide", V1={"way": "S -N", "lane": 0, "at": [[-200, speed], [60, speed]],
                             "aside": [[-100, 0], [-60, 3.6]]},
                 V2={"way": "S -N", "lane": 1, "at": [[start, behind], [start + 14 * behind, behind]]})  # fmt: skip
    assert status(made, "lane_change") == ("broken" if gap < needs else "kept")
    told = found(made, "lane_change")[0]
    assert told.measured == pytest.approx(gap, abs=1.0)
    assert told.other == "V2"


@pytest.mark.parametrize(
    ("behind", "ahead", "metres"),
    [(20.0, 20.0, 20.0), (26.0, 20.0, 6 * 0.4 + 36 / 6 + 20.0), (10.0, 25.0, 10.0), (0.0, 20.0, 0.0)],
)
def test_the_room_is_that_of_the_regulation(behind: float, ahead: float, metres: float) -> None:
    assert room_m(behind, ahead, LIMITS) == pytest.approx(metres)


@pytest.mark.parametrize(("road", "said"), [("dashed", "kept"), ("double", "broken"), ("road", "unknown")])
def test_the_center_line_decides_on_passing(road: str, said: str) -> None:
    made = scene(road, V1={"way": "S -N", "at": [[-200, 18], [130, 18]],
                           "aside": [[-150, 0], [-120, 3.5], [0, 3.5], [30, 0]]},
                 V2={"way": "S -N", "at": [[-120, 8], [100, 8]]})  # fmt: skip
    assert status(made, "passing") == said
    assert found(made, "passing")[0].other == "V2"
    assert not found(made, "wrong_side")


@given(st.floats(10.0, 160.0))
@settings(max_examples=many(10, 200), deadline=None)
def test_passing_ends_200_feet_before_one_that_comes(apart: float) -> None:
    assume(abs(apart - LIMITS.pass_oncoming_m) > 3.0)
    leaves_y, speed, other = 15.0, 18.0, 15.0  # V1 is back in its lane at y = 15 m, after 215 m
    start = -(leaves_y + apart) - other * (200.0 + leaves_y) / speed
    made = scene("dashed", V1={"way": "S -N", "at": [[-200, speed], [130, speed]],
                               "aside": [[-150, 0], [-120, 3.5], [0, 3.5], [30, 0]]},
                 V2={"way": "S -N", "at": [[-120, 8], [100, 8]]},
                 V3={"way": "N -S", "at": [[start, other], [300, other]]})  # fmt: skip
    assert status(made, "passing") == ("broken" if apart < LIMITS.pass_oncoming_m else "kept")


def test_nobody_who_keeps_a_lane_changes_or_passes_unlawfully() -> None:
    made = scene("wide", V1={"way": "S -N", "lane": 0, "at": [[-200, 25], [60, 25]]},
                 V2={"way": "S -N", "lane": 1, "at": [[-180, 18], [60, 18]]})  # fmt: skip
    assert not found(made, "lane_change")
    assert not found(made, "passing")


def test_a_bicycle_may_use_the_shoulder() -> None:
    made = scene("road", B1={"way": "S -N", "at": [[-100, 5], [0, 5]], "aside": [[-300, -2.6], [300, -2.6]]})
    assert status(made, "off_road", "B1") == "kept"
