"""A PDF report: its text layer and its largest picture. Scans without a text layer are refused."""

from __future__ import annotations

import io
from pathlib import Path

from pypdf import PdfReader
from pypdf.errors import PyPdfError

from plugins.report_reader.evidence import EvidenceReader, diagram, read_bytes
from sgcad_core.errors import BadInput
from sgcad_core.records import CrashReport, Diagram

MAX_PAGES = 60
MIN_PICTURE_PX = 200


class Pdf(EvidenceReader):
    """Reads a PDF with a text layer; its largest embedded picture is taken for the crash diagram."""

    def read(self, source: Path) -> CrashReport:
        """Read one PDF. Raises BadInput for scans, encrypted and broken files."""
        pages = self._pages(source)
        try:
            text = "\n".join(page.extract_text() for page in pages)
        except (PyPdfError, ValueError, KeyError, TypeError, RecursionError) as fault:
            raise BadInput(f"{source}: the text layer cannot be read ({fault}): save the PDF anew") from fault
        if not text.strip():
            raise BadInput(f"{source}: the PDF has no text layer: run text recognition (OCR) on it first")
        picture = _largest_picture(pages) if self.use_diagrams else None
        return self.evidence(source, text, (picture,) if picture else ())

    def _pages(self, source: Path) -> list:  # type: ignore[type-arg]
        try:
            reader = PdfReader(io.BytesIO(read_bytes(source)))
            if reader.is_encrypted and not reader.decrypt(""):
                raise BadInput(f"{source}: the PDF is encrypted: save it without a password")
            if len(reader.pages) > MAX_PAGES:
                raise BadInput(
                    f"{source}: {len(reader.pages)} pages, the limit is {MAX_PAGES}: extract the crash report"
                )
            return list(reader.pages)
        except (PyPdfError, ValueError, KeyError, TypeError, RecursionError) as fault:
            raise BadInput(f"{source}: no readable PDF ({fault})") from fault


def _largest_picture(pages: list) -> Diagram | None:  # type: ignore[type-arg]
    """The largest readable raster of all pages; None if all are small (logos) or unreadable."""
    best: Diagram | None = None
    for page in pages:
        try:
            found = [diagram(image.data, Path(image.name)) for image in page.images]
        except (BadInput, PyPdfError, ValueError, KeyError, NotImplementedError, OSError):
            continue  # a picture in a codec that we do not read is no reason to lose the text
        for picture in found:
            if min(picture.width_px, picture.height_px) >= MIN_PICTURE_PX and (
                best is None or picture.width_px * picture.height_px > best.width_px * best.height_px
            ):
                best = picture
    return best
