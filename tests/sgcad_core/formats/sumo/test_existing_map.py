"""Maps that exist already and networks without a spec: read back with the lanes, turns and controls that they have."""

import math
from pathlib import Path

import pytest

from research.benchmarks.scenes.reimport import differences
from sgcad_core.case.records import RoadNetwork
from sgcad_core.errors import ConfigError, InvalidOutput
from sgcad_core.formats.sumo.existing_map import hub_legs, read_map
from sgcad_core.formats.sumo.graph_spec import spec_of_graph
from sgcad_core.formats.sumo.net_xml import network_figures, parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Leg, Node, Road, RoadLayout, RoadSpec
from sgcad_core.roads.layout import road_spec

LEGS = (
    Leg(bearing="N", lanes_in=2, lanes_out=2, control="signal"), Leg(bearing="S", lanes_in=2, lanes_out=2),
    Leg(bearing="E", lanes_in=0, lanes_out=1), Leg(bearing="W", lanes_in=1, lanes_out=0, speed_limit_mph=25),
)  # fmt: skip


@pytest.fixture(scope="module")
def drawn() -> RoadNetwork:
    spec = road_spec(RoadLayout(legs=LEGS))
    return compile_network(plain_xml(spec), spec)


@pytest.fixture(scope="module")
def files(drawn: RoadNetwork, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("maps")
    for name, text in (("a.net.xml", drawn.net_xml), ("a.xodr", drawn.xodr)):
        (folder / name).write_text(text or "")
    return {file.name: file for file in folder.iterdir()}


def test_a_spec_read_back_has_the_roads_that_were_drawn(drawn: RoadNetwork) -> None:
    assert drawn.spec
    assert drawn.net_xml
    found = spec_of_graph(parse_net(drawn.net_xml))
    lanes = {r.id: (r.from_node, r.to_node, r.lanes_forward, r.lanes_backward) for r in found.roads}
    assert lanes == {r.id: (r.from_node, r.to_node, r.lanes_forward, r.lanes_backward) for r in drawn.spec.roads}
    assert {n.id: (n.x_m, n.y_m, n.control) for n in found.nodes} == {
        n.id: (n.x_m, n.y_m, n.control) for n in drawn.spec.nodes
    }
    west = next(r for r in found.roads if r.id == "W")
    assert (west.speed_limit_mph, west.via) == (25, ())
    north = next(r for r in found.roads if r.id == "N")
    assert len(north.turns_forward) == 2


def test_a_curved_road_keeps_its_curve() -> None:
    legs = (Leg(bearing="N", lanes_in=1, lanes_out=1, curve="left"), Leg(bearing="S", lanes_in=1, lanes_out=1))
    spec = road_spec(RoadLayout(legs=legs))
    network = compile_network(plain_xml(spec), spec)
    found = {r.id: r for r in spec_of_graph(parse_net(network.net_xml or "")).roads}
    assert len(found["N"].via) > 2
    assert found["S"].via == ()


@pytest.mark.parametrize("name", ["a.net.xml", "a.xodr"])
def test_a_map_is_read_with_its_legs_and_compiles_to_the_same_figures(
    files: dict[str, Path], drawn: RoadNetwork, name: str
) -> None:
    plain = read_map(files[name])
    legs, control = hub_legs(plain)
    assert sorted((leg.lanes_in, leg.lanes_out) for leg in legs) == [(0, 1), (1, 0), (2, 2), (2, 2)]
    assert sorted(round(math.degrees(leg.angle_rad) / 90) % 4 for leg in legs) == [0, 1, 2, 3]
    assert control == "signal"
    again = compile_network(plain)
    assert again.net_xml, again.log
    figures, before = network_figures(parse_net(again.net_xml)), network_figures(parse_net(drawn.net_xml or ""))
    assert figures == before


def test_roads_there_and_back_are_one_road_with_an_id_of_the_project(files: dict[str, Path]) -> None:
    network = compile_network(read_map(files["a.net.xml"]))
    ids = set(parse_net(network.net_xml or "").edges)
    assert len(ids) == 6
    assert sum(f"-{i}" in ids for i in ids) == 2
    assert all(i.lstrip("-").startswith("R") for i in ids)


@pytest.mark.parametrize(("controls", "expected"), [
    (("stop", "none"), "priority_stop"), (("stop", "stop"), "allway_stop"), (("yield", "none"), "priority"),
])  # fmt: skip
def test_signs_and_center_lanes_of_an_xodr_are_read(controls: tuple[str, str], expected: str, tmp_path: Path) -> None:
    legs = [Leg(bearing=b, lanes_in=2, lanes_out=2, control=c, center_turn_lane=c == "none") for b, c in
            (("N", controls[0]), ("S", controls[0]), ("E", controls[1]), ("W", controls[1]))]  # fmt: skip
    spec = road_spec(RoadLayout(legs=tuple(legs)))
    before = compile_network(plain_xml(spec), spec)
    (tmp_path / "c.xodr").write_text(before.xodr or "")
    after = parse_net(compile_network(read_map(tmp_path / "c.xodr")).net_xml or "")
    (node,) = (n for n in after.nodes.values() if n.type != "dead_end")
    assert node.type == expected
    assert differences(before.net_xml or "", before.xodr or "", "sgcad") == []
    closed = [lane for edge in after.edges.values() for lane in edge.lanes if not lane.allows_cars]
    assert len(closed) == sum(leg.center_turn_lane for leg in legs)


def test_all_lanes_that_lead_into_one_are_read(tmp_path: Path) -> None:
    legs = tuple(Leg(bearing=b, lanes_in=4, lanes_out=1) for b in ("N", "S", "E", "W"))
    spec = road_spec(RoadLayout(legs=legs))
    before = compile_network(plain_xml(spec), spec)
    lost = differences(before.net_xml or "", before.xodr or "", "netconvert")
    assert {d.aspect for d in lost} == {"connections"}  # netconvert's own reading takes the first of them
    assert differences(before.net_xml or "", before.xodr or "", "sgcad") == []


def test_a_plain_road_is_a_map_and_roads_away_from_every_junction_are_none(tmp_path: Path) -> None:
    legs = (Leg(bearing="N", lanes_in=1, lanes_out=1), Leg(bearing="S", lanes_in=1, lanes_out=1))
    spec = road_spec(RoadLayout(legs=legs))
    (tmp_path / "p.xodr").write_text(compile_network(plain_xml(spec), spec).xodr or "")
    assert hub_legs(read_map(tmp_path / "p.xodr"))[1] == "none"
    far = RoadSpec(
        nodes=(*road_spec(RoadLayout(legs=LEGS)).nodes, Node(id="x", x_m=900, y_m=900), Node(id="y", x_m=990, y_m=900)),
        roads=(*road_spec(RoadLayout(legs=LEGS)).roads,
               Road(id="far", from_node="x", to_node="y", lanes_forward=1, lanes_backward=1)),
    )  # fmt: skip
    (tmp_path / "f.net.xml").write_text(compile_network(plain_xml(far), far).net_xml or "")
    assert len(parse_net(compile_network(read_map(tmp_path / "f.net.xml")).net_xml or "").edges) == 6


def test_a_file_that_is_no_map_is_named(tmp_path: Path) -> None:
    (tmp_path / "b.net.xml").write_text("<net>")
    with pytest.raises(ConfigError, match=r"b\.net\.xml: netconvert cannot read it"):
        read_map(tmp_path / "b.net.xml")


def test_a_network_too_large_for_a_spec_says_so(drawn: RoadNetwork) -> None:
    graph = parse_net(drawn.net_xml or "")
    edge = graph.edges["N"]
    many = type(graph)({f"R{i}": type(edge)(f"R{i}", "N_end", "hub", edge.lanes) for i in range(70)}, (), graph.nodes)
    with pytest.raises(InvalidOutput, match="use a smaller network"):
        spec_of_graph(many)
