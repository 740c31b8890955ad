"""Vehicles and people at their poses, in the manner of one drawing: boxes or car icons, names, arrows between poses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import numpy as np

from research.generator.crash.world import Contact
from research.renderer import icons
from research.renderer.boxes import Pose, overlap
from research.renderer.lines import Points
from research.renderer.pen import BLACK, Color, Pen
from research.renderer.poses import Track
from sgcad_core.kinds import actor_kind

COLORS: dict[int, tuple[Color, ...]] = {
    1: ((255, 0, 0), (255, 0, 0), (230, 20, 20), (240, 15, 40), (190, 15, 20), (235, 40, 90)),
    2: ((192, 192, 192), (200, 200, 200), (150, 150, 150), (25, 90, 150), (10, 20, 210), (30, 140, 190)),
    3: ((15, 140, 50), (20, 110, 40), (30, 200, 60), (230, 180, 30)),
    4: ((230, 180, 30), (150, 60, 180)),
    5: ((150, 60, 180),),
}

CROSSED = 0.12
"""Share of drawings with a cross at the first impact."""


@dataclass(frozen=True)
class Manner:
    """How one investigator draws vehicles."""

    style: str
    links: bool
    """Arrows from pose to pose."""
    labels: bool
    """Names on the vehicles; without them only the colors tell who is who."""
    ghosts: bool
    """All poses but that of the impact are pale."""
    dashed: bool
    """All poses before the impact have dashed outlines."""
    rests: float
    """Share of the vehicles whose way to rest is drawn."""

    @classmethod
    def drawn(cls, rng: Random) -> Manner:
        """Boxes with arrows from each to the next and without places of rest, or car icons without arrows and with
        them, most often."""
        style = rng.choices(("box", "icon", "plain"), (36, 50, 14))[0]
        icon, labels = style == "icon", rng.random() < 0.95
        return cls(
            style=style,
            links=style == "plain" or rng.random() < (0.25 if icon else 0.85),
            labels=labels,
            ghosts=icon and labels and rng.random() < 0.2,
            dashed=icon and rng.random() < 0.6,
            rests=0.7 if icon else 0.3,
        )


def draw_tracks(rng: Random, pen: Pen, tracks: list[Track], manner: Manner, first: Contact) -> None:
    """Draws the actors: what came later lies below, the impact on top, so that each is seen where it counts."""
    order = list(tracks)
    rng.shuffle(order)
    colors = {track.actor.id: _color(rng, track, manner.labels) for track in order}
    layers = sorted(((t, i) for t in order for i in range(len(t.poses))), key=lambda at: _layer(*at))
    for track, i in layers if manner.links else ():
        if 0 < i <= track.contact:
            _link(pen, track, i, order)
    for track, i in layers:
        outside = i != track.contact
        seen = icons.Look(manner.style, manner.labels, manner.ghosts and outside, manner.dashed and i < track.contact)
        icons.vehicle(rng, pen, track, track.poses[i], colors[track.actor.id], seen)
    for track in order:
        if track.ahead is not None:
            _intended(pen, track.ahead, colors[track.actor.id])
    if rng.random() < CROSSED:
        at = [tracks[i].poses[tracks[i].contact] for i in (first.striker, first.struck)]
        x, y = pen.px(np.array([(pose.x, pose.y) for pose in at])).mean(axis=0)
        pen.draw.line([(x - 8, y), (x + 8, y)], fill=BLACK, width=2)
        pen.draw.line([(x, y - 8), (x, y + 8)], fill=BLACK, width=2)


def _layer(track: Track, index: int) -> int:
    return 0 if index > track.contact else 1 if index < track.contact else 2


def _color(rng: Random, track: Track, labels: bool) -> Color:
    if not track.actor.vehicle:
        return (
            rng.choice(((90, 60, 20), (20, 110, 40), (20, 20, 20)))
            if actor_kind(track.actor.kind).thing
            else rng.choice(((250, 150, 30), (20, 20, 20), (150, 30, 160)))
        )
    if rng.random() < 0.03 and labels:
        return (255, 255, 255)
    return rng.choice(COLORS[int(track.actor.id[1:])])


def _intended(pen: Pen, way: Points, color: Color) -> None:
    """A dashed arrow where one would have turned, in its color."""
    (width, head), ink = _stroke(pen), BLACK if sum(color) > 600 else color
    pen.line(way, width=width, color=ink, dash=1.5, gap=1.5)
    a, b = pen.px(way[-3:])[[0, -1]]
    pen.head(b, math.atan2(*(b - a)[::-1]), head, ink)


def _stroke(pen: Pen) -> tuple[int, float]:
    """Pixels of the shaft and of the head of an arrow that tells a way."""
    return 1 if pen.scale < 6 else 2, max(6.0, 1.1 * pen.scale)


def _link(pen: Pen, track: Track, index: int, others: list[Track]) -> None:
    """An arrow from one pose to the next, unless another actor stands between them."""
    before, after = track.poses[index - 1], track.poses[index]
    a, b = pen.px(np.array([(before.x, before.y), (after.x, after.y)]))
    gap = float(np.hypot(*(b - a)))
    margin = track.size[0] * pen.scale * 0.55
    if gap <= 2.6 * margin:
        return
    u = (b - a) / gap
    length = (gap - 2 * margin) / pen.scale
    shaft = Pose((before.x + after.x) / 2, (before.y + after.y) / 2, math.atan2(after.y - before.y, after.x - before.x))
    taken = [(pose, other.size) for other in others if other is not track for pose in other.poses[: other.contact + 1]]
    if not any(overlap(shaft, (length, 0.4), pose, size) for pose, size in taken):
        width, head = _stroke(pen)
        pen.arrow(a + u * margin, b - u * margin, width=width, head=head)
