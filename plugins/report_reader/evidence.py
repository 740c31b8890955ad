"""The base of every reader: decoding of text, checks of pictures, and the switches of the evidence.

Knows no folder layout and no XML. Limits are generous for real reports and small for attacks.
"""

from __future__ import annotations

import io
import re
import struct
import warnings
import zlib
from abc import ABC
from pathlib import Path

import numpy as np
from PIL import Image, ImageOps, UnidentifiedImageError

from plugins.report_reader.degrade import Level, degrade
from sgcad_core.case.records import CrashReport, Diagram
from sgcad_core.errors import BadInput
from sgcad_core.interfaces import ReportReader
from sgcad_core.reading.text.privacy import redacted
from sgcad_core.reading.text.traced_text import TracedText, joined, runs
from sgcad_core.system.pictures import opened

MAX_NARRATIVE = 100_000
"""Characters: the longest real report here has 6,000."""
MAX_PIXELS = 40_000_000
MAX_SIDE_PX = 2048
MIN_WORDS = 3
PICTURE_KINDS = "PNG, JPEG, GIF, BMP, TIFF or WebP"
UNREADABLE = (
    OSError, SyntaxError, EOFError, ValueError, LookupError, TypeError, AttributeError, AssertionError, ArithmeticError,
    RuntimeError, MemoryError, struct.error, zlib.error,
)  # fmt: skip
"""Errors that Pillow and pypdf raise for broken files, beside their own error classes."""
_FUNCTION_WORDS = frozenset((
    "the", "a", "an", "of", "in", "on", "at", "to", "and", "was", "were", "is", "it", "that", "by", "with", "for",
    "from", "as", "this", "which", "had", "not", "no", "has", "be", "or", "both",
))  # fmt: skip


class EvidenceReader(ReportReader, ABC):
    """A reader whose evidence can be narrowed for an ablation; each switch is a config field."""

    use_narrative: bool = True
    """Use the narrative as evidence."""
    use_diagrams: bool = True
    """Use the diagrams as evidence."""
    use_coded_fields: bool = False
    """Append NHTSA's coded fields to the narrative; no compared config does."""
    redact_persons: bool = True
    """Leave out sex, age, names, licence, health and injury data."""
    robustness_level: Level = "full"
    """Degrade the evidence, for robustness studies."""

    def evidence(
        self,
        source: Path,
        narrative: str,
        diagrams: tuple[Diagram, ...] = (),
        coded: dict[str, object] | None = None,
        notes: tuple[str, ...] = (),
    ) -> CrashReport:
        """Assembles a report by the switches. Raises BadInput if no evidence is left."""
        text = checked_narrative(TracedText.of(narrative), source) if self.use_narrative else TracedText.of("")
        text = redacted(text) if self.redact_persons else text
        if self.use_coded_fields and coded:
            text = _appended(text, f"\n\nCoded fields:\n{coded_lines(coded)}", len(narrative)).strip()
        shown = diagrams if self.use_diagrams else ()
        if not text.text and not shown:
            raise BadInput(f"{source}: no diagram, and the narrative is switched off: set use_narrative to true")
        name = source.name if source.is_dir() else source.stem
        report = CrashReport(
            case=safe_case(name),
            narrative=text.text,
            diagrams=shown,
            coded=coded if self.use_coded_fields else None,
            notes=notes,
            places=runs(text),
        )
        return degrade(report, self.robustness_level)


def _appended(text: TracedText, more: str, end: int) -> TracedText:
    """The text with an addition of the program, placed at the narrative's end."""
    nowhere = [end] * len(more)
    return joined([text, TracedText(more, nowhere, nowhere)])


def safe_case(name: str) -> str:
    """A case id that is a plain folder name: no separators, no leading dot, at most 100 characters."""
    return re.sub(r"[^\w.\-]+", "_", name).strip(".")[:100] or "case"


