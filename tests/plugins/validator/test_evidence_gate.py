"""The evidence gate: which groups it sums, when it refuses, what it passes over."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from plugins.validator.evidence_gate import EvidenceGate
from sgcad_core import config
from sgcad_core.case.records import CrashReport, Evidence, Generation, RoadNetwork, Scenario

ROAD = {
    "legs[]": 1.0, "legs[0].bearing": 0.2, "legs[0].lanes_in": 0.9, "legs[0].lanes_out": -0.5, "legs[0].median": -9.0
}  # fmt: skip
CRASH = {"actors[]": 2.0, "actors[0].maneuver": 1.0, "contacts[0].striker": 0.01, "contacts[1].striker": 9.0}


def evidence(grounding: dict[str, float] | None) -> Evidence:
    report = CrashReport(case="c", narrative="V1 struck V2.")
    generation = None if grounding is None else Generation(text="{}", grounding=grounding)
    return Evidence(report=report, generation=generation)


def test_a_group_below_its_threshold_is_refused_and_named() -> None:
    (finding,) = EvidenceGate().findings(RoadNetwork(), evidence(ROAD))
    assert (finding.severity, finding.value) == ("refuse", "lanes")
    assert "adds 0.40 nats, at least 0.5 are wanted" in finding.what


def test_only_the_first_contact_counts() -> None:
    (finding,) = EvidenceGate(at="scenario").findings(Scenario(actors=()), evidence(CRASH))
    assert finding.value == "first contact"
    assert EvidenceGate(at="scenario", first_contact=0.005).findings(Scenario(actors=()), evidence(CRASH)) == []


def test_the_weakest_group_comes_first() -> None:
    findings = EvidenceGate(road_layout=5.0, lanes=5.0).findings(RoadNetwork(), evidence(ROAD))
    assert [f.value for f in findings] == ["lanes", "road layout"]


def test_null_leaves_a_group_out() -> None:
    assert EvidenceGate(lanes=None).findings(RoadNetwork(), evidence(ROAD)) == []


@pytest.mark.parametrize("grounding", [None, {}, {"refuse": 3.0}, {"light": -1.0}])
def test_what_has_no_grounding_is_passed_over(grounding: dict[str, float] | None) -> None:
    for at in ("road", "scenario"):
        assert EvidenceGate(at=at).findings(RoadNetwork(), evidence(grounding)) == []


def test_the_gate_stands_in_the_stage_that_its_field_names() -> None:
    assert EvidenceGate(at="scenario").stage == "scenario"
    raw = config.yaml.safe_load("""
        report_reader: auto
        retriever: none
        road_writer: template
        scenario_writer: rules
        simulator: kinematic
        tracker: none
        validators: [{name: evidence_gate, at: road}, {name: evidence_gate, at: scenario, actors: 2}]
    """)
    built = config.build(raw, "x", "x.yaml")
    assert [v.stage for v in built.validators_of("scenario")] == ["scenario"]
    assert len(built.validators_of("road")) == 1


def test_without_a_stage_it_judges_each_by_the_groups_of_that_stage() -> None:
    raw = config.yaml.safe_load("""
        report_reader: auto
        retriever: none
        road_writer: template
        scenario_writer: rules
        simulator: kinematic
        tracker: none
        validators: [{name: evidence_gate, lanes: 0.45, actors: 4}]
    """)
    built = config.build(raw, "x", "x.yaml")
    (road,), (scenario,) = built.validators_of("road"), built.validators_of("scenario")
    assert [f.value for f in road.findings(RoadNetwork(), evidence({**ROAD, **CRASH}))] == ["lanes"]
    found = scenario.findings(Scenario(actors=()), evidence({**ROAD, **CRASH}))
    assert [f.value for f in found] == ["actors", "first contact"]


def test_an_unknown_stage_is_refused() -> None:
    with pytest.raises(ValidationError, match="'road', 'scenario' or 'both'"):
        EvidenceGate(at="simulator")
