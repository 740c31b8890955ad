"""Schema, references and playability of the scenario file."""

from __future__ import annotations

from typing import ClassVar

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.interfaces import Validator


class OpenScenario(Validator):
    """Checks the .xosc against its schema, its references and the project's player; skips scenarios without one."""

    stage: ClassVar[str] = "scenario"

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Faults of the .xosc against its schema and the network's .xodr."""
        if not isinstance(artifact, Scenario) or artifact.xosc is None:
            return []
        return xosc_findings(artifact.xosc, evidence.network.xodr if evidence.network else None)
