"""CARLA's client: the map is read where the package is installed; the replay needs a server and is not tried."""

from __future__ import annotations

import importlib.util
import sys

import pytest

from plugins.simulator.carla import Carla, waypoints
from sgcad_core.case.records import RoadNetwork
from sgcad_core.errors import MissingTool, SimulationFailed
from tests.plugins.simulator.test_simulators import scenario_of
from tests.sgcad_core.formats.xosc_samples import crossroads, trajectory

INSTALLED = importlib.util.find_spec("carla") is not None


def test_without_the_client_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "carla", None)
    with pytest.raises(MissingTool, match=r"CARLA's client is not installed: `pip install sg-cadvlm\[carla\]`"):
        Carla().ready()


def test_without_a_map_nothing_is_read():
    with pytest.raises(SimulationFailed, match=r"needs an \.xodr"):
        Carla().execute(scenario_of(trajectory("V1", [0, 1], 0)), RoadNetwork())


@pytest.mark.skipif(not INSTALLED, reason="CARLA's client is not installed, no map was read with it")
def test_the_client_reads_our_maps():
    assert waypoints(crossroads().xodr) > 100
    execution = Carla().execute(scenario_of(trajectory("V1", [0, 1], 0)), crossroads())
    assert "waypoints; no host: not replayed there" in execution.log
