"""Whether SUMO loads the network: libsumo in a worker process, whose death is a finding, not the end."""

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

_WORKER = Worker("plugins.validator._sumo_start:start")


class SumoLoad(Validator):
    """Starts SUMO on the .net.xml, about 10 ms once the worker runs (0.5 s)."""

    stage: ClassVar[str] = "road"
    timeout_s: float = 30.0

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Schema faults, else at most one finding; a network without .net.xml is passed over."""
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
        except ProcessDied as fault:
            if fault.from_outside:  # says nothing of the network: the case fails, and is tried on the next run
                raise
            return [_finding(f"SUMO died of the network: {fault}", remedy="simplify the network")]
        except SimulationFailed as fault:
            return [_finding(f"SUMO died of the network: {fault}", remedy="simplify the network")]
        return (
            [_finding(f"SUMO does not load the network: {_details(said)}", remedy="mend what SUMO names")]
            if said
            else []
        )

    def _load(self, net_xml: str) -> str:
        """SUMO's words about the network, "" where it loads; once more where somebody killed the process."""
        try:
            return self._said(net_xml)
        except ProcessDied as fault:
            if not fault.from_outside:
                raise
            return self._said(net_xml)

    def _said(self, net_xml: str) -> str:
        said: str = _WORKER.call(net_xml, timeout_s=self.timeout_s)
        return said


def _details(message: str) -> str:
    """SUMO's message with the error lines that it printed."""
    lines = [s for line in _WORKER.said().splitlines() if (s := line.strip()) and not s.startswith("In file")]
    return " | ".join(dict.fromkeys([message, *lines]))[:600]
