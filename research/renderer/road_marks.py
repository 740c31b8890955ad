"""Roads on paper: edges with rounded corners, center and lane lines, turn arrows, medians, signs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from random import Random

import numpy as np
from PIL import Image, ImageDraw

from research.generator.crash.world import Crash
from research.renderer import accesses
from research.renderer.boxes import Pose, Size, overlap
from research.renderer.lines import STEP, Band, Ground, Points
from research.renderer.masks import outline, rounded
from research.renderer.pen import Color, Pen
from sgcad_core.kinds import ROAD

TURN_STEPS = {
    "left": ("left",),
    "right": ("right",),
    "through": ("through",),
    "left_through": ("left", "through"),
    "through_right": ("through", "right"),
    "left_right": ("left", "right"),
}

ARROW = (7.0, 2.4)
"""Metres of road that an arrow takes."""


class RoadMarks:
    """Draws one crash's roads with one style."""

    def __init__(
        self, rng: Random, pen: Pen, crash: Crash, ground: Ground, taken: Sequence[tuple[Pose, Size]] = ()
    ) -> None:
        """`taken`: the boxes of vehicles, which will hide what lies beneath them."""
        self.rng, self.pen, self.crash, self.ground, self.taken = rng, pen, crash, ground, taken
        self.edge = rng.choice((1, 2, 2, 3))
        self.mark = rng.choice((1, 2, 2))
        self.dash = rng.uniform(2.0, 4.0)
        self.gap = rng.uniform(2.0, 5.0)
        self.corner = rng.uniform(1.5, 5.5) if rng.random() < 0.65 else rng.uniform(5.0, 9.0)
        self.shoulders = rng.choices((0, 1, 2, 3), (25, 40, 31, 4) if ground.plain else (65, 25, 10, 0))[0]
        self.curb = (
            0 if ground.plain or self.shoulders or rng.random() > 0.2 else round(rng.uniform(0.5, 2.5) * pen.scale)
        )
        """Pixels between the edges of a junction and a second line around it; 0: none."""
        narrow = all(leg.lanes_in <= 1 for leg in crash.legs)
        odds = (50, 20, 15, 15) if narrow else (10, 50, 25, 15)
        self.center = rng.choices(("dashed", "double", "solid", "solid_dashed"), odds)[0]
        self.arrow_fill = rng.choices((None, (250, 235, 205), (255, 255, 255), (170, 170, 170)), (55, 20, 15, 10))[0]
        """Color of broad turn arrows with an outline; None: thin black ones."""
        self.every_lane = rng.random() < 0.6
        """Whether lanes that only go straight have arrows too."""
        self.arrow_size = rng.uniform(0.55, 1.2)
        self.turn_lane_gap = rng.uniform(0.0, 0.8)
        """Metres from the solid to the dashed line of a two-way left-turn lane; small ones run into one."""
        self.turn_lane_dashed = rng.random() < 0.03
        self.storage = rng.random() < 0.7
        """Whether the line beside a turn lane is solid."""
        self.stop_bars = rng.random() < 0.25

    def draw(self, arrows: bool, signs: bool) -> None:
        """Everything, edges first."""
        self._edges()
        for band in self.ground.bands.values():
            start = self.ground.setback(band.leg.bearing, self.corner * 0.8)
            self._center(band, start)
            self._lanes(band, start)
            if signs and self.stop_bars and band.leg.control in ("stop", "signal") and band.leg.lanes_in:
                ends = np.concatenate((band.at(start, band.right), band.at(start, band.middle / 2)))
                self.pen.line(ends, width=self.mark + 2)
            if arrows:
                self._arrows(band, start)
            self._one_way(band, start, arrows)
        if signs:
            self._signs()

    # -------------------------------------------------------------- edges
    def _edges(self) -> None:
        pen, bands = self.pen, list(self.ground.bands.values())
        area = Image.new("L", pen.image.size, 0)
        paint = ImageDraw.Draw(area)
        for band in bands:
            self._fill(paint, band, band.right, band.left, band.length + 60, 255)
        for access in (access for access in self.crash.accesses if access.mouth is None):
            paint.polygon([tuple(p) for p in pen.px(accesses.box(pen, self.ground, access))], fill=255)
        if not self.ground.plain:
            area = rounded(area, self.corner * pen.scale * 0.6)
        area = accesses.opened(pen, self.ground, self.crash.accesses, area, self.corner)
        pen.image.paste((0, 0, 0), (0, 0), outline(area, self.edge))
        if self.curb:
            pen.image.paste((0, 0, 0), (0, 0), outline(area, self.mark, self.edge + self.curb))
        for band in bands:
            if band.length < 500:
                self._cut(band)
        accesses.cut(pen, self.ground, self.crash.accesses, 1.0 + (self.edge + self.curb) / pen.scale)
        if self.shoulders:
            self._shoulders(bands)

    def _fill(
        self, paint: ImageDraw.ImageDraw, band: Band, right: float, left: float, length: float, value: int
    ) -> None:
        s = np.arange(-0.5, length, 1.0 if band.leg.curve != "none" else 4.0)
        shape = np.concatenate((band.at(s, right), band.at(s, left)[::-1]))
        paint.polygon([tuple(p) for p in self.pen.px(shape)], fill=value)

    def _cut(self, band: Band) -> None:
        """A leg ends where its drawing ends: white beyond."""
        if band.length > 80:
            return
        s = np.arange(band.length, band.length + 70, 4.0)
        more = 2 + self.curb / self.pen.scale
        shape = np.concatenate((band.at(s, band.right + more), band.at(s, band.left - more)[::-1]))
        self.pen.draw.polygon([tuple(p) for p in self.pen.px(shape)], fill="white")

    def _shoulders(self, bands: list[Band]) -> None:
        """Lines beside the travel lanes: paved and gravel shoulders, as most investigators draw them, narrower than
        lanes and the outermost line thin."""
        lane = min(band.lane for band in bands)
        places = [self.rng.uniform(0.4, 0.75 * lane if self.shoulders == 1 else 0.45 * lane)]
        for _ in range(self.shoulders - 1):
            places.append(places[-1] + self.rng.uniform(0.4, 0.35 * lane))
        for band in bands:
            s = np.arange(self.ground.setback(band.leg.bearing, self.corner + 1.5), band.length, 1.0)
            if len(s) < 3 or band.leg.kind != ROAD:
                continue
            for side, curb, sign in (("right", band.right, 1), ("left", band.left, -1)):
                for run in accesses.beside(self.pen, self.ground, self.crash.accesses, band, side, s):
                    for wide in places:
                        width = 1 if wide == places[-1] and len(places) > 1 else self.mark
                        self.pen.line(band.at(run, curb + sign * wide), width=width)

    # -------------------------------------------------------------- lines
    def _center(self, band: Band, start: float) -> None:
        leg, pen = band.leg, self.pen
        if not leg.two_way or leg.kind != ROAD:
            return
        s = np.arange(start, band.length, STEP)
        if len(s) < 3:
            return
        if leg.twltl:
            for side in (1, -1):
                if not self.turn_lane_dashed:
                    pen.line(band.at(s, side * band.middle / 2), width=self.mark)
                inner = side * (band.middle / 2 - self.turn_lane_gap)
                pen.line(band.at(s, inner), width=self.mark + self.turn_lane_dashed, dash=self.dash, gap=self.gap)
        elif leg.median == "none":
            self._center_line(band, s)
        else:
            self._median(band, s)

    def _center_line(self, band: Band, s: Points) -> None:
        pen, wide = self.pen, max(0.35, 1.6 / self.pen.scale)
        narrow = band.leg.lanes_in == band.leg.lanes_out == 1
        if self.center == "dashed" and narrow:
            pen.line(band.at(s, 0), width=self.mark, dash=self.dash, gap=self.gap)
        elif self.center in ("solid", "dashed"):
            pen.line(band.at(s, 0), width=self.mark + (2 if self.storage and band.leg.turns_in else 1))
        else:
            if self.ground.plain and band.leg.bearing < 4:
                wide = -wide  # one side of the road has the dashes, whichever leg they are drawn with
            pen.line(band.at(s, wide), width=self.mark)
            dash = self.dash if self.center == "solid_dashed" and narrow else 0.0
            pen.line(band.at(s, -wide), width=self.mark, dash=dash, gap=self.gap)

    def _median(self, band: Band, s: Points) -> None:
        pen, kind = self.pen, band.leg.median
        for side in (1, -1):
            pen.line(band.at(s, side * band.middle / 2), width=self.mark)
        if kind == "barrier":
            for k in range(0, len(s) - 1, 6):
                pen.line(np.concatenate((band.at(s[k], band.middle / 2), band.at(s[k], -band.middle / 2))), width=1)
        elif kind in ("raised", "painted"):
            for k in range(0, len(s) - 8, 8):
                pen.line(np.concatenate((band.at(s[k], band.middle / 2), band.at(s[k + 6], -band.middle / 2))), width=1)
            if kind == "raised":
                pen.line(band.at(s, 0), width=self.mark + 1)
        else:
            self._tufts(band, s)

    def _tufts(self, band: Band, s: Points) -> None:
        for k in range(2, len(s) - 2, 9):
            x, y = self.pen.px(band.at(s[k], self.rng.uniform(-0.3, 0.3) * band.middle))[0]
            self.pen.draw.line([(x - 3, y + 3), (x, y - 3), (x + 3, y + 3)], fill=(60, 130, 60), width=1)

    def _lanes(self, band: Band, start: float) -> None:
        leg, pen = band.leg, self.pen
        s = np.arange(start, band.length, STEP)
        if len(s) < 3 or leg.kind != ROAD:
            return
        for k in range(1, leg.lanes_in):
            uses = (leg.turns_in[k - 1], leg.turns_in[k]) if leg.turns_in else ("", "")
            solid = self.storage and (uses[0] == "right" or uses[1] == "left")
            pen.line(
                band.at(s, band.right - k * band.lane), width=self.mark, dash=0.0 if solid else self.dash, gap=self.gap
            )
        for k in range(1, leg.lanes_out):
            pen.line(band.at(s, band.left + k * band.lane), width=self.mark, dash=self.dash, gap=self.gap)

    # -------------------------------------------------------------- arrows, signs
    def _arrows(self, band: Band, start: float) -> None:
        for k, use in enumerate(band.leg.turns_in, 1):
            if use == "through" and not self.every_lane:
                continue
            place, turns = self._free(band, start, band.lane_in(k), 1.5), TURN_STEPS.get(use, ())
            for turn in turns:
                self._painted(self._turn_arrow(band, place, band.lane_in(k), turn, len(turns) > 1))

    def _free(self, band: Band, start: float, lateral: float, middle: float = 0.0) -> float:
        """Metres from the hub to a place for an arrow on a lane that the sheet shows and no vehicle will hide.

        `middle`: metres from that place to the middle of the arrow.
        """
        usual = min(start + self.rng.uniform(4, 9), band.length - 6)
        for place in (usual, *np.arange(start + 4, band.length - 6, 1.5)):
            (x, y), (u, v) = (band.at(place + far, lateral)[0] for far in (middle, middle + 1))
            here = Pose(x, y, math.atan2(y - v, x - u))
            if self.pen.shows(np.array([(x, y)]), 0.05) and not any(
                overlap(here, ARROW, pose, size) for pose, size in self.taken
            ):
                return float(place)
        return usual

    def _one_way(self, band: Band, start: float, arrows: bool) -> None:
        """Arrows on a one-way road, which nothing else would show; on a plain one the vehicles mostly do."""
        leg = band.leg
        if leg.kind != ROAD or leg.two_way or (arrows and leg.turns_in):
            return
        if self.ground.plain and self.rng.random() < 0.4:
            return
        for k in range(1, leg.lanes_in + leg.lanes_out + 1):
            lateral = band.lane_in(k) if leg.lanes_in else band.lane_out(k)
            place = self._free(band, start, lateral)
            ends = band.at(place + 3, lateral)[0], band.at(place - 3, lateral)[0]
            self._painted(self.pen.px(np.array(ends if leg.lanes_in else ends[::-1])))

    def _painted(self, points: Points) -> None:
        """An arrow on the road in the manner of this drawing."""
        if self.arrow_fill is None:
            self._thin_arrow(points)
        else:
            self._broad_arrow(points, self.arrow_fill)

    def _turn_arrow(self, band: Band, place: float, lateral: float, turn: str, forked: bool) -> Points:
        """Tail, knee and tip in pixels; of a forked arrow each head stands clear of the other."""
        big = self.arrow_size
        tail, knee = band.at(place + 4.2 * big, lateral)[0], band.at(place + (2.2 if forked else 1.2) * big, lateral)[0]
        reach = min((1.8 if forked else 1.4) * big, 0.48 * band.lane)
        side = {"left": -reach, "right": reach, "through": 0.0}[turn]
        ahead = (2.6 if forked else 1.5) if turn == "through" else -1.0 if forked else 0.2
        tip = band.at(place - ahead * big, lateral + side)[0]
        return self.pen.px(np.array([tail, knee, tip]))

    def _thin_arrow(self, points: Points) -> None:
        pen = self.pen
        pen.draw.line([tuple(p) for p in points], fill=(0, 0, 0), width=self.mark, joint="curve")
        pen.head(points[-1], math.atan2(*(points[-1] - points[-2])[::-1]), max(5.0, 1.5 * pen.scale * self.arrow_size))

    def _broad_arrow(self, points: Points, fill: Color) -> None:
        """As painted on the road: a broad shaft and a head, outlined."""
        pen, size = self.pen, max(6.0, 1.6 * self.pen.scale * self.arrow_size)
        angle = math.atan2(*(points[-1] - points[-2])[::-1])
        neck = points[-1] - 0.7 * size * np.array([math.cos(angle), math.sin(angle)])
        shaft = [tuple(p) for p in (*points[:-1], neck)]
        wide = max(2, round(0.45 * pen.scale))
        pen.draw.line(shaft, fill=(90, 80, 70), width=wide + 2, joint="curve")
        pen.head(points[-1], angle, size + 2, (90, 80, 70))
        pen.draw.line(shaft, fill=fill, width=wide, joint="curve")
        pen.head(points[-1] - 2.5 * np.array([math.cos(angle), math.sin(angle)]), angle, max(2.0, size - 3.0), fill)

    def _signs(self) -> None:
        """Stop signs as red ovals or the word, signals as three lamps in the middle of the junction."""
        pen, size = self.pen, max(9, int(2.2 * self.pen.scale))
        style = self.rng.random()
        for band in self.ground.bands.values():
            control = band.leg.control
            place = self.ground.setback(band.leg.bearing, self.corner)
            x, y = pen.px(band.at(place, band.right + 2.6))[0]
            if control == "stop":
                if style < 0.6:
                    pen.draw.ellipse((x - size, y - size * 0.6, x + size, y + size * 0.6), fill=(205, 40, 20))
                    pen.text(x, y, "stop", max(7, int(size * 0.8)), (255, 255, 255))
                else:
                    pen.text(x, y, "Stop", size)
            elif control == "yield":
                pen.draw.polygon([(x - size, y - size), (x + size, y - size), (x, y + size)], outline=(200, 0, 0))
            elif control in ("signal", "flashing"):
                self._lamps(x, y, size, control)

    def _lamps(self, x: float, y: float, size: int, control: str) -> None:
        lamps = [(220, 30, 30), (240, 190, 0), (0, 160, 60)] if control == "signal" else [(220, 30, 30)]
        r = max(3, size * 0.35)
        self.pen.draw.rectangle((x - r - 2, y - r - 2, x + r + 2, y + (2 * len(lamps) - 1) * r + 2), fill=(40, 40, 40))
        for k, color in enumerate(lamps):
            self.pen.draw.ellipse((x - r, y - r + 2 * k * r, x + r, y + r + 2 * k * r), fill=color)
