"""Through lanes line up where roads go on into each other, whatever turn lanes, medians and accesses they have."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.formats.agreement import network_disagreements
from sgcad_core.formats.opendrive.checks.check_file import xodr_findings
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Access, Leg, Median, RoadLayout, RoadSpec
from sgcad_core.roads.connections import links
from sgcad_core.roads.lane_graph import road_of
from sgcad_core.roads.layout import road_spec
from sgcad_core.roads.road_geometry import Roadway, lane_width_m, lanes, roadways
from tests.effort import spread

OPPOSITE = {"N": "S", "S": "N", "E": "W", "W": "E"}
SIDE = (Leg(bearing="E", lanes_in=1, lanes_out=1), Leg(bearing="W", lanes_in=1, lanes_out=1))


def turns(left: int, through: int) -> tuple[str, ...]:
    return ("through",) * through + ("left",) * left


def leg(bearing: str, left: int, through: int, lanes_out: int, **more: object) -> Leg:
    uses = turns(left, through) if through else ()
    given = {"bearing": bearing, "lanes_in": left + through, "lanes_out": lanes_out, "turns_in": uses, **more}
    return Leg.model_validate(given)


def lane_end(way: Roadway, edge: str, lane: int, at_end: bool) -> np.ndarray:
    """The middle of a lane at an end of its edge, and the direction there (2, 2)."""
    _, direction = road_of(edge)
    border = way.left_border(direction)
    here, there = border[-2:] if at_end else border[:2]
    ahead = (there - here) / np.hypot(*(there - here))
    width = lane_width_m(way.road)
    aside = (lanes(way.road, direction) - lane - 0.5) * width
    if direction == "forward" and way.road.center_turn_lane:
        aside += width
    place = border[-1] if at_end else border[0]
    return np.array([place + aside * np.array([ahead[1], -ahead[0]]), ahead])


def jogs(spec: RoadSpec, node: str = "hub") -> list[float]:
    """How far the leftmost of each road's through lanes jogs across a node, metres."""
    drawn = roadways(spec)
    farthest: dict[tuple[str, str], tuple[int, int]] = {}
    for link in links(spec, drawn):
        pair = (link.from_edge, link.to_edge)
        ends = [road_of(edge) for edge in pair]
        if {e[0] for e in ends} in ({"N", "S"}, {"N", "N_outer"}) and max(
            link.from_lane - lanes(drawn[ends[0][0]].road, ends[0][1]),
            link.to_lane - lanes(drawn[ends[1][0]].road, ends[1][1]),
        ) < 0:
            farthest[pair] = max(farthest.get(pair, (-1, -1)), (link.from_lane, link.to_lane))
    found = []
    for (start, end), (lane, goal) in farthest.items():
        a = lane_end(drawn[road_of(start)[0]], start, lane, at_end=True)
        b = lane_end(drawn[road_of(end)[0]], end, goal, at_end=False)
        found.append(float(np.cross(a[1], b[0] - a[0])))
    return found


sides = st.tuples(st.integers(0, 2), st.integers(1, 3), st.integers(1, 4))
medians = st.sampled_from(get_args(Median))


@given(sides, sides, medians, medians, st.booleans())
@settings(max_examples=150, deadline=None)
def test_through_lanes_line_up_across_a_junction(
    north: tuple[int, int, int], south: tuple[int, int, int], first: Median, second: Median, tee: bool
) -> None:
    legs = (leg("N", *north, median=first), leg("S", *south, median=second), *(SIDE[:1] if tee else SIDE))
    if tee:  # without left-turn lanes where no road lies to the left
        legs = (leg("N", *north, median=first), leg("S", 0, *south[1:], median=second), SIDE[0])
    spec = road_spec(RoadLayout(legs=legs))
    assert jogs(spec) == pytest.approx([0.0, 0.0], abs=0.02)


@pytest.mark.parametrize(("north", "south"), [
    ({"left": 0, "through": 2, "lanes_out": 2, "center_turn_lane": True}, {"left": 1, "through": 2, "lanes_out": 2}),
    ({"left": 0, "through": 2, "lanes_out": 2, "center_turn_lane": True}, {"left": 0, "through": 2, "lanes_out": 2}),
    ({"left": 0, "through": 3, "lanes_out": 0}, {"left": 0, "through": 0, "lanes_out": 2}),
    ({"left": 1, "through": 2, "lanes_out": 0}, {"left": 0, "through": 1, "lanes_out": 2}),
])  # fmt: skip
def test_center_lanes_and_one_way_roads_line_up(north: dict[str, int], south: dict[str, int]) -> None:
    spec = road_spec(RoadLayout(legs=(leg("N", **north), leg("S", **south), *SIDE)))
    assert jogs(spec)
    assert np.abs(jogs(spec)).max() < 0.02


def test_a_road_of_five_lanes_keeps_its_line_where_a_side_road_lies_on_one_side_only() -> None:
    layout = RoadLayout(legs=(leg("N", 1, 2, 2), leg("S", 1, 2, 2), SIDE[0]))
    spec = road_spec(layout)
    drawn = roadways(spec)
    on = [x for x in links(spec, drawn) if {x.from_edge.strip("-"), x.to_edge.strip("-")} == {"N", "S"}]
    assert {(x.from_edge, x.from_lane, x.to_lane) for x in on} == {
        ("N", 0, 0), ("N", 1, 1), ("S", 0, 0), ("S", 1, 1), ("S", 2, 1),
    } or {(x.from_edge, x.from_lane, x.to_lane) for x in on} == {
        ("N", 0, 0), ("N", 1, 1), ("N", 2, 1), ("S", 0, 0), ("S", 1, 1),
    }  # fmt: skip
    ends = [
        (lane_end(drawn[road_of(x.from_edge)[0]], x.from_edge, x.from_lane, True),
         lane_end(drawn[road_of(x.to_edge)[0]], x.to_edge, x.to_lane, False))
        for x in on if x.from_lane == x.to_lane
    ]  # fmt: skip
    assert max(abs(float(np.cross(a[1], b[0] - a[0]))) for a, b in ends) < 0.02


def test_a_road_with_a_left_turn_lane_keeps_its_line_behind_a_driveway() -> None:
    layout = RoadLayout(
        legs=(leg("N", 1, 2, 2), leg("S", 1, 2, 2), *SIDE), accesses=(Access(leg="N", side="right", distance_m=70),)
    )
    assert np.abs(jogs(road_spec(layout), "N_joint")).max() < 0.02


LINED_UP = [(median, *lanes) for lanes in ((1, 1), (1, 0), (2, 1)) for median in get_args(Median)]


@pytest.mark.parametrize(("median", "left", "other"), spread(LINED_UP, 4))
def test_lined_up_roads_are_sound_in_both_files(median: Median, left: int, other: int) -> None:
    doors = (Access(leg="N", side="both", distance_m=60),)
    legs = (leg("N", left, 2, 2, median=median, control="signal"), leg("S", other, 2, 2, control="signal"), *SIDE)
    spec = road_spec(RoadLayout(legs=legs, accesses=doors))
    net = compile_network(plain_xml(spec), spec)
    assert net.net_xml, net.log
    assert net.xodr, net.log
    graph = parse_net(net.net_xml)
    assert xodr_findings(net.xodr) == []
    assert network_disagreements(graph, net.xodr) == []
    for link in graph.connections:
        if {link.from_edge.strip("-"), link.to_edge.strip("-")} == {"N", "S"}:
            across = np.diff(link.via_shape[[0, -1]], axis=0)[0]
            assert abs(across[0]) < 0.15, "who drives on straight keeps the line"
