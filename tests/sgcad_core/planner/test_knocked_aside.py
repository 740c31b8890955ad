"""What is struck before the first contact of two vehicles is struck first, in order; the vehicles then meet as told."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import box_gaps
from sgcad_core.planner import plan
from sgcad_core.records.course import CourseTold, RestTold
from sgcad_core.records.specs import Actor, Area, BehaviorSpec, Contact, size_m
from tests.sgcad_core.planner.crash_scenes import network


def early(kind: str, *sides: Area, speed_mph: int = 35, size: tuple[float, float] = (0.4, 0.4)) -> BehaviorSpec:
    """V1 eastbound strikes one thing with each of some sides, then the right side of V2 southbound."""
    things = [
        Actor(id=f"{'O' if kind == 'object' else 'P'}{n}", kind=kind, road="W", direction="forward",
              maneuver="stopped" if kind == "object" else "straight",
              length_m=size[0] if kind == "object" else None, width_m=size[1] if kind == "object" else None)
        for n, _ in enumerate(sides, 1)
    ]  # fmt: skip
    actors = (
        Actor(id="V1", kind="car", road="W", direction="forward", exit_road="E", maneuver="straight",
              speed_mph=speed_mph),
        Actor(id="V2", kind="car", road="N", direction="forward", exit_road="S", maneuver="straight", speed_mph=30),
        *things,
    )  # fmt: skip
    struck: Area = "front" if kind == "object" else "left"
    met = [
        Contact(striker="V1", struck=t.id, striker_area=side, struck_area=struck)
        for t, side in zip(things, sides, strict=True)
    ]
    met.append(Contact(striker="V1", struck="V2", striker_area="front", struck_area="right"))
    return BehaviorSpec(actors=actors, contacts=tuple(met))


def order(behavior: BehaviorSpec) -> list[tuple[str, str]]:
    """Pairs in the order in which they first overlap."""
    made = plan(behavior, network("four_leg"))
    tracks, sizes = {t.actor: t.pose for t in made.trajectories}, {a.id: size_m(a) for a in behavior.actors}
    found = []
    for a, b in combinations(sorted(tracks), 2):
        hits = np.flatnonzero(box_gaps(tracks[a], sizes[a], tracks[b], sizes[b]) <= 0)
        found += [(int(hits[0]), a, b)] if len(hits) else []
    assert made.realised, made.notes
    return [(a, b) for _, a, b in sorted(found)]


def test_somebody_on_foot_is_struck_before_the_vehicles_meet() -> None:
    assert order(early("pedestrian", "front")) == [("P1", "V1"), ("V1", "V2")]


def test_two_things_are_struck_in_order_before_the_vehicles_meet() -> None:
    assert order(early("object", "front", "left"))[:3] == [("O1", "V1"), ("O2", "V1"), ("V1", "V2")]


@settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(
    side=st.sampled_from(("front", "left", "right")),
    speed_mph=st.integers(20, 60),
    size=st.sampled_from(((0.4, 0.4), (0.3, 1.2), (5.0, 0.6))),
)
def test_a_thing_of_any_size_is_struck_first_with_the_told_side(
    side: Area, speed_mph: int, size: tuple[float, float]
) -> None:
    size = size if side == "front" else (min(size), max(size))
    assert order(early("object", side, speed_mph=speed_mph, size=size))[:2] == [("O1", "V1"), ("V1", "V2")]


def test_a_firm_thing_that_is_glanced_on_the_way_takes_a_part_of_the_speed() -> None:
    behavior = early("object", "front")
    firm = [a.model_copy(update={"firm": a.id == "O1"}) for a in behavior.actors]
    made = plan(behavior.model_copy(update={"actors": tuple(firm)}), network("four_leg"))
    tracks, sizes = {t.actor: t.pose for t in made.trajectories}, {a.id: size_m(a) for a in behavior.actors}
    hit = int(np.flatnonzero(box_gaps(tracks["V1"], sizes["V1"], tracks["O1"], sizes["O1"]) <= 0)[0])
    speed = np.hypot(*np.diff(tracks["V1"][:, :2], axis=0).T) / 0.05
    assert made.realised
    assert 0.8 < speed[hit + 1] / speed[hit - 2] < 0.95


def test_a_lone_vehicle_rolls_over_and_touches_nobody() -> None:
    actor = Actor(id="V1", kind="car", road="W", direction="forward", maneuver="departing_road_right", speed_mph=45)
    told = CourseTold(rolls=True, rest=RestTold(facing_deg=0.0, attitude="roof"))
    made = plan(BehaviorSpec(actors=(actor,)), network("four_leg"), courses={"V1": told})
    (track,) = made.trajectories
    assert made.contact is None
    assert track.roll_rad is not None
    assert np.isclose(abs(track.roll_rad[-1]) % (2 * np.pi), np.pi, atol=0.05)
    assert np.isclose(np.sin(track.heading_rad[-1]), 1.0, atol=0.05)


def test_a_vehicle_goes_straight_on_over_a_loose_piece_and_is_turned_by_a_thing_that_stands() -> None:
    car = Actor(id="V1", kind="car", road="S", direction="forward", exit_road="N", maneuver="straight")
    hit = Contact(striker="V1", struck="O1", striker_area="front", struck_area="front")
    turned = {}
    for loose in (True, False):
        piece = Actor(id="O1", kind="object", road="S", direction="forward", maneuver="stopped", loose=loose)
        found = plan(BehaviorSpec(actors=(car, piece), contacts=(hit,)), network("straight"))
        way = found.trajectories[0]
        assert found.realised
        after = int(np.searchsorted(way.t_s, found.contact.t_s))
        gone = math.hypot(way.x_m[-1] - way.x_m[after], way.y_m[-1] - way.y_m[after])
        turned[loose] = abs(way.heading_rad[-1] - way.heading_rad[0]), gone
    assert turned[True][0] < math.radians(5.0) < turned[False][0]
    assert turned[True][1] > 8.0 > turned[False][1]
