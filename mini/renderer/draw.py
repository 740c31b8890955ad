"""A report's diagram: view, roads, vehicles at their poses, north arrow, captions, scan.

Everything follows from the report's seed. What a drawing tells is in `generator.targets.drawn_facts`; speeds and
names are only captions, too small to read at the size that the model sees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import numpy as np
from PIL import Image

from mini import tags
from mini.generator.report import Report
from mini.generator.world import Crash
from mini.renderer import accesses, icons
from mini.renderer.around import Shape, captions, north_arrow, scan
from mini.renderer.boxes import Pose, corners
from mini.renderer.lines import Ground, Points
from mini.renderer.pen import BLACK, Color, Pen
from mini.renderer.poses import Stage, Track
from mini.renderer.road_marks import RoadMarks

COLORS: dict[int, tuple[Color, ...]] = {
    1: ((230, 20, 20), (240, 15, 40), (190, 15, 20), (235, 40, 90)),
    2: ((200, 200, 200), (150, 150, 150), (175, 175, 175), (25, 90, 150), (10, 20, 210), (30, 140, 190)),
    3: ((15, 140, 50), (20, 110, 40), (30, 200, 60), (230, 180, 30)),
    4: ((230, 180, 30), (150, 60, 180)),
    5: ((150, 60, 180),),
}


QUEUED = 5.0
"""Metres of road more, either way, for each that runs into one ahead, so that where it came from is on the sheet."""
CENTERED = 0.8
"""Share of drawings in which a leg's pavement, not its center line, lies about the middle of the junction."""


@dataclass(frozen=True)
class Drawing:
    """A drawing as an investigator leaves it (RGB), what is where in it, and how far it is turned: radians
    counter-clockwise from north up."""

    image: Image.Image
    shapes: list[Shape]
    turn: float


def draw_report(report: Report) -> Image.Image:
    """The drawing of a report, RGB."""
    return draw_labeled(report).image


def draw_labeled(report: Report) -> Drawing:
    """The drawing of a report with its labels."""
    rng = Random(report.seed * 7 + 3)
    crash = report.shown or report.crash
    pen, ground = _sheet(rng, crash)
    tracks = Stage(rng, crash, ground, rng.uniform(1.0, 1.45)).tracks()
    _aim(rng, pen, tracks)
    marks = RoadMarks(rng, pen, crash, ground, [(pose, track.size) for track in tracks for pose in track.poses])
    arrows = any(fact.startswith("turns.") for fact in report.drawn)
    marks.draw(arrows=arrows, signs="control" in report.drawn)
    labels = _vehicles(rng, pen, tracks)
    shapes = _shapes(report, pen, ground, tracks, arrows) + north_arrow(rng, pen)
    captions(rng, pen, len(crash.actors))
    return Drawing(scan(rng, pen.image, gray=labels), shapes, pen.turn)


def _shapes(report: Report, pen: Pen, ground: Ground, tracks: list[Track], arrows: bool) -> list[Shape]:
    """The legs and the vehicles at their poses."""
    found, crash = [], report.shown or report.crash
    for band in ground.bands.values():
        s = np.arange(ground.setback(band.leg.bearing, 1.0), band.length, 2.0)
        outline = np.concatenate((band.at(s, band.right), band.at(s, band.left)[::-1]))
        shows = tags.drawn_leg(band.leg, "control" in report.drawn, arrows)
        found.append(Shape(pen.px(outline), shows, 0.3))
    for access in crash.accesses:
        mouth = accesses.box(pen, ground, access, 0.5, access.mouth or accesses.REACH)
        found.append(Shape(pen.px(mouth), [tags.PICTURE["access"]], 0.2))
    for track in tracks:
        for i, pose in enumerate(track.poses):
            when = "contact" if i == track.contact else "before" if i < track.contact else "after"
            faces = round((math.pi / 2 - pose.heading) / (math.pi / 4)) % 8
            shows = tags.drawn_actor(report.crash, track.actor, when, faces)
            found.append(Shape(pen.px(corners(pose, track.size)), shows, 0.04))
    return found


def _sheet(rng: Random, crash: Crash) -> tuple[Pen, Ground]:
    """View and ground; plain roads get wide sheets along the road, junctions nearly square ones."""
    plain = len(crash.legs) == 2
    turn = math.radians(rng.choices((0, 90, -90, 180, rng.uniform(-60, 60)), (62, 16, 12, 4, 6))[0])
    half = rng.uniform(21, 36) if not plain else rng.uniform(22, 48)
    wide = max(leg.lanes_in + leg.lanes_out for leg in crash.legs)
    actors = crash.actors
    queue = [c for c in crash.contacts if c.struck_area == "back" and actors[c.striker].leg == actors[c.struck].leg]
    half += 2.0 * wide + QUEUED * len(queue)
    used = {bearing for actor in crash.actors for bearing in (actor.leg, actor.out)}
    lengths = {leg.bearing: half * rng.uniform(0.85, 1.5) for leg in crash.legs}
    for leg in crash.legs:
        if leg.bearing not in used and not crash.is_main(leg.bearing):
            lengths[leg.bearing] = max(half * rng.uniform(0.3, 1.1), 12 + 2.0 * wide)
    for contact in queue:
        lengths[actors[contact.striker].leg] = max(lengths[actors[contact.striker].leg], 1.3 * half)
    curved = any(leg.curve != "none" for leg in crash.legs)
    radius, widths = rng.uniform(60, 140) if curved else 100.0, _lane_widths(rng, crash)
    ground = Ground(crash, lengths, radius, widths, centered=rng.random() < CENTERED)
    for bearing, band in ground.bands.items():
        clear = ground.setback(bearing, 1.0)
        band.length = max(band.length, clear + 12) if band.leg.mouth is None else clear + band.leg.mouth
    long = int(rng.uniform(400, 540))
    if plain and not curved:
        direction = math.radians(90 - 45 * crash.main) + turn
        short = int(long * rng.uniform(0.3, 0.75))
        size = (
            (long, short)
            if abs(math.cos(direction)) > 0.6
            else (short, long)
            if abs(math.cos(direction)) < 0.4
            else (long, long)
        )
    else:
        size = (long, int(long * rng.uniform(0.45 if crash.layout in ("t", "driveway") else 0.65, 1.0)))
        size = size if rng.random() < 0.75 else size[::-1]
    scale = max(size) / (2 * half) if plain else min(size) / (2 * half) * rng.uniform(1.0, 1.15)
    return Pen(rng, *size, scale, turn, (0.0, 0.0)), ground


