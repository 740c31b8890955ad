"""SUMO networks as lane graphs, and what is counted in them."""

from __future__ import annotations

import importlib.util
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core import settings as paths
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.net_xml import (
    Edge,
    Lane,
    LaneGraph,
    NetNode,
    network_figures,
    parse_net,
    road_of,
    segments,
)
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from tests.sgcad_core.formats.road_samples import NAMED, compiled, random_spec

LINE = np.array([[0.0, 0.0], [10.0, 0.0]])


def graph_of(*roads):
    """A graph from (from, to, lanes) triples."""
    edges = {}
    for i, (a, b, count) in enumerate(roads):
        lanes = tuple(Lane(f"e{i}_{k}", k, LINE, 3.6, 10, 13, True) for k in range(count))
        edges[f"e{i}"] = Edge(f"e{i}", a, b, lanes)
    nodes = {n: NetNode(0, 0, "priority") for a, b, _ in roads for n in (a, b)}
    return LaneGraph(edges, (), nodes)


def both(a, b, there=1, back=1):
    return [(a, b, there), (b, a, back)]


# ------------------------------------------------------------------ reading
@pytest.mark.parametrize("name", NAMED)
def test_lanes_lie_side_by_side_and_are_as_long_as_said(name):
    for edge in parse_net(compiled(name).net_xml).edges.values():
        assert [lane.index for lane in edge.lanes] == list(range(len(edge.lanes)))
        for lane in edge.lanes:
            drawn = np.hypot(*np.diff(lane.shape, axis=0).T).sum()
            assert drawn == pytest.approx(lane.length_m, rel=0.02)  # SUMO gives all lanes the edge's mean
        for right, left in zip(edge.lanes, edge.lanes[1:], strict=False):
            gap = np.hypot(*(left.shape[0] - right.shape[0]))
            assert gap == pytest.approx((left.width_m + right.width_m) / 2, abs=0.5)


@pytest.mark.parametrize("name", NAMED)
def test_a_connection_runs_from_lane_end_to_lane_start(name):
    graph = parse_net(compiled(name).net_xml)
    assert graph.connections or name == "curve"
    for c in graph.connections:
        start, end = graph.edges[c.from_edge].lanes[c.from_lane], graph.edges[c.to_edge].lanes[c.to_lane]
        assert c.via_shape.ndim == 2
        assert len(c.via_shape) >= 2
        assert np.allclose(c.via_shape[0], start.shape[-1], atol=0.05)
        assert np.allclose(c.via_shape[-1], end.shape[0], atol=0.05)


def test_directions_are_those_of_the_turns():
    graph = parse_net(compiled("signal").net_xml)
    turns = {c.to_edge: c.direction for c in graph.connections if c.from_edge == "S"}
    assert turns == {"-W": "left", "-N": "through", "-E": "right"}
    assert {c.from_lane for c in graph.leaving("S")} == {0, 1, 2}
    assert all(c.from_lane == 2 for c in graph.leaving("S", 2))


def test_ids_tell_road_and_direction():
    assert road_of("-main") == ("main", "backward")
    assert road_of("main") == ("main", "forward")


def test_a_two_way_left_turn_lane_is_there_but_no_car_lane():
    edge = parse_net(compiled("center_lane").net_xml).edges["E"]
    assert [lane.allows_cars for lane in edge.lanes] == [True, True, False]
    assert len(edge.car_lanes) == 2


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: "", "well-formed"),
        (lambda t: "no xml", "well-formed"),
        (lambda t: "\x00", "well-formed"),
        (lambda t: t[: len(t) // 2], "well-formed"),
        (lambda t: "<nodes/>", "no SUMO network"),
        (lambda t: '<!DOCTYPE net [<!ENTITY a "b">]><net/>', "entities"),
        (lambda t: t.replace('speed="', 'speed="x'), "no finite number"),
        (lambda t: t.replace('length="', 'length="nan'), "no finite number"),
        (lambda t: t.replace('to="hub"', 'to="nowhere"'), "a node that is not there"),
        (lambda t: t.replace('toLane="0"', 'toLane="9"'), "a lane that is not there"),
        (lambda t: t.replace('shape="', 'shape="1,2 x'), "shape of two"),
    ],
)
def test_rubbish_is_invalid_output_that_names_the_fault(change, message):
    with pytest.raises(InvalidOutput, match=message) as caught:
        parse_net(change(compiled("stop").net_xml))
    assert caught.value.findings


