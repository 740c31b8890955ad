"""A PDF report: its text layer and its largest picture. Scans without a text layer are refused."""

from __future__ import annotations

from pathlib import Path

from plugins.report_reader.evidence import EvidenceReader
from sgcad_core.case.records import CrashReport


class Pdf(EvidenceReader):
    """Reads a PDF with a text layer; its largest embedded picture is the crash diagram."""

    def read(self, source: Path) -> CrashReport:
        """Reads one PDF. Raises BadInput for scans, encrypted and broken files."""
        from plugins.report_reader._pdf_pages import text_and_picture  # pypdf: 0.15 s that other reports need not wait

        text, picture = text_and_picture(source, self.use_diagrams)
        return self.evidence(source, text, (picture,) if picture else ())
