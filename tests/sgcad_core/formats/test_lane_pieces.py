"""Pieces of a network: neighbors that name each other, ways across nodes between the lanes that they join."""

import numpy as np
import pytest

from sgcad_core.formats.lane_pieces import pieces_of
from sgcad_core.roads.lane_graph import Connection, Edge, Lane, LaneGraph, NetNode


def lane(name, index, y, x=(0.0, 50.0)):
    return Lane(name, index, np.array([[x[0], y], [x[1], y]]), 3.5, x[1] - x[0], 13.9, True)


@pytest.fixture
def graph():
    first = Edge("A", "a", "b", (lane("A_0", 0, 0.0), lane("A_1", 1, 3.5)))
    second = Edge("B", "b", "c", (lane("B_0", 0, 0.0, (60.0, 100.0)),))
    across = Connection("A", 0, "B", 0, np.array([[50.0, 0.0], [60.0, 0.0]]), "through")
    at_once = Connection("A", 1, "B", 0, np.array([[50.0, 3.5], [50.1, 3.5]]), "through")
    return LaneGraph({"A": first, "B": second}, (across, at_once), {"b": NetNode(55.0, 0.0, "priority")})


def test_lanes_of_one_direction_are_neighbors(graph):
    pieces = pieces_of(graph)
    assert (pieces["A_0"].left, pieces["A_1"].right) == ("A_1", "A_0")
    assert (pieces["A_0"].right, pieces["A_1"].left) == ("", "")


@pytest.mark.parametrize(("apart", "joined"), [(0.0, True), (0.2, True), (2.0, False)])
def test_lanes_against_each_other_share_an_edge_where_nothing_lies_between_them(graph, apart, joined):
    shape = np.array([[50.0, 7.0 + apart], [0.0, 7.0 + apart]])
    back = Edge("back", "b", "a", (Lane("back_0", 0, shape, 3.5, 50.0, 13.9, True),))
    pieces = pieces_of(LaneGraph({**graph.edges, "back": back}, graph.connections, graph.nodes))
    one, other = pieces["A_1"], pieces["back_0"]
    assert (one.opposite, other.opposite) == (("back_0", "A_1") if joined else ("", ""))
    assert np.array_equal(one.side(1), other.side(1)[::-1]) == (joined or apart == 0)
    assert one.side(1)[:, 1] == pytest.approx([5.25 + (apart / 2 if joined else 0)] * 2)


def test_way_across_a_node_lies_between_its_lanes(graph):
    pieces = pieces_of(graph)
    assert pieces["A_0"].after == ["across_0"]
    assert pieces["across_0"].after == ["B_0"]
    assert pieces["across_0"].crosses


def test_lanes_that_meet_at_once_follow_each_other(graph):
    assert pieces_of(graph)["A_1"].after == ["B_0"]


def test_every_follower_names_its_leader(graph):
    pieces = pieces_of(graph)
    assert all(name in pieces[after].before for name, piece in pieces.items() for after in piece.after)


def test_sides_are_half_a_width_away(graph):
    piece = pieces_of(graph)["A_0"]
    assert piece.side(1)[:, 1] == pytest.approx([1.75, 1.75])
    assert piece.side(-1)[:, 1] == pytest.approx([-1.75, -1.75])