@given(st.integers(0, 10**6), st.binary(min_size=1, max_size=6))
@settings(max_examples=150, deadline=None)
def test_a_damaged_network_is_read_or_invalid_never_a_crash(seed, junk):
    text = compiled("stop").net_xml
    at = random.Random(seed).randrange(len(text))
    try:
        graph = parse_net(text[:at] + junk.decode("latin-1") + text[at + len(junk) :])
    except InvalidOutput:
        return
    assert {e.from_node for e in graph.edges.values()} <= set(graph.nodes)


# ------------------------------------------------------------------ counting
def test_a_plain_road_is_one_segment_without_intersection():
    found = network_figures(graph_of(*both("a", "b", 2, 1), *both("b", "c", 2, 1)))
    assert found == (0, 1, 1.5, 1)


def test_the_widest_piece_of_a_segment_counts():
    assert network_figures(graph_of(*both("a", "b", 3, 1), *both("b", "c", 2, 1))).mean_lanes == 2.0


def test_an_interrupted_direction_does_not_count():
    assert network_figures(graph_of(*both("a", "b", 2, 1), ("b", "c", 2))).mean_lanes == 2.0


def test_a_crossing_has_one_intersection_and_four_segments():
    roads = [r for leg in "nesw" for r in both(leg, "hub", 2, 1)]
    assert network_figures(graph_of(*roads)) == (1, 1, 1.5, 4)


def test_parts_that_are_not_joined_are_counted():
    assert network_figures(graph_of(*both("a", "b"), *both("c", "d"))).components == 2


def test_a_ring_is_one_segment():
    assert network_figures(graph_of(*both("a", "b"), *both("b", "c"), *both("c", "a"))) == (0, 1, 1.0, 1)


def test_an_empty_network_counts_nothing():
    assert network_figures(graph_of()) == (0, 0, 0.0, 0)


def test_segments_name_roads_and_their_car_lanes():
    found = segments(parse_net(compiled("center_lane").net_xml))
    assert sorted(s["id"] for s in found) == ["E", "W"]
    assert {(s["lanes_forward"], s["lanes_backward"]) for s in found} == {(2, 2)}


SCORER = paths.ROOT.parent / "shared" / "tools" / "score.py"


@pytest.mark.data
@pytest.mark.slow
@pytest.mark.skipif(not SCORER.exists(), reason="the scorer of the real reports is not here")
def test_figures_are_those_of_the_scorer(tmp_path):
    spec = importlib.util.spec_from_file_location("score", SCORER)
    score = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(score)
    nets = [compiled(name).net_xml for name in NAMED]
    nets += [compile_network(plain_xml(random_spec(seed))).net_xml for seed in range(30)]
    for net in nets:
        file = tmp_path / "road.net.xml"
        file.write_text(net, encoding="utf-8")
        theirs, ours = score.network_of(file), network_figures(parse_net(net))
        assert (ours.intersections, ours.components, ours.segments) == (
            theirs["intersections"], theirs["components"], theirs["segments"]
        )  # fmt: skip
        assert ours.mean_lanes == pytest.approx(theirs["mean_lanes"])


def test_a_graph_that_was_read_is_shared_and_cannot_be_changed():
    net = compiled("stop").net_xml
    graph = parse_net(net)
    assert parse_net(net) is graph
    with pytest.raises(ValueError, match="read-only"):
        next(iter(graph.edges.values())).lanes[0].shape[0, 0] = 1.0
