"""The validators of the road stage on real networks and on broken ones."""

from __future__ import annotations

import re

import pytest

from plugins.validator.netconvert import Netconvert
from plugins.validator.opendrive import OpenDrive
from plugins.validator.sumo_load import _WORKER, SumoLoad
from plugins.validator.sumo_xsd import SumoXsd
from plugins.validator.topology import Topology
from sgcad_core.case.records import CrashReport, Evidence, PlainXml, RoadNetwork, Scenario
from sgcad_core.errors import ProcessDied
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Leg, Node, RoadLayout, RoadSpec
from sgcad_core.roads.layout import road_spec
from tests.sgcad_core.formats.road_samples import NAMED, compiled, road, star

EVIDENCE = Evidence(report=CrashReport(case="c", narrative="n"))
ALL = (SumoXsd(), Netconvert(), Topology(), SumoLoad(), OpenDrive())
EMPTY_NET = (
    '<net version="1.20"><location netOffset="0.00,0.00" convBoundary="0,0,0,0" origBoundary="0,0,0,0" '
    'projParameter="!"/></net>'
)


def network(nodes, *roads):
    spec = RoadSpec(nodes=[Node(id=n, x_m=x, y_m=y) for n, x, y in nodes], roads=roads)
    return compile_network(plain_xml(spec), spec)


def whats(validator, artifact):
    return [f.what for f in validator.findings(artifact, EVIDENCE) if f.severity == "repair"]


@pytest.mark.parametrize("name", NAMED)
@pytest.mark.parametrize("validator", ALL, ids=lambda v: type(v).__name__)
def test_good_networks_pass(validator, name):
    assert whats(validator, compiled(name)) == []


@pytest.mark.parametrize("validator", ALL, ids=lambda v: type(v).__name__)
@pytest.mark.parametrize("artifact", [RoadNetwork(net_xml=None), Scenario(actors=())], ids=["nothing", "scenario"])
def test_what_cannot_be_judged_is_passed_over(validator, artifact):
    if not (isinstance(validator, Netconvert) and isinstance(artifact, RoadNetwork)):
        assert validator.findings(artifact, EVIDENCE) == []


# ------------------------------------------------------------------ schema and compiler
def test_schema_faults_of_plain_xml_are_findings():
    bad = PlainXml(nodes="<nodes/>", edges='<edges><edge id="e" from="a" to="b" numLanes="-1"/></edges>')
    assert "numLanes" in whats(SumoXsd(), RoadNetwork(plain=bad))[0]


def test_a_network_that_did_not_compile_is_a_finding_with_netconverts_words():
    nodes = '<nodes><node id="a" x="0" y="0"/></nodes>'
    failed = compile_network(PlainXml(nodes=nodes, edges='<edges><edge id="e" from="a" to="x"/></edges>'))
    found = Netconvert().findings(failed, EVIDENCE)
    assert found[0].severity == "repair"
    assert "'x' is not known" in found[0].what


def test_a_compiler_that_died_is_a_finding():
    found = Netconvert().findings(RoadNetwork(returncode=-11), EVIDENCE)
    assert "SIGSEGV" in found[0].value


def test_warnings_are_notes_unless_wanted_otherwise():
    warned = RoadNetwork(net_xml="x", xodr="x", log="Warning: Edge 'a' is steep.\nSuccess.")
    assert [f.severity for f in Netconvert().findings(warned, EVIDENCE)] == ["note"]
    assert [f.severity for f in Netconvert(warnings="repair").findings(warned, EVIDENCE)] == ["repair"]
    assert Netconvert(warnings="off").findings(warned, EVIDENCE) == []


# ------------------------------------------------------------------ topology
def test_roads_that_cross_need_a_node():
    nodes = [("a", -100, 0), ("b", 100, 0), ("c", 0, -100), ("d", 0, 100)]
    found = Topology().findings(network(nodes, road("r", "a", "b"), road("q", "c", "d")), EVIDENCE)
    crossing = next(f for f in found if "cross" in f.what)
    assert "roads q and r" in crossing.where
    assert "(0, 0)" in crossing.value


def test_parts_that_are_not_joined_are_named():
    nodes = [("a", -100, 0), ("b", 100, 0), ("c", -100, 90), ("d", 100, 90)]
    found = Topology().findings(network(nodes, road("r", "a", "b"), road("q", "c", "d")), EVIDENCE)
    assert "2 parts" in found[0].what
    assert found[0].value == "q; r"


def test_junctions_three_meters_apart_are_one():
    nodes = [("a", -100, 0), ("m", 0, 0), ("n", 3, 0), ("b", 100, 0), ("c", 0, 80), ("d", 3, -80)]
    roads = [road("r", "a", "m"), road("x", "m", "n"), road("s", "n", "b"), road("u", "m", "c"), road("v", "n", "d")]
    found = whats(Topology(), network(nodes, *roads))
    assert "two nodes are in one place" in found
    assert any("less than 5 m" in what for what in found)


def test_roads_on_top_of_each_other_are_found():
    nodes = [("a", -100, 0), ("m", 0, 0), ("b", 100, 2), ("c", 100, -2)]
    found = whats(Topology(), network(nodes, road("r", "a", "m"), road("s", "m", "b"), road("t", "m", "c")))
    assert "two roads lie on each other" in found


