"""Where a told course is missed, the same encounter is tried a little otherwise, and the moment of a touch is exact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sgcad_core.planner.aftermath.impact import IMPACTS
from sgcad_core.planner.encounter.conflict import Conflicts
from sgcad_core.planner.encounter.encounter_search import _root, along_sides
from sgcad_core.planner.encounter.try_elsewhere import WholeCourse, _speeds, least_missed
from sgcad_core.planner.lines.maneuver_course import course_of
from sgcad_core.planner.scene import Scene
from sgcad_core.records.course import AT_IMPACT_M, RestTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from tests.sgcad_core.planner.crash_scenes import network


def test_without_an_encounter_nothing_else_is_tried() -> None:
    calls = []

    def unfold(found, impacts):
        calls.append((found, impacts))
        return WholeCourse(Scene(10, 2), (), 0.0, 9.0)

    assert least_missed(None, unfold).missed == 9.0
    assert calls == [(None, IMPACTS)]


def crossing(**speeds: float | str):
    """V1 eastbound and V2 southbound on a crossroads, as the search finds their encounter; with it their motions. A
    speed is told, or "stopped"."""
    actors = tuple(
        Actor(id=name, kind="car", road=road, direction="forward", exit_road=exit_road,
              maneuver="stopped" if speeds.get(name) == "stopped" else "straight",
              speed_mph=None if speeds.get(name) == "stopped" else speeds.get(name))
        for name, road, exit_road in (("V1", "W", "E"), ("V2", "N", "S"))
    )  # fmt: skip
    contact = Contact(striker="V1", struck="V2", striker_area="front", struck_area="right")
    behavior = BehaviorSpec(actors=actors, contacts=(contact,))
    lines = {a.id: course_of(network("four_leg"), a, 3.0) for a in actors}
    return Conflicts(behavior, lines).of(contact)


def test_contacts_along_the_told_sides_lie_apart_and_on_those_sides() -> None:
    found = crossing()
    meetings = along_sides(found.meeting.first, found.meeting.second, ("front", "right"), 5)
    assert len(meetings) == 5
    assert {meeting.sides for meeting in meetings} == {("front", "right")}
    places = [meeting.first.poses([meeting.first_s])[0] - meeting.second.poses([meeting.second_s])[0]
              for meeting in meetings]  # fmt: skip
    assert np.ptp(np.array(places)[:, :2], axis=0).max() > 2.0  # of a side of 4.7 m
    assert along_sides(found.meeting.first, found.meeting.second, ("back", "back"), 5) == []


def test_what_is_missed_is_tried_at_other_places_and_untold_speeds_until_it_is_had() -> None:
    tried = []

    def unfold(found, impacts):
        tried.append(found)
        return WholeCourse(Scene(10, 2), (), 0.0, 0.0 if len(tried) == 4 else 2.0)

    assert least_missed(crossing(), unfold).missed == 0.0
    assert len(tried) == 4
    factors = {(one.first.pacing.factor, one.second.pacing.factor) for one in tried}
    assert len(factors) > 1


def test_a_told_speed_is_kept_in_every_attempt() -> None:
    tried = []

    def unfold(found, impacts):
        tried.append(found)
        return WholeCourse(Scene(10, 2), (), 0.0, 2.0)

    first = crossing(V1=30.0, V2=25.0)
    least_missed(first, unfold)
    assert len(tried) > 1
    assert {(one.first.pacing, one.second.pacing) for one in tried} == {(first.first.pacing, first.second.pacing)}


def test_where_one_speed_is_told_or_one_stands_the_other_one_is_varied() -> None:
    for found in (crossing(V2=25.0), crossing(V2="stopped")):
        tried = []

        def unfold(one, impacts, tried=tried):
            tried.append(one)
            return WholeCourse(Scene(10, 2), (), 0.0, 2.0)

        least_missed(found, unfold)
        assert len({one.first.pacing.factor for one in tried}) > 2
        assert {one.second.pacing for one in tried} == {found.second.pacing}


@pytest.mark.parametrize("bend", [0.0, 0.3])
def test_the_moment_of_a_touch_is_found_between_two_samples(bend: float) -> None:
    rng = np.random.default_rng(1)
    wanted, rate = rng.uniform(-0.95, 0.95, 40), rng.uniform(0.2, 1.0, 40)

    def over(at):
        return rate * (at - wanted) + bend * np.sign(at - wanted) * (at - wanted) ** 2

    assert _root(over, 40) == pytest.approx(wanted, abs=5e-3)


def test_slow_speeds_are_tried_first_where_a_rest_at_the_impact_is_told() -> None:
    found = crossing()
    first = found.first.role
    for rest, speeds in (
        (RestTold(distance_m=AT_IMPACT_M), (0.5, 0.5)),
        (RestTold(distance_m=1.0), (0.5, 0.5)),
        (RestTold(where="off_road", side="right"), (1.0, 1.0)),
        (RestTold(), (1.0, 1.0)),
    ):
        told = replace(first, told=replace(first.told, rest=rest))
        assert _speeds(found._replace(first=replace(found.first, role=told)), again=False)[0] == speeds
