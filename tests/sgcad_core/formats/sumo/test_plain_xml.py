"""Road specs as SUMO plain XML."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from lxml import etree

from sgcad_core.case.records import PlainXml
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.plain_xml import plain_xml, sumo_findings, xsd_findings
from sgcad_core.records.specs import Node, RoadSpec
from sgcad_core.roads.connections import links
from sgcad_core.roads.road_geometry import MEDIAN_M, roadways, smooth
from sgcad_core.roads.road_spec import spec_findings, turn_findings
from tests.sgcad_core.formats.road_samples import NAMED, any_spec, compiled, random_spec, road, star


def edges(spec):
    return {e.get("id"): e for e in etree.fromstring(plain_xml(spec).edges.encode())}


def nodes(spec):
    return {n.get("id"): n for n in etree.fromstring(plain_xml(spec).nodes.encode())}


def line(edge):
    return np.array([[float(v) for v in p.split(",")] for p in edge.get("shape").split()])


def lane_links(spec, edge):
    """{(to edge, from lane)} of an approach."""
    return {(link.to_edge, link.from_lane) for link in links(spec, roadways(spec)) if link.from_edge == edge}


# ------------------------------------------------------------------ edges
@pytest.mark.parametrize("name", NAMED)
def test_both_directions_join_the_roads_own_nodes(name):
    found = edges(NAMED[name])
    for r in NAMED[name].roads:
        assert (found[r.id].get("from"), found[r.id].get("to")) == (r.from_node, r.to_node)
        if r.lanes_backward:
            assert (found[f"-{r.id}"].get("from"), found[f"-{r.id}"].get("to")) == (r.to_node, r.from_node)
        else:
            assert f"-{r.id}" not in found


@pytest.mark.parametrize("median", ["none", "painted", "raised", "grass", "barrier"])
def test_a_median_parts_the_directions_by_its_width(median):
    found = edges(star("N", "E", "S", median=median))
    gap = line(found["-N"])[0][0] - line(found["N"])[-1][0]
    assert gap == pytest.approx(MEDIAN_M[median])


def test_directions_meet_where_a_median_ends():
    found = edges(NAMED["chain"])
    assert line(found["one"])[0][1] == pytest.approx(-MEDIAN_M["grass"] / 2)
    assert line(found["one"])[-1][1] == pytest.approx(0, abs=1e-6)
    assert len(line(found["one"])) > 20


def test_a_two_way_left_turn_lane_straddles_the_center_line():
    found = edges(NAMED["center_lane"])
    assert found["E"].get("numLanes") == "3"
    assert found["-E"].get("numLanes") == "2"
    assert found["E"].find("lane").get("index") == "2"
    assert line(found["E"])[0][1] - line(found["-E"])[0][1] == pytest.approx(-3.6 + 3.6)
    assert line(found["E"])[0][1] == pytest.approx(-1.8)


def test_a_one_way_road_lies_on_its_line():
    ends = [Node(id="a", x_m=0, y_m=0), Node(id="b", x_m=100, y_m=0)]
    spec = RoadSpec(nodes=ends, roads=[road("r", "a", "b", (3, 0))])
    assert line(edges(spec)["r"])[0][1] == pytest.approx(1.5 * 3.6)


def test_two_one_way_roads_there_and_back_lie_side_by_side():
    two = [road("r", "a", "b", (2, 0)), road("q", "b", "a", (2, 0))]
    spec = RoadSpec(nodes=[Node(id="a", x_m=0, y_m=0), Node(id="b", x_m=100, y_m=0)], roads=two)
    assert {round(line(e)[0][1], 3) for e in edges(spec).values()} == {0.0}


def test_speeds_are_the_posted_or_the_usual_ones():
    assert float(edges(star("N", "E", "S", speed_limit_mph=45))["N"].get("speed")) == pytest.approx(20.117, abs=1e-3)
    assert float(edges(star("N", "E", "S"))["N"].get("speed")) == pytest.approx(15.646, abs=1e-3)


def test_curves_are_smooth_and_pass_through_their_points():
    points = np.array([[0.0, 0], [40, 5], [70, 25], [85, 60]])
    drawn = smooth(points)
    steps = np.hypot(*np.diff(drawn, axis=0).T)
    assert steps.min() > 1.5
    assert steps.max() < 4.5
    assert all(np.hypot(*(drawn - p).T).min() < 1e-6 for p in points)
    turns = np.abs(np.diff(np.unwrap(np.arctan2(*np.diff(drawn, axis=0).T[::-1]))))
    assert np.degrees(turns).max() < 4


def test_points_of_an_arc_give_the_arc():
    angle = np.linspace(0, 1.5, 6)
    drawn = smooth(100 * np.column_stack((np.cos(angle), np.sin(angle))))
    assert np.abs(np.hypot(*drawn.T) - 100).max() < 0.05


def test_points_in_one_place_do_not_break_a_curve():
    assert np.isfinite(smooth(np.array([[0.0, 0], [0, 0], [50, 1], [50, 1], [100, 0]]))).all()


# ------------------------------------------------------------------ nodes
@pytest.mark.parametrize(
    ("control", "kind"),
    [("none", "priority"), ("signal", "traffic_light"), ("stop", "priority_stop"), ("all_way_stop", "allway_stop"),
     ("yield", "priority"), ("flashing", "allway_stop")],
)  # fmt: skip
def test_control_becomes_the_type_of_the_node(control, kind):
    assert nodes(star("N", "E", "S", control=control))["hub"].get("type") == kind


def test_flashing_lights_stop_the_minor_roads_only():
    assert nodes(star("N", "E", "S", control="flashing", minor=True))["hub"].get("type") == "priority_stop"


def test_minor_roads_have_the_lower_priority():
    spec = star("N", "E", "S", control="stop")
    spec = RoadSpec(nodes=spec.nodes, roads=[*spec.roads[:2], spec.roads[2].model_copy(update={"minor": True})])
    priority = {name: int(e.get("priority")) for name, e in edges(spec).items()}
    assert priority["S"] < priority["N"] == priority["E"]


def test_a_stop_sign_needs_a_junction():
    spec = star("N", "S", control="stop")
    assert nodes(spec)["hub"].get("type") == "priority"


# ------------------------------------------------------------------ turns
def test_stated_turns_are_kept():
    spec = star("N", "E", "S", "W", lanes=(3, 2), turns_forward=["right", "through", "left"])
    assert lane_links(spec, "S") == {("-E", 0), ("-N", 1), ("-W", 2)}


def test_without_stated_turns_outer_lanes_turn_and_spare_lanes_only_turn():
    assert lane_links(star("N", "E", "S", "W", lanes=(2, 2)), "S") == {("-E", 0), ("-N", 0), ("-N", 1), ("-W", 1)}
    assert lane_links(star("N", "E", "S", "W", lanes=(3, 2)), "S") == {("-E", 0), ("-N", 0), ("-N", 1), ("-W", 2)}


def test_a_road_that_ends_at_a_t_turns_both_ways():
    assert lane_links(star("E", "S", "W", lanes=(2, 2)), "S") == {("-E", 0), ("-W", 1)}


def test_turns_that_forget_an_exit_still_reach_it():
    spec = star("N", "E", "S", "W", lanes=(2, 2), turns_forward=["through", "through"])
    assert {edge for edge, _ in lane_links(spec, "S")} == {"-E", "-N", "-W"}


def test_a_ramp_from_the_right_merges_into_the_right_lane():
    spec = NAMED["ramp"]
    goals = {link.to_lane for link in links(spec, roadways(spec)) if link.from_edge == "up"}
    assert goals == {0}


@pytest.mark.parametrize("seed", range(25))
def test_every_exit_can_be_reached_from_every_approach(seed):
    spec = random_spec(seed)
    found = Counter((link.from_edge, link.to_edge) for link in links(spec, roadways(spec)))
    lanes = {e: int(x.get("numLanes")) for e, x in edges(spec).items()}
    for link in links(spec, roadways(spec)):
        assert 0 <= link.from_lane < lanes[link.from_edge]
        assert 0 <= link.to_lane < lanes[link.to_edge]
    for name, edge in edges(spec).items():
        onward = [e for e, x in edges(spec).items() if x.get("from") == edge.get("to")]
        ways = [e for e in onward if e.strip("-") != name.strip("-")]
        assert not ways or any(found[name, way] for way in ways)


@pytest.mark.parametrize("name", NAMED)
def test_netconvert_keeps_all_connections(name):
    spec = NAMED[name]
    kept = {(c.from_edge, c.from_lane, c.to_edge, c.to_lane) for c in parse_net(compiled(name).net_xml).connections}
    assert kept == set(links(spec, roadways(spec)))


# ------------------------------------------------------------------ faults
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"roads": [road("r", "a", "x")]}, "no such node"),
        ({"roads": [road("r", "a", "a")]}, "ends where it begins"),
        ({"roads": [road("r", "a", "b", (0, 0))]}, "no lanes"),
        ({"roads": [road("r", "a", "b"), road("r", "b", "a")]}, "one id"),
        ({"nodes": [Node(id="a", x_m=0, y_m=0), Node(id="a", x_m=9, y_m=0), Node(id="b", x_m=90, y_m=0)]}, "one id"),
    ],
)
def test_a_spec_that_contradicts_itself_is_invalid_output(change, message):
    base = {"nodes": [Node(id="a", x_m=0, y_m=0), Node(id="b", x_m=90, y_m=0)], "roads": [road("r", "a", "b")]}
    with pytest.raises(InvalidOutput, match=message) as caught:
        plain_xml(RoadSpec(**(base | change)))
    assert all(f.remedy for f in caught.value.findings)


def test_turn_lists_of_another_length_are_found_and_passed_over():
    spec = star("N", "E", "S", lanes=(2, 2), turns_forward=["left"])
    assert len(turn_findings(spec)) == 3
    assert lane_links(spec, "S") == lane_links(star("N", "E", "S", lanes=(2, 2)), "S")


@given(any_spec)
@settings(max_examples=150, deadline=None)
def test_any_spec_becomes_valid_plain_xml_or_findings(spec):
    if spec_findings(spec):
        with pytest.raises(InvalidOutput, match="->"):
            plain_xml(spec)
    else:
        assert xsd_findings(plain_xml(spec)) == []


@pytest.mark.parametrize(
    ("nodes_xml", "edges_xml", "message"),
    [
        ('<nodes><node id="a" x="0" y="0" typ="z"/></nodes>', "<edges/>", "typ"),
        ("<nodes/>", '<edges><edge id="e" from="a" to="b" numLanes="-1"/></edges>', "numLanes"),
        ("<nodes/>", '<edges><edge id="e" from="a" to="b"/><edge id="e" from="b" to="a"/></edges>', "Duplicate key"),
        ("rubbish", "<edges/>", "well-formed"),
        ('<!DOCTYPE n [<!ENTITY x SYSTEM "file:///etc/passwd">]><nodes>&x;</nodes>', "<edges/>", "entities"),
    ],
)
def test_sumos_schema_finds_what_netconvert_lets_pass(nodes_xml, edges_xml, message):
    found = xsd_findings(PlainXml(nodes=nodes_xml, edges=edges_xml))
    assert found
    assert message in found[0].what


def test_compiled_networks_keep_sumos_schema():
    for name in NAMED:
        assert sumo_findings("net", compiled(name).net_xml) == []
