"""A report's diagram: view, roads, vehicles at their poses, north arrow, captions, scan.

Everything follows from the report's seed. What a drawing tells is in `research.generator.targets.drawn_facts`; speeds
and names are only captions, too small to read at the size that the model sees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import numpy as np
from PIL import Image

from research.generator.crash.world import Crash
from research.generator.report import Report
from research.renderer import accesses
from research.renderer.around import Shape, captions, north_arrow, scan
from research.renderer.boxes import corners
from research.renderer.lines import Ground, Points
from research.renderer.pen import Pen
from research.renderer.poses import Stage, Track
from research.renderer.road_marks import RoadMarks
from research.renderer.traffic import Manner, draw_tracks
from research.rows import evidence_labels
from sgcad_core.kinds import DRIVEWAY, T

QUEUED = 5.0
"""Metres of road more, either way, for each that runs into one ahead, so that where it came from is on the sheet."""
CENTERED = 0.8
"""Share of drawings in which a leg's pavement, not its center line, lies about the middle of the junction."""
EVEN = 0.35
"""Share of drawings whose legs end on one rectangle."""


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
    manner = Manner.drawn(rng)
    tracks = Stage(rng, crash, ground, rng.uniform(0.85, 1.3), manner.rests).tracks()
    _aim(rng, pen, tracks)
    marks = RoadMarks(rng, pen, crash, ground, [(pose, track.size) for track in tracks for pose in track.poses])
    arrows = any(fact.startswith("turns.") for fact in report.drawn)
    marks.draw(arrows=arrows, signs="control" in report.drawn)
    draw_tracks(rng, pen, tracks, manner, crash.contacts[0])
    shapes = _shapes(report, pen, ground, tracks, arrows) + north_arrow(rng, pen)
    captions(rng, pen, sum(actor.vehicle for actor in crash.actors))
    return Drawing(scan(rng, pen.image, gray=manner.labels), shapes, pen.turn)


def _shapes(report: Report, pen: Pen, ground: Ground, tracks: list[Track], arrows: bool) -> list[Shape]:
    """The legs and the vehicles at their poses."""
    found, crash = [], report.shown or report.crash
    for band in ground.bands.values():
        s = np.arange(ground.setback(band.leg.bearing, 1.0), band.length, 2.0)
        outline = np.concatenate((band.at(s, band.right), band.at(s, band.left)[::-1]))
        shows = evidence_labels.drawn_leg(band.leg, "control" in report.drawn, arrows)
        found.append(Shape(pen.px(outline), shows, 0.3))
    for access in crash.accesses:
        mouth = accesses.box(pen, ground, access, 0.5, access.mouth or accesses.REACH)
        found.append(Shape(pen.px(mouth), [evidence_labels.PICTURE["access"]], 0.2))
    for track in tracks:
        for i, pose in enumerate(track.poses):
            when = "contact" if i == track.contact else "before" if i < track.contact else "after"
            faces = round((math.pi / 2 - pose.heading) / (math.pi / 4)) % 8
            shows = evidence_labels.drawn_actor(report.crash, track.actor, when, faces, report.drawn)
            found.append(Shape(pen.px(corners(pose, track.size)), shows, 0.04))
    return found


def _sheet(rng: Random, crash: Crash) -> tuple[Pen, Ground]:
    """View and ground; plain roads get wide sheets along the road, junctions nearly square ones."""
    plain = len(crash.legs) == 2
    turn = math.radians(rng.choices((0, 90, -90, 180, rng.uniform(-60, 60)), (63, 17, 12, 4, 4))[0])
    half = rng.uniform(21, 36) if not plain else rng.uniform(22, 48)
    wide = max(leg.lanes_in + leg.lanes_out for leg in crash.legs)
    half += 2.0 * wide + QUEUED * len(crash.queue)
    used = {bearing for actor in crash.actors for bearing in (actor.leg, actor.out)}
    lengths = {leg.bearing: half * rng.uniform(0.85, 1.5) for leg in crash.legs}
    for leg in crash.legs:
        if leg.bearing not in used and not crash.is_main(leg.bearing):
            lengths[leg.bearing] = max(half * rng.uniform(0.3, 1.1), 12 + 2.0 * wide)
    if rng.random() < EVEN:
        even = {axis: half * rng.uniform(0.9, 1.15) for axis in sorted({leg.bearing % 4 for leg in crash.legs})}
        lengths |= {leg.bearing: max(even[leg.bearing % 4], 14 + 2.0 * wide) for leg in crash.legs}
    for contact in crash.queue:
        queued = crash.actors[contact.striker].leg
        lengths[queued] = max(lengths[queued], 1.3 * half)
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
        size = (long, int(long * rng.uniform(0.45 if crash.layout in (T, DRIVEWAY) else 0.65, 1.0)))
        size = size if rng.random() < 0.75 else size[::-1]
    scale = max(size) / (2 * half) if plain else min(size) / (2 * half) * rng.uniform(1.0, 1.15)
    return Pen(rng, *size, scale, turn, (0.0, 0.0)), ground


def _lane_widths(rng: Random, crash: Crash) -> dict[int, float]:
    """Metres by axis: few drawings are to scale, and of two roads one may be drawn wider."""
    if rng.random() < 0.25:
        return {}
    base = rng.uniform(3.2, 5.0)
    return {axis: base * rng.uniform(0.85, 1.15) for axis in sorted({leg.bearing % 4 for leg in crash.legs})}


def _aim(rng: Random, pen: Pen, tracks: list[Track]) -> None:
    """Center the sheet somewhere between the hub and the impact, so that both are on it and, if that can be, where
    all actors came from."""
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


__all__ = ["Drawing", "Points", "Shape", "draw_labeled", "draw_report", "scan"]
