"""Edges of a way: through, turning, on no lane, and never unconnected ones."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.handover.lane_following import poses_of, route_of
from tests.sgcad_core.formats.xosc_samples import crossroads

LANE = 4.8


def graph():
    return parse_net(crossroads().net_xml)


def turned_left():
    """Eastbound, then north, about the middle of the crossing."""
    angle = np.linspace(-np.pi / 2, 0, 12)
    bend = np.column_stack((-10 + 11.6 * np.cos(angle), 10 + 11.6 * np.sin(angle), angle + np.pi / 2))
    into = np.column_stack((np.linspace(-100, -10, 40), np.full(40, -1.6), np.zeros(40)))
    out = np.column_stack((np.full(40, 1.6), np.linspace(10, 100, 40), np.full(40, np.pi / 2)))
    return np.vstack((into, bend, out))


def test_a_way_straight_on_takes_both_roads():
    x = np.linspace(-100, 100, 200)
    assert route_of(graph(), poses_of(np.column_stack((x, 0 * x - LANE, 0 * x)))) == ("W", "-E")


def test_a_left_turn_takes_the_road_that_it_turns_into():
    assert route_of(graph(), poses_of(turned_left())) == ("W", "-N")


def test_who_stands_is_thought_to_go_straight_on():
    assert route_of(graph(), [(-50.0, -LANE, 0.0)]) == ("W", "-E")


@pytest.mark.parametrize("place", [(-50.0, -60.0, 0.0), (-50.0, -LANE, np.pi / 2)])
def test_on_no_lane_or_across_one_there_is_no_route(place):
    assert route_of(graph(), [place]) == ()


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(st.floats(-130, 130), st.floats(-130, 130), st.floats(-4, 4)), min_size=1, max_size=12))
def test_a_route_is_always_connected(places):
    made = graph()
    route = route_of(made, places)
    assert len(set(route)) == len(route)
    for a, b in pairwise(route):
        assert any(c.to_edge == b for c in made.leaving(a))
