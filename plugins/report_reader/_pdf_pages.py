"""Text layer and largest picture of a PDF, read by pypdf within limits. Knows no report."""

from __future__ import annotations

import io
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, cast

import pypdf
from PIL.Image import DecompressionBombError
from pypdf import PdfReader
from pypdf.errors import DependencyError, DeprecationError, PyPdfError
from pypdf.generic import StreamObject

from plugins.report_reader.evidence import MAX_NARRATIVE, UNREADABLE, diagram
from sgcad_core.case.records import Diagram
from sgcad_core.errors import BadInput
from sgcad_core.system.report_files import read_regular

MAX_PAGES = 60
MAX_DRAWN_BYTES = 8_000_000
"""Limit of the uncompressed drawing of all pages: a page of text has 20 kB, a scene diagram some 200 kB."""
MAX_BLANK_BYTES = 3_000_000
"""Limit of the white space within it, a fourth of a true drawing; it is read byte by byte, 3 MB in a second."""
MAX_DRAWN = 100_000
"""Limit of the drawing operators of all pages; a repeated drawing counts each time. So many take 1.5 s."""
WHITE = b"\0\t\n\f\r "
MAX_DAMAGED_BYTES = 200_000
"""Of a damaged compressed stream, which is read byte by byte: 1 MB takes a second."""
MAX_PALETTE_BYTES = 10_000
"""Of 256 colors of up to 32 inks."""
MIN_PICTURE_PX = 200
FAULTS = (PyPdfError, DependencyError, DeprecationError, *UNREADABLE)
"""What pypdf raises for a PDF that is broken, or needs a package or a program that is not there."""


def text_and_picture(source: Path, use_pictures: bool) -> tuple[str, Diagram | None]:
    """Its text and its largest picture, if wanted. Raises BadInput for scans, encrypted and broken files."""
    with _bounded():
        pages = _pages(source)
        try:
            text = _text(pages, source)
        except FAULTS as fault:
            raise BadInput(f"{source}: the text layer cannot be read ({fault}): save the PDF anew") from fault
        if not text.strip():
            raise BadInput(f"{source}: the PDF has no text layer: run text recognition (OCR) on it first")
        return text, _largest_picture(pages) if use_pictures else None


def _pages(source: Path) -> list:  # type: ignore[type-arg]
    try:
        reader = PdfReader(io.BytesIO(read_regular(source)))
        if reader.is_encrypted and not reader.decrypt(""):
            raise BadInput(f"{source}: the PDF is encrypted: save it without a password")
        if len(reader.pages) > MAX_PAGES:
            raise BadInput(f"{source}: {len(reader.pages)} pages, the limit is {MAX_PAGES}: extract the crash report")
        return list(reader.pages)
    except FAULTS as fault:
        raise BadInput(f"{source}: no readable PDF ({fault})") from fault


def _bounded() -> AbstractContextManager[object]:
    """pypdf without the program jbig2dec, which it would give JBIG2 pictures to, and with less patience for damage."""
    apply = getattr(pypdf, "apply_configuration", None)  # versions before 7 have no such limits
    limits = {"jbig2dec_binary": None, "zlib_maximum_recovery_input_length": MAX_DAMAGED_BYTES}
    return cast("AbstractContextManager[object]", apply(**limits)) if apply else nullcontext()


def _text(pages: list, source: Path) -> str:  # type: ignore[type-arg]
    """The text layer of all pages. Raises BadInput if the pages draw more than a report does."""
    found: list[str] = []
    drawn = drawn_bytes = blank_bytes = 0

    def count(*_: object) -> None:
        nonlocal drawn
        drawn += 1
        if drawn > MAX_DRAWN:
            raise BadInput(f"{source}: draws more than {MAX_DRAWN:,} things: print the report's pages to a new PDF")

    for page in pages:
        contents = page.get_contents()
        data = contents.get_data() if contents is not None else b""
        drawn_bytes += len(data)
        blank_bytes += len(data) - len(data.translate(None, WHITE))
        if drawn_bytes > MAX_DRAWN_BYTES or blank_bytes > MAX_BLANK_BYTES:
            raise BadInput(f"{source}: its pages hold more than {MAX_DRAWN_BYTES:,} bytes of drawing, or blanks: "
                           "print the report's pages to a new PDF")  # fmt: skip
        found.append(page.extract_text(visitor_operand_before=count))
        if sum(map(len, found)) > 2 * MAX_NARRATIVE:  # spaces are stripped yet
            raise BadInput(f"{source}: more than {MAX_NARRATIVE:,} characters of text: extract the crash report")
    return "\n".join(found)


def _largest_picture(pages: list) -> Diagram | None:  # type: ignore[type-arg]
    """The largest readable raster of all pages; None if all are small (logos) or unreadable."""
    best: Diagram | None = None
    for page in pages:
        try:
            images = page.images
            listed = [images[name] for name in images.keys() if not _long_palette(page, name)]  # noqa: SIM118 - a list
            found = [diagram(image.data, Path(image.name)) for image in listed]
        except (BadInput, DecompressionBombError, *FAULTS):
            continue  # a picture in a codec that we do not read, or too large, is no reason to lose the text
        for picture in found:
            if min(picture.width_px, picture.height_px) >= MIN_PICTURE_PX and (
                best is None or picture.width_px * picture.height_px > best.width_px * best.height_px
            ):
                best = picture
    return best


def _long_palette(page: Any, name: str | list[str]) -> bool:
    """Whether a picture has a palette beyond any real one, which pypdf would look through byte by byte."""
    found = page
    for part in [name] if isinstance(name, str) else name:
        inside = found.get("/Resources", {}).get("/XObject", {})
        if part not in inside:  # a picture within the drawing itself
            return False
        found = inside[part].get_object()
    space = found.get("/ColorSpace")
    palette = space[-1].get_object() if isinstance(space, list) and space else None
    return isinstance(palette, StreamObject) and len(palette.get_data()) > MAX_PALETTE_BYTES
