"""Replays scenarios in SUMO: every actor is put on its played pose and read back, step by step.

libsumo runs in a worker process (`_sumo_worker`): a network that kills it ends the execution, not the batch.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from pydantic import Field

from sgcad_core.case.records import Execution, Floats, RoadNetwork, Scenario, Trajectory
from sgcad_core.case.traffic import Driven, TrafficOrder
from sgcad_core.errors import InvalidOutput, SimulationFailed
from sgcad_core.execution.playback import execution_of, played
from sgcad_core.formats.openscenario.playing.player import DT_S
from sgcad_core.formats.xml import parse_xml
from sgcad_core.geometry.plane import wrap_angle
from sgcad_core.interfaces import Simulator
from sgcad_core.system.worker_process import Worker

TOLERANCE_M = 0.01


@functools.cache
def _worker(function: str, module: str = "_sumo_worker") -> Worker:
    """One SUMO process for all simulators of this process, since its start takes half a second."""
    return Worker(f"plugins.simulator.{module}:{function}")


class LibSumo(Simulator):
    """Replays scenario files in SUMO, which must hold every pose to within 1 cm, and runs route files.

    Route files are driven by SUMO's own driver models.
    """

    timeout_s: float = Field(60.0, gt=0, le=3600)
    """Longest wait for SUMO."""
    longest_s: float = Field(60.0, gt=0, le=600)
    """Longest run of a route file, in simulated seconds."""

    def load(self) -> None:
        """Start SUMO's process, the one that replays."""
        _worker("replay").begin()

    def execute(self, scenario: Scenario, network: RoadNetwork) -> Execution:
        """Replay the .xosc, or run the routes, on the net.xml. Raises SimulationFailed."""
        if not network.net_xml:
            raise SimulationFailed("the road network has no net.xml: compile it before simulating")
        if "<edge " not in network.net_xml:
            raise SimulationFailed("the network has no edges: nothing can drive on it")
        if scenario.xosc is None and scenario.routes_xml is not None:
            return self._drive(scenario, scenario.routes_xml, network.net_xml)
        return self._replay(scenario, network, network.net_xml)

    def drive_traffic(self, order: TrafficOrder) -> tuple[Driven, ...]:
        """SUMO's drivers among the actors. Raises SimulationFailed."""
        driven: tuple[Driven, ...] = self._ask(_worker("drive_traffic", "_sumo_traffic"), order)
        return driven

    def _replay(self, scenario: Scenario, network: RoadNetwork, net_xml: str) -> Execution:
        wanted = played(scenario, network)
        movers = [
            (actor.id, actor.length_m, actor.width_m, np.column_stack((t.pose, t.speed_mps)))
            for actor, t in zip(scenario.actors, wanted, strict=True)
        ]
        poses, notes = self._call("replay", net_xml, movers, DT_S)
        seen = [_seen(t, rows) for t, rows in zip(wanted, poses, strict=True)]
        worst = max(_deviation(a, b) for a, b in zip(wanted, seen, strict=True))
        return execution_of("libsumo", scenario, seen, "\n".join([*notes, f"largest deviation {worst:.1e} m"]))

    def _drive(self, scenario: Scenario, routes_xml: str, net_xml: str) -> Execution:
        try:
            parse_xml(routes_xml, "routes")
        except InvalidOutput as fault:
            raise SimulationFailed(str(fault)) from fault
        ids = [actor.id for actor in scenario.actors]
        poses, notes = self._call("drive", net_xml, routes_xml, ids, self.longest_s, DT_S)
        seen = [_driven(name, rows) for name, rows in zip(ids, poses, strict=True)]
        return execution_of("libsumo", scenario, seen, "\n".join(notes))

    def _call(self, function: str, *args: Any) -> Any:
        return self._ask(_worker(function), *args)

    def _ask(self, worker: Worker, *args: Any) -> Any:
        try:
            return worker.call(*args, timeout_s=self.timeout_s)
        except SimulationFailed as fault:
            if words := worker.said():
                fault.args = (f"{fault}; SUMO's words: {words}",)
            raise


def _driven(name: str, rows: Floats) -> Trajectory:
    t_s, heading = np.arange(len(rows)) * DT_S, np.unwrap(rows[:, 2])
    return Trajectory(actor=name, t_s=t_s, x_m=rows[:, 0], y_m=rows[:, 1], heading_rad=heading, speed_mps=rows[:, 3])


def _seen(wanted: Trajectory, rows: Floats) -> Trajectory:
    """Poses as SUMO holds them; headings stay continuous, speeds are the scenario's."""
    heading = wanted.heading_rad + wrap_angle(rows[:, 2] - wanted.heading_rad)
    return wanted.model_copy(update={"x_m": rows[:, 0], "y_m": rows[:, 1], "heading_rad": heading})


def _deviation(wanted: Trajectory, seen: Trajectory) -> float:
    """Largest distance of two poses, metres. Raises SimulationFailed above the tolerance."""
    away = np.hypot(wanted.x_m - seen.x_m, wanted.y_m - seen.y_m)
    if (worst := float(away.max())) > TOLERANCE_M:
        t_s = wanted.t_s[int(away.argmax())]
        moved = f"SUMO moved {wanted.actor} {worst:.3f} m away from its scenario pose"
        raise SimulationFailed(f"{moved} at {t_s:.2f} s (limit {TOLERANCE_M} m)")
    return worst
