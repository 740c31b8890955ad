"""Facts placed on networks of any shape."""

from __future__ import annotations

import pytest

from sgcad_core.errors import Refused
from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Access, Actor, BehaviorSpec, Leg, Node, Road, RoadLayout, RoadSpec
from sgcad_core.roads.layout import road_spec

CROSS = road_spec(RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=2, lanes_out=2) for b in ("N", "E", "S", "W"))))
PLAIN = road_spec(RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in ("E", "W"))))


def _behavior(text: str, spec: RoadSpec = CROSS) -> BehaviorSpec:
    return behavior_of_facts(read(text).crash, spec)


def _actor(behavior: BehaviorSpec, name: str) -> Actor:
    return next(a for a in behavior.actors if a.id == name)


def test_who_backs_up_in_its_lane_stays_on_its_road_and_who_backs_west_drives_west() -> None:
    ahead = "V1 was stopped westbound. V2, ahead of it, backed up and the back of V2 struck the front of V1."
    found = _behavior(ahead)
    assert (_actor(found, "V2").road, _actor(found, "V2").exit_road) == (_actor(found, "V1").road, None)
    west = "V2 was backing west. V1 was stopped westbound. The back of V2 struck the back of V1."
    assert _actor(_behavior(west), "V2").exit_road == "W"


def test_who_faces_one_way_and_backs_comes_from_the_side_that_it_faces() -> None:
    at_curb = (
        "The AV was going north. A van stopped facing east on the cross street reversed, and the rear of the van hit "
        "the right side of the AV."
    )
    van = _actor(_behavior(at_curb), "V2")
    assert (van.road, van.exit_road) == ("E", "W")
    before = (
        "The AV was going north. A van traveling east stopped and reversed, and its rear hit the right side of the AV."
    )
    assert _actor(_behavior(before), "V2").road == "E"
    told = "The AV was going north. A van was backing west, and the rear of the van hit the right side of the AV."
    assert _actor(_behavior(told), "V2").road == "E"


def test_who_faces_along_a_road_without_a_junction_backs_up_in_its_own_lane() -> None:
    told = (
        "V1 was traveling east. V2 was behind V1. V1 stopped in the road and began to move in reverse. The back of V1 "
        "struck the front of V2."
    )
    found = _behavior(told, PLAIN)
    assert (_actor(found, "V1").road, _actor(found, "V1").direction, _actor(found, "V1").exit_road) == (
        _actor(found, "V2").road, _actor(found, "V2").direction, None,
    )  # fmt: skip


def test_a_stated_heading_starts_on_the_opposite_leg() -> None:
    found = _behavior("V1 was traveling north. V2 was traveling west. The front of V1 struck the left side of V2.")
    assert (_actor(found, "V1").road, _actor(found, "V1").direction) == ("S", "forward")
    assert (_actor(found, "V2").road, _actor(found, "V2").direction) == ("E", "forward")


@pytest.mark.parametrize(("side", "exit_road"), [("left", "W"), ("right", "E")])
def test_a_turn_leaves_by_the_leg_on_that_side(side: str, exit_road: str) -> None:
    found = _behavior(f"V1 was northbound and turned {side}. V2 was southbound. The front of V2 struck V1.")
    assert _actor(found, "V1").exit_road == exit_road


def test_going_straight_leaves_by_the_facing_leg() -> None:
    found = _behavior("V1 was eastbound. V2 was southbound. The front of V1 struck the right side of V2.")
    assert (_actor(found, "V1").exit_road, _actor(found, "V2").exit_road) == ("E", "S")


def test_one_who_is_hit_from_behind_shares_road_and_lane_with_the_other() -> None:
    found = _behavior("V1 was eastbound in the left lane. V2 was stopped ahead of V1. V1 struck the rear of V2.")
    first, second = _actor(found, "V1"), _actor(found, "V2")
    assert (first.road, first.direction, first.lane) == (second.road, second.direction, second.lane)
    assert first.lane == 2


@pytest.mark.parametrize(
    ("words", "lane"), [("the right lane", 1), ("the left lane", 2), ("lane one", 1), ("lane five", 2)]
)
def test_lanes_count_from_the_right_curb_and_stay_on_the_road(words: str, lane: int) -> None:
    assert _actor(_behavior(f"V1 was northbound in {words} and struck a pole."), "V1").lane == lane


def test_oncoming_vehicles_of_a_plain_road_drive_at_each_other() -> None:
    found = _behavior("V1 was eastbound and crossed the centerline. V2 was westbound. They collided head-on.", PLAIN)
    assert {(a.road, a.direction) for a in found.actors} == {("W", "forward"), ("E", "forward")}


def test_one_who_leaves_a_driveway_starts_on_it() -> None:
    legs = tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in ("E", "W"))
    spec = road_spec(RoadLayout(legs=legs, accesses=(Access(leg="W", side="right"),)))
    found = _behavior(
        "V1 was eastbound. V2 was exiting a driveway on the right and turned left. The front of V1 struck the left "
        "side of V2.",
        spec,
    )
    assert next(r.kind for r in spec.roads if r.id == _actor(found, "V2").road) == "driveway"
    assert next(r.kind for r in spec.roads if r.id == _actor(found, "V1").road) == "road"


def test_without_any_heading_the_relative_one_is_kept() -> None:
    found = _behavior("V1 entered the intersection. The front of V2 struck the left side of V1.")
    order = ["S", "W", "N", "E"]  # legs on which one heads N, E, S, W
    first, second = (order.index(_actor(found, name).road) for name in ("V1", "V2"))
    assert (second - first) % 4 == 1


