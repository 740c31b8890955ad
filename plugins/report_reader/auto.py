"""Selects the reader by the kind of the source. The default of every config."""

from __future__ import annotations

from pathlib import Path

from plugins.report_reader.evidence import EvidenceReader
from plugins.report_reader.folder import Folder
from plugins.report_reader.nhtsa_xml import NhtsaXml
from plugins.report_reader.pdf import Pdf
from plugins.report_reader.text import Text
from sgcad_core.case.records import CrashReport
from sgcad_core.errors import BadInput
from sgcad_core.system.report_files import leads_inside

READERS: dict[str, type[EvidenceReader]] = {".txt": Text, ".md": Text, ".xml": NhtsaXml, ".pdf": Pdf}


class Auto(EvidenceReader):
    """Reads a case folder, a text file, NHTSA case XML or a PDF; the kind and the suffix select the reader."""

    def read(self, source: Path) -> CrashReport:
        """Reads one case with the reader that fits. Raises BadInput that lists what can be read."""
        if source.is_symlink() and not leads_inside(source, source.parent):
            raise BadInput(f"{source}: leads out of its folder: give the file or folder itself")
        if source.is_dir():
            reader: type[EvidenceReader] = Folder
        elif not source.exists():
            raise BadInput(f"{source}: no such file or folder")
        elif source.suffix.lower() in READERS:
            reader = READERS[source.suffix.lower()]
        else:
            raise BadInput(f"{source}: suffix {source.suffix!r} is not read; give a folder or {', '.join(READERS)}")
        return reader(**self.model_dump()).read(source)
