"""Scenario validators: what passes, what is found, what is left to others."""

from __future__ import annotations

import pytest

from plugins.validator.agreement import Agreement
from plugins.validator.openscenario import OpenScenario
from sgcad_core.case.records import CrashReport, Evidence, RoadNetwork, Scenario
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.formats.xml import parse_xml, to_text
from sgcad_core.records.specs import Contact, Evasion, NearCrash
from tests.sgcad_core.formats.xosc_samples import CROSSING, bent_road, crossroads

REPORT = CrashReport(case="a", narrative="")
EVIDENCE = Evidence(report=REPORT, network=crossroads())
VALIDATORS = [OpenScenario(), Agreement()]


@pytest.fixture(scope="module")
def scenario():
    return compile_scenario(CROSSING, crossroads())


def lines(scenario, evidence=EVIDENCE, validator=None):
    return [f.line() for f in (validator or Agreement()).findings(scenario, evidence)]


def on(network):
    return EVIDENCE.model_copy(update={"network": network})


@pytest.mark.parametrize("validator", VALIDATORS, ids=lambda v: type(v).__name__)
def test_a_compiled_scenario_passes(validator, scenario):
    assert validator.findings(scenario, EVIDENCE) == []
    unplanned = scenario.model_copy(update={"planned": ()})
    assert validator.findings(unplanned, EVIDENCE) == []


@pytest.mark.parametrize("validator", VALIDATORS, ids=lambda v: type(v).__name__)
def test_what_it_cannot_judge_it_passes_over(validator, scenario):
    assert validator.stage == "scenario"
    assert validator.findings(crossroads(), EVIDENCE) == []
    assert validator.findings(Scenario(routes_xml="<routes/>", actors=()), EVIDENCE) == []
    assert validator.findings(scenario, Evidence(report=REPORT)) == []


def test_schema_faults_are_openscenarios_to_find(scenario):
    broken = scenario.model_copy(update={"xosc": scenario.xosc.replace("<Storyboard>", "<Storyboard><Extra/>")})
    assert "follow the OpenSCENARIO schema" in lines(broken, validator=OpenScenario())[0]
    rubbish = scenario.model_copy(update={"xosc": "<a"})
    assert lines(rubbish) == []
    assert "no well-formed XML" in lines(rubbish, validator=OpenScenario())[0]


def test_actors_and_entities_must_be_the_same(scenario):
    assert "other entities than the scenario" in lines(scenario.model_copy(update={"actors": scenario.actors[:2]}))[0]
    wide = scenario.actors[0].model_copy(update={"width_m": 2.2})
    found = lines(scenario.model_copy(update={"actors": (wide, *scenario.actors[1:])}))
    assert found == [
        "[agreement] the box of V1 is not its size at ScenarioObject 'V1' (found (4.7, 1.8) m) -> make it (4.7, 2.2) m"
    ]


def test_a_contact_needs_its_actors(scenario):
    ghost = Contact(striker="V9", struck="V1", striker_area="front", struck_area="left")
    assert "names no actor at contacts (found V9)" in lines(scenario.model_copy(update={"declared": ghost}))[0]
    behavior = CROSSING.model_copy(update={"contacts": (*CROSSING.contacts, ghost)})
    assert "found V9" in lines(scenario.model_copy(update={"behavior": behavior}))[0]


@pytest.mark.parametrize("severity", ["repair", "note"])
def test_another_first_contact_is_named_with_the_severity_chosen(scenario, severity):
    other = Contact(striker="V1", struck="V2", striker_area="front", struck_area="left")
    declared = scenario.model_copy(update={"declared": other})
    (finding,) = Agreement(unrealised=severity).findings(declared, EVIDENCE)
    assert finding.severity == severity
    assert "not the declared one (V1 front into V2 left)" in finding.what
    assert finding.value.startswith("V1 right and V2 front at ")


def test_a_contact_nobody_declared_is_noted(scenario):
    (finding,) = Agreement().findings(scenario.model_copy(update={"declared": None}), EVIDENCE)
    assert finding.severity == "note"
    assert "not declared" in finding.what


