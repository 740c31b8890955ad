"""Red lights and stop signs over ranges of time and speed: a finding turns at the values of `RuleLimits`."""

from __future__ import annotations

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sgcad_core.rules.records import LIMITS
from tests.effort import many
from tests.sgcad_core.rules.drives import LINE_M, found, scene, status


@given(st.floats(1.0, 9.0), st.floats(7.0, 15.0))
@settings(max_examples=many(15, 200), deadline=None)
def test_a_red_light_is_run_where_the_line_is_passed_after_red_began(red_s: float, speed: float) -> None:
    made = scene(
        "signal", signal={"NS": f"green {red_s} red 99"}, V1={"way": "S -N", "at": [[-60, speed], [40, speed]]}
    )
    late = (60 - LINE_M) / speed - red_s - LIMITS.red_grace_s
    assume(abs(late) > 0.06)
    assert status(made, "red_light") == ("broken" if late > 0 else "kept")


@given(st.floats(0.0, 6.0))
@settings(max_examples=many(15, 200), deadline=None)
def test_a_stop_sign_asks_for_standstill(slowest: float) -> None:
    assume(abs(slowest - LIMITS.stands_mps) > 0.1)
    made = scene("stop", V1={"way": "S -N", "at": [[-40, 10], [-1, slowest], [30, 8]]})
    assert status(made, "stop_sign") == ("kept" if slowest < LIMITS.stands_mps else "broken")
    assert found(made, "stop_sign")[0].measured is not None


@given(st.floats(1.5, 30.0))
@settings(max_examples=many(10, 200), deadline=None)
def test_a_stop_counts_near_the_line_only(before_m: float) -> None:
    assume(abs(before_m - LINE_M - LIMITS.stop_before_m) > 0.5)
    at = [[-50, 10], [-before_m, 0], [-1, 2], [30, 8]]
    made = scene("stop", V1={"way": "S -N", "at": at, "stands": {-before_m: 1}})
    assert (status(made, "stop_sign") == "kept") == (before_m - LINE_M < LIMITS.stop_before_m)


def test_the_plan_runs_on_the_clock_that_is_given() -> None:
    made = scene("signal", signal={"NS": "green 20 red 99"}, V1={"way": "S -N", "at": [[-60, 12], [40, 12]]})
    assert status(made, "red_light") == "kept"
    later = made.__class__(made.graph, made.trajectories, made.actors, made.lights,
                           made.trajectories[0].t_s + 30.0)  # fmt: skip
    assert status(later, "red_light") == "broken"
