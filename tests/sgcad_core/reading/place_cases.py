"""What tests of places share: a text as its road and scenario, and the checks that every road passes."""

from __future__ import annotations

from plugins.road_writer.template import Template
from plugins.scenario_writer.rules import Rules
from plugins.validator.sumo_load import SumoLoad
from plugins.validator.topology import Topology
from research.benchmarks.scenes.reimport import differences
from sgcad_core.case.records import Context, CrashReport, Evidence, RoadNetwork, Scenario
from sgcad_core.formats.agreement import network_disagreements
from sgcad_core.formats.opendrive.checks.check_file import xodr_findings
from sgcad_core.formats.sumo.net_xml import parse_net


def written(text: str) -> tuple[RoadNetwork, Scenario]:
    """By the rules."""
    context = Context(narrative=text)
    net = Template().write(context, (), (), None, 1)  # type: ignore[arg-type]
    return net, Rules().write(context, (), (), None, 1, net)  # type: ignore[arg-type]


def assert_passes_what_roads_pass(net: RoadNetwork) -> None:
    """SUMO loads it, nothing lies in anything, the .xodr is valid and tells the same as the .net.xml."""
    assert net.net_xml
    assert net.xodr
    evidence = Evidence(report=CrashReport(case="c", narrative=""))
    assert not [f.line() for v in (SumoLoad(), Topology()) for f in v.findings(net, evidence)]
    assert xodr_findings(net.xodr) == []
    assert network_disagreements(parse_net(net.net_xml), net.xodr) == []
    assert differences(net.net_xml, net.xodr, "sgcad") == []
