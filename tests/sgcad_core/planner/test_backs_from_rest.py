"""One that backs has stood before: it is seen standing, then backs a short way into the other one."""

from __future__ import annotations

import pytest

from sgcad_core.planner import plan
from sgcad_core.planner.actor_plan import BACKS_M
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import BehaviorSpec
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_plan_rules import actor, at_contact, contact, track


@pytest.mark.parametrize("told", [CourseTold(), CourseTold(comes="drives_up")])
def test_one_that_backs_stands_ahead_of_the_one_that_it_backs_into_first(told: CourseTold) -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "stopped", "S", "N"), actor("V2", "backing", "S")), contacts=(contact("V2 back V1 front"),)
    )
    made = plan(behavior, network("four_leg"), courses={"V1": told})
    one = track(made, "V2")
    hit = at_contact(made)
    assert made.realised
    assert (one.speed_mps[:20] < 0.1).all()
    assert one.y_m[0] - one.y_m[hit] < 2 * BACKS_M
    assert one.y_m[0] < -9.0  # it stood before the junction, which begins at 7.6 m
