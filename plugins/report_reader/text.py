"""A text file that holds one narrative. Knows no pictures."""

from __future__ import annotations

from pathlib import Path

from plugins.report_reader.evidence import EvidenceReader, decode
from sgcad_core.case.records import CrashReport
from sgcad_core.system.report_files import read_regular


class Text(EvidenceReader):
    """Reads a .txt file as one narrative, without diagrams."""

    def read(self, source: Path) -> CrashReport:
        """Reads one narrative; accepts Latin-1, a BOM and CR line ends."""
        return self.evidence(source, decode(read_regular(source), source))
