"""Layers of findings and the figures of a batch."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.case.records import Finding
from sgcad_core.metrics.generation import LAYERS, AttemptRecord, CaseRecord, layer_of, quality


def finding(source, where="", severity="repair"):
    return Finding(source=source, what="wrong", where=where, severity=severity)


def road(*sources):
    return AttemptRecord("road", tuple(finding(s, "here") for s in sources))


def scenario(*sources):
    return AttemptRecord("scenario", tuple(finding(s, "here") for s in sources))


REFUSED = AttemptRecord("road", (finding("road", severity="refuse"),))


@pytest.mark.parametrize(("source", "where", "layer"), [
    ("answer", "$", "parse"),
    ("scenario", "", "parse"),
    ("scenario", "actors[0].id", "references"),
    ("sumo_xsd nodes", "line 3, column 1", "parse"),
    ("sumo_xsd", "nodes, line 3", "schema"),
    ("openscenario", "line 7", "schema"),
    ("openscenario", "<Event> in line 7", "references"),
    ("agreement", "contacts[0]", "content"),
    ("agreement", "Entities", "references"),
    ("netconvert", "", "netconvert"),
    ("python", "line 2", "execution"),
    ("a_strangers_validator", "", "content"),
])  # fmt: skip
def test_a_finding_belongs_to_the_layer_of_its_source(source, where, layer):
    assert layer_of(finding(source, where)) == layer


def test_an_attempt_fails_in_the_first_layer_that_finds_fault():
    assert road("topology", "netconvert", "sumo_xsd").layer == "schema"
    assert AttemptRecord("road", (finding("netconvert", severity="note"),)).layer is None
    assert REFUSED.refused


def test_the_first_attempt_and_the_last_are_counted_apart():
    found = quality([
        CaseRecord("generated", (road(), scenario())),
        CaseRecord("generated", (road("netconvert"), road(), scenario("python"), scenario())),
        CaseRecord("exhausted", (road("sumo_xsd"), road("netconvert"))),
        CaseRecord("refused", (REFUSED,)),
    ])  # fmt: skip
    assert (found.cases, found.refused, found.attempts) == (4, 1, 2.25)
    assert (found.first_success, found.success) == (0.25, 0.5)
    assert (found.first_file_errors, found.file_errors) == (5 / 8, 2 / 8)
    assert (found.first_scenario_errors, found.scenario_errors) == (0.5, 0.25)
    assert found.first_layers == {"schema": 2, "netconvert": 2, "execution": 1}
    assert found.layers == {"netconvert": 2}


def test_a_doubted_attempt_may_be_the_one_that_stands():
    doubted = AttemptRecord("scenario", (finding("meeting", "contacts[0]", severity="doubt"),))
    case = CaseRecord("generated", (road(), doubted, scenario("openscenario"), scenario("openscenario")))
    assert case.standing("scenario") is doubted
    found = quality([case, CaseRecord("generated", (road(), doubted))])
    assert (found.first_success, found.success, found.file_errors) == (1.0, 1.0, 0.0)
    assert not found.layers
    assert CaseRecord("exhausted", (road("netconvert"), road("topology"))).standing("road") == road("topology")
    assert case.standing("road") == road()


def test_opendrive_alone_at_fault_is_one_file_and_content_is_none():
    found = quality([CaseRecord("exhausted", (road("opendrive"),)), CaseRecord("exhausted", (road("road_narrative"),))])
    assert found.layers == {"references": 1}
    assert found.file_errors == 1 / 4


def test_a_scenario_that_dies_in_the_simulator_fails_in_execution():
    found = quality([CaseRecord("failed", (road(), scenario()))])
    assert found.layers == {"execution": 1}
    assert found.first_layers == {}


def test_an_empty_batch_has_figures():
    assert quality([]).success == 0.0


SOURCES = st.sampled_from(["answer", "sumo_xsd", "netconvert", "opendrive", "python", "topology", "x"])
ATTEMPT = st.builds(lambda s, f: AttemptRecord(s, tuple(finding(x, "w") for x in f)),
                    st.sampled_from(["road", "scenario"]), st.lists(SOURCES, max_size=3))  # fmt: skip
CASE = st.builds(
    CaseRecord,
    st.sampled_from(["generated", "refused", "exhausted", "failed"]),
    st.lists(ATTEMPT, max_size=5).map(tuple),
)


@settings(deadline=None, max_examples=60)
@given(st.lists(CASE, max_size=6))
def test_shares_are_shares_and_layers_sum_to_faulty_files(cases):
    found = quality(cases)
    for share in (found.first_success, found.success, found.first_file_errors, found.file_errors,
                  found.first_scenario_errors, found.scenario_errors):  # fmt: skip
        assert 0.0 <= share <= 1.0
    assert found.first_success <= found.success
    assert set(found.layers) <= set(LAYERS) - {"content"}
    assert (found.file_errors == 0) == (not found.layers)
