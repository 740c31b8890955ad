"""Checks the plain XML against SUMO's own schemas, before netconvert, which accepts or crashes on some faults."""

from __future__ import annotations

from typing import ClassVar

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.formats.sumo.plain_xml import xsd_findings
from sgcad_core.interfaces import Validator


class SumoXsd(Validator):
    """Checks nodes, edges and connections against the schemas that come with SUMO."""

    stage: ClassVar[str] = "road"

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """One finding for each schema fault; none for a network without plain XML."""
        if not isinstance(artifact, RoadNetwork) or artifact.plain is None:
            return []
        return xsd_findings(artifact.plain)
