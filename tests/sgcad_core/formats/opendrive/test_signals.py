"""Signs, signal heads, controllers and stop lines of a written map."""

from __future__ import annotations

import pytest
from lxml import etree

from sgcad_core.formats.opendrive.signals import control_of
from sgcad_core.formats.opendrive.streets import streets
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from tests.sgcad_core.formats.road_samples import compiled, star


def signal_controllers(net_xml):
    graph = parse_net(net_xml)
    return control_of(graph, streets(graph)).controllers


def root_of(network):
    return etree.fromstring(network.xodr.encode())


def minor(control):
    spec = star("N", "E", "S", "W", control=control)
    roads = tuple(r.model_copy(update={"minor": r.id in "NS"}) for r in spec.roads)
    spec = spec.model_copy(update={"roads": roads})
    return root_of(compile_network(plain_xml(spec), spec))


def signed(root, kind):
    return {s.getparent().getparent().get("name") for s in root.iterfind(f".//signal[@type='{kind}']")}


@pytest.mark.parametrize(("control", "kind"), [("stop", "R1-1"), ("yield", "R1-2")])
def test_minor_roads_have_the_sign_and_major_roads_none(control, kind):
    root = minor(control)
    assert signed(root, kind) == {"N", "S"}
    assert {s.get("type") for s in root.iterfind(".//signal")} == {kind}
    assert len(root.findall(".//object[@subtype='stopLine']")) == (2 if control == "stop" else 0)


def test_an_all_way_stop_has_a_plaque_under_every_sign():
    root = root_of(compiled("all_way_stop"))
    assert signed(root, "R1-1") == signed(root, "R1-3P") == {"N", "E", "S", "W"}


def test_a_sign_stands_right_of_the_lanes_that_it_stops():
    sign = root_of(compiled("all_way_stop")).find(".//signal[@type='R1-1']")
    street = sign.getparent().getparent()
    assert (sign.get("orientation"), float(sign.get("s"))) == ("+", pytest.approx(float(street.get("length"))))
    assert float(sign.get("t")) == pytest.approx(-3.6 - 1.0)
    assert (sign.find("validity").get("fromLane"), sign.find("validity").get("toLane")) == ("-1", "-1")


def test_controllers_show_what_the_net_shows_under_the_ids_of_the_map():
    network = compiled("signal")
    root, found = root_of(network), signal_controllers(network.net_xml)
    told = {c.get("id"): tuple(x.get("signalId") for x in c) for c in root.iterfind("controller")}
    assert {c.id: c.signals for c in found} == told
    assert {s.get("id") for s in root.iterfind(".//signal[@dynamic='yes']")} == {i for c in found for i in c.signals}
    phases = etree.fromstring(network.net_xml.encode()).findall("tlLogic/phase")
    for controller in found:
        assert [p.duration_s for p in controller.phases] == [float(p.get("duration")) for p in phases]
        assert {"green", "yellow", "red"} <= {v for p in controller.phases for v in p.states.values()}


def test_a_map_without_signals_has_no_controllers():
    assert signal_controllers(compiled("stop").net_xml) == ()
