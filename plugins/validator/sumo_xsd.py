"""Whether the plain XML keeps SUMO's own schemas; asked before netconvert, which lets faults pass or crashes."""

from __future__ import annotations

from typing import ClassVar

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.formats.sumo.plain_xml import xsd_findings
from sgcad_core.interfaces import Validator


class SumoXsd(Validator):
    """Validates nodes, edges and connections against the XSDs that come with SUMO."""

    stage: ClassVar[str] = "road"

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """One finding a schema fault; a network without plain XML is passed over."""
        if not isinstance(artifact, RoadNetwork) or artifact.plain is None:
            return []
        return xsd_findings(artifact.plain)
