"""What people find in an event file: lanes, routes, meetings, conditions; and what is told plainly instead."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.case.records import ObservedContact
from sgcad_core.execution.event_encoding import ASTRAY_M, write_editable
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.roads.lane_motion import lane_motion
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.openscenario.roads.way import LanePlace
from sgcad_core.formats.openscenario.writing.events import EventOptions, Fallbacks
from sgcad_core.formats.openscenario.writing.occasions import EventTriggers, between
from sgcad_core.formats.openscenario.writing.synchrony import FIRST_S, meeting_of
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.formats.xml import parse_xml
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from tests.sgcad_core.formats.xosc_samples import CROSSING, actor, crossroads, trajectory

K = np.arange(101)
T_S = K * 0.05
TOUCH = ObservedContact(actor="V1", other="V2", actor_area="front", other_area="right", t_s=4.35)
STRAIGHT = BehaviorSpec(
    actors=(
        Actor(id="V1", kind="car", road="S", direction="forward", maneuver="straight", speed_mph=30),
        Actor(id="V2", kind="car", road="W", direction="forward", maneuver="straight", speed_mph=30),
    ),
    contacts=(Contact(striker="V1", struck="V2", striker_area="front", struck_area="right"),),
)


def tags(text):
    return [element.tag for element in parse_xml(text, "xosc").iter()]


def northbound(aside_m, speed_mps=12.0):
    """From 110 m before the hub in the inner lane of the south leg, so many metres to the left of its line."""
    drift = np.arctan2(np.gradient(aside_m, T_S), speed_mps)
    return trajectory("V1", 1.8 - aside_m, -110 + speed_mps * T_S, np.pi / 2 + drift)


def alone(move):
    text = write_editable([actor("V1")], [move], None, EventOptions(None, crossroads().xodr), "1.2")
    seen = play(text, crossroads().xodr)[0]
    n = min(len(seen.t_s), len(move.t_s))
    assert np.hypot(seen.x_m[:n] - move.x_m[:n], seen.y_m[:n] - move.y_m[:n]).max() <= ASTRAY_M
    assert xosc_findings(text, crossroads().xodr) == []
    return tags(text)


def smooth(begin_s, span_s):
    u = np.clip((T_S - begin_s) / span_s, 0, 1)
    return u**3 * (10 - 15 * u + 6 * u * u)


# ------------------------------------------------------------------ ways
def test_who_crosses_a_junction_in_its_lane_has_a_route_and_no_path():
    told = tags(compile_scenario(STRAIGHT, crossroads(), encoding="events").xosc)
    assert told.count("AssignRouteAction") == 2
    assert "FollowTrajectoryAction" not in told


def test_a_change_to_the_next_lane_is_one():
    told = alone(northbound(-3.6 * smooth(1.0, 3.0)))
    assert told.count("LaneChangeAction") == 1
    assert "FollowTrajectoryAction" not in told


def test_a_drift_within_the_lane_is_an_offset():
    told = alone(northbound(1.1 * smooth(1.0, 2.5)))
    assert told.count("LaneOffsetAction") == 1
    assert "LaneChangeAction" not in told


def test_two_shifts_are_a_path():
    told = alone(northbound(1.5 * smooth(0.5, 2.0) - 1.5 * smooth(2.5, 2.0)))
    assert "FollowTrajectoryAction" in told
    assert not {"LaneOffsetAction", "LaneChangeAction"} & set(told)


def test_an_abrupt_shift_is_a_path():
    assert "FollowTrajectoryAction" in alone(northbound(1.5 * smooth(1.0, 0.8)))


def test_who_skids_in_its_lane_is_not_told_by_it():
    move = northbound(0 * T_S)
    skidding = move.model_copy(update={"heading_rad": move.heading_rad + 0.4 * smooth(2.0, 1.0)})
    assert lane_motion(move, XodrRoads(crossroads().xodr), 5.0) is not None
    assert lane_motion(skidding, XodrRoads(crossroads().xodr), 5.0) is None


def test_a_lane_that_ends_too_soon_tells_no_motion():
    assert lane_motion(northbound(0 * T_S), XodrRoads(crossroads().xodr), 400.0) is None


# ------------------------------------------------------------------ meetings
def test_of_two_at_even_speed_the_second_meets_the_first():
    scenario = compile_scenario(STRAIGHT, crossroads(), encoding="events")
    meeting = parse_xml(scenario.xosc, "xosc").find(".//SynchronizeAction")
    assert meeting.get("masterEntityRef") == "V1"
    assert len(list(meeting.iterfind(".//LanePosition"))) == 2


def test_the_meeting_holds_when_the_master_is_edited():
    """The point of it: a slower first vehicle is still met, though nothing else was changed."""
    scenario = compile_scenario(STRAIGHT, crossroads(), encoding="events")
    speed = parse_xml(scenario.xosc, "xosc").find("ParameterDeclarations/*[@name='V1_Speed']").get("value")
    slower = scenario.xosc.replace(f'value="{speed}"', f'value="{float(speed) - 1.0}"', 1)
    assert slower != scenario.xosc
    gaps = [
        min(np.hypot(a.x_m - b.x_m, a.y_m - b.y_m).min() for a, b in [play(text, crossroads().xodr)])
        for text in (scenario.xosc, slower)
    ]
    assert gaps[1] < gaps[0] + 1.0


def test_nobody_meets_who_changes_its_speed_or_stands():
    here, there = LanePlace("1", -1, 5.0, 0.0), LanePlace("2", -1, 5.0, 0.0)
    even = np.array([0.0, 4.0]), np.array([10.0, 10.0])
    brakes = np.array([0.0, 3.5, 4.0]), np.array([10.0, 10.0, 6.0])
    stands = np.array([0.0, 4.0]), np.array([10.0, 0.0])
    assert meeting_of((even, here), ("V1", even, there)).begin_s == FIRST_S
    assert meeting_of((even, here), ("V1", brakes, there)) is None
    assert meeting_of((even, here), ("V1", stands, there)) is None
    assert meeting_of((brakes, here), ("V1", even, there)) is None


# ------------------------------------------------------------------ conditions
def test_who_meets_somebody_acts_by_the_distance_of_the_other():
    scenario = compile_scenario(CROSSING, crossroads(), encoding="events")
    root = parse_xml(scenario.xosc, "xosc")
    nearer = root.findall(".//RelativeDistanceCondition")
    assert {c.get("entityRef") for c in nearer} <= {"V1", "V2"}
    assert {c.get("rule") for c in nearer} == {"lessThan"}


def test_a_condition_turns_true_in_the_planned_step():
    one, two = trajectory("V1", 10 * T_S, 0.0), trajectory("V2", 90 - 8 * T_S, 0.0)
    occasions = EventTriggers({"V1": one, "V2": two}, {"V1": "V2", "V2": "V1"})
    value = occasions.at("c", "V1", 2.0).entitycondition.value
    gap = two.x_m - one.x_m
    assert np.flatnonzero(gap < value)[0] == 40


def test_who_is_alone_acts_by_the_way_gone_and_who_stands_by_the_clock():
    goes, stands = trajectory("V1", 10 * T_S, 0.0), trajectory("V2", 0 * T_S, 9.0)
    occasions = EventTriggers({"V1": goes, "V2": stands}, {})
    assert 19.5 < occasions.at("c", "V1", 2.0).entitycondition.value < 20.0
    assert hasattr(occasions.at("c", "V2", 2.0), "valuecondition")
    assert hasattr(EventTriggers({"V1": goes}, {}, clock=True).at("c", "V1", 2.0), "valuecondition")


@pytest.mark.parametrize(("low", "high", "told"), [(19.6, 20.4, 20.0), (3.2, 3.4, 3.3), (3.201, 3.203, 3.202)])
def test_thresholds_have_few_digits(low, high, told):
    assert between(low, high) == between(high, low) == told


# ------------------------------------------------------------------ trial
def test_what_went_astray_is_told_plainly():
    moves = compile_scenario(STRAIGHT, crossroads()).planned
    actors = [actor("V1"), actor("V2")]
    plainly = Fallbacks(paths=frozenset({"V1", "V2"}), alone=True, clock=True)
    told = tags(write_xosc(actors, moves, None, handover=EventOptions(TOUCH, crossroads().xodr, plainly)))
    assert told.count("FollowTrajectoryAction") == 2
    assert not {"SynchronizeAction", "RelativeDistanceCondition", "TraveledDistanceCondition"} & set(told)


def test_a_contact_that_no_events_give_ends_in_the_plainest_words():
    """A made-up contact of two that never touch: every word is given up, and the file is still written."""
    moves = [northbound(0 * T_S), trajectory("V2", 50 + 0 * T_S, 50.0)]
    text = write_editable([actor("V1"), actor("V2")], moves, None, EventOptions(TOUCH, crossroads().xodr), "1.2")
    assert "FollowTrajectoryAction" in tags(text)
    assert not {"SynchronizeAction", "AssignRouteAction", "RelativeDistanceCondition"} & set(tags(text))
