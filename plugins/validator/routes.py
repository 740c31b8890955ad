"""Checks that SUMO runs a route file: schema, references, then SUMO itself in a worker process."""

from __future__ import annotations

from typing import ClassVar, Literal

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput, SimulationFailed
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.routes_xml import SOURCE, routes_findings
from sgcad_core.interfaces import Validator
from sgcad_core.system.worker_process import Worker

_finding = FindingFactory(SOURCE, where="routes")

_WORKER = Worker("plugins.validator._sumo_worker:trial")


class Routes(Validator):
    """Checks a scenario of SUMO routes by its schema and by a trial run in SUMO; skips OpenSCENARIO files."""

    stage: ClassVar[str] = "scenario"
    longest_s: float = 60.0
    """Simulated seconds of the trial."""
    timeout_s: float = 60.0
    """Longest wait for SUMO, seconds."""
    no_collision: Literal["repair", "note"] = "note"
    """Severity if SUMO's drivers avoid the declared crash."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Schema faults, else wrong references, else SUMO's errors, actors that never drive, and no collision."""
        network = evidence.network
        if not isinstance(artifact, Scenario) or artifact.routes_xml is None or not network or not network.net_xml:
            return []
        actors = [actor.id for actor in artifact.actors]
        try:
            if faults := routes_findings(artifact.routes_xml, parse_net(network.net_xml), actors):
                return faults
            said, missing, hits = _WORKER.call(
                network.net_xml, artifact.routes_xml, actors, self.longest_s, timeout_s=self.timeout_s
            )
        except InvalidOutput as fault:
            return list(fault.findings)
        except SimulationFailed as fault:
            return [_finding(f"SUMO died of the routes: {fault}", remedy="write plain vehicles with routes")]
        if said:
            return [_finding(f"SUMO does not run the routes: {_words(said)}", remedy="mend what SUMO names")]
        if missing:
            names = ", ".join(missing)
            return [
                _finding(
                    "actors that never drive",
                    value=names,
                    remedy=f"give {names} a free place: other departLane or departPos",
                )
            ]
        return self._contact(artifact, hits)

    def _contact(self, artifact: Scenario, hits: list[tuple[str, str]]) -> list[Finding]:
        """Nothing if the declared pair collides in SUMO."""
        declared = artifact.declared
        if declared is None or any({declared.striker, declared.struck} == set(pair) for pair in hits):
            return []
        seen = "; ".join(f"{a} into {b}" for a, b in hits) or "no collision"
        remedy = "lower minGap and tau, set jmIgnoreFoeProb to 1, or move departPos and departSpeed so that they meet"
        what = f"SUMO's drivers do not bring {declared.striker} into {declared.struck}"
        return [_finding(what, value=seen, remedy=remedy, severity=self.no_collision)]


def _words(message: str) -> str:
    lines = [line.strip() for line in _WORKER.said().splitlines() if line.strip()]
    return " | ".join(dict.fromkeys([message, *lines]))[:600]
