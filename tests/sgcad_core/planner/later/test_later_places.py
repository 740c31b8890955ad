"""A vehicle that stands until it is struck later stands where its partner comes by, as told and along its road."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.aftermath.struck_objects import standing_track
from sgcad_core.planner.encounter.meeting_place import Place
from sgcad_core.planner.later.later_places import ToBeStruck, is_astray, is_slowed, lane_line, not_as_told, not_waiting
from sgcad_core.planner.lines.maneuver_course import course_of
from sgcad_core.planner.scene import Scene, Track
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import Actor, Area, size_m
from sgcad_core.roads.surface import road_surface
from tests.sgcad_core.planner.crash_scenes import network

_GRAPH = network("straight")


def search(sides: tuple[Area, Area], mps: float = 12.0, maneuver: str = "parked") -> ToBeStruck:
    """V1 drives northwards beside the road at a speed; V3 is to be struck by it."""
    scene = Scene(200, 40)
    one, two = (
        Actor.model_validate({"id": name, "kind": "car", "road": "S", "direction": "forward", "maneuver": maneuver})
        for name in ("V1", "V3")
    )
    scene.tracks["V1"] = track = standing_track(scene, one, np.array([6.0, -60.0, math.pi / 2]))
    driven = track.driven.copy()
    driven[:, 1] += mps * 0.05 * np.minimum(np.arange(scene.count), 120)
    track.driven = track.poses = driven
    role = Role(two, course_of(_GRAPH, two, 3.0), size_m(two), Place(0.0, 0.0, 0.0, 0.0))
    return ToBeStruck(scene, role, "V1", sides, road_surface(_GRAPH), more=False)


@pytest.mark.parametrize(("side", "turned"), [("back", 0.0), ("front", 180.0), ("left", 90.0), ("right", 90.0)])
def test_the_told_side_faces_the_partner(side: Area, turned: float) -> None:
    pose = next(iter(search(("front", side)).poses(45)))
    assert abs(math.degrees(math.remainder(pose[2] - math.pi / 2, 2 * math.pi))) == pytest.approx(turned, abs=1.0)


def test_it_stands_where_the_partner_comes_after_the_last_contact() -> None:
    place = search(("front", "back"))
    pose = next(iter(place.poses(80)))
    driven = place.scene.tracks["V1"].driven
    assert pose[1] > driven[80, 1] + 4.0
    assert pose[1] < driven[-1, 1] + 5.0


def test_one_that_waits_in_traffic_is_not_put_beside_the_road_first() -> None:
    beside = next(iter(search(("front", "back"), maneuver="parked").poses(45)))
    assert beside[0] > 5.0
    assert list(search(("front", "back"), maneuver="stopped").poses(45))


def test_a_partner_that_stands_strikes_nobody() -> None:
    assert list(search(("front", "back"), mps=0.0).poses(45)) == []


def test_a_gentle_push_is_enough_where_there_is_no_more() -> None:
    assert list(search(("front", "back"), mps=1.0).poses(45))


def at(maneuver: str, pose: tuple[float, float, float]) -> tuple[Role, Track]:
    actor = Actor.model_validate({"id": "V3", "kind": "car", "road": "S", "direction": "forward", "maneuver": maneuver})
    course = course_of(network("four_leg"), actor, 3.0)
    role = Role(actor, course, size_m(actor), Place(course.start_m + 225.0, 0.0, 0.0, 0.0))
    return role, standing_track(Scene(200, 40), actor, np.array(pose))


@pytest.mark.parametrize(("maneuver", "pose", "astray"), [
    ("stopped", (1.8, -40.0, math.pi / 2), False),
    ("stopped", (1.8, 0.0, math.pi / 2), True),
    ("stopped", (12.0, -40.0, math.pi / 2), True),
    ("parked", (4.5, -40.0, math.pi / 2), False),
    ("parked", (15.0, -40.0, math.pi / 2), True),
    ("straight", (1.8, 0.0, math.pi / 2), False),
    ("straight", (5.0, -40.0, math.pi / 2), True),
    ("lane_change_left", (-1.8, -40.0, math.pi / 2), False),
])  # fmt: skip
def test_one_that_is_struck_beside_its_lane_is_astray(
    maneuver: str, pose: tuple[float, float, float], astray: bool
) -> None:
    role, track = at(maneuver, pose)
    assert is_astray(role, track, road_surface(network("four_leg"))) == astray


def test_one_that_steers_as_told_is_not_astray() -> None:
    role, track = at("straight", (5.0, -40.0, math.pi / 2))
    assert not is_astray(replace(role, told=CourseTold(steers="right")), track, road_surface(network("four_leg")))


@pytest.mark.parametrize(
    ("told_mph", "mps", "slowed"), [(40, 17.9, False), (40, 9.0, True), (40, 25.0, True), (None, 3.0, False)]
)
def test_one_that_never_drives_at_its_told_speed_is_slowed(told_mph: int | None, mps: float, slowed: bool) -> None:
    role, track = at("straight", (1.8, -40.0, math.pi / 2))
    role = replace(role, actor=role.actor.model_copy(update={"speed_mph": told_mph}))
    track.motion = replace(track.motion, standing=False)
    track.poses = track.poses + np.outer(np.arange(len(track.poses)) * mps * 0.05, (0.0, 1.0, 0.0))
    assert is_slowed(role, track) == slowed
    assert not_as_told(role, track, road_surface(network("four_leg"))) >= slowed


def test_the_line_of_one_that_waits_ends_before_the_junction() -> None:
    waits, drives, parked = (lane_line(at(m, (1.8, -40.0, math.pi / 2))[0]) for m in ("stopped", "straight", "parked"))
    assert waits[:, 1].max() < -5.0 < drives[:, 1].max()
    assert parked[0, 0] > drives[0, 0] + 2.0


def test_drivers_wait_before_a_junction_not_in_it_nor_beside_the_road() -> None:
    surface = road_surface(network("four_leg"))
    center, before, beside = [0.0, 0.0, 0.0], [1.8, -40.0, math.pi / 2], [40.0, -40.0, 0.0]
    inside, on_road, off_road = not_waiting(surface, np.array([center, before, beside]))
    assert on_road == 0.0 < inside < off_road
    assert len(not_waiting(surface, np.zeros((0, 3)))) == 0
