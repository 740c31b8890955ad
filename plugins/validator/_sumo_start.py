"""Runs in the worker process: starts libsumo on a network, does a step, closes it. A bad network may kill it."""

from __future__ import annotations

import libsumo

from sgcad_core.system.temp_folders import temp_folder

STEPS = 2


def start(net_xml: str) -> str:
    """ "" if SUMO loads the network and steps on it, else SUMO's message (details stand on stderr)."""
    with temp_folder("load") as folder:
        file = folder / "road.net.xml"
        file.write_text(net_xml, encoding="utf-8")
        try:
            libsumo.start(["sumo", "-n", str(file), "--no-step-log", "true", "--xml-validation", "never"])
            for _ in range(STEPS):
                libsumo.simulationStep()
        except (libsumo.TraCIException, libsumo.FatalTraCIError, RuntimeError) as fault:
            return str(fault) or type(fault).__name__
        finally:
            libsumo.close()
    return ""
