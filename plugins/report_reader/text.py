"""A bare text file: one narrative. Knows no pictures."""

from __future__ import annotations

from pathlib import Path

from plugins.report_reader.evidence import EvidenceReader, decode, read_bytes
from sgcad_core.records import CrashReport


class Text(EvidenceReader):
    """Reads a .txt file as a narrative."""

    def read(self, source: Path) -> CrashReport:
        """Read one narrative; Latin-1, BOM and CR line ends are understood."""
        return self.evidence(source, decode(read_bytes(source), source))
