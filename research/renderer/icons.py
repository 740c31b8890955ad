"""Vehicles, people and things at one pose: boxes, car icons, and symbols for what is small.

A motorcycle to scale has five pixels across on the sheet that the model sees, and a box of that size could as well be a
bicycle; investigators draw a symbol there and write its name beside it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import numpy as np

from research.renderer.boxes import Pose, corners, within
from research.renderer.lines import Points
from research.renderer.pen import BLACK, Color, Pen
from research.renderer.poses import Track
from sgcad_core.kinds import actor_kind
from sgcad_core.kinds.actors import Symbol

WHITE: Color = (255, 255, 255)
GRAY: Color = (120, 120, 120)
NAME = 11
"""Pixels of a name beside a symbol."""


@dataclass(frozen=True)
class Look:
    """How a vehicle is drawn at one pose."""

    style: str = "box"
    label: bool = True
    ghost: bool = False
    """Paler than at others."""
    dashed: bool = False
    """Outlined by dashes."""


def vehicle(rng: Random, pen: Pen, track: Track, pose: Pose, color: Color, look: Look) -> None:
    """One actor at one of its poses."""
    symbol, size, style, label = actor_kind(track.actor.kind).symbol, track.size, look.style, look.label
    if symbol == "thing":
        _thing(pen, pose, size, color, rng.choice(("", "tree", "pole")))
        return
    if symbol == "person":
        _person(pen, pose, size, color, track.actor.id)
        return
    fill: Color = tuple(round(0.3 * c + 0.7 * 255) for c in color) if look.ghost else color  # type: ignore[assignment]
    if symbol in ("motorcycle", "bicycle"):
        _two_wheels(pen, pose, size, fill, symbol)
        if label:
            _beside(pen, pose, size, track.actor.id)
        return
    if symbol == "truck":
        _truck(pen, pose, size, fill)
    elif look.dashed:
        pen.polygon(corners(pose, size), fill, None)
        _dashes(pen, corners(pose, size))
    else:
        pen.polygon(corners(pose, size), fill, BLACK, 1)
    if symbol == "bus":
        _windows(pen, pose, size, fill)
    elif style == "icon":
        _glass(pen, pose, size, symbol, WHITE if fill != WHITE else GRAY)
    if style == "box":
        _triangle(pen, pose, size, WHITE if sum(fill) < 700 else GRAY)
    if label:
        _name(pen, track, pose, fill, style)


def _name(pen: Pen, track: Track, pose: Pose, fill: Color, style: str) -> None:
    """An actor's name on its box, along it unless that stands on end."""
    x, y = pen.px(within(pose, track.size, [(-0.16 if style == "box" else -0.1, 0.0)]))[0]
    ink = WHITE if sum(fill) < 300 or (style == "box" and sum(fill) < 450) else BLACK
    angle = (math.degrees(pose.heading + pen.turn) + 90) % 180 - 90
    lies = abs(math.cos(math.radians(angle))) > 0.2
    pen.text(x, y, track.actor.id, max(8, int(track.size[1] * 0.72 * pen.scale)), ink, angle if lies else 90)


def _beside(pen: Pen, pose: Pose, size: tuple[float, float], name: str) -> None:
    """A name to the left of what is too small to bear it."""
    away = size[1] / 2 + 0.8 * NAME / pen.scale
    x, y = pen.px(within(pose, (1.0, 1.0), [(0.0, away)]))[0]
    pen.text(x, y, name, NAME)


def _part(
    pen: Pen,
    pose: Pose,
    size: tuple[float, float],
    middle: tuple[float, float],
    share: tuple[float, float],
    color: Color,
) -> None:
    """A box within a box, in shares of it."""
    x, y = within(pose, size, [middle])[0]
    pen.polygon(corners(Pose(x, y, pose.heading), (size[0] * share[0], size[1] * share[1])), color, BLACK, 1)


def _triangle(pen: Pen, pose: Pose, size: tuple[float, float], color: Color) -> None:
    pen.polygon(within(pose, size, [(0.47, 0.0), (0.2, 0.34), (0.2, -0.34)]), color, BLACK, 1)


