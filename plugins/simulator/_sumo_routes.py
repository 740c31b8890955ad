"""The far end of the LibSumo simulator for SUMO route files: SUMO's own driver models decide.

Runs in a worker process. Gives poses of box centers while all wanted actors are under way, since every actor
of an execution has a row at every time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import libsumo
import numpy as np

from plugins.simulator._exchange import Driven
from sgcad_core.errors import SimulationFailed
from sgcad_core.system.temp_folders import temp_folder

_COLLISIONS = ("--collision.action", "warn", "--collision.check-junctions", "true", "--collision.mingap-factor", "0")
_SILENT = ("--no-step-log", "true", "--duration-log.disable", "true")
_OPTIONS = ("--time-to-teleport", "-1", "--xml-validation", "never", *_COLLISIONS, *_SILENT)

Row = tuple[float, float, float, float]


def drive(net_xml: str, routes_xml: str, ids: Sequence[str], longest_s: float, dt_s: float) -> Driven:
    """Run a route file and read the wanted actors' poses, from when all are there until one has left.

    Raises SimulationFailed with SUMO's words, or naming who never appears together.
    """
    with temp_folder("drive") as folder:
        net, routes = folder / "road.net.xml", folder / "scenario.rou.xml"
        net.write_text(net_xml, encoding="utf-8")
        routes.write_text(routes_xml, encoding="utf-8")
        files = ["-n", str(net), "-r", str(routes)]
        try:
            libsumo.start(["sumo", *files, "--step-length", str(dt_s), *_OPTIONS])
            return _drive(ids, round(longest_s / dt_s))
        except libsumo.TraCIException as fault:
            raise SimulationFailed(f"SUMO cannot run the routes: {fault}") from fault
        finally:
            libsumo.close()


def _drive(ids: Sequence[str], most: int) -> Driven:
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
    return Driven(tuple(np.array(column) for column in zip(*rows, strict=True)), tuple(notes))


def _row(name: str) -> Row:
    """Box center, heading and speed; a person's position is its center, a vehicle's its front bumper."""
    is_vehicle = name in libsumo.vehicle.getIDList()
    kind = libsumo.vehicle if is_vehicle else libsumo.person
    x, y = kind.getPosition(name)
    heading = math.radians(90.0 - kind.getAngle(name))
    reach = kind.getLength(name) / 2 if is_vehicle else 0.0
    return x - reach * math.cos(heading), y - reach * math.sin(heading), heading, kind.getSpeed(name)