def _lane_widths(rng: Random, crash: Crash) -> dict[int, float]:
    """Metres by axis: few drawings are to scale, and of two roads one may be drawn wider."""
    if rng.random() < 0.25:
        return {}
    base = rng.uniform(3.0, 4.7)
    return {axis: base * rng.uniform(0.85, 1.15) for axis in sorted({leg.bearing % 4 for leg in crash.legs})}


def _aim(rng: Random, pen: Pen, tracks: list[Track]) -> None:
    """Center the sheet somewhere between the hub and the impact, so that both are on it and, if that can be, where
    everyone came from."""
    at = [track.poses[track.contact] for track in tracks]
    came = [track.poses[track.contact - 1] for track in tracks if track.contact]
    x, y = sum(p.x for p in at) / len(at), sum(p.y for p in at) / len(at)
    room, share = 0.16 * min(pen.image.size) / pen.scale, rng.uniform(0.3, 0.85)
    shift = rng.uniform(-room, room), rng.uniform(-room, room)
    hub, before = np.array([(0.0, 0.0), (x, y)]), np.array([(p.x, p.y) for p in came]).reshape(-1, 2)
    near = (1.0, 0.8, 0.6, 0.4, 0.2)
    centers = [(k * (share * x + shift[0]), k * (share * y + shift[1])) for k in near]
    for origins in (before, before[:0]):
        for center in centers:
            pen.center = center
            if pen.shows(hub, 0.1) and pen.shows(origins, 0.03):
                return


# ------------------------------------------------------------------ vehicles
def _vehicles(rng: Random, pen: Pen, tracks: list[Track]) -> bool:
    """Draws the actors; whether their names stand beside them, without which only their colors tell who is who."""
    style = rng.choice(("box", "box", "icon", "icon", "plain"))
    arrows, labels = rng.random() < 0.55 or style == "plain", rng.random() < 0.9
    ghosts = style == "icon" and labels and rng.random() < 0.3
    order = list(tracks)
    rng.shuffle(order)
    colors = {track.actor.id: _color(rng, track, labels) for track in order}
    for track in order:
        if track.ahead is not None:
            _intended(pen, track.ahead)
    # What came later lies below, the impact on top: every actor is to be seen where it counts.
    layers = sorted(((t, i) for t in order for i in range(len(t.poses))), key=lambda at: _layer(*at))
    for track, i in layers:
        if i and arrows and i <= track.contact:
            _link(pen, track.poses[i - 1], track.poses[i], track.size[0])
        icons.vehicle(
            rng, pen, track, track.poses[i], colors[track.actor.id], style, labels, ghosts and i != track.contact
        )
    if rng.random() < 0.12 and tracks:
        at = [track.poses[track.contact] for track in tracks[:2]]
        x, y = pen.px(np.array([(pose.x, pose.y) for pose in at])).mean(axis=0)
        pen.draw.line([(x - 8, y), (x + 8, y)], fill=BLACK, width=2)
        pen.draw.line([(x, y - 8), (x, y + 8)], fill=BLACK, width=2)
    return labels


def _layer(track: Track, index: int) -> int:
    return 0 if index > track.contact else 1 if index < track.contact else 2


def _color(rng: Random, track: Track, labels: bool) -> Color:
    if not track.actor.vehicle:
        return (
            rng.choice(((90, 60, 20), (20, 110, 40), (20, 20, 20)))
            if track.actor.kind == "object"
            else rng.choice(((250, 150, 30), (20, 20, 20), (150, 30, 160)))
        )
    if rng.random() < 0.05 and labels:
        return (255, 255, 255)
    return rng.choice(COLORS[int(track.actor.id[1:])])


def _intended(pen: Pen, way: Points) -> None:
    """A dashed arrow where one would have turned."""
    width = 1 if pen.scale < 6 else 2
    pen.line(way, width=width, dash=1.5, gap=1.5)
    a, b = pen.px(way[-3:])[[0, -1]]
    pen.head(b, math.atan2(*(b - a)[::-1]), max(6.0, 1.1 * pen.scale))


def _link(pen: Pen, before: Pose, after: Pose, length: float) -> None:
    a, b = pen.px(np.array([(before.x, before.y), (after.x, after.y)]))
    gap = float(np.hypot(*(b - a)))
    margin = length * pen.scale * 0.55
    if gap > 2.6 * margin:
        u = (b - a) / gap
        pen.arrow(a + u * margin, b - u * margin, width=1 if pen.scale < 6 else 2, head=max(6.0, 1.1 * pen.scale))


__all__ = ["Drawing", "Points", "Shape", "draw_labeled", "draw_report", "scan"]
