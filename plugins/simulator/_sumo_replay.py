"""The far end of the LibSumo simulator: runs in a worker process, since libsumo may take its process along.

Poses go in and come out as (n, 4) arrays of box center x, y, heading and speed; metres, radians. SUMO's own
reference point is the middle of the front bumper, its angle is clockwise from north in degrees.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import libsumo

from plugins.simulator._exchange import Mover, Replayed
from sgcad_core.errors import SimulationFailed
from sgcad_core.system.temp_folders import temp_folder

_SILENT = ("--no-step-log", "true", "--duration-log.disable", "true", "--no-warnings", "true")
_OPTIONS = ("--collision.action", "none", "--time-to-teleport", "-1", "--xml-validation", "never", *_SILENT)

EXACT_CLASS = "passenger"
"""Class of every mover, people included. Who may drive anywhere ("ignoring") is matched to the areas where people wait
at a crosswalk, too, and SUMO 1.28 dies of that (signal 11). Poses are exact on and off all lanes either way."""


def replay(net_xml: str, movers: Sequence[Mover], dt_s: float) -> Replayed:
    """Drive every mover along its poses on the network and read the poses back.

    Where SUMO drops an actor (off the net), its own poses stand and a note says from when on. Raises
    SimulationFailed with SUMO's words.
    """
    with temp_folder("replay") as folder:
        net = folder / "road.net.xml"
        net.write_text(net_xml, encoding="utf-8")
        try:
            libsumo.start(["sumo", "-n", str(net), "--step-length", str(dt_s), *_OPTIONS])
            return _replay(movers)
        except libsumo.TraCIException as fault:
            raise SimulationFailed(f"SUMO cannot replay the scenario: {fault}") from fault
        finally:
            libsumo.close()


def _replay(movers: Sequence[Mover]) -> Replayed:
    edge = next((e for e in libsumo.edge.getIDList() if not e.startswith(":")), None)
    if edge is None:
        raise SimulationFailed("the network has no edges: nothing can drive on it")
    libsumo.route.add("any", [edge])
    for mover in movers:
        _add(mover)
    seen = [mover.poses.copy() for mover in movers]
    lost: dict[str, int] = {}
    for k in range(len(movers[0].poses)):
        held = [i for i, mover in enumerate(movers) if mover.id not in lost]
        for i in held:
            _place(movers[i], k)
        libsumo.simulationStep()
        there = set(libsumo.vehicle.getIDList())
        for i in held:
            if movers[i].id in there:
                seen[i][k, :3] = _pose(movers[i])
            else:
                lost[movers[i].id] = k
    return Replayed(tuple(seen), tuple(_note(name, k) for name, k in lost.items()))


def _add(mover: Mover) -> None:
    """A vehicle of the mover's size that SUMO neither steers nor keeps off anything."""
    kind = f"type_{mover.id}"
    libsumo.vehicletype.copy("DEFAULT_VEHTYPE", kind)
    libsumo.vehicletype.setLength(kind, mover.length_m)
    libsumo.vehicletype.setWidth(kind, mover.width_m)
    libsumo.vehicletype.setMinGap(kind, 0.0)
    libsumo.vehicletype.setVehicleClass(kind, EXACT_CLASS)
    libsumo.vehicle.add(mover.id, "any", typeID=kind)
    libsumo.vehicle.setSpeedMode(mover.id, 0)
    libsumo.vehicle.setLaneChangeMode(mover.id, 0)


def _place(mover: Mover, k: int) -> None:
    x, y, heading, speed = (float(v) for v in mover.poses[k])
    reach = mover.length_m / 2
    front = x + reach * math.cos(heading), y + reach * math.sin(heading)
    angle = (90.0 - math.degrees(heading)) % 360.0
    libsumo.vehicle.moveToXY(mover.id, "", -1, *front, angle=angle, keepRoute=2, matchThreshold=100)
    libsumo.vehicle.setSpeed(mover.id, speed)


def _pose(mover: Mover) -> tuple[float, float, float]:
    x, y = libsumo.vehicle.getPosition(mover.id)
    heading = math.radians(90.0 - libsumo.vehicle.getAngle(mover.id))
    reach = mover.length_m / 2
    return x - reach * math.cos(heading), y - reach * math.sin(heading), heading


def _note(name: str, k: int) -> str:
    return f"{name}: SUMO lost it at row {k} (off the network); its scenario poses stand from there on"
