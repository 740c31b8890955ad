"""Route files are judged before SUMO runs them for good: schema, references, then a trial."""

from __future__ import annotations

import pytest

from plugins.validator.routes import Routes
from sgcad_core.case.records import ActorInfo, CrashReport, Evidence, Finding, PlainXml, RoadNetwork, Scenario
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.records.specs import Contact
from tests.transcripts import EDGES, NODES
from tests.transcripts_rivals import ROUTES

DECLARED = Contact(striker="V2", struck="V1", striker_area="front", struck_area="back")


@pytest.fixture(scope="module")
def network() -> RoadNetwork:
    return compile_network(PlainXml(nodes=NODES, edges=EDGES))


def found(network: RoadNetwork, routes: str, **fields: object) -> list[Finding]:
    actors = tuple(ActorInfo(id=n, type="car", length_m=4.7, width_m=1.8, maneuver="straight") for n in ("V1", "V2"))
    scenario = Scenario(routes_xml=routes, actors=actors, declared=DECLARED)
    evidence = Evidence(report=CrashReport(case="c", narrative="V1."), network=network)
    return Routes.model_validate(fields).findings(scenario, evidence)


def test_routes_whose_drivers_crash_as_declared_pass(network: RoadNetwork) -> None:
    assert found(network, ROUTES) == []


@pytest.mark.parametrize(("old", "new", "says"), [
    ("</routes>", "", "no well-formed XML"),
    ('tau="0.05"', 'taw="0.05"', "taw"),
    ('edges="S -N"', 'edges="S nowhere"', "edges that are not there"),
    ('edges="S -N"', 'edges="S E"', "no way leads from edge to edge"),
    ('depart="0"', 'depart="5"', "an actor departs late"),
    ('id="V1"', 'id="V9"', "declared actors are not in the file"),
    ('id="V1"', 'id="V2"', "two vehicles have one id"),
    (' length="4.7"', "", "the actor's size is not told"),
    ("</routes>", '<trip id="x" depart="0" from="S" to="-N"/></routes>', "<trip> is not read"),
    (' insertionChecks="none"', "", "actors that never drive"),
])  # fmt: skip
def test_a_fault_is_named(network: RoadNetwork, old: str, new: str, says: str) -> None:
    findings = found(network, ROUTES.replace(old, new, 1))
    assert says in " ".join(f.what for f in findings)
    assert {f.severity for f in findings} == {"repair"}


@pytest.mark.parametrize("severity", ["note", "repair"])
def test_drivers_who_avoid_the_crash_are_told_of_as_the_field_says(network: RoadNetwork, severity: str) -> None:
    careful = ROUTES.replace('decel="0.5" emergencyDecel="0.5"', 'decel="8" emergencyDecel="9"')
    (finding,) = found(network, careful.replace('departSpeed="13"', 'departSpeed="5"'), no_collision=severity)
    assert (finding.severity, finding.value) == (severity, "no collision")
    assert "do not bring V2 into V1" in finding.what


def test_an_openscenario_file_is_passed_over(network: RoadNetwork) -> None:
    scenario = Scenario(xosc="<OpenSCENARIO/>", actors=())
    assert Routes().findings(scenario, Evidence(report=CrashReport(case="c", narrative=""), network=network)) == []
