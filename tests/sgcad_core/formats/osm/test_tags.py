"""Lanes, turns and limits are those of the tags; what a map does not tell is marked so."""

import pytest

from sgcad_core.formats.osm.street_map import MapWay
from sgcad_core.formats.osm.tags import lanes_of, limit_mph, one_way, turns_of


def way(**tags: str) -> MapWay:
    return MapWay(1, (1, 2), {"highway": "tertiary"} | {key.replace("__", ":"): value for key, value in tags.items()})


@pytest.mark.parametrize(
    ("tags", "lanes"),
    [
        ({}, (1, 1, False, 0)),
        ({"lanes": "2"}, (1, 1, True, 0)),
        ({"lanes": "3"}, (2, 1, True, 0)),
        ({"lanes": "5", "lanes__both_ways": "1"}, (2, 2, True, 1)),
        ({"lanes": "4", "lanes__forward": "3"}, (3, 1, True, 0)),
        ({"lanes__forward": "2", "lanes__backward": "1"}, (2, 1, True, 0)),
        ({"lanes": "2", "oneway": "yes"}, (2, 0, True, 0)),
        ({"lanes": "2", "oneway": "-1"}, (0, 2, True, 0)),
        ({"oneway": "yes"}, (1, 0, False, 0)),
        ({"highway": "motorway"}, (2, 0, False, 0)),
        ({"lanes": "40", "oneway": "yes"}, (8, 0, True, 0)),
        ({"lanes": "many"}, (1, 1, False, 0)),
        ({"lanes": "0"}, (1, 1, False, 0)),
    ],
)
def test_lanes_are_those_of_the_tags(tags: dict[str, str], lanes: tuple[int, int, bool, int]) -> None:
    assert tuple(lanes_of(way(**tags))) == lanes


def test_a_roundabout_is_one_way_unless_it_says_otherwise() -> None:
    assert [
        one_way(way(**tags)) for tags in ({"junction": "roundabout"}, {"junction": "roundabout", "oneway": "no"}, {})
    ] == [1, 0, 0]


def test_turns_stand_from_the_right_curb() -> None:
    made = way(lanes__forward="3", turn__lanes__forward="left|through|through;slight_right")
    assert turns_of(made, True, 3) == ("through_right", "through", "left")
    assert turns_of(made, True, 2) == ()
    assert turns_of(made, False, 3) == ()


def test_turns_of_a_one_way_street_need_no_direction() -> None:
    assert turns_of(way(oneway="yes", turn__lanes="left|none"), True, 2) == ("through", "left")


def test_a_turn_that_is_not_known_leaves_all_open() -> None:
    assert turns_of(way(oneway="yes", turn__lanes="left|sideways"), True, 2) == ()


@pytest.mark.parametrize(
    ("told", "limit"), [("35 mph", 35), ("50", 31), ("80 km/h", 50), ("none", None), ("2 mph", None), ("130 mph", None)]
)
def test_limits_are_in_miles_an_hour(told: str, limit: int | None) -> None:
    assert limit_mph(way(maxspeed=told), True) == limit


def test_a_limit_of_one_direction_comes_first() -> None:
    assert limit_mph(way(maxspeed="30 mph", maxspeed__backward="20 mph"), False) == 20
