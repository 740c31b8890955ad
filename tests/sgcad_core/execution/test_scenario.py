"""From a behavior to an executable scenario."""

from __future__ import annotations

import re

import numpy as np
import pytest

from sgcad_core.case.records import Hold, RoadNetwork
from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.contact import first_contact
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.records.specs import BehaviorSpec, Contact, Evasion, NearCrash
from tests.sgcad_core.formats.xosc_samples import CROSSING, crossroads


def test_a_scenario_carries_what_the_result_needs():
    scenario = compile_scenario(CROSSING, network := crossroads())
    assert [(a.id, a.type, a.length_m, a.width_m, a.maneuver) for a in scenario.actors] == [
        ("V1", "car", 4.7, 1.8, "turn_left"), ("V2", "truck", 9.0, 2.5, "straight"),
        ("P1", "pedestrian", 0.5, 0.6, "straight"),
    ]  # fmt: skip
    assert scenario.declared == CROSSING.contacts[0]
    assert scenario.behavior == CROSSING
    for played, planned in zip(play(scenario.xosc, network.xodr), scenario.planned, strict=True):
        assert played.actor == planned.actor
        away = np.hypot(played.x_m - planned.x_m, played.y_m - planned.y_m)
        assert away.max() < 0.06  # the file leaves out what players merge while somebody comes to rest


def test_parameters_slow_shift_and_smooth_the_crash_and_lanes_hold_the_starts():
    network = crossroads()
    text = compile_scenario(CROSSING.model_copy(update={"surface": "wet"}), network).xosc
    declared = dict(re.findall(r'<ParameterDeclaration name="(\w+)" parameterType="double" value="([^"]+)"', text))
    assert declared.keys() >= {"EndTime", "V1_TimeScale", "V1_TimeOffset", "V2_TimeScale", "P1_TimeOffset", "Friction"}
    assert 'frictionScaleFactor="$Friction"' in text
    assert text.count("<LanePosition") >= 2
    plain = {t.actor: t for t in play(text, network.xodr)}
    later = text.replace('name="V2_TimeOffset" parameterType="double" value="0"',
                         'name="V2_TimeOffset" parameterType="double" value="1"')  # fmt: skip
    shifted = {t.actor: t for t in play(later, network.xodr)}
    assert np.allclose(shifted["V1"].pose[:100], plain["V1"].pose[:100])
    assert np.allclose(shifted["V2"].points[40:100], plain["V2"].points[20:80], atol=1e-3)
    slower = text.replace('name="V2_TimeScale" parameterType="double" value="1"',
                          'name="V2_TimeScale" parameterType="double" value="2"')  # fmt: skip
    slow = {t.actor: t for t in play(slower, network.xodr)}
    assert np.allclose(slow["V2"].points[40:120:2], plain["V2"].points[20:60], atol=1e-3)


@pytest.mark.parametrize("after_s", [0.0, 1.0])
@pytest.mark.parametrize("version", ["1.0", "1.2"])
def test_a_parameter_ends_the_file_a_time_behind_the_declared_contact(after_s, version):
    network = crossroads()
    scenario = compile_scenario(CROSSING, network, version)
    whole = play(scenario.xosc, network.xodr)
    met = first_contact(whole, {actor.id: (actor.length_m, actor.width_m) for actor in scenario.actors})
    told = re.sub(r'("TimeAfterContact" parameterType="double" value=)"[^"]+"', rf'\1"{after_s:g}"', scenario.xosc)
    assert told != scenario.xosc
    assert play(told, network.xodr)[0].t_s[-1] == pytest.approx(met.t_s + after_s, abs=0.051)
    assert whole[0].t_s[-1] > met.t_s + 2.0


def test_a_file_without_a_contact_has_no_time_behind_it():
    alone = CROSSING.model_copy(update={"contacts": ()})
    assert "TimeAfterContact" not in compile_scenario(alone, crossroads()).xosc


def test_the_same_behavior_gives_the_same_file():
    assert compile_scenario(CROSSING, crossroads()).xosc == compile_scenario(CROSSING, crossroads()).xosc


