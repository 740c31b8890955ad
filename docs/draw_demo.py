"""Draws the crash diagrams of the bundled reports: `python docs/draw_demo.py`. Needs Pillow alone.

In the manner of NHTSA's scene diagrams: black road edges on white, dashed and double lines, vehicles as
boxes at successive places, a north arrow. Coordinates are pixels of the finished picture.
"""

from __future__ import annotations

import math
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

SCALE = 3  # drawn large, then reduced: smooth lines
DEMO = Path(__file__).resolve().parent / "demo"
RED, BLUE = "#d03a2a", "#2f7fb8"


class Sheet:
    """A white sheet with the few strokes that a scene diagram needs."""

    def __init__(self, width: int, height: int) -> None:
        self.image = Image.new("RGB", (width * SCALE, height * SCALE), "white")
        self.pen = ImageDraw.Draw(self.image)

    def line(self, *points: tuple[float, float], width: float = 1.6, color: str = "black") -> None:
        """A polyline."""
        self.pen.line([(x * SCALE, y * SCALE) for x, y in points], fill=color, width=round(width * SCALE))

    def dashed(self, a: tuple[float, float], b: tuple[float, float]) -> None:
        """A lane line."""
        n = int(math.dist(a, b) / 16)
        for i in range(n):
            p, q = i / n, (i + 0.55) / n
            self.line((a[0] + (b[0] - a[0]) * p, a[1] + (b[1] - a[1]) * p),
                      (a[0] + (b[0] - a[0]) * q, a[1] + (b[1] - a[1]) * q), width=1.2)  # fmt: skip

    def double(self, a: tuple[float, float], b: tuple[float, float]) -> None:
        """A double centerline."""
        dx, dy = (1.8, 0) if a[0] == b[0] else (0, 1.8)
        for sign in (-1, 1):
            self.line((a[0] + sign * dx, a[1] + sign * dy), (b[0] + sign * dx, b[1] + sign * dy), width=1.1)

    def corner(self, x: float, y: float, quadrant: int, radius: float = 16) -> None:
        """A rounded curb; quadrant 0 right-below, 1 left-below, 2 left-above, 3 right-above of (x, y)."""
        cx, cy = x + (radius if quadrant in (0, 3) else -radius), y + (radius if quadrant in (0, 1) else -radius)
        start = {0: 180, 1: 270, 2: 0, 3: 90}[quadrant]
        box = [(cx - radius) * SCALE, (cy - radius) * SCALE, (cx + radius) * SCALE, (cy + radius) * SCALE]
        self.pen.arc(box, start, start + 90, fill="black", width=round(1.6 * SCALE))

    def car(self, x: float, y: float, heading_deg: float, name: str, color: str, length: float = 46) -> None:
        """A vehicle; heading clockwise from up, its front marked by a triangle."""
        h = math.radians(heading_deg)
        ahead, side = (math.sin(h), -math.cos(h)), (math.cos(h), math.sin(h))

        def at(along: float, across: float) -> tuple[float, float]:
            return tuple((c + along * a + across * s) * SCALE for c, a, s in zip((x, y), ahead, side, strict=True))

        a, w = length / 2, 10
        self.pen.polygon([at(a, -w), at(a, w), at(-a, w), at(-a, -w)], fill=color, outline="black")
        self.pen.polygon([at(a - 3, 0), at(a - 14, 7), at(a - 14, -7)], fill="white")
        self.text(x - ahead[0] * 9, y - ahead[1] * 9, name, 11, "white", center=True)

    def arrow(self, *points: tuple[float, float], width: float = 1.3) -> None:
        """A path with a head at its end."""
        self.line(*points, width=width)
        (x0, y0), (x1, y1) = points[-2:]
        h = math.atan2(y1 - y0, x1 - x0)
        head = [(x1, y1)] + [(x1 + 9 * math.cos(h + t), y1 + 9 * math.sin(h + t)) for t in (2.75, -2.75)]
        self.pen.polygon([(x * SCALE, y * SCALE) for x, y in head], fill="black")

    def text(self, x: float, y: float, words: str, size: int = 12, color: str = "black", center: bool = False) -> None:
        """A caption."""
        font = ImageFont.load_default(size * SCALE)
        self.pen.text((x * SCALE, y * SCALE), words, fill=color, font=font, anchor="mm" if center else "lm")

    def save(self, case: str) -> None:
        """Reduce and write diagram.png of a case."""
        width, height = (n // SCALE for n in self.image.size)
        self.image.resize((width, height), Image.Resampling.LANCZOS).save(DEMO / case / "diagram.png", optimize=True)


def left_turn_at_signal() -> None:
    """Four legs; 2 + left-turn lane northbound; V1 turns left across V2."""
    s = Sheet(640, 520)
    left, right, top, bottom = 245, 395, 215, 275  # curbs of the street (five lanes of 30) and of the cross road
    north_right = 365  # no turn lane there
    for x, y0, y1 in (
        (left, 0, top - 16),
        (north_right, 0, top - 16),
        (left, bottom + 16, 520),
        (right, bottom + 16, 520),
    ):
        s.line((x, y0), (x, y1))
    for x0, x1, y in (
        (0, left - 16, top),
        (north_right + 16, 640, top),
        (0, left - 16, bottom),
        (right + 16, 640, bottom),
    ):
        s.line((x0, y), (x1, y))
    for x, y, q in ((left, top, 2), (north_right, top, 3), (left, bottom, 1), (right, bottom, 0)):
        s.corner(x, y, q)
    s.double((305, 0), (305, top - 10))
    s.double((305, bottom + 10), (305, 520))
    s.dashed((275, 0), (275, top - 10))
    s.dashed((275, bottom + 10), (275, 520))
    s.dashed((335, 0), (335, top - 10))
    s.dashed((365, bottom + 10), (365, 520))
    s.line((335, bottom + 10), (335, 430))
    s.double((0, 245), (left - 10, 245))
    s.double((right + 10, 245), (640, 245))
    s.arrow((320, 400), (320, 378), (308, 370))
    s.car(320, 470, 0, "V1", RED)
    s.arrow((320, 444), (320, 300), (300, 265))
    s.car(272, 248, 296, "V1", RED)
    s.car(260, 60, 180, "V2", BLUE, 48)
    s.arrow((260, 86), (260, 170))
    s.car(261, 212, 180, "V2", BLUE, 48)
    s.arrow((590, 80), (590, 36))
    s.text(590, 24, "N", 16, center=True)
    s.text(430, 190, "signal", 12)
    s.text(420, 480, "speed limit 35 mph (56 kmph)", 12)
    s.save("left-turn-at-signal")


def rear_end_on_arterial() -> None:
    """Four lanes, no junction; V1 runs into the standing V2."""
    s = Sheet(760, 230)
    for y in (45, 175):
        s.line((0, y), (760, y))
    s.double((0, 110), (760, 110))
    s.dashed((0, 77), (760, 77))
    s.dashed((0, 142), (760, 142))
    s.car(60, 158, 90, "V1", RED, 54)
    s.arrow((90, 158), (385, 158))
    s.car(425, 158, 90, "V1", RED, 54)
    s.car(478, 158, 90, "V2", BLUE)
    s.car(560, 158, 90, "", "#999999")
    s.arrow((715, 30), (715, 8))
    s.text(726, 16, "N", 14)
    s.text(16, 205, "posted speed limit 45 mph (72 kmph)", 12)
    s.text(560, 186, "queue", 10, center=True)
    s.save("rear-end-on-arterial")


def across_the_centerline() -> None:
    """Two lanes; V2 drifts over the centerline into V1. North is to the right of the sheet, so up is west."""
    s = Sheet(300, 620)
    for x in (100, 200):
        s.line((x, 0), (x, 620))
    s.dashed((150, 0), (150, 620))
    s.car(175, 560, 0, "V1", RED)
    s.arrow((175, 534), (175, 340))
    s.car(176, 300, 356, "V1", RED)
    s.car(125, 60, 180, "V2", BLUE, 52)
    s.arrow((125, 88), (128, 150), (160, 220))
    s.car(165, 250, 172, "V2", BLUE, 52)
    s.car(214, 400, 326, "V1", RED)  # where the replay ends: turned counterclockwise, off the north edge
    s.arrow((240, 40), (278, 40))
    s.text(288, 40, "N", 14, center=True)
    s.text(8, 590, "rural road", 12)
    s.save("across-the-centerline")


if __name__ == "__main__":
    left_turn_at_signal()
    rear_end_on_arterial()
    across_the_centerline()
