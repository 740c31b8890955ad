"""The .xodr that is written from a .net.xml: two-way roads, lanes, markings, junctions, in the net's frame."""

from __future__ import annotations

import numpy as np
import pytest
from lxml import etree

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.agreement import network_disagreements
from sgcad_core.formats.opendrive.checks.check_file import xodr_findings
from sgcad_core.formats.opendrive.checks.road_index import lane_index
from sgcad_core.formats.opendrive.write import write_xodr
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.geometry.distances import distance_to
from sgcad_core.geometry.plane import arc_lengths, prolonged, resample
from tests.sgcad_core.formats.road_samples import NAMED, compiled, random_spec, road, star


def root_of(network):
    return etree.fromstring(network.xodr.encode())


def made(spec):
    return compile_network(plain_xml(spec), spec)


def street(network, name):
    return root_of(network).xpath(f"road[@name='{name}']")[0]


def lanes(element, side):
    found = element.iterfind(f"lanes/laneSection/{side}/lane")
    return {int(lane.get("id")): lane for lane in found}


@pytest.mark.parametrize("name", NAMED)
def test_both_directions_of_a_street_are_one_road(name):
    network = compiled(name)
    graph, index = parse_net(network.net_xml), lane_index(network.xodr)
    for edge in graph.edges:
        assert index.by_edge(edge) is not None
        if edge.startswith("-") and edge[1:] in graph.edges:
            assert index.by_edge(edge).id == index.by_edge(edge[1:]).id
            assert index.lane(edge, 0).lane > 0 > index.lane(edge[1:], 0).lane


@pytest.mark.parametrize("name", NAMED)
def test_lane_centers_and_connectors_lie_where_sumo_has_them(name):
    network = compiled(name)
    graph, index, roads = parse_net(network.net_xml), lane_index(network.xodr), XodrRoads(network.xodr)
    for edge in graph.edges.values():
        for lane in edge.lanes:
            center = prolonged(roads.lane_center(*index.lane(edge.id, lane.index)), 1.0)
            limit = 1e-6 if len(lane.shape) == 2 else 0.05
            assert distance_to(center, sampled(lane.shape)).max() < limit
    inner = [r.get("id") for r in root_of(network).iterfind("road") if r.get("junction") != "-1"]
    for connector, link in zip(inner, graph.connections, strict=True):
        assert distance_to(roads.lane_center(connector, -1), sampled(link.via_shape)).max() < 0.45
    assert network_disagreements(graph, network.xodr) == []


def sampled(line):
    return resample(line, np.linspace(0, arc_lengths(line)[-1], 21))


@pytest.mark.parametrize("seed", range(6))
def test_wild_networks_are_valid_and_agree(seed):
    network = made(random_spec(500 + seed))
    assert xodr_findings(network.xodr) == []
    roads = lane_index(network.xodr)
    assert roads.edges == set(parse_net(network.net_xml).edges)


def test_the_header_tells_version_bounds_and_frame():
    header = root_of(compiled("stop")).find("header")
    assert (header.get("revMajor"), header.get("revMinor")) == ("1", "7")
    assert [round(float(header.get(k)), 1) for k in ("north", "south", "east", "west")] == [121.8, -7.2, 121.8, -121.8]
    assert header.find("geoReference").text.startswith("+proj=tmerc")


def test_a_two_way_left_turn_lane_is_bidirectional_and_marked_for_both_sides():
    east = street(compiled("center_lane"), "E")
    assert {i: lane.get("type") for i, lane in lanes(east, "right").items()} == {
        -1: "bidirectional", -2: "driving", -3: "driving",
    }  # fmt: skip
    marks = [lanes(east, "center")[0].find("roadMark"), lanes(east, "right")[-1].find("roadMark")]
    assert [(m.get("type"), m.get("color")) for m in marks] == [("solid broken", "yellow"), ("broken solid", "yellow")]


