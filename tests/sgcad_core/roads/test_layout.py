"""Layouts compile to road networks with the promised ids, whatever their legs."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.formats.sumo.net_xml import network_figures, parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.geometry.distances import distance_to
from sgcad_core.geometry.plane import arc_lengths
from sgcad_core.records.specs import Access, Compass, Leg, Median, Node, Road, RoadLayout, RoadSpec
from sgcad_core.roads.layout import COMPASS, LEG_M, road_spec
from tests.effort import spread


def leg(bearing: str, lanes_in: int = 1, lanes_out: int = 1, **more: object) -> Leg:
    return Leg.model_validate({"bearing": bearing, "lanes_in": lanes_in, "lanes_out": lanes_out, **more})


def node(spec: RoadSpec, id: str) -> Node:
    return next(n for n in spec.nodes if n.id == id)


def road(spec: RoadSpec, id: str) -> Road:
    return next(r for r in spec.roads if r.id == id)


def test_a_leg_runs_from_its_bearing_to_the_hub() -> None:
    spec = road_spec(RoadLayout(legs=(leg("N", 2, 1), leg("E"))))
    north = road(spec, "N")
    assert (north.from_node, north.to_node) == ("N_end", "hub")
    assert (north.lanes_forward, north.lanes_backward) == (2, 1)
    end = node(spec, "N_end")
    assert (end.x_m, end.y_m) == pytest.approx((0, LEG_M))


def test_an_access_splits_its_leg_at_a_joint() -> None:
    spec = road_spec(RoadLayout(legs=(leg("N"), leg("S")), accesses=(Access(leg="N", side="left", distance_m=50),)))
    assert {r.id for r in spec.roads} == {"N", "N_outer", "N_access_left", "S"}
    assert {n.id for n in spec.nodes} == {"hub", "N_joint", "N_end", "N_access_left_end", "S_end"}
    assert (road(spec, "N").from_node, road(spec, "N_outer").to_node) == ("N_joint", "N_joint")
    assert road(spec, "N_access_left").to_node == "N_joint"


@pytest.mark.parametrize(("bearing", "side", "east", "north"), [
    ("N", "left", 1, 0), ("N", "right", -1, 0), ("E", "left", 0, -1), ("S", "right", 1, 0), ("W", "left", 0, 1),
])  # fmt: skip
def test_the_side_of_an_access_is_as_one_drives_to_the_hub(bearing: str, side: str, east: int, north: int) -> None:
    access = Access.model_validate({"leg": bearing, "side": side})
    spec = road_spec(RoadLayout(legs=(leg(bearing), leg("NE")), accesses=(access,)))
    joint, end = node(spec, f"{bearing}_joint"), node(spec, f"{bearing}_access_{side}_end")
    length = math.dist((joint.x_m, joint.y_m), (end.x_m, end.y_m))
    assert (end.x_m - joint.x_m) / length == pytest.approx(east, abs=0.01)
    assert (end.y_m - joint.y_m) / length == pytest.approx(north, abs=0.01)


def test_an_access_on_both_sides_shares_one_joint() -> None:
    spec = road_spec(RoadLayout(legs=(leg("E"), leg("W")), accesses=(Access(leg="E", side="both"),)))
    assert {r.id for r in spec.roads if "access" in r.id} == {"E_access_left", "E_access_right"}
    assert sum(n.id.startswith("E_joint") for n in spec.nodes) == 1


def test_an_access_joins_clear_of_a_wide_crossing_road() -> None:
    wide = leg("E", 3, 3, median="grass")
    near = Access(leg="N", side="right", distance_m=15)
    spec = road_spec(RoadLayout(legs=(leg("N"), leg("S"), wide), accesses=(near,)))
    assert node(spec, "N_joint").y_m >= 20 + (6 * 3.6 + 8) / 2


def test_accesses_of_one_side_get_joints_of_their_own() -> None:
    accesses = (Access(leg="E", side="left", distance_m=40), Access(leg="E", side="left", distance_m=90))
    spec = road_spec(RoadLayout(legs=(leg("E"), leg("W")), accesses=accesses))
    assert {r.id for r in spec.roads if r.id.startswith("E")} == {
        "E", "E_mid", "E_outer", "E_access_left", "E_access_left2",
    }  # fmt: skip


@pytest.mark.parametrize(("curve", "sign"), [("left", 1), ("right", -1)])
def test_a_curve_bends_as_one_drives_to_the_hub(curve: str, sign: int) -> None:
    spec = road_spec(RoadLayout(legs=(leg("N", curve=curve), leg("S"))))
    north = road(spec, "N")
    line = [node(spec, "N_end"), *north.via, node(spec, "hub")]
    headings = [math.atan2(b.y_m - a.y_m, b.x_m - a.x_m) for a, b in pairwise(line)]
    turns = [math.remainder(b - a, 2 * math.pi) for a, b in pairwise(headings)]
    assert all(turn * sign > -1e-3 for turn in turns)
    assert sum(turns) * sign == pytest.approx(math.radians(20), abs=0.06)


def test_a_ramp_joins_at_an_acute_angle() -> None:
    spec = road_spec(RoadLayout(legs=(leg("W", 2, 2), leg("E", 2, 2), leg("SW", 1, 0, kind="ramp"))))
    end = node(spec, "SW_end")
    angle = math.degrees(math.atan2(abs(end.y_m), abs(end.x_m)))
    assert angle == pytest.approx(28, abs=1)


@pytest.mark.parametrize(("controls", "want"), [
    (("stop", "none", "stop"), "stop"), (("stop", "stop", "stop"), "all_way_stop"),
    (("signal", "stop", "none"), "signal"), (("none", "none", "none"), "none"),
    (("none", "yield", "none"), "yield"), (("flashing", "stop", "none"), "flashing"),
])  # fmt: skip
def test_the_strongest_control_stands_at_the_hub(controls: tuple[str, str, str], want: str) -> None:
    legs = tuple(leg(b, control=c) for b, c in zip("NES", controls, strict=True))
    assert node(road_spec(RoadLayout(legs=legs)), "hub").control == want


def test_a_leg_that_nobody_comes_by_makes_no_all_way_stop_a_lesser_one() -> None:
    legs = (leg("N", control="stop"), leg("E", control="stop"), leg("S", 0, 1))
    assert node(road_spec(RoadLayout(legs=legs)), "hub").control == "all_way_stop"


def test_two_legs_make_no_junction() -> None:
    spec = road_spec(RoadLayout(legs=(leg("N", control="stop"), leg("S"))))
    assert node(spec, "hub").control == "none"


def test_of_two_legs_with_one_bearing_the_first_stands() -> None:
    spec = road_spec(RoadLayout(legs=(leg("N", 3, 3), leg("N", 1, 1), leg("S"))))
    assert [(r.id, r.lanes_forward) for r in spec.roads] == [("N", 3), ("S", 1)]


counts = st.integers(0, 4)
legs = st.lists(
    st.builds(
        leg, st.sampled_from(COMPASS), counts, counts, curve=st.sampled_from(["none", "left", "right"]),
        control=st.sampled_from(["none", "stop", "signal"]), center_turn_lane=st.booleans(),
        median=st.sampled_from(["none", "raised", "grass"]),
    ).filter(lambda x: x.lanes_in + x.lanes_out > 0),
    min_size=2, max_size=6, unique_by=lambda x: x.bearing,
)  # fmt: skip
accesses = st.lists(
    st.tuples(st.integers(0, 5), st.sampled_from(["left", "right", "both"]), st.floats(15, 150)), max_size=4
)


@given(legs, accesses)
@settings(max_examples=200, deadline=None)
def test_every_layout_gives_a_sound_spec(chosen: list[Leg], places: list[tuple[int, str, float]]) -> None:
    at = [chosen[i % len(chosen)].bearing for i, _, _ in places]
    doors = tuple(
        Access.model_validate({"leg": b, "side": side, "distance_m": d})
        for b, (_, side, d) in zip(at, places, strict=True)
    )
    spec = road_spec(RoadLayout(legs=tuple(chosen), accesses=doors))
    ids = [n.id for n in spec.nodes]
    assert len(ids) == len(set(ids))
    assert len({r.id for r in spec.roads}) == len(spec.roads)
    assert all(r.from_node in ids and r.to_node in ids and r.from_node != r.to_node for r in spec.roads)
    assert sum("access" in r.id for r in spec.roads) == sum(2 if side == "both" else 1 for _, side, _ in places)


@pytest.mark.slow
@given(legs)
@settings(max_examples=25, deadline=None)
def test_every_layout_compiles_to_one_network_with_its_lanes(chosen: list[Leg]) -> None:
    both = tuple(x.model_copy(update={k: max(getattr(x, k), 1) for k in ("lanes_in", "lanes_out")}) for x in chosen)
    spec = road_spec(RoadLayout(legs=both))
    network = compile_network(plain_xml(spec), spec)
    assert network.net_xml, network.log
    graph = parse_net(network.net_xml)
    figures = network_figures(graph)
    assert figures.components == 1
    assert figures.intersections == (len(both) > 2)
    for x in both:
        assert len(graph.edges[x.bearing].car_lanes) == x.lanes_in
        assert len(graph.edges[f"-{x.bearing}"].car_lanes) == x.lanes_out


RAMPS = [
    (own, lanes, median, leaves)
    for leaves in (False, True)
    for lanes, median in ((1, "none"), (2, "grass"), (3, "grass"), (3, "barrier"))
    for own in ("N", "NE", "E")
]


@pytest.mark.parametrize(("own", "lanes", "median", "leaves"), spread(RAMPS, 4))
def test_a_ramp_meets_the_outer_lane_of_its_road(own: Compass, lanes: int, median: Median, leaves: bool) -> None:
    back = COMPASS[(COMPASS.index(own) + 4) % 8]
    side = COMPASS[(COMPASS.index(own) + (5 if leaves else -1)) % 8]
    legs = [Leg(bearing=at, lanes_in=lanes, lanes_out=lanes, median=median) for at in (own, back)]
    ramp = Leg(bearing=side, lanes_in=int(not leaves), lanes_out=int(leaves), kind="ramp")
    spec = road_spec(RoadLayout(legs=(*legs, ramp)))
    graph = parse_net(compile_network(plain_xml(spec), spec).net_xml or "")
    ends = (own, f"-{side}") if leaves else (side, f"-{back}")
    link = next(c for c in graph.connections if (c.from_edge, c.to_edge) == ends)
    outer = graph.edges[own if leaves else f"-{back}"].lanes[0].shape
    at_road = link.via_shape[0 if leaves else -1]
    assert float(distance_to(outer, at_road[None])[0]) < 0.05
    assert 5.0 < float(arc_lengths(link.via_shape)[-1]) < 30.0, "it joins beside the lane, not across the road"
