"""A told start from rest: the vehicle is seen standing, and has moved on when it touches the other one."""

from __future__ import annotations

import pytest

from sgcad_core.planner import plan
from sgcad_core.planner.lead_time import WAITS_S
from sgcad_core.planner.motion import ACCELERATION_MPS2
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import BehaviorSpec
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_plan_rules import actor, at_contact, contact, track

_FROM_REST = {"V2": CourseTold(from_rest=True)}


@pytest.mark.parametrize(("maneuver", "exit_road", "hit"), [
    ("straight", "E", "V1 front V2 left"),
    ("straight", "E", "V2 front V1 right"),
    ("turn_left", "N", "V1 front V2 right"),
    ("turn_right", "S", "V2 front V1 left"),
])  # fmt: skip
def test_who_is_told_to_start_from_rest_stands_first(maneuver, exit_road, hit) -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "straight", "S"), actor("V2", maneuver, "W", exit_road)), contacts=(contact(hit),)
    )
    made = plan(behavior, network("four_leg"), courses=_FROM_REST)
    speed = track(made, "V2").speed_mps[: at_contact(made)]
    stood = int((speed < 0.1).sum())
    if any("does not stop" in note for note in made.notes):
        assert not stood
        return
    assert stood * 0.05 >= WAITS_S - 0.1
    assert (speed[:stood] < 0.1).all()
    assert speed[-1] > 1.0
    assert (speed[10:] - speed[:-10]).max() / 0.5 < ACCELERATION_MPS2 + 0.6
    assert made.realised


def test_a_start_from_rest_is_kept_in_plain_crossings() -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "straight", "S"), actor("V2", "straight", "W", "E")),
        contacts=(contact("V1 front V2 left"),),
    )
    made = plan(behavior, network("four_leg"), courses=_FROM_REST)
    assert not [note for note in made.notes if "does not stop" in note]
