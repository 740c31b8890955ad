"""Runs in the worker process: SUMO drives a route file on trial. A bad file may kill it."""

from __future__ import annotations

from collections.abc import Sequence

import libsumo

from sgcad_core.system.temp_folders import temp_folder

STEP_S = 0.05
_OPTIONS = (
    "--collision.action", "warn", "--collision.check-junctions", "true", "--collision.mingap-factor", "0",
    "--time-to-teleport", "-1", "--xml-validation", "never", "--no-step-log", "true", "--duration-log.disable", "true",
)  # fmt: skip


def trial(
    net_xml: str, routes_xml: str, ids: Sequence[str], longest_s: float
) -> tuple[str, list[str], list[tuple[str, str]]]:
    """SUMO's message ("" if it runs), who never drove, and who collided with whom, each pair once."""
    met: set[str] = set()
    hits: dict[tuple[str, str], None] = {}
    with temp_folder("routes") as folder:
        net, routes = folder / "road.net.xml", folder / "scenario.rou.xml"
        net.write_text(net_xml, encoding="utf-8")
        routes.write_text(routes_xml, encoding="utf-8")
        try:
            libsumo.start(["sumo", "-n", str(net), "-r", str(routes), "--step-length", str(STEP_S), *_OPTIONS])
            for _ in range(round(longest_s / STEP_S)):
                libsumo.simulationStep()
                met |= set(libsumo.vehicle.getIDList()) | set(libsumo.person.getIDList())
                hits |= {(c.collider, c.victim): None for c in libsumo.simulation.getCollisions()}
                if libsumo.simulation.getMinExpectedNumber() == 0:
                    break
        except (libsumo.TraCIException, libsumo.FatalTraCIError, RuntimeError) as fault:
            return str(fault) or type(fault).__name__, [], []
        finally:
            libsumo.close()
    return "", [name for name in ids if name not in met], list(hits)
