"""Plays the scenario file with the project's own player, in this process; needs no installation."""

from __future__ import annotations

from sgcad_core.case.records import Execution, RoadNetwork, Scenario
from sgcad_core.execution.playback import execution_of, played
from sgcad_core.interfaces import Simulator


class Kinematic(Simulator):
    """Plays the scenario's own motion, without physics and without a driver model."""

    def execute(self, scenario: Scenario, network: RoadNetwork) -> Execution:
        """Plays the .xosc. Raises SimulationFailed if it cannot be played."""
        return execution_of("kinematic", scenario, played(scenario, network))
