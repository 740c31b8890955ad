"""A told start from rest: the vehicle is seen standing, and has moved on when it touches the other one."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.planner import plan
from sgcad_core.planner.actor_plan import Role, start_m
from sgcad_core.planner.encounter.meeting_place import Place
from sgcad_core.planner.lead_time import WAITS_S
from sgcad_core.planner.lines.actor_course import find_course
from sgcad_core.planner.lines.turning import corner_lines
from sgcad_core.planner.motion import ACCELERATION_MPS2
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import BehaviorSpec, size_m
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


def test_one_that_stood_behind_another_passes_it_from_there() -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "stopped", "S", "N"), actor("V2", "overtaking", "S", "N")),
        contacts=(contact("V2 right V1 left"),),
    )
    made = plan(behavior, network("four_leg"), courses=_FROM_REST)
    speed = track(made, "V2").speed_mps[: at_contact(made)]
    assert made.realised
    assert (speed[:20] < 0.1).all()
    assert track(made, "V1").y_m[0] - track(made, "V2").y_m[0] < 16.0


def test_a_start_from_rest_is_kept_in_plain_crossings() -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "straight", "S"), actor("V2", "straight", "W", "E")),
        contacts=(contact("V1 front V2 left"),),
    )
    made = plan(behavior, network("four_leg"), courses=_FROM_REST)
    assert not [note for note in made.notes if "does not stop" in note]


@pytest.mark.parametrize("hit", ["V1 front V2 left", "V2 front V1 left"])
def test_one_that_stands_at_its_line_stands_square_in_its_lane(hit) -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "turn_left", "E", "S"), actor("V2", "straight", "W", "E")), contacts=(contact(hit),)
    )
    made = plan(behavior, network("four_leg"), courses=_FROM_REST)
    assert abs(track(made, "V2").heading_rad[0]) < 0.05


def test_corners_are_cut_behind_the_line_where_one_started_from_rest() -> None:
    one = actor("V2", "straight", "W", "E")
    course = find_course(network("four_leg"), one)
    role = Role(one, course, size_m(one), Place(course.turn.exit_m, 0.0, 0.0, 0.0), told=_FROM_REST["V2"])
    begins = [line.end_m - line.length_m for line in corner_lines(role)]
    assert begins
    assert min(begins) > start_m(role)


def test_one_that_starts_behind_a_standing_one_stood_behind_it_and_rolls_into_it() -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "stopped", "W"), actor("V2", "straight", "W", "E")),
        contacts=(contact("V2 front V1 back"),),
    )
    made = plan(behavior, network("four_leg"), courses=_FROM_REST)
    speed = track(made, "V2").speed_mps[: at_contact(made)]
    gap_m = abs(track(made, "V2").x_m[0] - track(made, "V1").x_m[0]) - size_m(behavior.actors[0])[0]
    assert made.realised
    assert int((speed < 0.1).sum()) * 0.05 >= WAITS_S - 0.1
    assert 1.0 < gap_m < 8.0
    assert 1.0 < speed[-1] < 5.0


def test_one_that_backs_into_a_parked_vehicle_was_in_the_row_of_the_parked_ones() -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "parked", "S"), actor("V2", "backing", "S")), contacts=(contact("V2 back V1 front"),)
    )
    made = plan(behavior, network("straight"))
    x_m = track(made, "V2").x_m[: at_contact(made)]
    assert made.realised
    assert np.ptp(x_m) < 0.1
