"""Contacts after the first one come about in told order, whoever is there already."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from sgcad_core.geometry.plane import Box, box_gaps, contact_area
from sgcad_core.planner import Plan, plan
from sgcad_core.planner.aftermath.later_contacts import expect_later_contacts, strikes_of
from sgcad_core.planner.scene import Scene
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, size_m
from sgcad_core.roads.surface import road_surface
from tests.sgcad_core.planner.crash_scenes import network


def car(number: int, road: str, maneuver: str = "straight", **more: object) -> Actor:
    fields = {"id": f"V{number}", "kind": "car", "road": road, "direction": "forward", "maneuver": maneuver}
    return Actor.model_validate(fields | more)


def hits(*told: str) -> tuple[Contact, ...]:
    """Contacts of words such as "V1 front V2 back"."""
    parts = (words.split() for words in told)
    return tuple(
        Contact.model_validate({"striker": a, "striker_area": own, "struck": b, "struck_area": other})
        for a, own, b, other in parts
    )


def order(behavior: BehaviorSpec, made: Plan) -> list[tuple[str, str]]:
    """Pairs in the order in which they first overlap."""
    tracks, sizes = {t.actor: t.pose for t in made.trajectories}, {a.id: size_m(a) for a in behavior.actors}
    found = []
    for a, b in combinations(sorted(tracks), 2):
        at = np.flatnonzero(box_gaps(tracks[a], sizes[a], tracks[b], sizes[b]) <= 0)
        found += [(int(at[0]), a, b)] if len(at) else []
    return [(a, b) for _, a, b in sorted(found)]


def met(layout: str, actors: tuple[Actor, ...], *told: str) -> list[tuple[str, str]]:
    behavior = BehaviorSpec(actors=actors, contacts=hits(*told))
    made = plan(behavior, network(layout))
    assert made.realised, made.notes
    return order(behavior, made)


def test_a_queue_is_pushed_together_from_behind() -> None:
    queue = (car(1, "S"), *(car(n, "S", "stopped") for n in (2, 3, 4)))
    told = ("V1 front V2 back", "V2 front V3 back", "V3 front V4 back")
    assert met("straight", queue, *told) == [("V1", "V2"), ("V2", "V3"), ("V3", "V4")]


def test_the_one_ahead_of_a_struck_vehicle_may_be_under_way() -> None:
    row = (car(1, "S"), car(2, "S"), car(3, "S"))
    found = met("straight", row, "V1 front V2 back", "V2 front V3 back")
    assert found[:2] == [("V1", "V2"), ("V2", "V3")]


@pytest.mark.parametrize("side", ["left", "back"])
def test_a_vehicle_strikes_one_parked_car_and_then_another(side: str) -> None:
    cars = (car(1, "S", "departing_road_right"), car(2, "S", "parked"), car(3, "S", "parked"))
    assert met("straight", cars, "V1 front V2 back", f"V1 front V3 {side}") == [("V1", "V2"), ("V1", "V3")]


def test_one_that_comes_later_strikes_a_wreck() -> None:
    cars = (car(1, "W", exit_road="E"), car(2, "N", exit_road="S"), car(3, "W", exit_road="E"))
    found = met("four_leg", cars, "V1 front V2 right", "V3 front V1 back")
    assert found[:2] == [("V1", "V2"), ("V1", "V3")]


def test_two_others_meet_after_the_first_two() -> None:
    cars = (car(1, "S"), car(2, "S", "stopped"), car(3, "N"), car(4, "N", "stopped"))
    assert met("straight", cars, "V1 front V2 back", "V3 front V4 back") == [("V1", "V2"), ("V3", "V4")]


def test_a_thing_between_two_contacts_of_vehicles_is_struck_between_them() -> None:
    post = Actor(id="O1", kind="object", road="S", direction="forward", maneuver="stopped", length_m=0.4, width_m=0.4)
    cars = (car(1, "S", "departing_road_right"), car(2, "S", "parked"), car(3, "S", "parked"), post)
    told = ("V1 front V2 back", "V1 front O1 front", "V1 front V3 back")
    assert met("straight", cars, *told) == [("V1", "V2"), ("O1", "V1"), ("V1", "V3")]


def test_a_contact_that_nobody_can_bring_about_is_told() -> None:
    cars = (car(1, "S", speed_mph=10), car(2, "S", "stopped"), car(3, "N", "stopped"), car(4, "N", "stopped"))
    behavior = BehaviorSpec(actors=cars, contacts=hits("V1 front V2 back", "V1 back V3 left"))
    made = plan(behavior, network("straight"))
    assert ("V1", "V3") in order(behavior, made) or "later contact of V1 and V3 could not be arranged" in made.notes


def test_things_struck_in_a_row_give_way_to_the_vehicle() -> None:
    posts = tuple(Actor(id=f"O{n}", kind="object", road="S", direction="forward", maneuver="stopped", length_m=0.4,
                        width_m=0.4) for n in (1, 2, 3))  # fmt: skip
    cars = (car(1, "S", "departing_road_right"), *posts)
    told = tuple(f"V1 front O{n} front" for n in (1, 2, 3))
    assert met("straight", cars, *told) == [("O1", "V1"), ("O2", "V1"), ("O3", "V1")]


@pytest.mark.parametrize("told", ["V2 front V3 left", "V2 left V3 left", "V2 right V3 front"])
def test_a_struck_vehicle_meets_an_oncoming_one_on_the_told_sides(told: str) -> None:
    cars = (car(1, "S"), car(2, "S", "stopped"), car(3, "N"))
    behavior = BehaviorSpec(actors=cars, contacts=hits("V1 front V2 back", told))
    made = plan(behavior, network("straight"))
    _, own, _, other = told.split()
    assert touching_sides(behavior, made, "V2", "V3") == (own, other)


def touching_sides(behavior: BehaviorSpec, made: Plan, one: str, other: str) -> tuple[str, str]:
    """The sides on which two first overlap."""
    tracks, sizes = {t.actor: t.pose for t in made.trajectories}, {a.id: size_m(a) for a in behavior.actors}
    at = int(np.flatnonzero(box_gaps(tracks[one], sizes[one], tracks[other], sizes[other]) <= 0)[0])
    boxes = [Box.at(tracks[name][at], sizes[name]) for name in (one, other)]
    return contact_area(*boxes), contact_area(*reversed(boxes))


def test_those_that_are_pushed_into_one_another_at_a_light_stand_before_the_junction() -> None:
    cars = (car(1, "S", exit_road="N"), *(car(n, "S", "stopped", exit_road="N") for n in (2, 3, 4)))
    told = ("V1 front V2 back", "V2 front V3 back", "V3 front V4 back")
    behavior, graph = BehaviorSpec(actors=cars, contacts=hits(*told)), network("four_leg")
    made = plan(behavior, graph)
    assert order(behavior, made) == [("V1", "V2"), ("V2", "V3"), ("V3", "V4")]
    (junction,) = road_surface(graph).junctions
    for one in made.trajectories[1:]:
        assert junction.out_m(np.array([[one.x_m[0], one.y_m[0] + 2.3 - 1.0]]))[0] > 0.0, one.actor


def test_a_rail_is_struck_a_second_time_with_another_side() -> None:
    told = hits("V1 left V2 right", "V1 front O1 front", "V1 right O1 front")
    scene = Scene(100, 40)
    expect_later_contacts(scene, told)
    pair = frozenset(("V1", "O1"))
    assert scene.again == {pair}
    assert scene.sides[pair] == {"V1": "right", "O1": "front"}
    rail = Actor(id="O1", kind="object", road="S", direction="forward", maneuver="stopped", length_m=0.6,
                 width_m=14.0, firm=True)  # fmt: skip
    cars = (car(1, "S", "lane_change_left"), car(2, "S"), rail)
    (strike,) = strikes_of(BehaviorSpec(actors=cars, contacts=told), told)
    assert strike.goes_on
    assert not strike.glances, "the vehicle passes through it"
