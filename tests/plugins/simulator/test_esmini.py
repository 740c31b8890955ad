"""esmini as a simulator: its process, its log, and, where it is installed, what it makes of our files."""

from __future__ import annotations

import numpy as np
import pytest

from plugins.simulator.esmini import Esmini
from plugins.simulator.kinematic import Kinematic
from sgcad_core.case.records import RoadNetwork, Scenario
from sgcad_core.errors import MissingTool, SimulationFailed
from sgcad_core.execution.compare_executions import TOLERANCE_M, judge
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.kinds import ACTORS
from tests.plugins.simulator.fake_esmini import COLUMNS, log, make
from tests.plugins.simulator.test_simulators import scenario_of
from tests.sgcad_core.formats.xosc_samples import CROSSING, actor, crossroads, trajectory

BODIES = (("V1", 0.0, 0.0, 0.0, 10.0, 1.4), ("V2", 12.0, 0.0, 0.0, 0.0, 1.4))
SCENARIO = Scenario(xosc="<OpenSCENARIO/>", actors=(actor("V1"), actor("V2")))
NETWORK = RoadNetwork(xodr="<OpenDRIVE/>")


def run(tmp_path, content, says="", then="", **fields):
    return Esmini(path=str(make(tmp_path, content, says, then)), **fields).execute(SCENARIO, NETWORK)


# ------------------------------------------------------------------ the process
def test_its_log_becomes_trajectories_of_box_centers_and_a_contact(tmp_path):
    execution = run(tmp_path, log(*BODIES))
    assert [t.actor for t in execution.trajectories] == ["V1", "V2"]
    np.testing.assert_allclose(execution.trajectories[0].x_m, np.arange(60) * 0.5 + 1.4, atol=1e-9)
    np.testing.assert_allclose(execution.trajectories[0].speed_mps, 10, atol=1e-9)
    contact = execution.contact
    assert (contact.actor, contact.actor_area, contact.other_area) == ("V1", "front", "back")
    assert contact.t_s == pytest.approx(0.75)
    assert execution.complaints == ()


def test_what_it_says_it_cannot_do_is_a_complaint_once_each(tmp_path):
    says = (
        "[] [error] Unsupported geo reference attr: +q\n[0.1] [warn] TrafficAction not supported yet\n[] [info] fine\n"
        "[0.2] [warn] TrafficAction not supported yet"
    )
    assert run(tmp_path, log(*BODIES), says).complaints == (
        "[error] Unsupported geo reference attr: +q", "[warn] TrafficAction not supported yet",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("then", "message"),
    [
        ("time.sleep(60)", r"did not end within 1 s"),
        ("os.kill(os.getpid(), signal.SIGSEGV)", r"died of SIGSEGV; its last words: .*cannot load"),
        ("sys.exit(255)", r"ended with 255; its last words: \[error\] cannot load"),
    ],
    ids=["hangs", "crashes", "fails"],
)
def test_a_process_that_ends_badly_is_a_failed_simulation(tmp_path, then, message):
    with pytest.raises(SimulationFailed, match=message):
        run(tmp_path, None, "[] [error] cannot load", then, timeout_s=1.0)


ODD = {
    "no log": (None, "wrote no log; its last words: none"),
    "empty": ("", "has no rows"),
    "head only": ("a\nb\n", "has no rows"),
    "cut off": (log(*BODIES, steps=2).rsplit("\n", 2)[0], "no row every 0.05 s|has no rows"),
    "no pose": (log(*BODIES, columns=COLUMNS[:4]), "has no column World_Position_X"),
    "words": (log(*BODIES).replace("12.0", "far"), "a row that is no numbers: 0, ?0.0"),
    "somebody else": (log(BODIES[0]), "lacks V2; it has V1"),
    "another clock": (log(*BODIES, dt_s=0.07), "no row every 0.05 s for V1"),
}


@pytest.mark.parametrize(("content", "message"), ODD.values(), ids=ODD)
def test_a_log_that_cannot_be_understood_is_a_failed_simulation(tmp_path, content, message):
    with pytest.raises(SimulationFailed, match=message):
        run(tmp_path, content)


def test_a_file_that_is_no_program_and_a_scenario_without_file_are_told(tmp_path):
    (tmp_path / "script").write_text("")
    with pytest.raises(MissingTool, match=r"script' is no program that can be run: name the esmini binary by `path`"):
        Esmini(path=str(tmp_path / "script")).ready()
    with pytest.raises(SimulationFailed, match=r"needs an \.xosc and an \.xodr"):
        Esmini(path=str(make(tmp_path, ""))).execute(Scenario(routes_xml="<routes/>", actors=SCENARIO.actors), NETWORK)


def test_without_a_binary_the_three_places_to_name_it_are_told(monkeypatch, tmp_path):
    monkeypatch.delenv("ESMINI", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(MissingTool, match=r"no 'esmini' on PATH: .*`path` or by the variable ESMINI \(get it from"):
        Esmini().ready()
    binary = make(tmp_path, log(*BODIES))
    Esmini().ready()
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setenv("ESMINI", str(binary))
    Esmini().ready()
    assert Esmini().stamp != ""


# ------------------------------------------------------------------ the real one, where there is one
@pytest.fixture
def esmini():
    simulator = Esmini()
    try:
        simulator.ready()
    except MissingTool as fault:
        pytest.skip(f"esmini is not installed, nothing was compared with it: {fault}")
    return simulator


@pytest.mark.parametrize("version", ["1.0", "1.1", "1.2", "1.3"])
def test_esmini_replays_a_planned_crash_and_sees_the_declared_contact(esmini, version):
    network, scenario = crossroads(), compile_scenario(CROSSING, crossroads(), version)
    verdict = judge(esmini, Kinematic().execute(scenario, network), scenario, network)
    assert verdict.lines() == []
    assert (verdict.loaded, verdict.same_motion, verdict.as_declared) == (True, True, True)


@pytest.mark.parametrize("kind", ACTORS)
def test_esmini_places_the_box_of_every_kind_where_we_do(esmini, kind):
    """Fast and slow, around, to rest, off again and backwards."""
    t = np.arange(200) * 0.05
    speed = np.clip(8 - 4 * t, 0, None) - 1.5 * (t > 5)
    heading = 0.8 * np.sin(t)
    x, y = (np.cumsum(0.05 * speed * f(heading)) for f in (np.cos, np.sin))
    scenario = scenario_of(trajectory("V1", x, y, heading), kinds=[kind])
    verdict = judge(esmini, Kinematic().execute(scenario, crossroads()), scenario, crossroads())
    assert verdict.loaded, verdict.complaints
    assert verdict.deviation.distance_m <= TOLERANCE_M
