"""The player: its clock, its end, boxes, parameters, and what it refuses."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.playing.player import entity_boxes, play
from tests.sgcad_core.formats.xosc_samples import (
    at,
    entity,
    event,
    follow,
    row,
    scenario,
    speed_action,
    timing,
    v1,
    when,
    world,
)

V1 = {"V1": world(0, 0)}
ORIGIN = '<WorldPosition x="0" y="0" h="0.0"/>'


# ------------------------------------------------------------------ clock and end
def test_the_clock_counts_steps():
    motion = v1(scenario(V1, speeds={"V1": 10}, end=at(100)))
    np.testing.assert_array_equal(motion.t_s, np.arange(2001) * 0.05)
    np.testing.assert_allclose(motion.x_m, motion.t_s * 10, atol=1e-9)


@pytest.mark.parametrize(("rule", "time", "last"), [
    ("greaterOrEqual", 2, 2.0), ("greaterThan", 2, 2.0), ("greaterThan", 2.02, 2.0), ("greaterOrEqual", 2.02, 2.0),
])  # fmt: skip
def test_rows_end_where_the_stop_time_lies(rule, time, last):
    assert v1(scenario(V1, end=at(time, rule))).t_s[-1] == pytest.approx(last)


def test_a_stop_by_a_condition_keeps_the_row_in_which_it_holds():
    places = {"V1": world(0, 0), "V2": world(20, 0)}
    touch = when('<CollisionCondition><EntityRef entityRef="V2"/></CollisionCondition>')
    motion = v1(scenario(places, speeds={"V1": 10}, end=touch))
    assert motion.x_m[-1] == pytest.approx(15.5)
    assert motion.x_m[-2] < 20 - 4.6


def test_without_stop_trigger_it_ends_with_its_stories():
    done = event("e", speed_action(20, "linear", "time", 2), at(1))
    text = scenario(V1, done, end="EMPTY").replace("<ConditionGroup>EMPTY</ConditionGroup>", "")
    assert v1(text).t_s[-1] == pytest.approx(3.0)


def test_a_scenario_that_never_ends_is_refused():
    with pytest.raises(InvalidOutput, match=r"does not end within 300 s .*-> add a <StopTrigger>"):
        play(scenario(V1, end=when('<SpeedCondition rule="greaterThan" value="99"/>')))


@pytest.mark.parametrize("time", [0, -1, 0.04])
def test_a_scenario_lasts_at_least_one_step(time):
    with pytest.raises(InvalidOutput, match="ends as soon as it begins"):
        play(scenario(V1, end=at(time)))


# ------------------------------------------------------------------ boxes and places
def test_trajectories_are_those_of_box_centers():
    text = scenario({"V1": world(10, 5, math.pi / 2)}, speeds={"V1": 2}, entities=entity("V1", center_x=1.4))
    assert entity_boxes(text)["V1"] == (4.6, 1.8, 1.4, 0.0)
    assert row(v1(text), 1.0) == pytest.approx((10, 5 + 1.4 + 2, math.pi / 2, 2))


@pytest.mark.parametrize(("tag", "orientation", "expected"), [
    ("RelativeWorldPosition", "", (13, 4, math.pi / 2)),
    ("RelativeObjectPosition", "", (6, 3, math.pi / 2)),
    ("RelativeObjectPosition", '<Orientation type="relative" h="1"/>', (6, 3, math.pi / 2 + 1)),
    ("RelativeWorldPosition", '<Orientation type="absolute" h="-1"/>', (13, 4, -1)),
])  # fmt: skip
def test_places_may_be_relative_to_an_entity(tag, orientation, expected):
    position = f'<Position><{tag} entityRef="V1" dx="3" dy="4">{orientation}</{tag}></Position>'
    text = scenario({"V1": world(10, 0, math.pi / 2), "V2": position})
    second = play(text)[1]
    assert (second.x_m[0], second.y_m[0], second.heading_rad[0]) == pytest.approx(expected)


# ------------------------------------------------------------------ parameters
def test_parameters_and_expressions_are_filled_in():
    declared = '<ParameterDeclaration name="v" parameterType="double" value="6"/>'
    speeds = {"V1": "${pow($v, 2) / round(4.2)}"}
    text = scenario({"V1": world("$v", "${2 * $v - 1}")}, speeds=speeds, parameters=declared)
    assert row(v1(text), 0) == pytest.approx((6, 11, 0, 9))


@pytest.mark.parametrize(("value", "message"), [
    ("$nope", r"unknown parameter .*found \$nope.*declared: v"),
    ("${1 / 0}", "expression cannot be evaluated"),
    ("${__import__('os')}", "expression cannot be evaluated"),
    ("${(1).real}", "expression cannot be evaluated"),
    ("${" + "+".join(["1"] * 600) + "}", "longer than 1000"),
    ("${pow(10, 400)}", "expression cannot be evaluated"),
    ("INF", "no finite number"),
    ("1e300", r"must lie within \+-1e\+09"),
    ("fast", "no finite number"),
])  # fmt: skip
def test_a_value_that_is_none_names_its_line(value, message):
    declared = '<ParameterDeclaration name="v" parameterType="double" value="6"/>'
    with pytest.raises(InvalidOutput, match=message) as caught:
        play(scenario(V1, speeds={"V1": value}, parameters=declared))
    assert "in line 2" in str(caught.value)
    assert caught.value.findings[0].source == "openscenario"


# ------------------------------------------------------------------ what is not supported
@pytest.mark.parametrize(("old", "new", "message"), [
    ("<LongitudinalAction>", "<LongitudinalAction><LongitudinalDistanceAction/>", "needs exactly one child"),
    ("<SpeedAction>", "<SpeedProfileAction>", "well-formed"),
    (ORIGIN, '<GeoPosition latitude="1" longitude="2"/>', "does not support <GeoPosition>"),
    (ORIGIN, '<LanePosition roadId="1" laneId="-1" s="0"/>', "needs a road network"),
    (ORIGIN, '<WorldPosition y="0"/>', "attribute 'x' is missing"),
    ("SimulationTimeCondition", "MoonPhaseCondition", "does not support <MoonPhaseCondition> as condition by value"),
    ('entityRef="V1"', 'entityRef="V7"', r"unknown entity .*found V7.*entities: V1"),
    ("<TeleportAction>", "<VisibilityAction/><TeleportAction>", "exactly one child"),
    ('dynamicsShape="step"', 'dynamicsShape="wild"', "must be one of step, linear"),
    ("<Vehicle ", "<Bicycle ", "well-formed"),
    ('length="4.6"', 'length="-4.6"', "'length' must be above 0"),
    ("Storyboard>", "Board>", "needs a <Storyboard>"),
])  # fmt: skip
def test_what_cannot_be_played_is_named_with_its_line(old, new, message):
    with pytest.raises(InvalidOutput, match=message) as caught:
        play(scenario(V1).replace(old, new))
    assert "line" in str(caught.value)


@pytest.mark.parametrize(("action", "message"), [
    ("<ControllerAction/>", "needs an <AssignControllerAction>"),
    ("<RoutingAction><AcquirePositionAction/></RoutingAction>", "at <AcquirePositionAction>"),
    ("<LateralAction><LaneOffsetAction/></LateralAction>", "at <LaneOffsetAction>"),
    (follow([(0, 0, 0, 0)], timing()), "2 to 50000 vertices .*found 1"),
    (follow([(1, 0, 0, 0), (0, 1, 0, 0)], timing()), "vertex times fall"),
    (follow([(None, 0, 0, 0), (0, 1, 0, 0)], timing()), "a vertex has no time"),
    (follow([(0, 1, 0, 0), (1, 2, 0, 0)], timing(scale=0)), "'scale' must be above 0"),

    (follow([(0, 1, 0, 0), (1, 2, 0, 0)]).replace("Polyline>", "Nurbs>"), "at <Nurbs>"),
    (speed_action(5, "linear", "time", -1), "'value' must not be below 0"),
])  # fmt: skip
def test_an_action_that_cannot_be_played_is_found_before_it_starts(action, message):
    with pytest.raises(InvalidOutput, match=message):
        play(scenario(V1, event("e", action, at(99))))


def test_an_untimed_trajectory_leads_somewhere():
    with pytest.raises(InvalidOutput, match="all vertices lie in one place"):
        play(scenario(V1, event("e", follow([(0, 1, 0, 0), (1, 1, 0, 0)]), at(1))))


def test_an_entity_without_place_is_named():
    with pytest.raises(InvalidOutput, match=r"no initial place .*found V2"):
        play(scenario(V1, entities=entity("V1") + entity("V2")))


@pytest.mark.parametrize("dimension", ["time", "rate", "distance"])
def test_a_change_over_nothing_happens_at_once(dimension):
    motion = play(scenario(V1, event("e", speed_action(7, "linear", dimension, 0), at(1)), {"V1": 3}))[0]
    assert motion.speed_mps[19:22] == pytest.approx([3, 7, 7])


# ------------------------------------------------------------------ hostile files
def test_entities_and_bombs_are_refused():
    bomb = '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]>'
    with pytest.raises(InvalidOutput, match="document types and entities are not allowed"):
        play(scenario(V1).replace("<OpenSCENARIO>", f"{bomb}<OpenSCENARIO>").replace('author="test"', 'author="&b;"'))


def test_huge_files_and_counts_are_refused():
    with pytest.raises(InvalidOutput, match="20000030 characters, at most 20000000"):
        play("<OpenSCENARIO></OpenSCENARIO>".ljust(20_000_030))
    with pytest.raises(InvalidOutput, match=r"1 to 200 scenario objects .*found 201"):
        play(scenario(V1, entities="".join(entity(f"V{i}") for i in range(201))))
    with pytest.raises(InvalidOutput, match=r"2 to 50000 vertices .*found 50001"):
        play(scenario(V1, event("e", follow([(i, i, 0, None) for i in range(50001)], timing()), at(0))))
    with pytest.raises(InvalidOutput, match="no well-formed XML"):
        play("<OpenSCENARIO>" + "<a>" * 5000)


@pytest.mark.parametrize("text", ["", "not xml", "<a/>", "\x00", "<OpenSCENARIO/>"])
def test_what_is_no_scenario_is_invalid(text):
    with pytest.raises(InvalidOutput):
        play(text)


def test_poses_are_the_rear_axles_even_where_a_file_places_it_elsewhere():
    """Such a file contradicts itself; every player moves the box so that the rear axle is the origin."""
    own = scenario(V1, entities=entity("V1"))
    moved = own.replace('positionX="0"', 'positionX="-1.4"')
    assert entity_boxes(moved)["V1"] == (4.6, 1.8, 1.4, 0.0)
    assert play(moved)[0].x_m[0] == pytest.approx(play(own)[0].x_m[0] + 1.4)


def test_the_speed_of_a_row_is_that_of_the_box_center():
    """A body that turns about its rear axle stands there, yet its center moves."""
    turn = [(share, 0, 0, share) for share in np.linspace(0, 1, 21)]
    text = scenario(V1, event("e", follow(turn, timing()), at(0)), entities=entity("V1", 1.4))
    motion = v1(text)
    assert motion.speed_mps[10] == pytest.approx(1.4, abs=1e-3)
