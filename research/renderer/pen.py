"""Pencil and paper: world to pixels, dashed lines, arrows, boxes, car icons, captions.

Knows Pillow; knows nothing of crashes.
"""

from __future__ import annotations

import math
from functools import cache
from random import Random
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from research.renderer.lines import Points

Color = tuple[int, int, int]
BLACK: Color = (0, 0, 0)


@cache
def font(size: int) -> Any:
    """Pillow's own font at a size in pixels."""
    return ImageFont.load_default(size)


class Pen:
    """A sheet with a view: metres times `scale`, turned by `turn` (counter-clockwise), centered on `center`."""

    def __init__(
        self, rng: Random, width: int, height: int, scale: float, turn: float, center: tuple[float, float]
    ) -> None:
        self.rng, self.scale, self.turn, self.center = rng, scale, turn, center
        self.image = Image.new("RGB", (width, height), "white")
        self.draw = ImageDraw.Draw(self.image)

    def px(self, points: Points) -> Points:
        """World points to pixels, (n, 2)."""
        c, s = math.cos(self.turn), math.sin(self.turn)
        p = np.asarray(points, float).reshape(-1, 2) - self.center
        x, y = p[:, 0] * c - p[:, 1] * s, p[:, 0] * s + p[:, 1] * c
        return np.stack((self.image.width / 2 + x * self.scale, self.image.height / 2 - y * self.scale), axis=1)

    def shows(self, points: Points, margin: float) -> bool:
        """Whether world points lie on the sheet, a share of its sides away from its edges."""
        seen = self.px(points) / self.image.size
        return bool(((seen > margin) & (seen < 1 - margin)).all())

    def line(self, points: Points, width: int = 2, color: Color = BLACK, dash: float = 0.0, gap: float = 0.0) -> None:
        """A line through world points; dash and gap in metres."""
        if not dash:
            self.draw.line([tuple(p) for p in self.px(points)], fill=color, width=width, joint="curve")
            return
        step = float(np.hypot(*(points[1] - points[0]))) if len(points) > 1 else 1.0
        on, period = max(1, int(dash / step)), max(2, int((dash + gap) / step))
        for start in range(0, len(points) - 1, period):
            piece = points[start : start + on + 1]
            if len(piece) > 1:
                self.draw.line([tuple(p) for p in self.px(piece)], fill=color, width=width)

    def polygon(self, points: Points, fill: Color | None = None, outline: Color | None = BLACK, width: int = 1) -> None:
        """A closed shape of world points."""
        self.draw.polygon([tuple(p) for p in self.px(points)], fill=fill, outline=outline, width=width)

    def arrow(
        self, start: Points, end: Points, width: int = 2, head: float = 9.0, color: Color = BLACK, barb: float = 0.0
    ) -> None:
        """An arrow between two pixel points; `barb` is how far its head is notched, as a share."""
        start, end = np.asarray(start, float), np.asarray(end, float)
        self.draw.line([tuple(start), tuple(end)], fill=color, width=width)
        self.head(end, math.atan2(*(end - start)[::-1]), head, color, barb)

    def head(self, tip: Points, angle: float, size: float, color: Color = BLACK, barb: float = 0.0) -> None:
        """A filled arrow head in pixels."""
        sides = [(tip[0] - size * math.cos(angle + d), tip[1] - size * math.sin(angle + d)) for d in (-0.4, 0.4)]
        notch = [(tip[0] - size * (1 - barb) * math.cos(angle), tip[1] - size * (1 - barb) * math.sin(angle))]
        self.draw.polygon([tuple(tip), sides[0], *(notch if barb else []), sides[1]], fill=color)

    def text(self, x: float, y: float, text: str, size: int, color: Color = BLACK, angle: float = 0.0) -> None:
        """Text centered at a pixel, turned by degrees."""
        if not angle:
            self.draw.text((x, y), text, fill=color, font=font(size), anchor="mm")
            return
        box = self.draw.textbbox((0, 0), text, font=font(size), anchor="mm")
        w, h = int(box[2] - box[0]) + 6, int(box[3] - box[1]) + 6
        stamp = Image.new("L", (w, h), 0)
        ImageDraw.Draw(stamp).text((w / 2, h / 2), text, fill=255, font=font(size), anchor="mm")
        stamp = stamp.rotate(angle, expand=True)
        self.image.paste(color, (int(x - stamp.width / 2), int(y - stamp.height / 2)), stamp)
