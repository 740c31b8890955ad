"""A told change of lane or turn is seen before the contact."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgcad_core.case.records import Trajectory
from sgcad_core.planner import Plan, plan
from sgcad_core.planner.lines.maneuver_course import course_of
from sgcad_core.planner.maneuver_visible import unseen_evasion, unseen_maneuver
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import Actor, BehaviorSpec
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_plan_rules import actor, at_contact, contact, planned, track


def sideways(t: Trajectory, k: int) -> float:
    """Metres to the left of where it first headed, at a sample."""
    c, s = math.cos(t.heading_rad[0]), math.sin(t.heading_rad[0])
    return float((t.y_m[k] - t.y_m[0]) * c - (t.x_m[k] - t.x_m[0]) * s)


@pytest.mark.parametrize(("maneuver", "way"), [("lane_change_left", 1), ("lane_change_right", -1)])
@pytest.mark.parametrize("other", ["stopped", "slowing"])
def test_who_pulls_out_behind_another_has_left_its_line_when_it_strikes(maneuver, way, other) -> None:
    _, made = planned("straight_wide", actor("V2", maneuver, "E", lane=1 if way > 0 else 2),
                      actor("V1", other, "E", lane=1 if way > 0 else 2), contacts=("V2 front V1 back",))  # fmt: skip
    assert made.realised
    assert way * sideways(track(made, "V2"), at_contact(made)) > 1.0


def test_a_right_turn_into_the_rear_of_one_ahead_has_begun() -> None:
    _, made = planned("four_leg", actor("V2", "turn_right", "N", "W"), actor("V1", "straight", "N", "S"),
                      contacts=("V2 front V1 back",))  # fmt: skip
    assert made.realised
    t, k = track(made, "V2"), at_contact(made)
    assert math.degrees(t.heading_rad[k] - t.heading_rad[0]) < -12


def test_a_merge_on_the_other_ones_own_road_is_a_change_of_lane() -> None:
    _, made = planned("four_leg_wide", actor("V2", "merge", "E", "W"), actor("V1", "straight", "E", "W", lane=1),
                      contacts=("V2 front V1 back",))  # fmt: skip
    assert made.realised
    assert abs(sideways(track(made, "V2"), at_contact(made))) > 1.0


@pytest.mark.parametrize(("hand", "way"), [("left", 1.0), ("right", -1.0), ("either", 1.0)])
def test_an_evasion_that_is_not_seen_is_noted(hand, way) -> None:
    _, made = planned("four_leg", actor("V1", "straight", "S"))
    t = track(made, "V1")
    north = t.y_m[0] + 12.0 * 0.05 * np.arange(80)
    ahead = np.column_stack((np.full(80, t.x_m[0]), north, np.full(80, math.pi / 2)))
    course = course_of(network("four_leg"), actor("V1", "straight", "S"), 3.0)
    steers, brakes = CourseTold(steers=hand), CourseTold(brakes=True)
    assert [*unseen_evasion("V1", course, steers, ahead)] == ["V1 has hardly begun to steer aside when they touch"]
    assert [*unseen_evasion("V1", course, brakes, ahead)] == ["V1 has hardly begun to brake when they touch"]
    aside = ahead.copy()
    aside[-20:, 0] -= way * np.linspace(0.0, 0.6, 20)  # northbound: left is west
    assert not [*unseen_evasion("V1", course, steers, aside)]
    slows = ahead.copy()
    slows[-20:, 1] -= 0.5 * 4.0 * (np.arange(20) * 0.05) ** 2
    assert not [*unseen_evasion("V1", course, brakes, slows)]


def test_a_maneuver_that_is_not_seen_is_noted() -> None:
    turner, passer = actor("V1", "turn_left", "S", "W"), actor("V2", "lane_change_left", "S")
    _, made = planned("four_leg", actor("V1", "straight", "S"))
    t = track(made, "V1")
    ahead = np.column_stack((t.x_m, t.y_m, t.heading_rad))
    course = course_of(network("four_leg"), passer, 3.0)
    assert unseen_maneuver(turner, course, ahead) == "V1 has hardly begun to turn when they touch"
    assert unseen_maneuver(passer, course, ahead) == "V2 has hardly begun to change lanes when they touch"
    aside = ahead + np.column_stack((np.linspace(0.0, -1.5, len(ahead)), np.zeros((len(ahead), 2))))
    assert unseen_maneuver(passer, course, aside) is None
    assert unseen_maneuver(actor("V1", "straight", "S"), course, ahead) is None


def told(courses: dict[str, CourseTold], *actors: Actor, contacts: tuple[str, ...]) -> Plan:
    behavior = BehaviorSpec(actors=actors, contacts=tuple(contact(c) for c in contacts))
    return plan(behavior, network("four_leg_wide"), courses=courses)


def speed_before(made: Plan, who: str, seconds: float) -> float:
    """Mean speed in the last tenth of a second that ends so long before the contact, m/s."""
    t, k = track(made, who), at_contact(made) - round(seconds / 0.05) - 1
    return math.hypot(t.x_m[k] - t.x_m[k - 2], t.y_m[k] - t.y_m[k - 2]) / 0.1


def test_told_braking_lasts_until_the_contact() -> None:
    made = told({"V2": CourseTold(brakes=True)}, actor("V1", "stopped", "E"), actor("V2", "straight", "E"),
                contacts=("V2 front V1 back",))  # fmt: skip
    assert made.realised
    assert speed_before(made, "V2", 0.0) < speed_before(made, "V2", 0.3) - 0.8


def test_a_speed_told_at_the_impact_is_that_of_the_contact_though_it_brakes() -> None:
    one = actor("V2", "straight", "E", speed_mph=30)
    made = told({"V2": CourseTold(brakes=True, speed_at_impact=True)}, actor("V1", "stopped", "E"), one,
                contacts=("V2 front V1 back",))  # fmt: skip
    assert speed_before(made, "V2", 0.0) == pytest.approx(30 * 0.44704, rel=0.12)
    assert speed_before(made, "V2", 1.5) > 1.2 * 30 * 0.44704


def test_who_turned_and_stopped_in_the_way_stands_when_it_is_struck() -> None:
    made = told({"V1": CourseTold(stops=True)}, actor("V1", "turn_left", "S", "W"), actor("V2", "straight", "W", "E"),
                contacts=("V2 front V1 left",))  # fmt: skip
    assert made.realised
    assert [speed_before(made, "V1", s) for s in (0.0, 0.4)] == pytest.approx([0.0, 0.0], abs=0.1)
    assert speed_before(made, "V1", 3.0) > 1.0


def test_one_that_slows_is_never_faster_than_the_one_behind_that_strikes_it() -> None:
    made = told({}, actor("V1", "slowing", "E"), actor("V2", "straight", "E", speed_mph=20),
                contacts=("V2 front V1 back",))  # fmt: skip
    assert made.realised
    assert speed_before(made, "V1", 0.0) < 0.5 * 20 * 0.44704