def decode(raw: bytes, source: Path) -> str:
    """Bytes of a text file as text: UTF-8 (with or without BOM), UTF-16 with BOM, else Latin-1; LF line ends."""
    if len(raw) > 4 * MAX_NARRATIVE:  # four bytes a character, in any of these codings
        raise BadInput(f"{source}: {len(raw):,} bytes of text; a narrative has at most {MAX_NARRATIVE:,} characters: "
                       "cut the file")  # fmt: skip
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = raw.decode("utf-16", errors="replace")
    else:
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = raw.decode("cp1252", errors="replace")
    control = sum(1 for c in text if (ord(c) < 32 and c not in "\t\n\r\f") or c == "\x7f")
    if "\x00" in text or control > 0.01 * len(text):
        raise BadInput(f"{source}: binary data, not text ({control} control characters): give plain text, XML or PDF")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def checked_narrative(text: TracedText, source: Path) -> TracedText:
    """The narrative, stripped. Raises BadInput if it is empty or does not read like English."""
    text = text.strip()
    if len(text.text) > MAX_NARRATIVE:
        raise BadInput(f"{source}: a narrative of {len(text.text):,} characters, at most {MAX_NARRATIVE:,} are read: "
                       "give one report, without its appendices")  # fmt: skip
    words = re.findall(r"[^\W\d_]+", text.text.lower())
    if len(words) < MIN_WORDS:
        raise BadInput(f"{source}: the narrative has {len(words)} words, at least {MIN_WORDS} are needed: is it empty?")
    whole = [w for w in words if len(w) > 1 or w == "a"]  # "V1's" is no word of any language
    common = sum(w in _FUNCTION_WORDS for w in whole) / max(len(whole), 1)
    if len(whole) >= 25 and common < 0.12:
        raise BadInput(f"{source}: does not read like English ({common:.0%} common words, 12 % expected): translate it")
    return text


def diagram(raw: bytes, source: Path) -> Diagram:
    """A picture, encoded again as RGB PNG of at most 2048 px a side. Raises BadInput if it cannot be read."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the limit below is stricter than Pillow's
            picture = opened(raw)
            if picture.width * picture.height > MAX_PIXELS:
                raise BadInput(
                    f"{source}: {picture.width} x {picture.height} pixels, the limit is {MAX_PIXELS:,}: scale it down"
                )
            flat = _on_white(ImageOps.exif_transpose(picture))
    except Image.DecompressionBombError as fault:
        raise BadInput(f"{source}: {fault}; the limit is {MAX_PIXELS:,} pixels: scale it down") from fault
    except UnidentifiedImageError as fault:  # its text names an object of ours
        raise BadInput(
            f"{source}: no picture of a kind that is read: give PNG, JPEG, GIF, BMP, TIFF or WebP"
        ) from fault
    except UNREADABLE as fault:
        raise BadInput(f"{source}: no readable picture ({fault}): give {PICTURE_KINDS}") from fault
    if max(flat.size) > MAX_SIDE_PX:
        flat.thumbnail((MAX_SIDE_PX, MAX_SIDE_PX))
    out = io.BytesIO()
    flat.save(out, "PNG")
    return Diagram(png=out.getvalue(), width_px=flat.width, height_px=flat.height)


def _on_white(picture: Image.Image) -> Image.Image:
    """The picture as RGB; transparent parts become white, 16 bits a pixel become 8."""
    if picture.mode.startswith("I"):
        deep = np.asarray(picture).astype(np.int64)
        return Image.fromarray((deep >> 8).clip(0, 255).astype(np.uint8)).convert("RGB")
    if picture.mode not in ("RGBA", "LA", "PA") and "transparency" not in picture.info:
        return picture.convert("RGB")
    layer = picture.convert("RGBA")
    paper = Image.new("RGBA", layer.size, "white")
    return Image.alpha_composite(paper, layer).convert("RGB")


def coded_lines(coded: dict[str, object], path: str = "") -> str:
    """Coded fields as one "name: value" line each, for a prompt and for the rules."""
    lines = []
    for key, value in coded.items():
        name = f"{path}{key}".replace("_", " ")
        if isinstance(value, dict):
            lines.append(coded_lines(value, f"{name} "))
        elif isinstance(value, (list, tuple)):
            lines += [
                coded_lines(v if isinstance(v, dict) else {"": v}, f"{name} {i} ") for i, v in enumerate(value, 1)
            ]
        elif value is not None:
            lines.append(f"{name.strip()}: {value}")
    return "\n".join(line for line in lines if line)
