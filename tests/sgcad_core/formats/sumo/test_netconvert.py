"""The compiler as a process: whatever goes in, a result comes out."""

from __future__ import annotations

import stat
import subprocess

import pytest
from hypothesis import HealthCheck, given, settings

from sgcad_core import settings as paths
from sgcad_core.case.records import PlainXml
from sgcad_core.errors import InvalidOutput, SimulationFailed
from sgcad_core.formats.opendrive.checks.check_file import xodr_findings
from sgcad_core.formats.sumo import netconvert
from sgcad_core.formats.sumo.net_xml import parse_net, segments
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from tests.effort import many
from tests.sgcad_core.formats.road_samples import NAMED, any_spec, compiled, random_spec


@pytest.mark.parametrize("name", NAMED)
def test_named_specs_compile_with_the_lanes_they_state(name):
    network = compiled(name)
    assert network.returncode == 0
    assert "Error" not in network.log
    found = {s["id"]: (s["lanes_forward"], s["lanes_backward"]) for s in segments(parse_net(network.net_xml))}
    assert found == {r.id: (r.lanes_forward, r.lanes_backward) for r in NAMED[name].roads}


def test_the_frame_of_the_spec_is_that_of_the_network():
    nodes = parse_net(compiled("ramp").net_xml).nodes
    assert {n: (v.x_m, v.y_m) for n, v in nodes.items()} == {n.id: (n.x_m, n.y_m) for n in NAMED["ramp"].nodes}


def test_equal_specs_give_equal_files():
    plain = plain_xml(NAMED["stop"])
    one, two = compile_network(plain), compile_network(plain)
    assert one.net_xml == two.net_xml
    assert one.xodr == two.xodr
    assert "sgcad-net" not in one.net_xml + one.xodr


@pytest.mark.parametrize(
    "edges",
    [
        "",
        "<edges/>",
        "rubbish",
        '<edges><edge id="e" from="a" to="b" numLanes="-1"/></edges>',
        '<edges><edge id="e" from="a" to="x"/></edges>',
        '<edges><edge id="e" from="a" to="a"/></edges>',
    ],
)
def test_bad_plain_xml_leaves_no_network_and_says_why(edges):
    nodes = '<nodes><node id="a" x="0" y="0"/><node id="b" x="9" y="0"/></nodes>'
    network = compile_network(PlainXml(nodes=nodes, edges=edges))
    assert network.net_xml is None
    assert network.xodr is None
    assert network.returncode != 0
    assert network.log


@pytest.mark.parametrize(("script", "code"), [("kill -SEGV $$", -11), ("exit 3", 3), ("exit 0", 1), ("sleep 9", 124)])
def test_a_compiler_that_dies_or_hangs_is_a_result(script, code, tmp_path, monkeypatch):
    binary = tmp_path / "netconvert"
    binary.write_text(f"#!/bin/sh\n{script}\n")
    binary.chmod(binary.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(paths, "netconvert", lambda: binary)
    monkeypatch.setattr(netconvert, "TIMEOUT_S", 1.0)
    network = compile_network(plain_xml(NAMED["stop"]))
    assert network.returncode == code
    assert network.net_xml is None
    assert network.log


@given(any_spec)
@settings(max_examples=many(12, 40), deadline=None, suppress_health_check=list(HealthCheck))
def test_any_spec_compiles_to_valid_files_or_yields_findings(spec):
    try:
        plain = plain_xml(spec)
    except InvalidOutput:
        return
    network = compile_network(plain, spec)
    if network.xodr is None:
        assert network.log
        assert network.returncode != 0
    else:
        assert xodr_findings(network.xodr) == []
        assert parse_net(network.net_xml).edges


@pytest.mark.parametrize("seed", range(12))
def test_wild_networks_are_valid_opendrive(seed):
    spec = random_spec(1000 + seed)
    assert xodr_findings(compile_network(plain_xml(spec), spec).xodr) == []


@pytest.mark.parametrize(("code", "match"), [(-9, "ended by SIGKILL.*run again"), (-15, "ended by SIGTERM")])
def test_a_netconvert_that_others_ended_says_nothing_of_the_network(monkeypatch, code, match):
    monkeypatch.setattr(netconvert, "run_limited", lambda *_: subprocess.CompletedProcess([], code, b"", b""))
    with pytest.raises(SimulationFailed, match=match):
        compile_network(plain_xml(NAMED["stop"]))


def test_a_full_temporary_folder_says_nothing_of_the_network(monkeypatch):
    monkeypatch.setattr(netconvert, "run_limited", lambda *_: subprocess.CompletedProcess([], 1, b"", b""))
    monkeypatch.setattr(netconvert, "LEAST_FREE", 1 << 62)
    with pytest.raises(SimulationFailed, match="is full: make room and run again"):
        compile_network(plain_xml(NAMED["stop"]))
