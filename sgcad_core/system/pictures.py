"""The one place that opens pictures: by a list of formats, so that a file's first bytes choose no other decoder.

Pillow hands an EPS to Ghostscript, a program that runs the file; formats that are not in the list are never tried.
"""

from __future__ import annotations

import io
from pathlib import Path

from PIL import Image

FORMATS = ("PNG", "JPEG", "GIF", "BMP", "TIFF", "WEBP")


def opened(picture: bytes | Path) -> Image.Image:
    """A picture of one of FORMATS, to be closed by the caller. Raises UnidentifiedImageError for any other."""
    return Image.open(io.BytesIO(picture) if isinstance(picture, bytes) else picture, formats=FORMATS)
