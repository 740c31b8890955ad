"""Traffic around a finished crash: added, written into the case's files, and read from them."""

from __future__ import annotations

from pathlib import Path

from flows.case_files.case_folder import write_trajectories
from sgcad_core.case.density import Density
from sgcad_core.case.traffic import CrashScene, Traffic
from sgcad_core.execution.traffic_written import CrashWithTraffic, add_traffic
from sgcad_core.formats.sumo.traffic_routes import FILE, traffic_routes
from sgcad_core.handover.script import Script
from sgcad_core.interfaces import Simulator


def traffic_around_script(
    script: Script, xodr: str | None, density: Density, seed: int, simulator: Simulator
) -> CrashWithTraffic:
    """A script's crash with traffic. Raises NoTraffic, SimulationFailed, InvalidOutput."""
    scene = CrashScene(script.case, script.actors, script.trajectories, script.net_xml, script.xosc)
    return add_traffic(scene, xodr, density, seed, simulator.drive_traffic)


def write_motion(folder: Path, script: Script, traffic: Traffic) -> list[Path]:
    """trajectories.csv with the traffic's rows, and the traffic as SUMO's routes; their paths."""
    csv, routes = folder / "trajectories.csv", folder / FILE
    write_trajectories(csv, script.trajectories, traffic.trajectories)
    routes.write_text(traffic_routes(traffic.entrants), encoding="utf-8")
    return [csv, routes]
