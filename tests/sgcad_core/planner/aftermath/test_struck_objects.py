"""What is struck on the way to rest stands there, in order, and is struck by nobody before."""

from __future__ import annotations

import math
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

from sgcad_core.geometry.plane import Box, box_gaps, contact_area
from sgcad_core.planner import plan
from sgcad_core.planner.aftermath import struck_objects
from sgcad_core.records.course import CourseTold, RestTold
from sgcad_core.records.specs import Actor, Area, BehaviorSpec, Contact, size_m
from sgcad_core.roads.surface import road_surface
from tests.sgcad_core.planner.crash_scenes import network

CAR = (4.7, 1.8)


def crash(*things: Actor, more: tuple[Contact, ...] = ()) -> BehaviorSpec:
    """V1 eastbound strikes the right side of V2 southbound; V2 then strikes the things."""
    actors = (
        Actor(id="V1", kind="car", road="W", direction="forward", exit_road="E", maneuver="straight", speed_mph=40),
        Actor(id="V2", kind="car", road="N", direction="forward", exit_road="S", maneuver="straight", speed_mph=30),
        *things,
    )
    first = Contact(striker="V1", struck="V2", striker_area="front", struck_area="right")
    later = (Contact(striker="V2", struck=t.id, striker_area="front", struck_area="front") for t in things)
    return BehaviorSpec(actors=actors, contacts=(first, *more, *later))


def thing(number: int, kind: str = "object") -> Actor:
    return Actor(id=f"{'O' if kind == 'object' else 'P'}{number}", kind=kind, road="N", direction="forward",
                 maneuver="stopped", length_m=0.4, width_m=0.4)  # fmt: skip


def touches(behavior: BehaviorSpec, **more) -> tuple[list[tuple[str, str]], tuple[str, ...]]:
    """Pairs in the order in which they first overlap, and the notes."""
    made = plan(behavior, network("four_leg"), **more)
    tracks = {t.actor: t.pose for t in made.trajectories}
    sizes = {a.id: size_m(a) for a in behavior.actors}
    found = []
    for a, b in combinations(sorted(tracks), 2):
        hits = np.flatnonzero(box_gaps(tracks[a], sizes[a], tracks[b], sizes[b]) <= 0)
        found += [(int(hits[0]), a, b)] if len(hits) else []
    assert made.realised
    return [(a, b) for _, a, b in sorted(found)], made.notes


def test_a_pole_is_struck_behind_the_first_contact() -> None:
    found, notes = touches(crash(thing(1)))
    assert found == [("V1", "V2"), ("O1", "V2")], notes


def test_two_things_are_struck_in_their_order() -> None:
    found, notes = touches(crash(thing(2), thing(1)))
    assert found == [("V1", "V2"), ("O2", "V2"), ("O1", "V2")], notes


def test_somebody_beside_the_road_is_struck_too() -> None:
    found, notes = touches(crash(thing(1, "pedestrian")))
    assert found == [("V1", "V2"), ("P1", "V2")], notes


def test_a_thing_that_nobody_can_reach_is_told_and_touches_nobody() -> None:
    still = crash(thing(1)).model_copy(update={})
    slow = [a.model_copy(update={"speed_mph": 3}) if a.id.startswith("V") else a for a in still.actors]
    found, notes = touches(still.model_copy(update={"actors": tuple(slow)}))
    assert found == [("V1", "V2")]
    assert "V2 does not reach O1, which it strikes as told" in notes


def test_a_thing_that_is_not_reached_stands_beside_the_rest_where_there_is_no_room_ahead(monkeypatch) -> None:
    def room_beside(scene, strike, pose, size, until) -> bool:
        x, y, heading = scene.tracks[strike.by].poses[-1]
        return abs((pose[0] - x) * np.cos(heading) + (pose[1] - y) * np.sin(heading)) < 1.0

    monkeypatch.setattr(struck_objects, "_is_free", room_beside)
    track = SimpleNamespace(poses=np.array([[0.0, 0.0, 0.0], [20.0, 5.0, 0.3]]))
    post = SimpleNamespace(thing=thing(1), by="V2")
    pose = struck_objects._out_of_reach(SimpleNamespace(tracks={"V2": track}), post, None)
    assert np.hypot(*(pose[:2] - track.poses[-1, :2])) <= 60.0


@pytest.mark.parametrize("where", ["off_road", "shoulder"])
def test_the_rest_is_still_looked_for(where) -> None:
    told = {"V1": CourseTold(rest=RestTold(where=where))}
    found, _ = touches(crash(thing(1)), courses=told)
    assert ("O1", "V2") in found


def test_a_thing_is_struck_so_fast_that_a_file_shows_it() -> None:
    behavior = crash(thing(1))
    made = plan(behavior, network("four_leg"))
    track = next(t for t in made.trajectories if t.actor == "V2")
    post = next(t for t in made.trajectories if t.actor == "O1")
    gaps = box_gaps(track.pose, CAR, post.pose, (0.4, 0.4))
    hit = int(np.flatnonzero(gaps <= 0)[0])
    assert np.hypot(*(track.pose[hit - 1, :2] - track.pose[hit - 2, :2])) > 0.11


