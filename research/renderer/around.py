"""What stands around a made drawing: north arrow, captions, and what copying does to the sheet."""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random
from typing import Any

import numpy as np
from PIL import Image, ImageFilter

from research.renderer.lines import Points
from research.renderer.pen import BLACK, Pen, font
from research.rows import evidence_labels

NOTES = (
    "Speed limit {n} mph",
    "Speed Limit - {k} kmph ({n} mph)",
    "posted speed limit {n} mph ({k} kph)",
    "FRPs not supported by evidence",
    "No physical evidence",
    "POI & FRPs not supported by evidence",
    "V1 - {y} Ford Taurus, 4-door sedan",
    "V2 - {y} Jeep, 4-door utility",
    "Not to scale",
    "paved shoulder",
    "gravel",
    "Lawn",
    "telephone pole",
    "witness stood here",
    "measured from this curb",
    "V1 - {y} Saturn, wagon\nV2 - {y} Mazda, pickup",
    "N/S road {n} mph, E/W road {n} mph",
)
TRIES = 12


@dataclass(frozen=True)
class Shape:
    """A part of a drawing: corners in pixels (n, 2), what it shows as indices into `evidence_labels.PICTURE`, and the
    least share of a token that it must cover to be asked for there."""

    corners: Points
    tags: list[int]
    least: float


def north_arrow(rng: Random, pen: Pen) -> list[Shape]:
    """An arrow with an N; missing now and then where north is up."""
    if abs(pen.turn) < 0.01 and rng.random() < 0.08:
        return []
    length = rng.uniform(9, 18) if rng.random() < 0.35 else rng.uniform(14, 46)
    x, y = _free(rng, pen.image, length)
    up = np.array([math.cos(math.pi / 2 + pen.turn), -math.sin(math.pi / 2 + pen.turn)])
    center, size = np.array([x, y]), max(7.0, length * rng.uniform(0.36, 0.95))
    pen.draw.rectangle((x - length * 0.7, y - length * 0.7, x + length * 0.7, y + length * 0.7), fill="white")
    head, width = max(4.0, length * rng.uniform(0.2, 0.4)), 1 if length < 24 else rng.choice((1, 1, 2, 2, 3))
    tail, tip, place = _arrow_and_letter(rng, center, up, length, size)
    pen.arrow(tail, tip, width=width, head=head, barb=rng.choice((0.0, 0.3, 0.45)))
    angle = math.degrees(pen.turn) if rng.random() < 0.4 else 0.0
    name, size = ("North", 0.5 * size) if rng.random() < 0.06 else ("N", size)
    for bold in range(rng.choice((1, 2, 2))):
        pen.text(place[0] + bold, place[1], name, round(max(7.0, size)), angle=angle)
    square = center + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * length * 0.5
    return [Shape(square, [evidence_labels.PICTURE[f"north={round(-pen.turn / (math.pi / 4)) % 8}"]], 0.1)]


def _free(rng: Random, image: Image.Image, length: float) -> tuple[float, float]:
    """The middle (pixels) of a place for a north arrow near an edge of the sheet, where nothing is drawn if there is
    room."""
    w, h = image.size
    x = y = 0.0
    for _ in range(TRIES):
        x = rng.choice((rng.uniform(0.06, 0.3), rng.uniform(0.7, 0.94), rng.uniform(0.3, 0.7))) * w
        y = rng.choice((rng.uniform(0.02, 0.25), rng.uniform(0.75, 0.94))) * h
        x, y = min(max(x, length), w - length), min(max(y, length), h - length)
        if _blank(image, (x - length, y - length, x + length, y + length)):
            break
    return x, y


def _blank(image: Image.Image, box: tuple[float, float, float, float]) -> bool:
    """Whether nothing is drawn in a box (left, top, right, bottom in pixels)."""
    left, top, right, bottom = (int(edge) for edge in box)
    return bool(np.asarray(image.crop((left, top, right, bottom)).convert("L")).min(initial=255) > 250)


def _arrow_and_letter(rng: Random, center: Points, up: Points, length: float, size: float) -> tuple[Points, ...]:
    """Tail, tip and the middle of the N (pixels): before the tip, behind the tail, or at one side of the arrow."""
    manner = rng.random()
    if manner < 0.35:
        tail, tip = center - up * length * 0.5, center + up * length * 0.3
        return tail, tip, tip + up * (size * rng.uniform(0.5, 0.8) + rng.choice((0.0, 0.0, 2.0, 5.0)))
    if manner < 0.7:
        tail, tip = center - up * length * 0.25, center + up * length * 0.5
        return tail, tip, tail - up * size * rng.uniform(0.42, 0.65)
    aside = np.array([-up[1], up[0]]) * rng.choice((1, -1))
    along = up * length * rng.choice((0.0, 0.0, 0.2, -0.2))
    return center - up * length * 0.5, center + up * length * 0.5, center + along + aside * size * rng.uniform(0.5, 1.1)


def captions(rng: Random, pen: Pen, actors: int) -> None:
    """Notes as investigators leave them, some over the drawing, none of more actors than there are."""
    w, h = pen.image.size
    notes = [note for note in NOTES if actors > 1 or "V2" not in note]
    n = rng.choice((25, 35, 45, 55, 70))
    for _ in range(rng.choice((0, 1, 1, 2, 3))):
        text = rng.choice(notes).format(n=n, k=round(n * 1.609), y=rng.randint(1990, 2007))
        size = rng.choice((9, 10, 12, 14))
        for _ in range(TRIES):
            x, y = rng.uniform(0.2, 0.8) * w, rng.choice((rng.uniform(0.03, 0.2), rng.uniform(0.82, 0.97))) * h
            box = pen.draw.textbbox((x, y), text, font=font(size), anchor="mm")
            if 0 < box[0] < box[2] < w and _blank(pen.image, box):
                break
        pen.text(x, y, text, size)
    if rng.random() < 0.15:
        x, y = rng.uniform(0.1, 0.9) * w, rng.uniform(0.1, 0.9) * h
        pen.draw.line([(x, y), (x + rng.uniform(-60, 60), y + rng.uniform(-40, 40))], fill=BLACK, width=1)


def scan(rng: Random, image: Image.Image, gray: bool = True) -> Image.Image:
    """What copying does: gray (where that may be), blur, low resolution, skew, specks; most drawings are clean."""
    if rng.random() < 0.06 and gray:
        image = image.convert("L").convert("RGB")
    if rng.random() < 0.15:
        factor = rng.uniform(0.45, 0.8)
        small = image.resize((int(image.width * factor), int(image.height * factor)), Image.Resampling.BILINEAR)
        image = small.resize(image.size, Image.Resampling.BILINEAR)
    if rng.random() < 0.12:
        image = image.filter(ImageFilter.GaussianBlur(rng.uniform(0.4, 1.1)))
    if rng.random() < 0.12:
        image = image.rotate(rng.uniform(-2.5, 2.5), fillcolor="white", resample=Image.Resampling.BILINEAR)
    if rng.random() < 0.1:
        image = _specks(rng, image)
    return image


def _specks(rng: Random, image: Image.Image) -> Any:
    noise = np.random.default_rng(rng.randrange(2**32))
    pixels = np.asarray(image, np.int16) + noise.normal(0, rng.uniform(3, 14), (image.height, image.width, 1)).astype(
        np.int16
    )
    return Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8))
