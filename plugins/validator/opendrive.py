"""Checks that the .xodr is valid OpenDRIVE 1.7: schema, references, lane links, lengths, gaps, signals, stop lines."""

from __future__ import annotations

from typing import ClassVar

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.formats.opendrive.checks.check_file import xodr_findings
from sgcad_core.interfaces import Validator


class OpenDrive(Validator):
    """Checks the .xodr against OpenDRIVE's schema and ASAM's rules."""

    stage: ClassVar[str] = "road"
    most: int = 20
    """Largest number of findings."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """At most `most` findings; none for a network without .xodr, which the validator netconvert reports."""
        if not isinstance(artifact, RoadNetwork) or artifact.xodr is None:
            return []
        return xodr_findings(artifact.xodr)[: self.most]