def test_a_divided_road_of_two_one_way_roads_is_no_overlap():
    nodes = [("a", -100, 0), ("b", 100, 0)]
    assert whats(Topology(), network(nodes, road("r", "a", "b", (2, 0)), road("q", "b", "a", (2, 0)))) == []


def test_one_way_roads_that_run_against_each_other_lead_nowhere():
    nodes = [("a", -100, 0), ("m", 0, 0), ("b", 100, 0)]
    found = whats(Topology(), network(nodes, road("r", "a", "m", (1, 0)), road("s", "m", "b", (0, 1))))
    assert sorted(found) == ["the backward direction leads nowhere", "the forward direction leads nowhere"]


def test_faults_of_the_spec_are_told_with_their_path():
    spec = star("N", "E", "S", lanes=(2, 1), turns_forward=["left"])
    spec = RoadSpec(nodes=[*spec.nodes, Node(id="lost", x_m=500, y_m=0)], roads=spec.roads)
    found = Topology().findings(compile_network(plain_xml(spec), spec), EVIDENCE)
    assert {f.where for f in found} == {f"roads[{i}].turns_forward" for i in range(3)} | {"nodes[4]"}


def test_limits_are_fields():
    assert any("less than 200 m" in what for what in whats(Topology(min_edge_m=200), compiled("stop")))


# ------------------------------------------------------------------ loading
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: EMPTY_NET, "no roads"),
        (lambda t: "rubbish", "well-formed"),
        (lambda t: t.replace('length="', 'length="-'), "no finite number|length|minExclusive"),
        (lambda t: t.replace("<connection", "<konnektion"), "konnektion"),
        (lambda t: t.replace('type="priority_stop"', 'type="mystery"'), "mystery"),
    ],
)
def test_a_network_that_sumo_does_not_take_is_a_finding(change, message):
    found = SumoLoad().findings(RoadNetwork(net_xml=change(compiled("stop").net_xml)), EVIDENCE)
    assert found
    assert re.search(message, " ".join(f.what for f in found))


def test_a_worker_that_dies_is_a_finding_and_the_next_network_loads():
    assert whats(SumoLoad(), compiled("stop")) == []
    slow = SumoLoad(timeout_s=0)
    assert "SUMO died of the network" in whats(slow, compiled("stop"))[0]
    assert whats(SumoLoad(), compiled("stop")) == []
    _WORKER.close()


@pytest.mark.parametrize("times", [1, 2])
def test_a_worker_killed_from_outside_says_nothing_of_the_network(monkeypatch, times):
    calls = []

    def killed(*_args, **_more):
        calls.append(1)
        if len(calls) <= times:
            raise ProcessDied("start: the worker process died of SIGKILL", from_outside=True)
        return ""

    monkeypatch.setattr(_WORKER, "call", killed)
    if times == 1:
        assert whats(SumoLoad(), compiled("stop")) == []
    else:  # the case fails, and is tried on the next run
        with pytest.raises(ProcessDied, match="SIGKILL"):
            SumoLoad().findings(compiled("stop"), EVIDENCE)
    assert len(calls) == 2


def test_a_worker_that_crashes_by_itself_is_a_finding_at_once(monkeypatch):
    def crashed(*_args, **_more):
        raise ProcessDied("start: the worker process died of SIGSEGV")

    monkeypatch.setattr(_WORKER, "call", crashed)
    assert "SIGSEGV" in whats(SumoLoad(), compiled("stop"))[0]


# ------------------------------------------------------------------ OpenDRIVE
def test_a_broken_xodr_is_a_finding_and_their_number_is_limited():
    bad = compiled("signal").xodr.replace("<width ", "<breadth ")
    assert len(OpenDrive(most=3).findings(RoadNetwork(xodr=bad), EVIDENCE)) == 3


def layout_of(legs):
    spec = road_spec(RoadLayout(legs=[Leg.model_validate(leg) for leg in legs]))
    return compile_network(plain_xml(spec), spec)


def test_a_ramp_that_nobody_can_use_is_held_the_other_way_round():
    through = [{"bearing": "E", "lanes_in": 0, "lanes_out": 2}, {"bearing": "W", "lanes_in": 2, "lanes_out": 0}]
    ramp = {"bearing": "SW", "kind": "ramp"}
    (finding,) = Topology().findings(layout_of([*through, {**ramp, "lanes_in": 0, "lanes_out": 1}]), EVIDENCE)
    assert "road SW " in finding.where
    (hold,) = finding.holds
    assert (hold.items, hold.key, hold.values) == ("legs", "bearing", ("SW",))
    (choice,) = hold.either
    turned = {name: values[0] for name, values in choice.items()}
    assert turned == {"lanes_in": 1, "lanes_out": 0}
    assert Topology().findings(layout_of([*through, {**ramp, **turned}]), EVIDENCE) == []


def test_what_stands_in_no_layout_is_found_and_not_held():
    nodes = (("a", -200, 0), ("b", 0, 0), ("c", 200, 0))
    made = network(nodes, road("west", "a", "b", (1, 0)), road("east", "c", "b", (1, 0)))
    found = [f for f in Topology().findings(made, EVIDENCE) if "leads nowhere" in f.what]
    assert found
    assert not any(f.holds for f in found)
