"""Rules of single plans: what an actor does, what is noted, what is refused."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

from sgcad_core.case.records import Trajectory
from sgcad_core.errors import InvalidOutput
from sgcad_core.geometry.plane import box_gaps
from sgcad_core.planner import Plan, plan
from sgcad_core.planner.lines.box_angles import SLIDES
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, size_m
from tests.effort import spread
from tests.sgcad_core.planner.crash_scenes import network

MPH = 0.44704


def actor(name: str, maneuver: str, road: str, exit_road: str | None = None, **more: object) -> Actor:
    fields = {"id": name, "kind": "car", "road": road, "direction": "forward", "maneuver": maneuver}
    return Actor.model_validate(fields | {"exit_road": exit_road} | more)


def contact(text: str) -> Contact:
    """ "V1 front V2 left" as a contact."""
    striker, striker_area, struck, struck_area = text.split()
    return Contact.model_validate(
        {"striker": striker, "struck": struck, "striker_area": striker_area, "struck_area": struck_area}
    )


def planned(layout: str, *actors: Actor, contacts: tuple[str, ...] = ()) -> tuple[BehaviorSpec, Plan]:
    behavior = BehaviorSpec(actors=actors, contacts=tuple(contact(c) for c in contacts))
    return behavior, plan(behavior, network(layout))


def track(made: Plan, name: str) -> Trajectory:
    return next(t for t in made.trajectories if t.actor == name)


def at_contact(made: Plan) -> int:
    assert made.contact is not None
    return round(made.contact.t_s / 0.05)


def gaps(behavior: BehaviorSpec, made: Plan, a: str, b: str) -> np.ndarray:
    size = {x.id: size_m(x) for x in behavior.actors}
    poses = [np.column_stack((t.x_m, t.y_m, t.heading_rad)) for t in (track(made, a), track(made, b))]
    return box_gaps(poses[0], size[a], poses[1], size[b])


def bearing(t: Trajectory, k: int) -> float:
    return math.degrees(t.heading_rad[k]) % 360


# ------------------------------------------------------------------ oddity
def test_ordinary_driving_is_not_odd() -> None:
    _, made = planned(
        "four_leg", actor("V1", "straight", "S"), actor("V2", "straight", "E"), contacts=("V1 front V2 left",)
    )
    assert made.oddity == 0


def test_sides_that_only_a_skid_can_offer_are_odd() -> None:
    _, made = planned(
        "four_leg", actor("V1", "straight", "S"), actor("V2", "straight", "N"), contacts=("V1 front V2 left",)
    )
    assert made.realised
    assert made.oddity > 0.5


@pytest.mark.parametrize("first", [
    actor("V1", "turn_left", "S"), actor("V1", "straight", "N", "E", direction="backward"),
])  # fmt: skip
def test_a_way_that_does_not_exist_costs_one(first: Actor) -> None:
    _, made = planned("tee_wide", first, actor("V2", "straight", "S"), contacts=("V2 front V1 back",))
    there = first.model_copy(update={"maneuver": "straight", "exit_road": None})
    _, other = planned("tee_wide", there, actor("V2", "straight", "S"), contacts=("V2 front V1 back",))
    assert made.oddity >= 1 > other.oddity


# ------------------------------------------------------------------ areas
PAIRS = [
    ("four_leg", ("straight", "S"), ("straight", "E"), "V1 front V2 left"),
    ("four_leg", ("straight", "S"), ("straight", "E"), "V1 right V2 front"),
    ("four_leg", ("straight", "S"), ("straight", "W"), "V1 left V2 front"),
    ("four_leg", ("straight", "S"), ("straight", "E"), "V1 front V2 front"),
    ("four_leg", ("turn_left", "S", "W"), ("straight", "N"), "V1 right V2 front"),
    ("four_leg", ("turn_left", "S", "W"), ("straight", "N"), "V1 front V2 left"),
    ("four_leg", ("turn_left", "S", "W"), ("straight", "W"), "V1 left V2 front"),
    ("four_leg", ("turn_right", "S", "E"), ("straight", "W"), "V1 left V2 front"),
    ("straight", ("straight", "S"), ("stopped", "S"), "V1 front V2 back"),
    ("straight", ("straight", "S"), ("straight", "S"), "V1 front V2 back"),
    ("straight", ("crossing_centerline", "S"), ("straight", "N"), "V1 front V2 front"),
    ("straight", ("crossing_centerline", "S"), ("straight", "N"), "V1 left V2 left"),
    ("straight_wide", ("lane_change_left", "E"), ("straight", "E"), "V1 left V2 right"),
    ("straight_wide", ("lane_change_right", "W"), ("straight", "W"), "V1 right V2 left"),
    ("straight", ("u_turn", "S"), ("straight", "S"), "V1 left V2 front"),
    ("straight", ("backing", "S"), ("stopped", "S"), "V1 back V2 front"),
    ("straight", ("straight", "S"), ("parked", "S"), "V1 right V2 left"),
]


@pytest.mark.parametrize(("layout", "first", "second", "declared"), PAIRS)
def test_declared_sides_touch_first(layout, first, second, declared):
    _, made = planned(layout, actor("V1", *first), actor("V2", *second), contacts=(declared,))
    assert made.realised, (made.contact, made.notes)


@pytest.mark.parametrize(("own", "other"), spread(product(("front", "back", "left", "right"), repeat=2), 3))
def test_any_two_sides_can_be_brought_together_where_two_cross(own, other):
    _, made = planned(
        "four_leg", actor("V1", "straight", "S"), actor("V2", "straight", "E"), contacts=(f"V1 {own} V2 {other}",)
    )
    assert made.realised, (made.contact, made.notes)
    assert made.oddity >= 2 or not any(SLIDES in note for note in made.notes)


def test_sides_that_no_driving_brings_together_are_named_with_those_that_would() -> None:
    actors = (actor("V1", "straight", "S"), actor("V2", "straight", "E"))
    behavior = BehaviorSpec(actors=actors, contacts=(contact("V1 back V2 back"),))
    made = plan(behavior, network("four_leg"), by_force=False)
    assert not made.realised
    assert made.oddity == 0
    assert any("as they drive, the front of V1 meets the left of V2" in note for note in made.notes)
    assert any(SLIDES in note for note in plan(behavior, network("four_leg")).notes)


@pytest.mark.parametrize(
    ("mph", "maneuver", "exit_road"), [(20, "turn_left", "W"), (45, "straight", "N"), (5, "turn_right", "E")]
)
def test_a_told_speed_is_driven_before_the_contact(mph, maneuver, exit_road):
    _, made = planned(
        "four_leg", actor("V1", maneuver, "S", exit_road, speed_mph=mph), actor("V2", "straight", "E", speed_mph=30),
        contacts=("V1 front V2 left",),
    )  # fmt: skip
    speed = track(made, "V1").speed_mps[: at_contact(made) + 1]
    assert np.abs(speed - mph * MPH).min() < 0.05 * mph * MPH


def test_nobody_turns_its_box_unless_control_was_lost() -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "straight", "S"), actor("V2", "straight", "S")), contacts=(contact("V1 right V2 back"),)
    )
    graph = network("straight")
    assert not plan(behavior, graph, by_force=False).realised
    made = plan(behavior, graph, may_skid=True)
    assert made.realised
    assert "V1 skids before contact" in made.notes


def test_ordinary_crashes_need_no_notes():
    ordinary = [PAIRS[i] for i in (0, 1, 2, 4, 8, 10)]
    for layout, first, second, declared in ordinary:
        _, made = planned(layout, actor("V1", *first), actor("V2", *second), contacts=(declared,))
        assert made.notes == (), declared


# ------------------------------------------------------------------ driving
def test_initial_heading_is_that_of_the_road():
    _, made = planned("four_leg", actor("V1", "turn_left", "S", "W"), actor("V2", "straight", "E"))
    assert bearing(track(made, "V1"), 0) == pytest.approx(90, abs=2)
    assert bearing(track(made, "V2"), 0) == pytest.approx(180, abs=2)


def test_stated_speed_is_driven():
    _, made = planned("straight", actor("V1", "straight", "S", speed_mph=40))
    assert track(made, "V1").speed_mps[10] == pytest.approx(40 * MPH, rel=0.01)


def test_a_turn_is_driven_slower_than_the_road_before_it():
    _, made = planned("four_leg", actor("V1", "turn_right", "S", "E"))
    speed = track(made, "V1").speed_mps
    assert speed[:100].min() < 0.7 * speed[0]


def test_who_backs_faces_against_its_motion():
    _, made = planned(
        "straight", actor("V1", "backing", "S"), actor("V2", "stopped", "S"), contacts=("V1 back V2 front",)
    )
    t, k = track(made, "V1"), at_contact(made)
    way = math.atan2(t.y_m[k - 1] - t.y_m[0], t.x_m[k - 1] - t.x_m[0])
    assert math.cos(way - t.heading_rad[0]) == pytest.approx(-1, abs=0.01)
    assert bearing(t, 0) == pytest.approx(90, abs=2)


def test_who_departs_leaves_the_road_on_the_stated_side():
    _, made = planned("straight", actor("V1", "departing_road_right", "S"))
    t = track(made, "V1")
    assert t.x_m.max() - t.x_m[0] > 4


def test_crossing_the_centerline_shows_less_than_30_degrees():
    _, made = planned(
        "straight",
        actor("V1", "crossing_centerline", "S"),
        actor("V2", "straight", "N"),
        contacts=("V1 front V2 front",),
    )
    t, k = track(made, "V1"), at_contact(made)
    assert np.degrees(np.abs(t.heading_rad[: k + 1] - t.heading_rad[0])).max() < 30
    assert t.x_m[k] < t.x_m[0] - 1.5


def test_a_pedestrian_walks_across_from_the_side_that_is_struck():
    for side, way in (("left", 180.0), ("right", 0.0)):
        _, made = planned(
            "straight", actor("V1", "straight", "S"), actor("P1", "straight", "S", kind="pedestrian"),
            contacts=(f"V1 front P1 {side}",),
        )  # fmt: skip
        assert made.realised
        assert math.remainder(bearing(track(made, "P1"), 0) - way, 360) == pytest.approx(0, abs=2)


def test_a_cyclist_keeps_to_the_right_edge():
    _, made = planned(
        "straight_wide", actor("B1", "straight", "E", kind="bicycle"), actor("V1", "straight", "E", lane=1)
    )
    assert track(made, "B1").y_m[0] > track(made, "V1").y_m[0] + 0.8


def test_a_trailer_follows_its_tractor_without_touching_it():
    behavior, made = planned(
        "four_leg", actor("V1", "turn_right", "S", "E", kind="pickup"), actor("T1", "turn_right", "S", kind="trailer")
    )
    assert gaps(behavior, made, "V1", "T1").min() > 0
    t, v = track(made, "T1"), track(made, "V1")
    assert 6 < math.hypot(t.x_m[40] - v.x_m[40], t.y_m[40] - v.y_m[40]) < 12


def test_a_struck_trailer_counts_as_the_contact():
    _, made = planned(
        "straight", actor("V1", "straight", "S"), actor("V2", "slowing", "S", kind="truck"),
        actor("T2", "slowing", "S", kind="trailer"), contacts=("V1 front T2 back",),
    )  # fmt: skip
    assert made.realised


# ------------------------------------------------------------------ afterwards
def test_both_come_to_rest_within_five_seconds():
    _, made = planned(
        "four_leg", actor("V1", "straight", "S", speed_mph=55), actor("V2", "straight", "E", speed_mph=45),
        contacts=("V1 front V2 left",),
    )  # fmt: skip
    for t in made.trajectories:
        assert t.speed_mps[-3:].max() == 0
        assert t.t_s[-1] == pytest.approx(made.contact.t_s + 5, abs=0.06)


def test_the_struck_one_is_pushed_on():
    _, made = planned(
        "straight", actor("V1", "straight", "S"), actor("V2", "stopped", "S"), contacts=("V1 front V2 back",)
    )
    t, k = track(made, "V2"), at_contact(made)
    assert t.y_m[-1] - t.y_m[k] > 2


def test_a_chain_pushes_the_second_into_the_third():
    behavior, made = planned(
        "four_leg", actor("V1", "straight", "S"), actor("V2", "stopped", "S"), actor("V3", "stopped", "S"),
        contacts=("V1 front V2 back", "V2 front V3 back"),
    )  # fmt: skip
    k = at_contact(made)
    between = gaps(behavior, made, "V2", "V3")
    assert made.realised
    assert (between[: k + 1] > 0).all()
    assert (between[k:] <= 0).any()


def test_an_object_is_put_where_a_vehicle_slides_after_the_first_contact():
    behavior, made = planned(
        "four_leg", actor("V1", "straight", "S", speed_mph=45), actor("V2", "straight", "E", speed_mph=45),
        actor("O1", "stopped", "S", kind="object"), contacts=("V1 front V2 left", "V2 front O1 front"),
    )  # fmt: skip
    between = gaps(behavior, made, "V2", "O1")
    assert made.realised
    assert (between <= 0).any()


def test_others_keep_clear_of_the_first_contact():
    others = [actor("V3", "straight", "S"), actor("V4", "stopped", "N"), actor("V5", "turn_left", "W", "N")]
    behavior, made = planned(
        "four_leg", actor("V1", "straight", "S"), actor("V2", "straight", "E"), *others, contacts=("V1 front V2 left",)
    )
    assert made.realised
    for name in ("V3", "V4", "V5"):
        for struck in ("V1", "V2"):
            assert gaps(behavior, made, name, struck).min() > 0


def test_nobody_touches_where_no_contact_is_declared():
    _, made = planned(
        "four_leg", actor("V1", "straight", "S"), actor("V2", "straight", "E"), actor("V3", "straight", "N")
    )
    assert made.contact is None
    assert made.realised


# ------------------------------------------------------------------ what cannot be as stated
def test_unknown_road_lists_the_known_ones():
    with pytest.raises(InvalidOutput, match=r"no such road.*X.*use one of: N, S") as caught:
        planned("straight", actor("V1", "straight", "X"))
    assert caught.value.findings[0].where == "actor V1, road"


def test_unknown_exit_road_is_refused():
    with pytest.raises(InvalidOutput, match=r"exit_road.*Q"):
        planned("straight", actor("V1", "straight", "S", "Q"))


def test_a_lane_that_is_not_there_is_the_leftmost():
    _, made = planned("straight_wide", actor("V1", "straight", "E", lane=5))
    assert made.notes == ("V1: lane 5 of E taken as 2, its leftmost",)


def test_a_turn_that_the_network_lacks_is_made_up():
    _, made = planned("straight", actor("V1", "turn_left", "S"))
    t = track(made, "V1")
    assert any("offers no such turn" in note for note in made.notes)
    assert t.heading_rad.max() - t.heading_rad[0] == pytest.approx(math.pi / 2, abs=0.1)


def test_two_that_stand_are_not_left_standing():
    _, made = planned(
        "straight", actor("V1", "stopped", "S"), actor("V2", "stopped", "S"), contacts=("V1 front V2 back",)
    )
    assert made.realised
    assert any("set rolling" in note for note in made.notes)
    assert made.contact is not None
    rolls = track(made, "V1")
    until = int(np.searchsorted(rolls.t_s, made.contact.t_s, side="right"))
    assert math.hypot(rolls.x_m[until - 1] - rolls.x_m[0], rolls.y_m[until - 1] - rolls.y_m[0]) < 1.0
    assert rolls.speed_mps[0] == pytest.approx(0.0, abs=0.01)


def test_a_contact_with_an_unknown_actor_is_noted_and_left_out():
    _, made = planned("straight", actor("V1", "straight", "S"), contacts=("V1 front V7 back",))
    assert made.contact is None
    assert not made.realised
    assert made.notes == ("contact of V1 and V7 left out: they cannot meet",)


def test_who_swerves_left_on_a_narrow_road_comes_in_its_own_lane() -> None:
    swerving, turning = actor("V1", "lane_change_left", "S", "N"), actor("V2", "turn_left", "S", "W", speed_mph=8)
    _, made = planned("four_leg", swerving, turning, contacts=("V1 front V2 left",))
    assert made.realised
    assert 0.0 < track(made, "V1").x_m[0] < 3.6


def test_a_parked_car_is_struck_where_it_is_parked() -> None:
    drifting, parked = actor("V1", "crossing_centerline", "N", speed_mph=30), actor("V2", "parked", "S")
    _, made = planned("straight", drifting, parked, contacts=("V1 front V2 front",))
    assert made.realised
    assert track(made, "V2").x_m[0] > 2.2


@pytest.mark.parametrize("mph", [5, 7, 12, 40])
def test_one_that_slows_is_seen_to_slow_however_slow_the_one_behind_it_is(mph: int) -> None:
    ahead, behind = actor("V1", "slowing", "S", "N"), actor("V2", "straight", "S", "N", speed_mph=mph)
    _, made = planned("four_leg", ahead, behind, contacts=("V2 front V1 back",))
    assert made.realised
    gaps = box_gaps(track(made, "V1").pose, size_m(ahead), track(made, "V2").pose, size_m(behind))
    met = int(np.flatnonzero(gaps <= 0)[0])
    speeds = track(made, "V1").speed_mps[: met - 1]
    assert speeds.min() < 0.75 * speeds.max()
