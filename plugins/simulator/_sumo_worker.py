"""The LibSumo simulator's worker process: replays poses in SUMO, or runs a route file with SUMO's driver models.

libsumo may end its process, so it is imported in the worker only, by the two functions that the simulator calls. Poses
are (n, 4) arrays of box center x, y, heading and speed; metres, radians, m/s. Every actor has a row at every time.
"""

from __future__ import annotations

from collections.abc import Sequence

import libsumo
import numpy as np

from plugins.sumo_session import AS_TOLD, COLLISIONS, QUIET, box_center, front_bumper, heading_of, running, sumo_angle
from sgcad_core.case.records import Floats
from sgcad_core.errors import SimulationFailed

_REPLAY = ("--collision.action", "none", *AS_TOLD, *QUIET, "--no-warnings", "true")
EXACT_CLASS = "passenger"
"""Class of every mover, people included. SUMO matches the class "ignoring" also to the areas where people wait at a
crosswalk, and SUMO 1.28 dies of that (signal 11). Poses are exact on and off all lanes either way."""

Mover = tuple[str, float, float, Floats]
"""An actor to replay: id, length and width in metres, poses."""
Row = tuple[float, float, float, float]


Poses = tuple[tuple[Floats, ...], tuple[str, ...]]
"""Poses read back from SUMO, one array for each actor, and notes on what SUMO did otherwise. A plain tuple: a class of
this module would make the caller import libsumo when it reads the answer."""


def replay(net_xml: str, movers: Sequence[Mover], dt_s: float) -> Poses:
    """Drives every mover along its poses on the network and reads the poses back.

    Where SUMO drops an actor (off the network), the actor's own poses stay and a note names the row. Raises
    SimulationFailed with SUMO's message.
    """
    try:
        with running(_REPLAY, net_xml, step_s=dt_s):
            return _replay(movers)
    except libsumo.TraCIException as fault:
        raise SimulationFailed(f"SUMO cannot replay the scenario: {fault}") from fault


def _replay(movers: Sequence[Mover]) -> Poses:
    edge = next((e for e in libsumo.edge.getIDList() if not e.startswith(":")), None)
    if edge is None:
        raise SimulationFailed("the network has no edges: nothing can drive on it")
    libsumo.route.add("any", [edge])
    for mover in movers:
        _add(mover)
    seen = [poses.copy() for _, _, _, poses in movers]
    lost: dict[str, int] = {}
    for k in range(len(seen[0])):
        held = [(i, mover) for i, mover in enumerate(movers) if mover[0] not in lost]
        for _, mover in held:
            _place(mover, k)
        libsumo.simulationStep()
        there = set(libsumo.vehicle.getIDList())
        for i, (name, length, _, _) in held:
            if name in there:
                heading = heading_of(libsumo.vehicle.getAngle(name))
                seen[i][k, :3] = *box_center(libsumo.vehicle.getPosition(name), heading, length), heading
            else:
                lost[name] = k
    notes = (
        f"{n}: SUMO lost it at row {k} (off the network); its scenario poses stand from there on"
        for n, k in lost.items()
    )
    return tuple(seen), tuple(notes)


def _add(mover: Mover) -> None:
    """Adds a vehicle of the mover's size that SUMO neither steers nor brakes."""
    name, length, width, _ = mover
    kind = f"type_{name}"
    libsumo.vehicletype.copy("DEFAULT_VEHTYPE", kind)
    libsumo.vehicletype.setLength(kind, length)
    libsumo.vehicletype.setWidth(kind, width)
    libsumo.vehicletype.setMinGap(kind, 0.0)
    libsumo.vehicletype.setVehicleClass(kind, EXACT_CLASS)
    libsumo.vehicle.add(name, "any", typeID=kind)
    libsumo.vehicle.setSpeedMode(name, 0)
    libsumo.vehicle.setLaneChangeMode(name, 0)


def _place(mover: Mover, k: int) -> None:
    name, length, _, poses = mover
    x, y, heading, speed = (float(v) for v in poses[k])
    front = front_bumper(x, y, heading, length)
    libsumo.vehicle.moveToXY(name, "", -1, *front, angle=sumo_angle(heading), keepRoute=2, matchThreshold=100)
    libsumo.vehicle.setSpeed(name, speed)


def drive(net_xml: str, routes_xml: str, ids: Sequence[str], longest_s: float, dt_s: float) -> Poses:
    """Runs a route file and reads the wanted actors' poses, from when all have departed until the first one leaves.

    Raises SimulationFailed with SUMO's message, or naming the actors that never appear together.
    """
    try:
        with running((*AS_TOLD, *COLLISIONS, *QUIET), net_xml, routes_xml, dt_s):
            return _drive(ids, round(longest_s / dt_s))
    except libsumo.TraCIException as fault:
        raise SimulationFailed(f"SUMO cannot run the routes: {fault}") from fault


def _drive(ids: Sequence[str], most: int) -> Poses:
    rows: list[list[Row]] = []
    met: set[str] = set()
    notes: list[str] = []
    late = 0
    for _ in range(most):
        libsumo.simulationStep()
        here = set(libsumo.vehicle.getIDList()) | set(libsumo.person.getIDList())
        met |= here & set(ids)
        notes += [f"SUMO: {c.collider} into {c.victim}" for c in libsumo.simulation.getCollisions()]
        if all(name in here for name in ids):
            rows.append([_row(name) for name in ids])
        elif rows or libsumo.simulation.getMinExpectedNumber() == 0:
            break
        else:
            late += 1
    if len(rows) < 2:
        missing = [name for name in ids if name not in met]
        what = f"{', '.join(missing)} never appear" if missing else "the actors are never under way together"
        raise SimulationFailed(f"SUMO ran the routes, but {what}: let all depart at 0, with the actors' ids")
    notes = list(dict.fromkeys([*([f"begins when all have departed, step {late}"] if late else []), *notes]))
    return tuple(np.array(column) for column in zip(*rows, strict=True)), tuple(notes)


def _row(name: str) -> Row:
    """Box center, heading and speed; a person's position is its center, a vehicle's its front bumper."""
    is_vehicle = name in libsumo.vehicle.getIDList()
    kind = libsumo.vehicle if is_vehicle else libsumo.person
    heading = heading_of(kind.getAngle(name))
    x, y = box_center(kind.getPosition(name), heading, kind.getLength(name) if is_vehicle else 0.0)
    return x, y, heading, kind.getSpeed(name)
