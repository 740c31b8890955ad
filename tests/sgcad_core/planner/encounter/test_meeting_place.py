"""Where two that drive one way meet: one that slows straight ahead of a junction is met before it."""

from __future__ import annotations

import pytest

from sgcad_core.planner.encounter.meeting_place import turns_off
from sgcad_core.planner.lines.maneuver_course import course_of
from sgcad_core.planner.plan import plan
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from tests.sgcad_core.planner.crash_scenes import network

SLOWS = Actor(id="V1", kind="car", road="W", direction="forward", exit_road="E", maneuver="slowing", lane=1)
FOLLOWS = SLOWS.model_copy(update={"id": "V2", "maneuver": "straight"})
REAR_END = Contact(striker="V2", struck="V1", striker_area="front", struck_area="back")


@pytest.mark.parametrize(("exit_road", "expected"), [("E", False), ("N", True), ("S", True)])
def test_a_course_straight_on_does_not_turn_off(exit_road, expected):
    actor = FOLLOWS.model_copy(update={"exit_road": exit_road})
    assert turns_off(course_of(network("four_leg"), actor, 3.0)) is expected


def test_one_that_slows_for_what_waits_at_a_junction_is_struck_before_it():
    made = plan(BehaviorSpec(actors=(SLOWS, FOLLOWS), contacts=(REAR_END,)), network("four_leg"))
    assert made.realised
    assert made.contact is not None
    k = round(made.contact.t_s / 0.05)
    assert made.trajectories[0].x_m[k] < -9.0


def test_one_that_stands_at_a_junction_is_struck_near_its_line():
    stands = SLOWS.model_copy(update={"maneuver": "stopped"})
    made = plan(BehaviorSpec(actors=(stands, FOLLOWS), contacts=(REAR_END,)), network("four_leg"))
    assert made.realised
    assert -15.5 < made.trajectories[0].x_m[0] < -9.0  # the junction begins at 7.6 m


@pytest.mark.parametrize(("inside", "before"), [(False, True), (True, False)])
def test_a_row_meets_before_the_junction_unless_it_is_told_to_have_driven_into_it(inside, before):
    drives = SLOWS.model_copy(update={"maneuver": "straight"})
    courses = {"V1": CourseTold(brakes=True, inside=inside)}
    made = plan(BehaviorSpec(actors=(drives, FOLLOWS), contacts=(REAR_END,)), network("four_leg"), courses=courses)
    assert made.realised
    assert made.contact is not None
    assert bool(made.trajectories[0].x_m[round(made.contact.t_s / 0.05)] < -9.0) is before
