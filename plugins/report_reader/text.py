"""A bare text file: one narrative. Knows no pictures."""

from __future__ import annotations

from pathlib import Path

from plugins.report_reader.evidence import EvidenceReader, decode
from sgcad_core.case.records import CrashReport
from sgcad_core.system.report_files import read_regular


class Text(EvidenceReader):
    """Reads a .txt file as a narrative."""

    def read(self, source: Path) -> CrashReport:
        """Read one narrative; Latin-1, BOM and CR line ends are understood."""
        return self.evidence(source, decode(read_regular(source), source))
