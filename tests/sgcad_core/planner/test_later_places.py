"""A vehicle that stands until it is struck later stands where its partner comes by, as told and along its road."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.aftermath.struck_objects import standing_track
from sgcad_core.planner.encounter.meeting_place import Place
from sgcad_core.planner.later_places import ToBeStruck, not_waiting
from sgcad_core.planner.lines.maneuver_course import course_of
from sgcad_core.planner.scene import Scene
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


def test_drivers_wait_before_a_junction_not_in_it_nor_beside_the_road() -> None:
    surface = road_surface(network("four_leg"))
    center, before, beside = [0.0, 0.0, 0.0], [1.8, -40.0, math.pi / 2], [40.0, -40.0, 0.0]
    inside, on_road, off_road = not_waiting(surface, np.array([center, before, beside]))
    assert on_road == 0.0 < inside < off_road
    assert len(not_waiting(surface, np.zeros((0, 3)))) == 0
