"""A narrow thing stands before that half of the side that strikes it by which the vehicle turns as told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sgcad_core.geometry.plane import local_points
from sgcad_core.planner.encounter.conflict import Conflicts
from sgcad_core.planner.encounter.off_center import at_corner, beside_middle
from sgcad_core.planner.lines.maneuver_course import course_of
from sgcad_core.records.course import CourseTold, RestTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from tests.sgcad_core.planner.crash_scenes import network


def into_thing(told: CourseTold, size_m: float = 0.4, *, firm: bool = False, on: bool = False):
    """The encounter of V1 eastbound with a thing beside its road; `on`: it then strikes a second one."""
    actors = (
        Actor(id="V1", kind="car", road="W", direction="forward", exit_road="E", maneuver="departing_road_right"),
        Actor(id="O1", kind="object", road="E", direction="forward", maneuver="stopped", length_m=size_m,
              width_m=size_m, firm=firm),
    )  # fmt: skip
    contact = Contact(striker="V1", struck="O1", striker_area="front", struck_area="front")
    further = (contact.model_copy(update={"struck": "O2"}),) if on else ()
    actors += (actors[1].model_copy(update={"id": "O2"}),) if on else ()
    behavior = BehaviorSpec(actors=actors, contacts=(contact, *further))
    lines = {a.id: course_of(network("four_leg"), a, 3.0) for a in actors}
    return Conflicts(behavior, lines, told={"V1": told}).of(contact)


def left_m(found) -> float:
    """How far to the left of the middle of V1's front the thing is met."""
    meeting = found.meeting
    car, thing = (
        motion.poses([own])[0]
        for motion, own in ((meeting.first, meeting.first_s), (meeting.second, meeting.second_s))
    )  # fmt: skip
    return float(local_points(car[None], thing[None, None, :2])[0, 0, 1])


@pytest.mark.parametrize(("spin", "sign"), [("counterclockwise", 1.0), ("clockwise", -1.0)])
def test_the_thing_stands_on_the_side_to_which_the_vehicle_is_told_to_turn(spin: str, sign: float) -> None:
    places = [left_m(one) * sign for one in beside_middle(into_thing(CourseTold(spin=spin)))]
    assert len(places) > 1
    assert min(places) > 0.2
    assert max(places) < 0.9


def test_a_pole_that_throws_a_vehicle_back_to_the_road_stands_on_the_outer_side_at_several_depths() -> None:
    told = CourseTold(departs="right", spin="counterclockwise", rest=RestTold(where="road"))
    found = into_thing(told, firm=True)
    places = [left_m(one) for one in beside_middle(found)]
    assert len(places) > 1
    assert sorted(places) == places
    assert places[0] < -0.9 < places[-1] < -0.6  # the corner is 0.9 m to the right of the middle
    corner = at_corner(found)
    assert corner is not None
    assert left_m(corner) == pytest.approx(places[0])
    assert at_corner(into_thing(replace(told, rest=RestTold(where="off_road")), firm=True)) is None


def test_without_a_told_turn_it_stands_a_little_off_the_middle() -> None:
    (place,) = [left_m(one) for one in beside_middle(into_thing(CourseTold()))]
    assert 0.2 < abs(place) < 0.6


def test_the_moment_and_the_way_of_the_vehicle_stay() -> None:
    found = into_thing(CourseTold())
    (moved,) = beside_middle(found)
    assert moved.meeting.first_s == found.meeting.first_s
    assert moved.meeting.first is found.meeting.first
    apart = np.hypot(*np.ptp([found.meeting.second.path.points[0], moved.meeting.second.path.points[0]], axis=0))
    assert apart < 1.0


def test_a_wide_thing_stays_where_it_is() -> None:
    assert beside_middle(into_thing(CourseTold(), size_m=3.0)) == []


def test_a_thing_at_which_the_vehicle_comes_to_rest_is_met_near_the_middle() -> None:
    (place,) = [left_m(one) for one in beside_middle(into_thing(CourseTold(rest=RestTold(against="pole"))))]
    assert abs(place) < 0.3


def test_a_firm_thing_that_is_passed_overlaps_by_a_quarter_of_the_width_or_less() -> None:
    found = into_thing(CourseTold(), firm=True, on=True)
    width, size_m = found.first.role.size[1], 0.4
    overlaps = [width / 2 + size_m / 2 - abs(left_m(one)) for one in beside_middle(found)]
    assert overlaps == sorted(overlaps, reverse=True)
    assert overlaps[0] == pytest.approx(0.25 * width, abs=0.02)
    assert 0.0 < overlaps[-1] < 0.1 * width