def test_an_oblique_unnamed_network_serves_as_well() -> None:
    spec = RoadSpec(
        nodes=(Node(id="a", x_m=-100, y_m=-90), Node(id="b", x_m=0, y_m=0), Node(id="c", x_m=95, y_m=100),
               Node(id="d", x_m=-80, y_m=90)),
        roads=(Road(id="first", from_node="a", to_node="b", lanes_forward=1, lanes_backward=1),
               Road(id="second", from_node="c", to_node="b", lanes_forward=1, lanes_backward=1),
               Road(id="third", from_node="b", to_node="d", lanes_forward=1, lanes_backward=1)),
    )  # fmt: skip
    found = _behavior(
        "V1 was northeastbound. V2 was southeastbound and failed to stop. V1 struck V2 in the right side.", spec
    )
    assert (_actor(found, "V1").road, _actor(found, "V1").direction) == ("first", "forward")
    assert (_actor(found, "V2").road, _actor(found, "V2").direction) == ("third", "backward")


def test_all_numbered_vehicles_become_actors_and_what_they_strike_later_too() -> None:
    three = _behavior("V1, V2 and V3 were southbound. V1 struck the rear of V2. V3 drove on. V1 then struck a tree.")
    assert [a.id for a in three.actors] == ["V1", "V2", "V3", "O1"]
    assert [(c.striker, c.struck) for c in three.contacts] == [("V1", "V2"), ("V1", "O1")]
    alone = _behavior("V1 was southbound and struck a tree.")
    assert [a.id for a in alone.actors] == ["V1", "O1"]
    assert alone.contacts[0].struck == "O1"


def test_a_trailer_lengthens_its_vehicle() -> None:
    found = _behavior("V1, a 2001 Ford F-150 pickup towing a boat trailer, was northbound. V2 struck the rear of V1.")
    assert (_actor(found, "V1").length_m or 0) > 10


def test_a_text_without_vehicles_is_refused() -> None:
    with pytest.raises(Refused, match="tells no crash"):
        _behavior("The road was wet.")


def test_conditions_are_handed_on() -> None:
    found = _behavior("V1 was northbound and struck V2. It was raining and dark.")
    assert (found.light, found.weather, found.surface) == ("dark", "rain", "wet")


@pytest.mark.parametrize(("side", "lane"), [("left", 2), ("right", 1)])
def test_who_waits_to_turn_waits_in_the_lane_for_it(side: str, lane: int) -> None:
    found = _behavior(f"V1 was traveling north. V2 was ahead of V1 and was stopped waiting to turn {side} at the "
                      "intersection. The front of V1 struck the back of V2.")  # fmt: skip
    assert (_actor(found, "V2").maneuver, _actor(found, "V2").lane, _actor(found, "V1").lane) == ("stopped", lane, lane)


@pytest.mark.parametrize(("word", "lane"), [("right through", 2), ("left", 3)])
def test_who_goes_straight_is_in_no_turn_lane(word: str, lane: int) -> None:
    wide = Leg(bearing="S", lanes_in=4, lanes_out=2, turns_in=("right", "through", "through", "left"))
    others = tuple(Leg(bearing=b, lanes_in=2, lanes_out=2) for b in ("N", "E", "W"))
    text = f"V1 was traveling north in the {word} lane. V2 was traveling west. The front of V1 struck the left of V2."
    assert _actor(_behavior(text, road_spec(RoadLayout(legs=(wide, *others)))), "V1").lane == lane


def test_a_piece_in_the_way_is_loose_and_a_tree_firm() -> None:
    for word, loose, firm in (("some debris", True, False), ("a traffic cone", True, False), ("a tree", False, True)):
        thing = _actor(_behavior(f"V1 was traveling east and the front of V1 struck {word}.", PLAIN), "O1")
        assert (thing.loose, thing.firm) == (loose, firm)


@pytest.mark.parametrize(("words", "loose", "width_m"), [
    ("a tree that had fallen across the roadway", True, 7.0), ("a tree", False, 0.5),
    ("a crate in the roadway", True, None),
])  # fmt: skip
def test_what_lies_in_the_road_is_a_piece_of_it(words: str, loose: bool, width_m: float | None) -> None:
    thing = _actor(_behavior(f"V1 was traveling east. The front of V1 struck {words}.", PLAIN), "O1")
    assert (thing.loose, thing.firm) == (loose, not loose)
    assert width_m is None or thing.width_m == width_m


def test_one_wall_that_is_struck_with_two_sides_is_one_wall() -> None:
    found = _behavior(
        "V1 was traveling east. V2 was traveling east beside V1. The left side of V1 struck the right side of V2. The "
        "front of V1 contacted a wall, rotated on and contacted the wall a second time with the right side.", PLAIN,
    )  # fmt: skip
    struck = [(c.struck, c.striker_area) for c in found.contacts[1:]]
    assert struck == [("O1", "front"), ("O1", "right")]


@pytest.mark.parametrize(("thing", "along_m"), [("guardrail", 14.0), ("wooden fence", 10.0), ("ditch", 12.0)])
def test_the_first_thing_that_is_struck_is_as_long_as_things_of_its_name(thing: str, along_m: float) -> None:
    found = _behavior(f"V1 was traveling east. V1 departed the road to the right and struck a {thing}.", PLAIN)
    assert _actor(found, "O1").width_m == along_m
