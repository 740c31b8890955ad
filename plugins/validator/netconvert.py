"""netconvert's messages as findings: errors if it wrote no network, warnings as notes."""

from __future__ import annotations

import re
import signal
from typing import ClassVar, Literal

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.interfaces import Validator

_SAID = re.compile(r"^(Error|Warning|Quitting): *")
_EMPTY = ("Success.", "Quitting (on error).")


class Netconvert(Validator):
    """Reports netconvert's errors and warnings."""

    stage: ClassVar[str] = "road"
    warnings: Literal["repair", "note", "off"] = "note"
    """Severity of warnings; most are about things that the model cannot see (smooth shapes, signal programs)."""
    most: int = 12
    """Largest number of findings."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Errors if there is no network, then warnings."""
        if not isinstance(artifact, RoadNetwork):
            return []
        failed = artifact.net_xml is None or artifact.xodr is None
        found = [self._said(line, failed) for line in artifact.log.splitlines() if line and line not in _EMPTY]
        kept = [f for f in found if f is not None]
        if failed and not any(f.severity == "repair" for f in kept):
            kept.insert(0, self._death(artifact.returncode))
        return sorted(kept, key=lambda f: f.severity != "repair")[: self.most]

    def _said(self, line: str, failed: bool) -> Finding | None:
        warning = line.startswith("Warning:")
        if warning and self.warnings == "off":
            return None
        severity: Literal["repair", "note"] = "repair" if failed and not warning else "note"
        if warning and self.warnings == "repair":
            severity = "repair"
        remedy = "" if severity == "note" else "mend what is named and give the whole network again"
        return Finding(source="netconvert", severity=severity, what=_SAID.sub("", line), remedy=remedy)

    def _death(self, returncode: int) -> Finding:
        how = f"exit code {returncode}"
        if returncode < 0:
            how = f"died of {signal.Signals(-returncode).name}"
        remedy = "simplify the network: fewer lanes, no roads on top of each other"
        return Finding(source="netconvert", what="netconvert wrote no network", value=how, remedy=remedy)
