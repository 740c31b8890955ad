"""A told way to a stop is driven: the vehicle comes, and stands for a while before it is struck."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.planner import plan
from sgcad_core.planner.encounter.arrival import CLOSING_MPS, MOVES_UP_M, STANDS_S
from sgcad_core.planner.plan import Plan
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import BehaviorSpec
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_plan_rules import actor, at_contact, contact, track


def _struck(told: CourseTold, behind: CourseTold | None = None, **second: int) -> Plan:
    behavior = BehaviorSpec(
        actors=(actor("V1", "stopped", "S", "N"), actor("V2", "straight", "S", "N", **second)),
        contacts=(contact("V2 front V1 back"),),
    )
    return plan(behavior, network("four_leg"), courses={"V1": told, "V2": behind or CourseTold()})


@pytest.mark.parametrize("behind", [CourseTold(), CourseTold(from_rest=True)])
def test_one_that_moves_up_stands_twice(behind: CourseTold) -> None:
    made = _struck(CourseTold(comes="moves_up"), behind)
    one = track(made, "V1")
    before = slice(0, at_contact(made))
    speed = one.speed_mps[before]
    moved = np.hypot(np.ptp(one.x_m[before]), np.ptp(one.y_m[before]))
    assert made.realised
    assert moved == pytest.approx(MOVES_UP_M, abs=0.1)
    assert speed[0] < 0.1 < 1.5 < speed.max()
    assert (speed[-round(STANDS_S / 0.05) + 4 :] < 0.1).all()


def test_one_that_drives_up_brakes_and_stands() -> None:
    made = _struck(CourseTold(comes="drives_up"))
    speed = track(made, "V1").speed_mps[: at_contact(made)]
    assert made.realised
    assert speed[0] > 8.0
    assert (np.diff(speed[4:]) < 0.05).all()
    assert (speed[-round(STANDS_S / 0.05) + 4 :] < 0.1).all()


def test_one_that_is_only_told_to_stand_stands_from_the_beginning() -> None:
    made = _struck(CourseTold())
    assert track(made, "V1").speed_mps[: at_contact(made)].max() < 0.1


def test_nobody_drives_through_one_that_waits_behind() -> None:
    made = _struck(CourseTold(comes="drives_up"), CourseTold(from_rest=True))
    assert made.realised
    assert track(made, "V1").speed_mps[: at_contact(made)].max() < 0.1


@pytest.mark.parametrize("comes", [None, "drives_up", "moves_up"])
def test_a_slight_blow_from_behind_comes_with_little_speed(comes) -> None:
    made = _struck(CourseTold(comes=comes, slight=True), CourseTold(slight=True))
    speed = track(made, "V2").speed_mps[: at_contact(made)]
    assert made.realised
    assert speed[0] > 12.0
    assert speed[-1] == pytest.approx(CLOSING_MPS, abs=0.5)


def test_a_low_told_speed_is_that_of_the_contact() -> None:
    made = _struck(CourseTold(), speed_mph=5)
    speed = track(made, "V2").speed_mps[: at_contact(made)]
    assert made.realised
    assert speed[0] > 12.0
    assert speed[-1] == pytest.approx(5 * 0.447, abs=0.5)


def test_a_cyclist_comes_no_faster_than_cyclists_do() -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "stopped", "S", "N"), actor("B1", "straight", "S", "N", kind="bicycle")),
        contacts=(contact("B1 front V1 back"),),
    )
    made = plan(behavior, network("four_leg"), courses=dict.fromkeys(("V1", "B1"), CourseTold(slight=True)))
    assert made.realised
    assert track(made, "B1").speed_mps[: at_contact(made)].max() < 7.0


def test_ways_that_cross_in_a_slight_blow_are_driven_slowly() -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "straight", "S", "N"), actor("V2", "straight", "W", "E")),
        contacts=(contact("V2 front V1 left"),),
    )
    fast, slow = (
        plan(behavior, network("four_leg"), courses=dict.fromkeys(("V1", "V2"), CourseTold(slight=slight)))
        for slight in (False, True)
    )
    assert fast.realised
    assert slow.realised
    assert track(fast, "V2").speed_mps.max() > 12.0
    assert track(slow, "V2").speed_mps.max() < 7.0


def test_one_that_moves_off_has_stood_and_moves_a_little_as_it_is_struck() -> None:
    made = _struck(CourseTold(comes="moves_off"))
    one = track(made, "V1")
    before = slice(0, at_contact(made))
    speed = one.speed_mps[before]
    assert made.realised
    assert (speed[: -round(1.0 / 0.05) - 2] < 0.1).all()
    assert (np.diff(speed) > -1e-6).all()
    assert 1.0 < speed[-1] < 2.0
    assert np.hypot(np.ptp(one.x_m[before]), np.ptp(one.y_m[before])) < 1.0