def _glass(pen: Pen, pose: Pose, size: tuple[float, float], symbol: Symbol, color: Color) -> None:
    """A curved windshield behind the hood, and of a car another before its trunk; what has a longer body has a shorter
    hood."""
    hood = 0.22 if symbol == "car" else 0.32
    bands = [(hood, 1.0)] + ([(-0.3, -1.0)] if symbol == "car" else [(-0.08, 1.0)] if symbol == "pickup" else [])
    for at, bends in bands:
        outer = [(at + bends * (0.05 - 0.2 * side * side), side) for side in (-0.44, -0.22, 0.0, 0.22, 0.44)]
        inner = [(along - bends * 0.1, 0.9 * side) for along, side in reversed(outer)]
        pen.polygon(within(pose, size, outer + inner), color, None)


def _dashes(pen: Pen, box: Points) -> None:
    """The outline of a box by dashes of three pixels."""
    points = pen.px(box)
    for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
        steps = max(1, int(np.hypot(*(b - a)) / 6))
        for k in range(steps):
            ends = a + (b - a) * k / steps, a + (b - a) * (k + 0.5) / steps
            pen.draw.line([tuple(p) for p in ends], fill=BLACK, width=1)


def _truck(pen: Pen, pose: Pose, size: tuple[float, float], fill: Color) -> None:
    """Tractor and trailer."""
    _part(pen, pose, size, (0.4, 0.0), (0.2, 1.0), fill)
    _part(pen, pose, size, (-0.12, 0.0), (0.76, 1.0), fill)


def _windows(pen: Pen, pose: Pose, size: tuple[float, float], fill: Color) -> None:
    """Windows along both sides of a bus, and its windshield."""
    pane = WHITE if sum(fill) < 650 else GRAY
    for along in (-0.38, -0.22, -0.06, 0.1, 0.26):
        for side in (-0.36, 0.36):
            _part(pen, pose, size, (along, side), (0.1, 0.18), pane)
    _part(pen, pose, size, (0.44, 0.0), (0.05, 0.8), pane)


def _two_wheels(pen: Pen, pose: Pose, size: tuple[float, float], fill: Color, symbol: Symbol) -> None:
    """Handlebars ahead; a motorcycle with a body between dark wheels, a bicycle of two rings and a bar."""
    bars = pen.px(within(pose, size, [(0.24, 0.5), (0.24, -0.5)]))
    if symbol == "motorcycle":
        for along in (-0.38, 0.38):
            _part(pen, pose, size, (along, 0.0), (0.24, 0.36), BLACK)
        pen.polygon(
            within(pose, size, [(0.3, 0.1), (0.1, 0.36), (-0.3, 0.3), (-0.3, -0.3), (0.1, -0.36), (0.3, -0.1)]), fill
        )
        width = 2
    else:
        radius = max(3.0, 0.24 * size[0] * pen.scale)
        ends = pen.px(within(pose, size, [(-0.3, 0.0), (0.3, 0.0)]))
        pen.draw.line([tuple(p) for p in ends], fill=fill if sum(fill) < 650 else GRAY, width=2)
        for x, y in ends:
            pen.draw.ellipse((x - radius, y - radius, x + radius, y + radius), outline=BLACK)
        width = 1
    pen.draw.line([tuple(p) for p in bars], fill=BLACK, width=width)


def _thing(pen: Pen, pose: Pose, size: tuple[float, float], color: Color, text: str) -> None:
    """A tree or a pole: a disk with a cross in it."""
    (x, y), r = pen.px(within(pose, size, [(0.0, 0.0)]))[0], max(5.0, size[0] * pen.scale * 0.6)
    pen.draw.ellipse((x - r, y - r, x + r, y + r), fill=color, outline=BLACK)
    arm = 0.7 * r
    for way in (-1, 1):
        pen.draw.line([(x - arm, y - way * arm), (x + arm, y + way * arm)], fill=WHITE, width=1)
    if text:
        pen.text(x, y + r + 7, text, NAME)


def _person(pen: Pen, pose: Pose, size: tuple[float, float], color: Color, name: str) -> None:
    """A figure of strokes, upright on the sheet however that is turned."""
    (x, y), r = pen.px(within(pose, size, [(0.0, 0.0)]))[0], max(7.0, size[0] * pen.scale * 0.8)
    head = 0.34 * r
    strokes = [((0, -0.4), (0, 0.3)), ((-0.55, -0.1), (0.55, -0.1)), ((0, 0.3), (-0.4, 1.0)), ((0, 0.3), (0.4, 1.0))]
    for start, end in strokes:
        pen.draw.line([(x + r * a, y + r * b) for a, b in (start, end)], fill=color, width=2)
    pen.draw.ellipse((x - head, y - r, x + head, y - r + 2 * head), fill=color, outline=BLACK)
    pen.text(x, y + r + 7, name, NAME)
