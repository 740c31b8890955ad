"""A vehicle that loses control and touches nothing sways and catches itself, or spins to a stop."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.planner import plan
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import BehaviorSpec
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_plan_rules import actor, track


def alone(surface=None, **told):
    behavior = BehaviorSpec(actors=(actor("V1", "straight", "S", lane=1),), surface=surface)
    made = plan(behavior, network("straight"), courses={"V1": CourseTold(lost_control=True, **told)}, may_skid=True)
    return track(made, "V1")


@pytest.mark.parametrize("surface", [None, "ice"])
def test_it_sways_to_both_hands_and_is_back_on_its_line(surface):
    mine = alone(surface)
    off = np.degrees(np.unwrap(mine.heading_rad) - mine.heading_rad[0])
    assert off.max() > 8.0
    assert off.min() < -8.0
    assert abs(off[-1]) < 3.0
    assert abs(mine.x_m[-1] - mine.x_m[0]) < 0.3
    assert np.ptp(mine.x_m) > 1.0


@pytest.mark.parametrize(("way", "sign"), [("clockwise", -1.0), ("counterclockwise", 1.0)])
def test_it_spins_as_far_as_told_and_stops(way, sign):
    mine = alone("snow", spin=way, spin_deg=180.0)
    assert sign * np.degrees(np.unwrap(mine.heading_rad)[-1] - mine.heading_rad[0]) == pytest.approx(180.0, abs=30.0)
    assert mine.speed_mps[-1] < 0.3


def test_without_a_loss_of_control_it_keeps_straight_on():
    behavior = BehaviorSpec(actors=(actor("V1", "straight", "S", lane=1),))
    mine = track(plan(behavior, network("straight")), "V1")
    assert np.ptp(mine.x_m) < 0.1
