"""Encounters behind untold driving out of the lanes are not taken; told maneuvers may leave them."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from sgcad_core.case.records import ActorInfo
from sgcad_core.execution.scenario import actor_infos
from sgcad_core.metrics.lane_places import lane_steps
from sgcad_core.metrics.untold_places import untold_places
from sgcad_core.planner import Plan, plan
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.records.course import Courses, CourseTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from tests.effort import spread
from tests.sgcad_core.planner.crash_scenes import network


def actor(name: str, maneuver: str, road: str, **more: object) -> Actor:
    fields = {"id": name, "kind": "car", "road": road, "direction": "forward", "maneuver": maneuver}
    return Actor.model_validate(fields | more)


def planned(layout: str, first: Actor, second: Actor, sides: tuple[str, str], courses: Courses | None = None) -> Plan:
    said = Contact.model_validate({"striker": "V1", "struck": "V2", "striker_area": sides[0], "struck_area": sides[1]})
    return plan(BehaviorSpec(actors=(first, second), contacts=(said,)), network(layout), courses=courses or {})


def out(layout: str, made: Plan, *actors: Actor) -> list[str]:
    infos: tuple[ActorInfo, ...] = actor_infos(BehaviorSpec(actors=actors))
    return [one.actor for one in untold_places(network(layout), made.trajectories, infos, CrashFacts(()))]


SIDES = [("front", "back"), ("right", "left"), ("left", "left"), ("front", "left")]


@pytest.mark.parametrize(("layout", "sides"), spread(product(("straight", "straight_wide"), SIDES), 3))
def test_two_that_drive_one_way_stay_in_their_lanes_whatever_sides_are_told(layout, sides) -> None:
    road = "S" if layout == "straight" else "E"
    pair = actor("V1", "straight", road), actor("V2", "straight", road)
    assert out(layout, planned(layout, *pair, sides), *pair) == []


def test_a_lane_change_without_a_lane_beside_is_not_driven_on_the_wrong_side() -> None:
    pair = actor("V1", "lane_change_left", "S"), actor("V2", "straight", "S")
    made = planned("straight", *pair, ("left", "right"))
    assert out("straight", made, *pair) == []


def test_a_told_crossing_and_a_told_swerve_may_leave_the_lanes() -> None:
    pair = actor("V1", "crossing_centerline", "S"), actor("V2", "straight", "N")
    made = planned("straight", *pair, ("front", "front"))
    assert made.realised
    steps = lane_steps(network("straight"), made.trajectories[0].pose)
    assert "opposing" in steps.places
    swerves = actor("V1", "straight", "S"), actor("V2", "straight", "N")
    told = {"V1": CourseTold(steers="left")}
    assert planned("straight", *swerves, ("front", "front"), told).realised


def test_a_stop_is_in_the_lane_and_before_the_junction() -> None:
    pair = actor("V1", "straight", "S"), actor("V2", "stopped", "S")
    made = planned("four_leg", *pair, ("front", "back"))
    places = lane_steps(network("four_leg"), made.trajectories[1].pose[:10]).places
    assert set(places) == {"lane"}


def test_the_center_turn_lane_is_driven_from_both_ends_and_turned_from() -> None:
    for road, exit_road in (("E", "S"), ("W", "N")):
        pair = (actor("V1", "turn_left", road, exit_road=exit_road, lane=3),
                actor("V2", "straight", "W" if road == "E" else "E"))  # fmt: skip
        made = planned("four_leg_turn_lanes", *pair, ("right", "front"))
        before = made.trajectories[0].pose[:40]
        assert set(lane_steps(network("four_leg_turn_lanes"), before).places) == {"center_lane"}
        assert made.realised, made.notes
        assert np.abs(np.diff(np.unwrap(made.trajectories[0].heading_rad))).max() < 0.2
