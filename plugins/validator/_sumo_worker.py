"""The worker process of the validators that start SUMO: a bad network or route file may end the process."""

from __future__ import annotations

from collections.abc import Sequence

import libsumo

from plugins.sumo_session import AS_TOLD, COLLISIONS, FAULTS, QUIET, running

STEP_S = 0.05
LOAD_STEPS = 2


def load(net_xml: str) -> str:
    """SUMO's message about the network, "" if SUMO loads it and steps on it; details are printed on stderr."""
    try:
        with running(("--no-step-log", "true", "--xml-validation", "never"), net_xml):
            for _ in range(LOAD_STEPS):
                libsumo.simulationStep()
    except FAULTS as fault:
        return str(fault) or type(fault).__name__
    return ""


def trial(
    net_xml: str, routes_xml: str, ids: Sequence[str], longest_s: float
) -> tuple[str, list[str], list[tuple[str, str]]]:
    """SUMO's message ("" if it runs), actors that never drove, and pairs that collided, each once."""
    met: set[str] = set()
    hits: dict[tuple[str, str], None] = {}
    try:
        with running((*COLLISIONS, *AS_TOLD, *QUIET), net_xml, routes_xml, STEP_S):
            for _ in range(round(longest_s / STEP_S)):
                libsumo.simulationStep()
                met |= set(libsumo.vehicle.getIDList()) | set(libsumo.person.getIDList())
                hits |= {(c.collider, c.victim): None for c in libsumo.simulation.getCollisions()}
                if libsumo.simulation.getMinExpectedNumber() == 0:
                    break
    except FAULTS as fault:
        return str(fault) or type(fault).__name__, [], []
    return "", [name for name in ids if name not in met], list(hits)
