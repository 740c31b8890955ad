"""Yielding at junctions and crosswalks: a duty from the map, a hazard from the motions."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sgcad_core.metrics.conflict import post_encroachment_time
from sgcad_core.rules.records import LIMITS, RuleScene
from tests.effort import many
from tests.sgcad_core.rules.drives import found, scene, status


def pulls_out(from_m: float) -> RuleScene:
    stops: dict[str, Any] = {"way": "S -N", "at": [[-30, 8], [-1, 0], [25, 10], [150, 10]], "stands": {-1: 1}}
    return scene("stop", V1=stops, V2={"way": "W -E", "at": [[-from_m, 15], [60, 15]]})


@given(st.floats(60.0, 320.0))
@settings(max_examples=many(15, 200), deadline=None)
def test_one_who_pulls_out_must_leave_the_other_time(from_m: float) -> None:
    made = pulls_out(from_m)
    one, other = made.movers
    if one.until is None:
        gap = post_encroachment_time(one.track(0, 999), other.track(0, 999)).seconds
        assume(gap is not None and abs(gap - LIMITS.hazard_s) > 0.1)
        first = from_m > 172.0  # where they do not touch, V2 is at the junction clearly before or behind V1
        assert gap is not None
        assert (status(made, "right_of_way") == "broken") == (first and gap < LIMITS.hazard_s)
    else:
        assert found(made, "right_of_way")[0].measured == 0.0
        assert found(made, "right_of_way")[0].where.endswith("into the junction")
    assert status(made, "right_of_way", "V2") == ""


def test_contact_breaks_the_duty_of_the_one_who_had_it() -> None:
    made = pulls_out(158.0)
    assert made.movers[0].until is not None
    assert (status(made, "right_of_way"), found(made, "right_of_way")[0].other) == ("broken", "V2")


@pytest.mark.parametrize("delay_s", [-3.0, 3.0])
def test_at_an_all_way_stop_the_later_one_yields(delay_s: float) -> None:
    late, early = max(delay_s, 0.0), max(-delay_s, 0.0)
    way = {"at": [[-24, 8], [-1, 0], [40, 8]]}
    made = scene("all_way", V1=way | {"way": "S -N", "at": [[-24 - 8 * late, 8], *way["at"]][late == 0:]},
                 V2=way | {"way": "E -W", "at": [[-24 - 8 * early, 8], *way["at"]][early == 0:]})  # fmt: skip
    duty = "V1" if late else "V2"
    other = {"V1": "V2", "V2": "V1"}[duty]
    assert [f.other for f in found(made, "right_of_way", duty)] == [other]
    assert found(made, "right_of_way", other) == []


def test_signals_without_a_plan_leave_the_duty_unknown() -> None:
    turn = {"way": "S -W", "maneuver": "turn_left", "at": [[-50, 10], [-1, 6], [40, 8]]}
    made = scene("signal", V1=turn, V2={"way": "N -S", "at": [[-125, 15], [60, 15]]})
    assert status(made, "right_of_way") == "unknown"


@given(st.floats(0.0, 9.0))
@settings(max_examples=many(10, 200), deadline=None)
def test_a_person_off_the_crosswalk_yields_and_the_car_does_not(start_s: float) -> None:
    made = scene("road", V1={"way": "S -N", "at": [[-200, 18], [20, 18]]},
                 P1={"from": [7, -60], "to": [-6, -60], "start_s": start_s})  # fmt: skip
    assert status(made, "right_of_way") == ""
    said = status(made, "right_of_way", "P1")
    assert said == "" or (said == "broken") == any(
        (f.measured or 0.0) < LIMITS.hazard_s and f.status == "broken" for f in found(made, "right_of_way", "P1")
    )


def test_in_a_crosswalk_without_a_signal_the_car_yields() -> None:
    person = {"from": [6, -6.1], "to": [-6, -6.1], "start_s": 2.0}
    made = scene("walks", signal={"NS": "red 60", "EW": "green 60"}, P1=person,
                 V1={"way": "S -N", "at": [[-60, 12], [40, 12]]})  # fmt: skip
    assert status(made, "right_of_way") == "broken"
    assert status(made, "red_light") == "broken"
    assert status(made, "red_light", "P1") == "kept"
