"""What no crash has is a lack, on one real execution that is moved by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.odd_scenes import odd_scenes
from sgcad_core.reading.actors.people_objects import OtherFacts
from sgcad_core.records.course import CourseTold, RestTold
from sgcad_core.records.specs import Actor
from tests.sgcad_core.account.test_account_parts import fact as stated
from tests.sgcad_core.account.test_account_parts import made, telling

__all__ = ["made"]


def fields(case: ExecutedCase) -> set[str]:
    return {item.field for item in odd_scenes(case)}


def moved(case: ExecutedCase, who: str, poses: np.ndarray) -> ExecutedCase:
    """The execution with other poses of one actor."""
    tracks = tuple(
        track.model_copy(update={"x_m": poses[:, 0], "y_m": poses[:, 1], "heading_rad": poses[:, 2],
                                 "speed_mps": np.zeros(len(poses))}) if track.actor == who else track
        for track in case.execution.trajectories
    )  # fmt: skip
    return replace(case, execution=case.execution.model_copy(update={"trajectories": tracks}))


def with_actor(case: ExecutedCase, **update: object) -> ExecutedCase:
    """The scenario with its second vehicle as another kind of actor."""
    behavior = case.scenario.behavior
    first, second, *rest = behavior.actors
    second = Actor.model_validate(second.model_dump() | update)
    scenario = case.scenario.model_copy(
        update={"behavior": behavior.model_copy(update={"actors": (first, second, *rest)})}
    )
    return replace(case, scenario=scenario)


def test_an_ordinary_crash_has_nothing_odd(made):
    assert fields(made) == set()


@pytest.mark.parametrize(("y_m", "odd"), [(0.0, True), (-30.0, False)])
def test_one_that_waits_stands_before_the_junction(made, y_m, odd):
    case = telling(with_actor(made, maneuver="stopped"), stated("vehicles.V2.maneuver", "stopped"))
    poses = np.tile([1.6, y_m, math.pi / 2], (len(case.tracks["V2"].t_s), 1))
    assert ("vehicles.V2.waits" in fields(moved(case, "V2", poses))) is odd


@pytest.mark.parametrize(("turned_deg", "x_m", "odd"), [(0, 20.0, False), (30, 20.0, True), (0, 1.6, True)])
def test_a_rail_runs_along_the_road_beside_its_lanes(made, turned_deg, x_m, odd):
    case = with_actor(made, kind="object", length_m=0.4, width_m=14.0, firm=True, maneuver="stopped")
    poses = np.tile([x_m, -60.0, math.pi + math.radians(turned_deg)], (len(case.tracks["V2"].t_s), 1))
    assert ("others.V2.place" in fields(moved(case, "V2", poses))) is odd


@pytest.mark.parametrize(("turned_deg", "odd"), [(0, False), (90, False), (45, True)])
def test_a_rail_at_a_corner_runs_along_either_road(made, turned_deg, odd):
    case = with_actor(made, kind="object", length_m=0.4, width_m=14.0, firm=True, maneuver="stopped")
    poses = np.tile([18.0, 12.0, math.pi + math.radians(turned_deg)], (len(case.tracks["V2"].t_s), 1))
    assert ("others.V2.place" in fields(moved(case, "V2", poses))) is odd


@pytest.mark.parametrize(("turn_deg", "way_m", "odd"), [(150, 1.0, True), (150, 30.0, False), (40, 1.0, False)])
def test_a_wreck_turns_as_it_slides_and_not_on_the_spot(made, turn_deg, way_m, odd):
    track, hit = made.tracks["V2"], made.crash.first_of("V2")
    poses, since = track.pose.copy(), np.linspace(0.0, 1.0, len(track.t_s) - hit)
    poses[hit:, 2] = poses[hit, 2] + math.radians(turn_deg) * since
    poses[hit:, 0] = poses[hit, 0] + way_m * since
    poses[hit:, 1] = poses[hit, 1]
    assert ("vehicles.V2.turns" in fields(moved(made, "V2", poses))) is odd


def test_what_lies_in_the_road_lies_in_its_lanes(made):
    crash = replace(made.reading.crash, others=(OtherFacts("V2", "object", "tree", lies="across"),))
    case = replace(made, reading=replace(made.reading, crash=crash))
    count = len(case.tracks["V2"].t_s)
    assert "others.V2.place" in fields(moved(case, "V2", np.tile([20.0, 60.0, 0.0], (count, 1))))
    assert "others.V2.place" not in fields(moved(case, "V2", np.tile([1.6, 60.0, 0.0], (count, 1))))


def test_an_animal_that_comes_from_beside_the_road_is_in_it_when_it_is_struck(made):
    crash = replace(made.reading.crash, others=(OtherFacts("V2", "animal", "elk", lies="along"),))
    case = replace(made, reading=replace(made.reading, crash=crash))
    track, hit = case.tracks["V2"], case.crash.first_of("V2")
    poses = track.pose.copy()
    poses[: hit // 2, 0] += 60.0
    assert made.crash.surface.off(poses[:1, :2])[0][0] > 0.0
    assert "others.V2.place" not in fields(moved(case, "V2", poses))


def test_one_that_rests_on_the_road_does_not_leave_it_first(made):
    told = MappingProxyType({"V2": CourseTold(rest=RestTold(where="road"))})
    crash = replace(made.reading.crash, courses=told)
    case = replace(made, reading=replace(made.reading, crash=crash))
    track, hit = case.tracks["V2"], case.crash.first_of("V2")
    poses, half = track.pose.copy(), (len(track.t_s) + hit) // 2
    poses[hit + 1 : half, :2] = poses[hit, :2] + [40.0, 40.0]
    poses[half:] = poses[hit]
    assert "vehicles.V2.rest.way" in fields(moved(case, "V2", poses))
