"""Road specs for tests: some named ones, seeded random ones, and a strategy for any valid one."""

from __future__ import annotations

import random
from functools import cache
from typing import get_args

from hypothesis import strategies as st

from sgcad_core.case.records import RoadNetwork
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Node, NodeControl, Point, Road, RoadSpec, Turn

BEARINGS = {"N": (0, 1), "NE": (0.7, 0.7), "E": (1, 0), "S": (0, -1), "SW": (-0.7, -0.7), "W": (-1, 0)}


def road(name, start, end, lanes=(1, 1), **fields):
    return Road(id=name, from_node=start, to_node=end, lanes_forward=lanes[0], lanes_backward=lanes[1], **fields)


def star(*bearings, control="none", lanes=(2, 2), **fields):
    """A hub with legs 120 m long, forward towards the hub."""
    nodes = [Node(id="hub", x_m=0, y_m=0, control=control)]
    nodes += [Node(id=f"{b}_end", x_m=120 * BEARINGS[b][0], y_m=120 * BEARINGS[b][1]) for b in bearings]
    return RoadSpec(nodes=nodes, roads=[road(b, f"{b}_end", "hub", lanes, **fields) for b in bearings])


def curve():
    """A plain two-lane road that bends through a quarter circle of 80 m."""
    via = [Point(x_m=x, y_m=y) for x, y in ((-70, 6), (-40, 24), (-17, 47), (-4, 74))]
    nodes = [Node(id="a", x_m=-100, y_m=0), Node(id="b", x_m=0, y_m=100)]
    return RoadSpec(nodes=nodes, roads=[road("r", "a", "b", via=via)])


def ramp():
    """A one-way road of two lanes, joined from its right by a ramp."""
    nodes = [Node(id="a", x_m=-200, y_m=0), Node(id="m", x_m=0, y_m=0), Node(id="b", x_m=200, y_m=0)]
    nodes.append(Node(id="r", x_m=-150, y_m=-80))
    roads = [road("in", "a", "m", (2, 0)), road("out", "m", "b", (2, 0)), road("up", "r", "m", (1, 0), kind="ramp")]
    return RoadSpec(nodes=nodes, roads=roads)


def chain():
    """A divided road that becomes undivided, then gets a two-way left-turn lane, with a driveway."""
    nodes = [Node(id=n, x_m=x, y_m=0) for n, x in (("a", -150), ("b", 0), ("c", 80), ("d", 200))]
    nodes.append(Node(id="x", x_m=80, y_m=-40))
    roads = [
        road("one", "a", "b", (2, 2), median="grass"),
        road("two", "b", "c", (2, 2)),
        road("three", "c", "d", (2, 2), center_turn_lane=True),
        road("drive", "x", "c", kind="driveway", minor=True),
    ]
    return RoadSpec(nodes=nodes, roads=roads)


NAMED = {
    "signal": star("N", "E", "S", "W", control="signal", lanes=(3, 2), median="raised"),
    "stop": star("N", "E", "W", control="stop"),
    "all_way_stop": star("N", "E", "S", "W", control="all_way_stop", lanes=(1, 1)),
    "skewed": star("N", "NE", "SW", "S", lanes=(1, 1)),
    "center_lane": star("E", "W", center_turn_lane=True),
    "curve": curve(),
    "ramp": ramp(),
    "chain": chain(),
}


@cache
def compiled(name: str) -> RoadNetwork:
    """A named spec, compiled once a test run."""
    return compile_network(plain_xml(NAMED[name]), NAMED[name])


def random_spec(seed: int) -> RoadSpec:
    """A wild network: roads cross, lie on each other, bend sharply."""
    r = random.Random(seed)
    reach = r.choice([60, 150, 400])
    nodes = [
        Node(id=f"n{i}", x_m=round(r.uniform(-reach, reach), 1), y_m=round(r.uniform(-reach, reach), 1),
             control=r.choice(get_args(NodeControl)))
        for i in range(r.randint(2, 7))
    ]  # fmt: skip
    return RoadSpec(nodes=nodes, roads=[_random_road(r, f"r{i}", nodes) for i in range(r.randint(1, len(nodes) + 2))])


def _random_road(r: random.Random, name: str, nodes: list[Node]) -> Road:
    a, b = r.sample(nodes, 2)
    lanes = r.choice([(1, 1), (2, 2), (1, 0), (0, 2), (3, 2), (4, 4), (8, 8)])
    via = [
        Point(x_m=a.x_m + (b.x_m - a.x_m) * k / 4 + r.uniform(-15, 15), y_m=a.y_m + (b.y_m - a.y_m) * k / 4)
        for k in range(1, r.choice([1, 1, 4]))
    ]
    turns = [r.choice(get_args(Turn)) for _ in range(lanes[0])] if r.random() < 0.3 else []
    return road(
        name, a.id, b.id, lanes, via=via, center_turn_lane=r.random() < 0.2, minor=r.random() < 0.3,
        median=r.choice(["none", "raised", "grass"]), kind=r.choice(["road", "road", "driveway", "ramp"]),
        turns_forward=turns,
    )  # fmt: skip


# ------------------------------------------------------------------ any valid spec
_near = st.floats(-300, 300, allow_nan=False).map(lambda v: round(v, 1))
_far = st.floats(-3000, 3000, allow_nan=False)
_place = st.one_of(_near, _far)
_name = st.sampled_from(["a", "b", "c", "d", "e"])
_count = st.integers(0, 8)
_turns = st.lists(st.sampled_from(get_args(Turn)), max_size=4)
_points = st.lists(st.builds(Point, x_m=_place, y_m=_place), max_size=4)
_roads = st.builds(
    Road, id=st.sampled_from(["p", "q", "r", "s", "t", "u"]), from_node=_name, to_node=_name, lanes_forward=_count,
    lanes_backward=_count, turns_forward=_turns, turns_backward=_turns, center_turn_lane=st.booleans(),
    median=st.sampled_from(["none", "painted", "raised", "grass", "barrier"]), via=_points,
    kind=st.sampled_from(["road", "driveway", "ramp"]), minor=st.booleans(),
    speed_limit_mph=st.one_of(st.none(), st.integers(5, 85)),
)  # fmt: skip
_nodes = st.builds(Node, id=_name, x_m=_place, y_m=_place, control=st.sampled_from(get_args(NodeControl)))
any_spec = st.builds(
    RoadSpec,
    nodes=st.lists(_nodes, min_size=2, max_size=5, unique_by=lambda n: n.id),
    roads=st.lists(_roads, min_size=1, max_size=6),
)
