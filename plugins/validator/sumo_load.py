"""Checks that SUMO loads the network: libsumo runs in a worker process, whose death is a finding."""

from __future__ import annotations

from typing import ClassVar

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput, ProcessDied, SimulationFailed
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.plain_xml import sumo_findings
from sgcad_core.interfaces import Validator
from sgcad_core.system.worker_process import Worker

_finding = FindingFactory("sumo_load")

_WORKER = Worker("plugins.validator._sumo_worker:load")


class SumoLoad(Validator):
    """Starts SUMO on the .net.xml; about 10 ms after the first start of the worker (0.5 s)."""

    stage: ClassVar[str] = "road"
    timeout_s: float = 30.0
    """Longest wait for SUMO, seconds."""

    def load(self) -> None:
        """Start SUMO's process."""
        _WORKER.begin()

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Schema faults, else at most one finding; none for a network without .net.xml."""
        if not isinstance(artifact, RoadNetwork) or artifact.net_xml is None:
            return []
        try:
            if not parse_net(artifact.net_xml).edges:  # libsumo would die of it
                return [_finding("the network has no roads", remedy="give it at least one road with a lane")]
            if faults := sumo_findings("net", artifact.net_xml):  # libsumo loads negative lengths without complaint
                return faults
            said = self._load(artifact.net_xml)
        except InvalidOutput as fault:
            return list(fault.findings)
        except SimulationFailed as fault:
            if isinstance(fault, ProcessDied) and fault.from_outside:  # tells nothing of the network: try it next run
                raise
            return [_finding(f"SUMO died of the network: {fault}", remedy="simplify the network")]
        what = f"SUMO does not load the network: {_details(said)}"
        return [_finding(what, remedy="mend what SUMO names")] if said else []

    def _load(self, net_xml: str) -> str:
        """SUMO's message about the network, "" if it loads; asked once more if the process was killed from outside."""
        try:
            said: str = _WORKER.call(net_xml, timeout_s=self.timeout_s)
        except ProcessDied as fault:
            if not fault.from_outside:
                raise
            said = _WORKER.call(net_xml, timeout_s=self.timeout_s)
        return said


def _details(message: str) -> str:
    """SUMO's message with the error lines that it printed."""
    lines = [s for line in _WORKER.said().splitlines() if (s := line.strip()) and not s.startswith("In file")]
    return " | ".join(dict.fromkeys([message, *lines]))[:600]
