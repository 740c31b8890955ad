"""Plays the scenario file with the project's own player, in process: nothing to install, nothing to die."""

from __future__ import annotations

from sgcad_core.case.records import Execution, RoadNetwork, Scenario
from sgcad_core.execution.playback import execution_of, played
from sgcad_core.interfaces import Simulator


class Kinematic(Simulator):
    """The scenario's own motion; no physics and no driver model."""

    def execute(self, scenario: Scenario, network: RoadNetwork) -> Execution:
        """Play the .xosc. Raises SimulationFailed where it cannot be played."""
        return execution_of("kinematic", scenario, played(scenario, network))
