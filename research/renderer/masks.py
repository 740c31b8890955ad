"""Masks of pavement: what a drawing shows of them is their outline, with round corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFilter


def grow(inside: NDArray[np.bool_], width: int) -> NDArray[np.bool_]:
    """A mask with `width` pixels more on every side (shifts of an array: far faster than a rank filter)."""
    grown = inside
    for _ in range(width):
        wider = grown.copy()
        wider[1:] |= grown[:-1]
        wider[:-1] |= grown[1:]
        wider[:, 1:] |= grown[:, :-1]
        wider[:, :-1] |= grown[:, 1:]
        grown = wider
    return grown


def outline(area: Image.Image, width: int, away: int = 0) -> Image.Image:
    """The ring of `width` pixels around a mask, `away` pixels from it."""
    inside = grow(np.asarray(area) > 0, away)
    return Image.fromarray((grow(inside, width) & ~inside).astype(np.uint8) * 255)


def rounded(area: Image.Image, radius: float) -> Image.Image:
    """A mask with the corners of what it covers rounded, and filled where two shapes meet; radius in pixels."""
    return area.filter(ImageFilter.BoxBlur(radius)).point(lambda v: 255 if v > 128 else 0)
