"""A vehicle has left the road where its center or its front is beside the lanes, on the side seen along its lane."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.metrics.road_departure import along_its_way, left_road
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

SPEC = road_spec(RoadLayout(legs=tuple(
    Leg.model_validate({"bearing": b, "lanes_in": 1, "lanes_out": 1}) for b in "SN")))  # fmt: skip
GRAPH = parse_net(compile_network(plain_xml(SPEC), SPEC).net_xml or "")


def driven(to_x_m: float, *, south: bool = False) -> np.ndarray:
    """(60, 3) poses in the lane of its direction and then to a distance east of the middle of the road."""
    own = -1.6 if south else 1.6
    x = own + (to_x_m - own) * np.clip((np.arange(60) - 20) / 40, 0, 1)
    y = np.linspace(-100, -60, 60) * (-1 if south else 1)
    return np.column_stack((x, y, np.full(60, -np.pi / 2 if south else np.pi / 2)))


@pytest.mark.parametrize(("to_x_m", "south", "side"), [
    (8.0, False, "right"), (-8.0, False, "left"), (-8.0, True, "right"), (8.0, True, "left"),
    (1.6, False, None), (-1.6, False, None),
])  # fmt: skip
def test_the_side_is_seen_in_the_direction_of_travel(to_x_m: float, south: bool, side: str | None) -> None:
    assert left_road(GRAPH, driven(to_x_m, south=south), 4.7) == side


def test_a_front_beside_the_lanes_is_enough() -> None:
    poses = driven(2.6)
    poses[-1, 2] = np.pi / 4
    assert left_road(GRAPH, poses, 4.7) == "right"
    assert left_road(GRAPH, poses, 0.5) is None


@pytest.mark.parametrize("to_x_m", [-8.0, 8.0])
def test_one_that_spins_has_left_the_road_on_the_side_to_which_it_slides(to_x_m: float) -> None:
    poses = driven(to_x_m)
    poses[:, 2] += np.pi * np.clip((np.arange(60) - 15) / 20, 0, 1)  # backward before it is off its lane
    assert left_road(GRAPH, poses, 4.7) == ("right" if to_x_m > 0 else "left")


@pytest.mark.parametrize("backs", [0.0, np.pi])
def test_one_that_backs_still_faces_against_its_way(backs: float) -> None:
    poses = driven(1.6)
    poses[:, 2] += backs
    np.testing.assert_allclose(np.cos(along_its_way(poses)[:, 2] - poses[:, 2]), 1.0)


def test_one_that_crosses_a_median_has_left_its_road() -> None:
    leg = {"lanes_in": 1, "lanes_out": 1, "median": "grass"}
    spec = road_spec(RoadLayout(legs=tuple(Leg.model_validate({"bearing": b, **leg}) for b in "SN")))
    graph = parse_net(compile_network(plain_xml(spec), spec).net_xml or "")
    own, other = (float(graph.edges[edge].lanes[0].shape[0, 0]) for edge in ("S", "-S"))
    x = own + (other - own) * np.clip((np.arange(60) - 20) / 30, 0, 1)
    poses = np.column_stack((x, np.linspace(-100, -60, 60), np.full(60, np.pi / 2)))
    assert left_road(graph, poses, 4.7) == "left"
    assert left_road(GRAPH, driven(-1.6), 4.7) is None, "over a painted line"


def test_beside_a_bend_the_side_is_that_on_which_the_road_is_left() -> None:
    spec = road_spec(RoadLayout(legs=tuple(
        Leg.model_validate({"bearing": b, "lanes_in": 1, "lanes_out": 1, "curve": "right" if b == "S" else "left"})
        for b in "SN")))  # fmt: skip
    graph = parse_net(compile_network(plain_xml(spec), spec).net_xml or "")
    middle = graph.edges["-N"].lanes[0].shape  # bends away to the right
    start, (east, north) = middle[0], (middle[1] - middle[0]) / np.hypot(*(middle[1] - middle[0]))
    along, across = np.linspace(0.0, 150.0, 200)[:, None], np.linspace(0.0, 1.0, 200)[:, None]
    straight = start + along * (east, north)
    back = straight + across**4 * 20.0 * np.array((north, -east))  # slides back, and stays outside the bend
    for way in (straight, back):
        poses = np.column_stack((way, np.full(200, np.arctan2(north, east))))
        assert left_road(graph, poses, 4.7) == "left"


def test_a_vehicle_that_never_was_on_a_lane_has_left_none() -> None:
    assert left_road(GRAPH, driven(20.0)[-3:], 4.7) is None
