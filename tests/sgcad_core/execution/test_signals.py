"""Signals show at the crash what the report tells, in the phases of the map's own program, in every version."""

from __future__ import annotations

import functools

import pytest

from sgcad_core.case.records import RoadNetwork
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.execution.signals import SHOWN_S, TURNED_S, signal_times
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.signal_phases import SignalPlan
from sgcad_core.formats.openscenario.reading.elements import read_root
from sgcad_core.formats.openscenario.writing.writer import origin_motion
from sgcad_core.formats.xml import parse_xml
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from tests.sgcad_core.formats.road_samples import NAMED, compiled
from tests.sgcad_core.formats.xosc_samples import crossroads

CRASH = BehaviorSpec(
    actors=(
        Actor(id="V1", kind="car", road="S", direction="forward", maneuver="straight", speed_mph=30),
        Actor(id="V2", kind="car", road="W", direction="forward", maneuver="straight", speed_mph=30),
    ),
    contacts=(Contact(striker="V1", struck="V2", striker_area="front", struck_area="right"),),
)


@functools.cache
def planned():
    scenario = compile_scenario(CRASH, compiled("signal"))
    motions = [origin_motion(a, t) for a, t in zip(scenario.actors, scenario.planned, strict=True)]
    return scenario, motions


def shown(controllers, at_s):
    """What all heads show at a time, as a file's controllers repeat their phases."""
    states = {}
    for controller in controllers:
        rest = at_s % sum(p.duration_s for p in controller.phases)
        for phase in controller.phases:
            if rest < phase.duration_s:
                states.update(phase.states)
                break
            rest -= phase.duration_s
    return states


def heads(told, crash_s=4.2):
    """The head of each vehicle: the ones that show what is told of it and nobody else's."""
    return signal_times(compiled("signal"), planned()[1], told, crash_s)


def test_the_spec_is_one_with_signals():
    assert {node.control for node in NAMED["signal"].nodes} == {"signal", "none"}


@pytest.mark.parametrize("state", ["green", "yellow", "red"])
@pytest.mark.parametrize("crash_s", [0.0, 4.2, 61.7])
def test_a_told_state_is_shown_at_the_crash_and_was_before(state, crash_s):
    times = heads({"V1": state}, crash_s)
    assert times.notes == ()
    assert state in shown(times.controllers, crash_s).values()
    cycles = {round(sum(p.duration_s for p in c.phases), 3) for c in times.controllers}
    assert len(cycles) == 1
    before = shown(times.controllers, crash_s - SHOWN_S + 0.01) if crash_s >= SHOWN_S else None
    assert before is None or before == shown(times.controllers, crash_s)


@pytest.mark.parametrize("state", ["green", "yellow", "red"])
def test_a_signal_that_is_told_to_turn_shows_another_state_just_before(state):
    crash_s = 4.2
    times = signal_times(compiled("signal"), planned()[1], {"V1": state}, crash_s, frozenset({"V1"}))
    assert times.notes == ()
    now, before = (shown(times.controllers, t) for t in (crash_s, crash_s - TURNED_S - 2.0))
    turned = {head for head in now if now[head] == state != before[head]}
    steady = shown(heads({"V1": state}, crash_s).controllers, crash_s)
    assert turned & {head for head, seen in steady.items() if seen == state}


def test_one_runs_the_red_that_the_other_has_green():
    states = shown(heads({"V1": "red", "V2": "green"}).controllers, 4.2)
    other = shown(heads({"V1": "green", "V2": "red"}).controllers, 4.2)
    assert {k for k in states if states[k] == "green"} & {k for k in other if other[k] == "green"} == set()


def test_states_that_no_phase_shows_at_once_are_left_out_and_said():
    times = heads({"V1": "green", "V2": "green"})
    assert times.controllers == ()
    assert times.notes == ("no phase of the signals shows V1 green and V2 green at once: the scenario has no phases",)


def test_untold_states_are_left_out_and_said_where_there_are_signals():
    assert heads({}).controllers == ()
    assert heads({}).notes == ("what the traffic signals showed is not told: the scenario has no phases",)
    assert signal_times(crossroads(), planned()[1], {"V1": "red"}, 4.2) == ((), ())
    assert signal_times(RoadNetwork(), planned()[1], {"V1": "red"}, 4.2) == ((), ())


def test_a_vehicle_that_comes_to_no_signal_is_said():
    away = planned()[1][0].model_copy(update={"x_m": planned()[1][0].x_m + 5000})
    assert signal_times(compiled("signal"), [away], {"V1": "red"}, 4.2).notes == (
        "V1 had red, but no signal stands on its way",
    )


@pytest.mark.parametrize("version", ["1.0", "1.1", "1.2", "1.3"])
@pytest.mark.parametrize("encoding", ["timed", "events"])
def test_every_version_has_the_phases_and_our_player_shows_them(version, encoding):
    network = compiled("signal")
    scenario = compile_scenario(CRASH, network, version, encoding, signals={"V1": "red", "V2": "green"})
    assert xosc_findings(scenario.xosc, network.xodr) == []
    assert scenario.notes == compile_scenario(CRASH, crossroads(), version, encoding).notes
    root = parse_xml(scenario.xosc, "xosc")
    signals = {s.get("id") for s in parse_xml(network.xodr, "xodr").iter("signal")}
    assert {s.get("trafficSignalId") for s in root.iter("TrafficSignalState")} <= signals
    controllers = {c.get("id") for c in parse_xml(network.xodr, "xodr").iter("controller")}
    assert {c.get("name") for c in root.iter("TrafficSignalController")} <= controllers
    plan, scene = SignalPlan(read_root(scenario.xosc)), Scene(0.05, {}, step=84)
    plan.step(scene)
    assert {scene.signals[s] for s in signals & set(scene.signals)} == {"red", "green"}
