"""A case folder: report.txt (or narrative.txt, XML, PDF) and a diagram, the evidence of a case.

XML beside a text is read only for its coded fields, and only with use_coded_fields.
"""

from __future__ import annotations

from pathlib import Path

from plugins.report_reader.evidence import EvidenceReader, decode, diagram, safe_case
from plugins.report_reader.nhtsa_xml import NhtsaXml, parse_case
from plugins.report_reader.pdf import Pdf
from sgcad_core.case.records import CrashReport, Diagram
from sgcad_core.errors import BadInput
from sgcad_core.system.report_files import check_inside, files_below, is_regular, read_regular

TEXTS = ("report.txt", "narrative.txt")
PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".bmp", ".tif", ".tiff", ".webp")
PICTURE_STEMS = ("diagram", "scene")


class Folder(EvidenceReader):
    """Reads report.txt or narrative.txt with diagram.png|jpg|..., else the folder's only XML, PDF or text file."""

    def read(self, source: Path) -> CrashReport:
        """Reads one folder. Raises BadInput that names the missing or wrong file."""
        try:
            files_below(source)
            files = sorted(f for f in source.iterdir() if is_regular(f))
        except OSError as fault:
            raise BadInput(f"{source}: cannot be listed: {fault.strerror or fault}") from fault
        pictures = self._diagrams(files) if self.use_diagrams else ()
        xml = [f for f in files if f.suffix.lower() == ".xml"]
        coded = parse_case(read_regular(xml[0], source), xml[0]).coded if xml and self.use_coded_fields else None
        text = next((f for name in TEXTS for f in files if f.name.lower() == name), None)
        if text is not None:
            report = self.evidence(text, decode(read_regular(text, source), text), pictures, coded)
        elif pictures and not self.use_narrative:
            report = self.evidence(source, "", pictures, coded)
        else:
            report = self._other(source, files, pictures)
        return report.model_copy(update={"case": safe_case(source.resolve().name)})

    def _diagrams(self, files: list[Path]) -> tuple[Diagram, ...]:
        found = [f for f in files if f.suffix.lower() in PICTURES]
        named = [f for f in found if f.stem.lower() in PICTURE_STEMS]
        return tuple(diagram(read_regular(f, f.parent), f) for f in (named or found)[:4])

    def _other(self, source: Path, files: list[Path], pictures: tuple[Diagram, ...]) -> CrashReport:
        """A folder without report.txt: its only XML, PDF or text file."""
        for suffix, reader in ((".xml", NhtsaXml), (".pdf", Pdf)):
            found = [f for f in files if f.suffix.lower() == suffix]
            if len(found) == 1:
                check_inside(found[0], source)
                report = reader(**self.model_dump()).read(found[0])
                return report.model_copy(update={"diagrams": pictures or report.diagrams})
        loose = [f for f in files if f.suffix.lower() == ".txt"]
        if len(loose) == 1:
            return self.evidence(loose[0], decode(read_regular(loose[0], source), loose[0]), pictures)
        raise BadInput(f"{source}: no {' or '.join(TEXTS)} and no single XML, PDF or text file; "
                       f"found {', '.join(f.name for f in files) or 'nothing'}")  # fmt: skip