def contact(striker, struck):
    return Contact(striker=striker, struck=struck, striker_area="front", struck_area="left")


def near(striker, struck, *evading):
    evasions = tuple(Evasion(actor=name, maneuver="braking") for name in evading)
    return {"contacts": (), "near_crash": NearCrash(conflict=contact(striker, struck), evasions=evasions)}


@pytest.mark.parametrize(("change", "where", "value"), [
    (near("V1", "V3"), "near_crash.conflict.struck", "V3"),
    (near("V1", "V2", "V1", "V7"), "near_crash.evasions[1].actor", "V7"),
    (near("V1", "V1"), "near_crash.conflict", "V1"),
    (near("V1", "V2") | {"contacts": CROSSING.contacts[:1]}, "near_crash", "1"),
    ({"contacts": (contact("V1", "V3"),)}, "contacts[0].struck", "V3"),
    ({"contacts": (*CROSSING.contacts, contact("O1", "V1"))}, "contacts[1].striker", "O1"),
    ({"contacts": (contact("V1", "V1"),)}, "contacts[0]", "V1"),
    ({"actors": (*CROSSING.actors, CROSSING.actors[0])}, "actors[3].id", "V1"),
])  # fmt: skip
def test_ids_must_be_unique_and_known(change, where, value):
    with pytest.raises(InvalidOutput, match=value) as caught:
        compile_scenario(CROSSING.model_copy(update=change), crossroads())
    (finding,) = caught.value.findings
    assert (finding.where, finding.value) == (where, value)
    assert finding.remedy


def test_a_network_that_does_not_compile_carries_no_scenario():
    with pytest.raises(InvalidOutput, match=r"has no net\.xml"):
        compile_scenario(CROSSING, RoadNetwork(returncode=1))


def test_an_unknown_road_is_said():
    lost = CROSSING.actors[0].model_copy(update={"road": "Z"})
    with pytest.raises(InvalidOutput, match="Z"):
        compile_scenario(BehaviorSpec(actors=(lost,)), crossroads())


@pytest.mark.parametrize(
    ("struck", "held"),
    [
        ("V4", "actors[3]: id V4"),
        ("V3", "actors[2]: id V3"),
        ("O1", "actors[2]: id O1"),
    ],
)
def test_whom_a_contact_names_belongs_among_the_actors(struck, held):
    contact = CROSSING.contacts[0].model_copy(update={"striker": "V1", "struck": struck})
    with pytest.raises(InvalidOutput) as fault:
        compile_scenario(CROSSING.model_copy(update={"contacts": (contact,)}), crossroads())
    (finding,) = fault.value.findings
    assert [hold.line() for hold in finding.holds] == [held]


def test_a_number_that_is_taken_gives_way_to_the_next():
    actors = (CROSSING.actors[0], CROSSING.actors[1].model_copy(update={"id": "V1"}))
    contact = CROSSING.contacts[0].model_copy(update={"striker": "V1", "struck": "V1"})
    with pytest.raises(InvalidOutput) as fault:
        compile_scenario(CROSSING.model_copy(update={"actors": actors, "contacts": (contact,)}), crossroads())
    assert fault.value.findings[0].holds[0].line() == "actors[1]: id V2"


def test_who_strikes_itself_strikes_another_in_the_next_answer():
    contact = CROSSING.contacts[0].model_copy(update={"striker": "V2", "struck": "V2"})
    behavior = CROSSING.model_copy(update={"contacts": (CROSSING.contacts[0], contact)})
    with pytest.raises(InvalidOutput, match="cannot strike itself") as fault:
        compile_scenario(behavior, crossroads())
    (finding,) = fault.value.findings
    names = {name: tuple(a.id for a in behavior.actors if a.id != name) for name in (a.id for a in behavior.actors)}
    assert finding.holds == (
        Hold(items="contacts", at=1, either=tuple({"striker": (k,), "struck": v} for k, v in names.items())),
    )
