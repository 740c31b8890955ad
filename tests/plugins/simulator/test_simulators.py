"""Both simulators give the scenario's own motion; SUMO's process may die, the caller does not."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest

from plugins.simulator.kinematic import Kinematic
from plugins.simulator.libsumo import LibSumo, _worker
from sgcad_core.case.records import RoadNetwork, Scenario
from sgcad_core.errors import SimulationFailed
from sgcad_core.execution.contact import realised
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.geometry.plane import wrap_angle
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec
from tests.sgcad_core.formats.xosc_samples import CROSSING, actor, crossroads, trajectory

K = np.arange(120)
REPLAY = "replay"
BOTH = [Kinematic(), LibSumo()]


def scenario_of(*motions, kinds=()):
    kinds = kinds or ["car"] * len(motions)
    sizes = {"pedestrian": (0.5, 0.6), "object": (0.5, 0.5), "bicycle": (1.8, 0.6), "trailer": (12.0, 2.5)}
    actors = [actor(m.actor, k, sizes.get(k, (4.7, 1.8))) for m, k in zip(motions, kinds, strict=True)]
    return Scenario(xosc=write_xosc(actors, motions, None), actors=tuple(actors))


@pytest.mark.parametrize("simulator", BOTH, ids=lambda s: type(s).__name__)
def test_a_planned_crash_happens_as_planned(simulator):
    scenario = compile_scenario(CROSSING, crossroads())
    execution = simulator.execute(scenario, crossroads())
    assert realised(scenario.declared, execution.contact)
    assert [t.actor for t in execution.trajectories] == ["V1", "V2", "P1"]
    for seen, planned in zip(execution.trajectories, scenario.planned, strict=True):
        np.testing.assert_allclose(seen.t_s, planned.t_s, atol=1e-9)
        away = np.hypot(seen.x_m - planned.x_m, seen.y_m - planned.y_m)
        assert away.max() < 0.06, "what the file leaves out of coming to rest"
        assert away[planned.t_s <= execution.contact.t_s].max() < 0.01
        assert np.abs(np.diff(seen.heading_rad)).max() < 1.0


def test_sumo_holds_everybody_on_and_off_the_road():
    turned = np.linspace(0, 7, len(K))
    motions = [
        trajectory("V1", K * 0.6 + 90, -1.8),  # over the end of the map
        trajectory("V2", 5 * np.cos(turned), 5 * np.sin(turned), turned + 4),  # sideways, around
        trajectory("V3", 60 - K * 0.2, 1.8, 0.0),  # backwards
        trajectory("P1", 40 + 0 * K, K * 0.07 - 20, np.pi / 2),
        trajectory("B1", K * 0.2 - 60, 30.0),
        trajectory("O1", 300 + 0 * K, 300.0),
        trajectory("O2", 300 + 0 * K, 300.0),  # inside another
        trajectory("T1", 0 * K - 40, -5.4),
    ]
    kinds = ["car", "car", "car", "pedestrian", "bicycle", "object", "object", "trailer"]
    execution = LibSumo().execute(scenario_of(*motions, kinds=kinds), crossroads())
    for seen, wanted in zip(execution.trajectories, motions, strict=True):
        assert np.hypot(seen.x_m - wanted.x_m, seen.y_m - wanted.y_m).max() < 1e-5
        assert np.abs(wrap_angle(seen.heading_rad - wanted.heading_rad)).max() < 1e-6
        assert np.abs(np.diff(seen.heading_rad)).max() < 0.1, "continuous"
    assert "largest deviation" in execution.log
    assert "lost" not in execution.log


def test_vehicles_may_cut_across_where_people_wait_at_a_crosswalk():
    legs = tuple(
        Leg(bearing=at, lanes_in=1, lanes_out=1, beside=("sidewalk",), crosswalk=True, control="signal")
        for at in "NSEW"
    )
    spec = road_spec(RoadLayout(legs=legs))
    net = compile_network(plain_xml(spec), spec)
    assert 'function="walkingarea"' in net.net_xml
    sweeps = np.linspace(-14, 14, len(K))
    motions = [trajectory(f"V{n}", sweeps, at + 0 * K, 0.0) for n, at in enumerate((-8.0, -6.5, 6.5, 8.0), 1)]
    motions += [trajectory(f"V{n}", at + 0 * K, sweeps, np.pi / 2) for n, at in enumerate((-8.0, -6.5, 6.5, 8.0), 5)]
    execution = LibSumo().execute(scenario_of(*motions), net)
    assert "lost" not in execution.log
    for seen, wanted in zip(execution.trajectories, motions, strict=True):
        assert np.hypot(seen.x_m - wanted.x_m, seen.y_m - wanted.y_m).max() < 1e-5


BAD_NETS = [
    ("garbage", "no edges"),
    ('<net version="1.20"><edge id="a" from="x" to="y"/></net>', "SUMO's words: Error: Unknown from-node 'x'"),
    ("<net/>", "no edges"),
    ('<net version="1.20"></net>', "no edges"),
    (None, "no net.xml"),
]


@pytest.mark.parametrize(("net", "message"), BAD_NETS)
def test_a_network_that_sumo_cannot_load_is_simulation_failed(net, message):
    network = crossroads().model_copy(update={"net_xml": net})
    with pytest.raises(SimulationFailed, match=message):
        LibSumo().execute(scenario_of(trajectory("V1", K * 0.5, 0)), network)


def test_a_dead_worker_is_simulation_failed_and_the_next_execution_works():
    good = scenario_of(trajectory("V1", K * 0.5 - 60, -1.8))
    LibSumo().execute(good, crossroads())
    cut = crossroads().model_copy(update={"net_xml": crossroads().net_xml[:4000]})
    with pytest.raises(SimulationFailed, match=r"SIGSEGV|SUMO's words: Error"):
        LibSumo().execute(good, cut)
    _worker(REPLAY)._process.popen.kill()
    _worker(REPLAY)._process.popen.wait()
    assert len(LibSumo().execute(good, crossroads()).trajectories) == 1


def test_a_late_worker_is_simulation_failed():
    scenario = scenario_of(trajectory("V1", K * 0.5 - 60, -1.8))
    LibSumo().execute(scenario, crossroads())
    os.kill(_worker(REPLAY)._process.popen.pid, signal.SIGSTOP)  # a worker that cannot answer, however quick it is
    with pytest.raises(SimulationFailed, match="no answer within"):
        LibSumo(timeout_s=0.05).execute(scenario, crossroads())
    assert LibSumo().execute(scenario, crossroads()).trajectories


@pytest.mark.parametrize("simulator", BOTH, ids=lambda s: type(s).__name__)
def test_what_cannot_be_played_is_simulation_failed(simulator):
    good = scenario_of(trajectory("V1", K * 0.5, 0))
    with pytest.raises(SimulationFailed, match=r"cannot be played: .*well-formed"):
        simulator.execute(good.model_copy(update={"xosc": "<x"}), crossroads())
    with pytest.raises(SimulationFailed, match=r"the \.xosc moves V1, but the scenario names V2"):
        simulator.execute(good.model_copy(update={"actors": (actor("V2"),)}), crossroads())


def test_without_xosc_the_kinematic_simulator_names_the_one_that_can():
    routes = Scenario(routes_xml="<routes/>", actors=(actor("V1"),))
    with pytest.raises(SimulationFailed, match="use simulator 'libsumo'"):
        Kinematic().execute(routes, RoadNetwork())


def test_executions_share_one_process_whose_start_is_what_costs():
    scenario = scenario_of(trajectory("V1", K * 0.5 - 60, -1.8))
    LibSumo().execute(scenario, crossroads())
    process = _worker(REPLAY)._process.popen.pid
    LibSumo(timeout_s=5).execute(scenario, crossroads())
    assert _worker(REPLAY)._process.popen.pid == process


# ------------------------------------------------------------------ route files
def routes(*rows, extra=""):
    return f'<routes><vType id="car" length="4.7" width="1.8" sigma="0"/>{"".join(rows)}{extra}</routes>'


def vehicle(name, depart=0, edges="W -E", **more):
    attributes = "".join(f' {k}="{v}"' for k, v in more.items())
    return f'<vehicle id="{name}" type="car" depart="{depart}"{attributes}><route edges="{edges}"/></vehicle>'


def run(text, *names, simulator=None):
    scenario = Scenario(routes_xml=text, actors=tuple(actor(n) for n in names))
    return (simulator or LibSumo()).execute(scenario, crossroads())


def test_sumo_drives_a_route_file_by_itself():
    execution = run(routes(vehicle("V1", departSpeed="10", departPos="5", departLane="0")), "V1")
    (motion,) = execution.trajectories
    np.testing.assert_allclose(motion.t_s, np.arange(len(motion.t_s)) * 0.05)
    assert motion.x_m[0] == pytest.approx(-120 + 5 - 4.7 / 2, abs=0.1), "box center, 5 m behind the edge's begin"
    assert motion.y_m == pytest.approx(-5.4, abs=0.3)
    assert motion.x_m[-1] > 100
    assert motion.heading_rad == pytest.approx(0, abs=0.1)
    np.testing.assert_allclose(np.diff(motion.x_m) / 0.05, motion.speed_mps[1:], atol=0.05)


def test_everybody_has_a_row_at_every_time():
    text = routes(vehicle("V1"), vehicle("V2", depart=3, edges="S -N"))
    execution = run(text, "V2", "V1")
    assert [t.actor for t in execution.trajectories] == ["V2", "V1"]
    assert len({len(t.t_s) for t in execution.trajectories}) == 1
    assert "begins when all have departed" in execution.log


def test_a_route_file_may_run_out_of_time():
    assert run(routes(vehicle("V1")), "V1", simulator=LibSumo(longest_s=2)).trajectories[0].t_s[-1] <= 2


def test_a_driver_without_brakes_strikes_and_both_see_it():
    start = {"departLane": "0", "insertionChecks": "none"}
    standing = vehicle("V1", departPos="40", departSpeed="0", **start)
    text = routes(standing, vehicle("V2", departPos="25", departSpeed="13", **start))
    execution = run(text.replace("<vType ", '<vType decel="0.3" emergencyDecel="0.3" accel="0.5" '), "V1", "V2")
    contact = execution.contact
    assert (contact.actor, contact.actor_area, contact.other_area) == ("V1", "back", "front")
    assert "SUMO: V2 into V1" in execution.log


@pytest.mark.parametrize(("text", "message"), [
    ("<routes>", "no well-formed XML"),
    ('<!DOCTYPE a [<!ENTITY b "c">]><routes/>', "entities are not allowed"),
    (routes(vehicle("V7")), r"V1 never appear: let all depart at 0"),
    (routes(vehicle("V1", edges="W nowhere")), "SUMO cannot run the routes: The edge 'nowhere'"),
    ("<routes/>", "V1 never appear"),
])  # fmt: skip
def test_a_bad_route_file_is_simulation_failed(text, message):
    with pytest.raises(SimulationFailed, match=message):
        run(text, "V1")