def test_no_contact_at_all_is_said(scenario):
    apart = tuple(t.model_copy(update={"x_m": t.x_m + 300 * i}) for i, t in enumerate(scenario.planned))
    found = lines(scenario.model_copy(update={"planned": apart}))
    assert any("found nothing touches" in line for line in found)


def test_who_drives_starts_in_a_lane_but_walkers_and_the_parked_need_not(scenario):
    moved = tuple(t.model_copy(update={"x_m": t.x_m + 40, "y_m": t.y_m + 60}) for t in scenario.planned)
    off = scenario.model_copy(update={"planned": moved})
    starts = [line for line in lines(off) if "does not start in a lane" in line]
    assert [line.split()[1] for line in starts] == ["V1", "V2"]
    actors = tuple(a.model_copy(update={"maneuver": "parked"}) for a in scenario.actors)
    assert not [line for line in lines(off.model_copy(update={"actors": actors})) if "start in a lane" in line]


def test_the_two_road_files_must_describe_the_same_roads(scenario):
    root = parse_xml(crossroads().xodr, "xodr")
    for geometry in root.iter("geometry"):
        geometry.set("y", str(float(geometry.get("y")) + 9))
    moved = crossroads().model_copy(update={"xodr": to_text(root)})
    assert any("edge 'S' lies elsewhere in the .xodr" in line for line in lines(scenario, on(moved)))
    renamed = crossroads().xodr.replace('value="-N_', 'value="-X_')
    found = lines(scenario, on(crossroads().model_copy(update={"xodr": renamed})))
    assert "edges without road in the .xodr at road network (found -N)" in found[0]
    assert "roads without edge in the net.xml at road network (found -X)" in found[1]
    mixed = RoadNetwork(net_xml=crossroads().net_xml, xodr=bent_road().xodr)
    assert any("edges without road" in line for line in lines(scenario, on(mixed)))


def test_lanes_must_be_as_many(scenario):
    network = crossroads()
    root = parse_xml(network.xodr, "xodr")
    (lane,) = root.xpath("road/lanes/laneSection/right/lane[userData/@value='N_0']")
    lane.getparent().remove(lane)
    found = lines(scenario, on(network.model_copy(update={"xodr": to_text(root)})))
    assert any("lanes of edge 'N' are not in the .xodr" in line and "N_0" in line for line in found)


def test_a_scenario_file_that_says_otherwise_than_the_plan_is_judged_by_its_boxes(scenario):
    small = [a.model_copy(update={"length_m": 1.0}) for a in scenario.actors]
    other = scenario.model_copy(update={"xosc": write_xosc(small, scenario.planned, None)})
    assert len(lines(other)) == 3


@pytest.fixture(scope="module")
def near_crash():
    conflict = CROSSING.contacts[0]
    near = NearCrash(conflict=conflict, evasions=(Evasion(actor=conflict.striker, maneuver="braking"),))
    return compile_scenario(CROSSING.model_copy(update={"contacts": (), "near_crash": near}), crossroads())


def test_a_near_crash_passes_where_nobody_touches_and_the_pair_comes_as_near_as_declared(near_crash):
    assert near_crash.declared is None
    assert [line for line in lines(near_crash) if "near_crash" in line] == []


def test_a_near_crash_that_ends_in_a_contact_or_keeps_too_far_apart_is_asked_again(near_crash, scenario):
    far = near_crash.near_crash.model_copy(update={"clearance_m": 3.0})
    (said,) = lines(near_crash.model_copy(update={"near_crash": far}))
    assert "the closest approach is not the declared 3 m (within 0.05 m) at near_crash.clearance_m" in said
    hit = scenario.model_copy(update={"declared": None, "near_crash": near_crash.near_crash})
    assert any("a near crash ends in a contact" in line for line in lines(hit))


def test_a_near_crash_needs_its_actors(near_crash):
    ghost = Contact(striker="V9", struck="V1", striker_area="front", struck_area="left")
    near = near_crash.near_crash.model_copy(update={"conflict": ghost})
    assert "found V9" in lines(near_crash.model_copy(update={"near_crash": near}))[0]
