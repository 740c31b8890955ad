"""The embedded model's view of a crash diagram: cropped, fitted to a grid of patches, thin lines kept dark.

Ink is averaged and then raised to a power below one, since a one-pixel line would disappear when a drawing of 1300
pixels shrinks to 384. Needs Pillow and numpy only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

IMAGE = "<|image_pad|>"
"""The token that stands for a drawing in a prompt."""
PATCH = 24
"""Pixels of the sheet along a patch."""
GRIDS = ((16, 16), (12, 20), (20, 12), (10, 24), (24, 10), (8, 32), (32, 8))
"""Rows and columns of patches; at most 256 patches, 64 tokens."""
GAMMA = 0.55
VIEWS = ((1.0, 0, 0), (0.94, -16, -16), (0.9, 16, 16), (0.97, 12, -12), (0.92, -12, 12))
"""Scale and shift (pixels of the sheet) of the views of one drawing. The edges of the tokens, 48 pixels apart, cut each
view elsewhere, so a line or a vehicle that one view reads badly another may read well."""
Floats = NDArray[np.float32]


def crop_box(ink: NDArray[np.uint8]) -> tuple[int, int, int, int]:
    """The part of a drawing that holds ink, with a small margin; (left, top, right, bottom)."""
    rows, columns = np.flatnonzero(ink.max(axis=1) > 60), np.flatnonzero(ink.max(axis=0) > 60)
    height, width = ink.shape
    if not len(rows) or not len(columns):
        return 0, 0, width, height
    margin = max(2, round(0.01 * max(height, width)))
    return (max(0, int(columns[0]) - margin), max(0, int(rows[0]) - margin), min(width, int(columns[-1]) + margin + 1),
            min(height, int(rows[-1]) + margin + 1))  # fmt: skip


def fit_grid(width: int, height: int) -> tuple[int, int]:
    """The grid whose shape is nearest to a picture's."""
    return min(GRIDS, key=lambda g: abs(np.log(g[1] / g[0]) - np.log(width / height)))


@dataclass(frozen=True)
class Fit:
    """How a drawing is laid on the model's sheet: crop, then scale, then shift."""

    box: tuple[int, int, int, int]
    grid: tuple[int, int]
    scale: float
    shift: tuple[int, int] = (0, 0)
    """Pixels of the sheet by which the crop lies off the middle, as far as there is room."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the crop on the sheet."""
        width, height = self.box[2] - self.box[0], self.box[3] - self.box[1]
        return max(1, round(width * self.scale)), max(1, round(height * self.scale))

    @property
    def corner(self) -> tuple[int, int]:
        """Left and top of the crop on the sheet."""
        rooms = (self.grid[1] * PATCH - self.size[0], self.grid[0] * PATCH - self.size[1])
        left, top = (min(max(room // 2 + by, 0), room) for room, by in zip(rooms, self.shift, strict=True))
        return left, top

    def __call__(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pixels of the drawing (n, 2) to pixels of the sheet."""
        laid: NDArray[np.float64] = (points - np.array(self.box[:2])) * self.scale + np.array(self.corner)
        return laid


def fit(image: Image.Image, view: int = 0) -> Fit:
    """Crop, grid and scale of a drawing, in one of its VIEWS."""
    box = crop_box(255 - np.asarray(image.convert("L")))
    width, height = box[2] - box[0], box[3] - box[1]
    grid = fit_grid(width, height)
    scale, right, down = VIEWS[view]
    return Fit(box, grid, scale * min(grid[1] * PATCH / width, grid[0] * PATCH / height), (right, down))


def look(image: Image.Image, view: int = 0) -> tuple[NDArray[np.uint8], tuple[int, int]]:
    """Ink of each color, (3, H, W) from 0 (white) to 255, and the grid of patches (rows, columns)."""
    rgb = image.convert("RGB")
    laid = fit(rgb, view)
    small = rgb.crop(laid.box).resize(laid.size, Image.Resampling.BOX if laid.scale < 1 else Image.Resampling.BILINEAR)
    (at_x, at_y), size = laid.corner, laid.size
    sheet = np.zeros((3, laid.grid[0] * PATCH, laid.grid[1] * PATCH), np.uint8)
    sheet[:, at_y : at_y + size[1], at_x : at_x + size[0]] = _INKED[np.asarray(small).transpose(2, 0, 1)]
    return sheet, laid.grid


_INKED = np.round(255 * (1 - np.arange(256) / 255) ** GAMMA).astype(np.uint8)
"""Ink of each brightness."""


# ------------------------------------------------------------------ turning
_TURNS = {1: Image.Transpose.ROTATE_270, 2: Image.Transpose.ROTATE_180, 3: Image.Transpose.ROTATE_90}


def quarters_of(turn: float) -> int:
    """Quarter turns (0 to 3) nearest to an angle in radians, counter-clockwise."""
    return round(turn / (np.pi / 2)) % 4


def turn_upright(image: Image.Image, quarters: int) -> Image.Image:
    """A drawing that is turned by quarters counter-clockwise, turned back."""
    return image.transpose(_TURNS[quarters]) if quarters % 4 else image


def turn_points(points: NDArray[np.float64], size: tuple[int, int], quarters: int) -> NDArray[np.float64]:
    """Where the pixels (n, 2) of a drawing of (width, height) go when it is turned back."""
    x, y = points[:, 0], points[:, 1]
    width, height = size
    return np.stack(
        {0: (x, y), 1: (height - y, x), 2: (width - x, height - y), 3: (y, width - x)}[quarters % 4], axis=1
    )


def place(height: int, width: int) -> Floats:
    """The two place channels, -1 to 1 along the longer side."""
    longest = max(height, width) / 2
    y = (np.arange(height, dtype=np.float32) - height / 2) / longest
    x = (np.arange(width, dtype=np.float32) - width / 2) / longest
    return np.stack((np.broadcast_to(x, (height, width)), np.broadcast_to(y[:, None], (height, width))))


def places(grid: tuple[int, int]) -> NDArray[np.int64]:
    """Row and column of each patch in that order, (rows * columns, 2)."""
    rows, columns = grid
    index = np.stack(np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"), axis=-1)
    cut = index.reshape(rows // 2, 2, columns // 2, 2, 2)
    return cut.transpose(0, 2, 1, 3, 4).reshape(-1, 2)