@pytest.mark.parametrize(("median", "gap"), [("painted", 0.6), ("raised", 1.2), ("grass", 4.0), ("barrier", 0.9)])
def test_a_median_is_a_lane_on_both_sides_of_the_center(median, gap):
    north = street(made(star("N", "E", "S", "W", median=median)), "N")
    for side, lane in (("left", 1), ("right", -1)):
        strip = lanes(north, side)[lane]
        assert strip.get("type") == "median"
        assert float(strip.find("width").get("a")) == pytest.approx(gap, abs=0.01)
        assert strip.find("userData[@code='median']").get("value") == median
    assert {i: lane.get("type") for i, lane in lanes(north, "right").items()} == {
        -1: "median", -2: "driving", -3: "driving",
    }  # fmt: skip


def test_markings_are_double_yellow_broken_white_and_solid_white():
    north = street(compiled("stop"), "N")
    found = [lanes(north, "center")[0], lanes(north, "right")[-1], lanes(north, "right")[-2]]
    marks = [(lane.find("roadMark").get("type"), lane.find("roadMark").get("color")) for lane in found]
    assert marks == [("solid solid", "yellow"), ("broken", "white"), ("solid", "white")]


def test_a_one_way_road_has_a_yellow_line_at_its_left_and_a_driveway_none():
    ramp = street(compiled("ramp"), "in")
    assert lanes(ramp, "center")[0].find("roadMark").get("color") == "yellow"
    assert ramp.find("lanes/laneSection/left") is None
    drive = street(compiled("chain"), "drive")
    assert {mark.get("type") for mark in drive.iterfind(".//roadMark")} == {"none"}
    assert drive.find("type").get("type") == "townPrivate"


def test_only_a_posted_limit_is_a_speed_of_road_and_lane_and_a_sign():
    spec = star("N", "E", "S", "W")
    told = spec.model_copy(update={"roads": tuple(
        r.model_copy(update={"speed_limit_mph": 25 if r.id == "N" else None}) for r in spec.roads
    )})  # fmt: skip
    network = made(told)
    north, east = street(network, "N"), street(network, "E")
    assert (north.find("type/speed").get("max"), north.find("type/speed").get("unit")) == ("25", "mph")
    assert {s.get("max") for s in north.iterfind(".//lane/speed")} == {"25"}
    signs = north.xpath("signals/signal[@type='R2-1']")
    assert [(s.get("orientation"), s.get("value")) for s in signs] == [("+", "25"), ("-", "25")]
    assert east.find("type").get("type") == "unknown"
    assert not east.xpath(".//speed | .//signal[@type='R2-1']")
    edges = etree.fromstring(network.net_xml.encode())
    limit = {e.get("id"): e.find("param[@key='speed_limit']").get("value") for e in edges.xpath("edge[param]")}
    assert (limit["N"], limit["E"]) == ("posted_mph 25", "assumed")


def test_equal_networks_are_equal_files():
    assert write_xodr(compiled("signal").net_xml) == compiled("signal").xodr


def test_a_net_without_a_road_is_refused():
    with pytest.raises(InvalidOutput, match="no road that can be drawn"):
        write_xodr("<net/>")


def test_lanes_that_touch_get_a_connecting_road_with_a_length():
    text = compiled("ramp").net_xml
    root = etree.fromstring(text.encode())
    ends = {lane.get("id"): lane for lane in root.iterfind("edge/lane")}
    first, second = ends["in_0"], ends["out_0"]
    start = second.get("shape").split()[0]
    first.set("shape", " ".join([*first.get("shape").split()[:-1], start]))
    for link in root.xpath("connection[@from='in'][@fromLane='0'][@to='out']"):
        link.attrib.pop("via", None)
    assert xodr_findings(write_xodr(etree.tostring(root).decode())) == []


def test_roads_there_and_back_that_lie_far_apart_stay_two_roads():
    root = etree.fromstring(compiled("center_lane").net_xml.encode())
    for lane in root.xpath("edge[@id='-E']/lane"):
        moved = [f"{p.split(',')[0]},{float(p.split(',')[1]) + 60}" for p in lane.get("shape").split()]
        lane.set("shape", " ".join(moved))
    index = lane_index(write_xodr(etree.tostring(root).decode()))
    assert index.by_edge("E").id != index.by_edge("-E").id
    assert road("a", "b", "c").lanes_forward == 1
