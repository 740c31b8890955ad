"""The lane and the median in which a vehicle comes to rest, on a four-lane divided road that runs east."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.metrics.rest_error import AGAINST_M, against_errors, near_m, rest_errors, whirls
from sgcad_core.records.course import AT_IMPACT_M, RestTold
from sgcad_core.roads.lane_positions import Position
from sgcad_core.roads.surface import RoadSurface, road_surface
from tests.sgcad_core.planner.crash_scenes import network

WIDTH = 3.5
NONE: frozenset[str] = frozenset()
CENTERS = {("E", 1): -7.25, ("E", 2): -3.75, ("W", 2): 3.75, ("W", 1): 7.25}
"""Metres north of the middle of the median, 4 m wide, by direction and place from the right."""


def road() -> RoadSurface:
    ends = {"E": (-50.0, 50.0), "W": (50.0, -50.0)}
    starts, stops = (np.array([(ends[way][i], y) for (way, _), y in CENTERS.items()]) for i in (0, 1))
    lanes = tuple(Position(place, 2, NONE, NONE, 1, 2) for _, place in CENTERS)
    return RoadSurface(starts, stops, np.full(4, WIDTH / 2), (), lanes)


def right(told: RestTold, north_m: float, came_rad: float = 0.0) -> dict[str, bool]:
    began = np.array([-40.0, CENTERS["E", 2], 0.0])
    return rest_errors(told, np.array([[0.0, north_m, 0.0]]), came_rad, road(), began).right()


@pytest.mark.parametrize(
    ("told", "lane"),
    [(RestTold(lane=1), ("E", 1)), (RestTold(lane=-1), ("E", 2)), (RestTold(lane="right"), ("E", 1)),
     (RestTold(lane=2, lane_way="W"), ("W", 2)), (RestTold(lane="own"), ("E", 2)),
     (RestTold(lane="own", lane_way="W"), ("W", 2))],
)  # fmt: skip
def test_a_told_lane_is_right_in_that_lane_alone(told: RestTold, lane: tuple[str, int]) -> None:
    assert {place: right(told, north)["lane"] for place, north in CENTERS.items()} == {
        place: place == lane for place in CENTERS
    }


def test_a_told_direction_is_right_in_all_its_lanes() -> None:
    found = {place for place, north in CENTERS.items() if right(RestTold(lane_way="W"), north)["lane"]}
    assert found == {("W", 1), ("W", 2)}


def test_a_lane_that_is_not_drawn_is_never_right() -> None:
    assert not any(right(RestTold(lane="center_turn"), north)["lane"] for north in CENTERS.values())


def test_the_second_lane_of_a_two_lane_road_is_that_of_the_other_direction() -> None:
    starts, stops = np.array([(-50.0, -1.75), (50.0, 1.75)]), np.array([(50.0, -1.75), (-50.0, 1.75)])
    lane = Position(1, 1, NONE, NONE, 1, 1)
    two_lane = RoadSurface(starts, stops, np.full(2, WIDTH / 2), (), (lane, lane))
    poses = np.array([[0.0, 1.75, 0.0], [0.0, -1.75, 0.0]])
    second, third = (rest_errors(RestTold(lane=number), poses, 0.0, two_lane).lane_m for number in (2, 3))
    assert (second <= 0.0).tolist() == [True, False]
    assert (third > 0.0).all()


def test_a_median_lies_left_of_its_lanes() -> None:
    told = RestTold(where="median")
    assert right(told, 0.5)["where"]
    assert not right(told, 10.0)["where"]
    assert not right(told, CENTERS["E", 1])["where"]


def test_the_median_is_never_on_the_right_of_a_vehicle_that_came_on_either_carriageway() -> None:
    off_road = {"left": RestTold(where="off_road", side="left"), "right": RestTold(where="off_road", side="right")}
    for north, came_rad in ((0.5, 0.0), (-0.5, 0.0), (0.5, np.pi), (-0.5, np.pi)):
        assert {side: right(told, north, came_rad)["side"] for side, told in off_road.items()} == {
            "left": True, "right": False,
        }  # fmt: skip
    assert right(off_road["right"], -10.0)["side"]
    assert right(off_road["left"], 10.0)["side"]


@pytest.mark.parametrize(("carried_m", "north_m", "side"), [
    (15.0, 12.0, "left"), (15.0, -12.0, "right"), (-15.0, 12.0, "right"), (-15.0, -12.0, "left"),
])  # fmt: skip
def test_a_road_that_was_crossed_has_its_hands_as_seen_along_it(carried_m: float, north_m: float, side: str) -> None:
    began, came_rad = np.array([0.0, -40.0, np.pi / 2]), np.pi / 2
    pose = np.array([[carried_m, north_m, 0.0]])
    for hand in ("left", "right"):
        told = RestTold(where="off_road", side=hand)
        assert rest_errors(told, pose, came_rad, road(), began).right()["side"] is (hand == side)
    straight_on = np.array([[0.5, 12.0, 0.0]])
    told = RestTold(where="off_road", side="left")
    assert not rest_errors(told, straight_on, came_rad, road(), began).right()["side"]


@pytest.mark.parametrize(("told_m", "met_m", "fits"), [
    (AT_IMPACT_M, 0.0, True), (AT_IMPACT_M, 4.9, True), (AT_IMPACT_M, 5.1, False),
    (10.0, 12.9, True), (10.0, 5.0, False),
])  # fmt: skip
def test_a_rest_at_the_impact_may_lie_some_metres_off(told_m: float, met_m: float, fits: bool) -> None:
    assert (abs(met_m - told_m) <= near_m(told_m)) == fits


# ------------------------------------------------------------------ at a junction of two roads, north and east
@pytest.fixture(scope="module")
def crossing() -> RoadSurface:
    return road_surface(network("four_leg"))


@pytest.mark.parametrize(("place", "inside"), [
    ((0.0, 0.0), True), ((3.0, -4.0), True), ((7.8, -2.0), True), ((8.2, -2.0), False), ((0.0, 16.0), False),
    ((-17.0, -2.0), False), ((10.0, 10.0), False),
])  # fmt: skip
def test_in_the_intersection_is_within_the_ends_of_the_lanes(crossing, place, inside) -> None:
    found = rest_errors(RestTold(where="intersection"), np.array([[*place, 0.0]]), 0.0, crossing)  # lanes end at 7.6 m
    assert found.right()["where"] == inside


@pytest.mark.parametrize(("side", "place", "fits"), [
    ("SW", (-12.0, -12.0), True), ("SW", (-10.0, -25.0), True), ("SW", (0.5, -28.0), False),
    ("SW", (-12.0, 12.0), False), ("SW", (12.0, -12.0), False), ("W", (-10.0, -25.0), True),
    ("S", (-25.0, -10.0), True), ("E", (-10.0, -25.0), False),
])  # fmt: skip
def test_a_corner_is_one_quarter_of_the_junction(crossing, side, place, fits) -> None:
    found = rest_errors(RestTold(where="off_road", side=side), np.array([[*place, 0.0]]), 0.0, crossing)
    assert found.right()["side"] == fits


@pytest.mark.parametrize(("way_m", "turned_deg", "whirls_deg"), [(2.0, 120, 120), (40.0, 120, 30), (0.0, 0, 0)])
def test_a_whirl_is_a_rotation_within_a_few_metres(way_m, turned_deg, whirls_deg):
    share = np.linspace(0.0, 1.0, 97)
    way = np.column_stack((way_m * share, 0 * share, np.radians(turned_deg) * share))
    found = np.degrees(whirls(np.stack((way, 0 * way), axis=1)))
    assert found[0] <= whirls_deg + 1e-6
    assert found[0] >= 0.9 * whirls_deg or way_m > 3.5
    assert found[1] == 0.0


@pytest.mark.parametrize(("gap_m", "right"), [(-0.1, True), (AGAINST_M - 0.05, True), (AGAINST_M + 0.05, False)])
def test_a_rest_at_a_thing_is_right_within_a_gap_between_both(gap_m: float, right: bool) -> None:
    car, pole = (4.7, 1.8), (0.4, 0.4)
    stands = np.array([2.35 + 0.2 + gap_m, 0.3, 1.5])
    error = against_errors(np.zeros((1, 3)), car, np.array([stands[0], stands[1], 0.0]), pole)
    assert (error[0] <= 0.0) is np.bool_(right)
