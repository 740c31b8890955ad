"""Common steps of the simulators of scenario files: playing the .xosc and finding the first contact.

Knows the player; no simulator.
"""

from __future__ import annotations

from collections.abc import Sequence

from sgcad_core.case.records import Execution, RoadNetwork, Scenario, Trajectory, sizes_of
from sgcad_core.errors import InvalidOutput, SimulationFailed
from sgcad_core.execution.contact import first_contact
from sgcad_core.formats.openscenario.playing.player import play


def played(scenario: Scenario, network: RoadNetwork) -> tuple[Trajectory, ...]:
    """The scenario file's trajectories, one an actor in the actors' order, 0.05 s apart.

    Raises SimulationFailed where it cannot be played or moves other actors than the scenario names.
    """
    if scenario.xosc is None:
        raise SimulationFailed("the scenario has no .xosc: use simulator 'libsumo', which also runs SUMO route files")
    try:
        found = {t.actor: t for t in play(scenario.xosc, network.xodr)}
    except InvalidOutput as fault:
        raise SimulationFailed(f"the scenario cannot be played: {fault}") from fault
    names = [actor.id for actor in scenario.actors]
    if sorted(found) != sorted(names):
        raise SimulationFailed(f"the .xosc moves {', '.join(found)}, but the scenario names {', '.join(names)}")
    return tuple(found[name] for name in names)


def execution_of(simulator: str, scenario: Scenario, seen: Sequence[Trajectory], log: str = "") -> Execution:
    """An execution with its first contact."""
    contact = first_contact(seen, sizes_of(scenario.actors))
    return Execution(simulator=simulator, trajectories=tuple(seen), contact=contact, log=log)
