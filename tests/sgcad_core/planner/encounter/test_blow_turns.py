"""The forecast of rotation tells places that turn a vehicle as told from those that turn it otherwise."""

from __future__ import annotations

from sgcad_core.planner.aftermath.impact import IMPACTS
from sgcad_core.planner.encounter.blow_turns import misturned, turns_told
from sgcad_core.planner.encounter.conflict import Conflicts
from sgcad_core.planner.encounter.encounter_search import along_sides
from sgcad_core.planner.lines.maneuver_course import course_of
from sgcad_core.records.course import CourseTold, RestTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from tests.sgcad_core.planner.crash_scenes import network


def places(told: CourseTold):
    """Encounters all along the right side of V2, southbound, that V1 strikes with its front, eastbound."""
    actors = tuple(
        Actor(id=name, kind="car", road=road, direction="forward", exit_road=exit_road, maneuver="straight",
              speed_mph=35)
        for name, road, exit_road in (("V1", "W", "E"), ("V2", "N", "S"))
    )  # fmt: skip
    contact = Contact(striker="V1", struck="V2", striker_area="front", struck_area="right")
    behavior = BehaviorSpec(actors=actors, contacts=(contact,))
    lines = {a.id: course_of(network("four_leg"), a, 3.0) for a in actors}
    found = Conflicts(behavior, lines, told={"V2": told}).of(contact)
    some = along_sides(found.meeting.first, found.meeting.second, ("front", "right"), 5)
    return [found._replace(meeting=meeting) for meeting in some]


def behind_m(found) -> float:
    """How far behind V2's center, along its way, the front of V1 comes."""
    v1, v2 = (
        motion.poses([own])[0]
        for motion, own in (
            (found.meeting.first, found.meeting.first_s),
            (found.meeting.second, found.meeting.second_s),
        )
    )
    return float(v1[1] - v2[1])


def test_a_blow_behind_the_center_turns_one_way_and_one_before_it_the_other() -> None:
    for spin, sign in (("clockwise", 1.0), ("counterclockwise", -1.0)):
        best = min(places(CourseTold(spin=spin, spin_deg=300.0)), key=misturned)
        assert sign * behind_m(best) > 0.0, spin


def test_only_a_told_rotation_or_facing_is_looked_for() -> None:
    assert not turns_told(places(CourseTold())[0])
    assert turns_told(places(CourseTold(spin="clockwise"))[0])
    assert turns_told(places(CourseTold(rest=RestTold(facing_deg=90.0)))[0])
    assert misturned(places(CourseTold())[0])[0] == 0.0


def test_of_several_frictions_that_is_taken_which_turns_the_vehicle_most_as_told() -> None:
    found = places(CourseTold(spin="clockwise", spin_deg=300.0))[0]
    each = {impact: misturned(found, [impact])[0] for impact in IMPACTS}
    off, best = misturned(found, IMPACTS)
    assert off == min(each.values()) == each[best]
    assert off < max(each.values())


def test_a_rotation_about_a_thing_that_stays_is_forecast_too() -> None:
    actors = (
        Actor(id="V1", kind="car", road="W", direction="forward", exit_road="E", maneuver="straight", speed_mph=35),
        Actor(id="O1", kind="object", road="W", direction="forward", maneuver="stopped", length_m=0.5, width_m=5.0),
    )
    contact = Contact(striker="V1", struck="O1", striker_area="front", struck_area="front")
    told = {"V1": CourseTold(spin="clockwise", spin_deg=90.0)}
    lines = {a.id: course_of(network("four_leg"), a, 3.0) for a in actors}
    found = Conflicts(BehaviorSpec(actors=actors, contacts=(contact,)), lines, told=told).of(contact)
    assert found is not None
    assert misturned(found, IMPACTS)[1] in IMPACTS