@pytest.mark.parametrize("firm", [True, False])
def test_a_firm_thing_stays_and_another_one_falls_where_its_vehicle_goes_on(firm: bool) -> None:
    things = (thing(1).model_copy(update={"firm": firm, "width_m": 3.0}), thing(2))
    made = plan(crash(*things), network("four_leg"))
    moved = next(math.dist(t.pose[0, :2], t.pose[-1, :2]) for t in made.trajectories if t.actor == "O1")
    assert moved == 0.0 if firm else 0.1 < moved < 8.0


@pytest.mark.parametrize("firm", [True, False])
def test_a_wall_that_is_struck_first_stays_where_it_stands(firm: bool) -> None:
    wall = Actor(id="O1", kind="object", road="W", direction="forward", maneuver="stopped", length_m=0.5, width_m=5.0,
                 firm=firm)  # fmt: skip
    car = Actor(id="V1", kind="car", road="W", direction="forward", exit_road="E", maneuver="straight", speed_mph=30)
    met = [Contact(striker="V1", struck=x, striker_area="front", struck_area="front") for x in ("O1", "O2")]
    made = plan(BehaviorSpec(actors=(car, wall, thing(2)), contacts=tuple(met)), network("four_leg"))
    moved = next(math.dist(t.pose[0, :2], t.pose[-1, :2]) for t in made.trajectories if t.actor == "O1")
    assert (moved == 0.0) is firm


@pytest.mark.parametrize(("first_mph", "second_mph"), [(25, 30), (25, 45), (40, 30)])
def test_a_firm_thing_stands_beside_the_road(first_mph: int, second_mph: int) -> None:
    behavior = crash(thing(1).model_copy(update={"firm": True}))
    speeds = {"V1": first_mph, "V2": second_mph, "O1": None}
    actors = tuple(a.model_copy(update={"speed_mph": speeds[a.id]}) for a in behavior.actors)
    graph = network("four_leg")
    made = plan(behavior.model_copy(update={"actors": actors}), graph)
    post = next(t for t in made.trajectories if t.actor == "O1")
    assert road_surface(graph).off(post.pose[:1, :2])[0][0] > 0.3


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("size_m", [(0.4, 0.4), (0.5, 0.5), (0.4, 14.0)])
def test_a_vehicle_that_drives_on_scrapes_a_thing_with_its_told_flank(side: Area, size_m: tuple[float, float]) -> None:
    rear, ahead = (
        Actor(id=name, kind="car", road="W", direction="forward", exit_road="E", maneuver="straight", speed_mph=mph)
        for name, mph in (("V1", 45), ("V2", 25))
    )
    post = thing(1).model_copy(update={"length_m": size_m[0], "width_m": size_m[1], "firm": True})
    contacts = (
        Contact(striker="V1", struck="V2", striker_area="front", struck_area="back"),
        Contact(striker="V2", struck="O1", striker_area=side, struck_area="front"),
    )
    made = plan(BehaviorSpec(actors=(rear, ahead, post), contacts=contacts), network("four_leg"))
    (struck, object_met) = (next(t for t in made.trajectories if t.actor == name).pose for name in ("V2", "O1"))
    hit = int(np.flatnonzero(box_gaps(struck, CAR, object_met, size_m) <= 0)[0])
    assert contact_area(Box.at(struck[hit], CAR), Box.at(object_met[hit], size_m)) == side


@pytest.mark.parametrize("goes_on", [True, False])
def test_a_vehicle_drives_over_what_lies_on_the_ground_and_it_stays(goes_on: bool) -> None:
    ditch = thing(1).model_copy(update={"flat": True, "length_m": 0.8})
    made = plan(crash(ditch, *([thing(2)] if goes_on else [])), network("four_leg"))
    car, there = (next(t for t in made.trajectories if t.actor == name) for name in ("V2", "O1"))
    assert np.ptp(there.x_m) == np.ptp(there.y_m) == 0.0
    away = box_gaps(car.pose, CAR, there.pose, size_m(ditch))
    over = np.flatnonzero(away <= 0)
    assert len(over)
    went = math.hypot(car.x_m[-1] - car.x_m[over[0]], car.y_m[-1] - car.y_m[over[0]])
    assert went > 1.0, "it stops dead"


def test_a_guardrail_runs_along_the_road_where_the_told_side_then_meets_it() -> None:
    rail = thing(1).model_copy(update={"firm": True, "width_m": 14.0})
    behavior = crash(rail)
    side = behavior.contacts[1].model_copy(update={"striker_area": "back"})
    behavior = behavior.model_copy(update={"contacts": (behavior.contacts[0], side)})
    made = plan(behavior, network("four_leg"))
    there = next(t for t in made.trajectories if t.actor == "O1")
    assert abs(math.sin(2 * float(there.heading_rad[0]))) < 0.02
    assert (made.notes, len(made.trajectories)) == ((), 3)
