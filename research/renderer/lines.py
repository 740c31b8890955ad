"""Where things lie on the ground, in metres: legs as bands, lanes as lines, the ways of the actors.

x east, y north, the hub at (0, 0). A leg's lateral coordinate counts from its center line and is positive to the right
of a driver on the way to the hub, so inbound lanes are positive. Knows no pixels.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from research.generator.crash.world import Actor, Crash, Leg
from sgcad_core.kinds import DRIVEWAY

Points = NDArray[np.float64]
LANE = 3.6
STEP = 0.5
MEDIAN = {"none": 0.0, "painted": 2.0, "raised": 2.5, "grass": 7.0, "barrier": 1.2}


@dataclass
class Band:
    """A leg on the ground."""

    leg: Leg
    length: float
    radius: float
    wide: float = LANE
    aside: float = 0.0
    """Metres from the line through the hub to the center line."""

    @property
    def lane(self) -> float:
        """Lane width."""
        return 2.8 if self.leg.kind == DRIVEWAY else self.wide

    @property
    def middle(self) -> float:
        """Width between both directions: median or two-way left-turn lane."""
        return self.wide if self.leg.twltl else MEDIAN[self.leg.median]

    @property
    def right(self) -> float:
        """Lateral place of the inbound curb."""
        return self.middle / 2 + self.leg.lanes_in * self.lane

    @property
    def left(self) -> float:
        """Lateral place of the outbound curb (negative)."""
        return -self.middle / 2 - self.leg.lanes_out * self.lane

    def at(self, s: NDArray[np.float64] | float, lateral: float) -> Points:
        """Points s metres from the hub, (n, 2)."""
        s, lateral = np.atleast_1d(np.asarray(s, float)), lateral + self.aside
        a = math.radians(90 - 45 * self.leg.bearing)
        k = {"none": 0.0, "left": -1 / self.radius, "right": 1 / self.radius}[self.leg.curve]
        heading = a + k * s
        if k:
            x, y = (np.sin(heading) - math.sin(a)) / k, (math.cos(a) - np.cos(heading)) / k
        else:
            x, y = s * math.cos(a), s * math.sin(a)
        return np.stack((x - lateral * np.sin(heading), y + lateral * np.cos(heading)), axis=1)

    def lane_in(self, lane: int | None) -> float:
        """Lateral center of an inbound lane, 1 at the right curb."""
        k = min(max(lane or 1, 1), max(self.leg.lanes_in, 1))
        return self.right - (k - 0.5) * self.lane

    def lane_out(self, lane: int) -> float:
        """Lateral center of an outbound lane, 1 at the right curb as one drives out."""
        k = min(max(lane, 1), max(self.leg.lanes_out, 1))
        return self.left + (k - 0.5) * self.lane


class Ground:
    """All bands of a crash and how far the junction reaches; `lanes` has the width of lanes by axis.

    `centered`: whether the pavement of a leg lies evenly about the line through the hub, as where a road is widened for
    turn lanes so that through traffic stays in line; else its center line does.
    """

    def __init__(
        self,
        crash: Crash,
        lengths: dict[int, float],
        radius: float,
        lanes: Mapping[int, float] | None = None,
        centered: bool = False,
    ) -> None:
        self.crash, wide = crash, lanes or {}
        self.bands = {
            leg.bearing: Band(leg, lengths[leg.bearing], radius, wide.get(leg.bearing % 4, LANE)) for leg in crash.legs
        }
        self.plain = len(crash.legs) == 2
        for band in self.bands.values() if centered else ():
            band.aside = -(band.right + band.left) / 2

    def setback(self, bearing: int, corner: float = 3.0) -> float:
        """Distance from the hub at which a leg's own markings begin."""
        if self.plain:
            return 0.0
        others = [b for b in self.bands.values() if b.leg.bearing % 4 != bearing % 4]
        return max((self._reach(band, bearing) for band in others), default=0.0) + corner

    @staticmethod
    def _reach(band: Band, bearing: int) -> float:
        """How far a leg reaches from the hub towards a bearing: if it crosses, to its curb on that side."""
        right, left = band.right + band.aside, -band.left - band.aside
        return {2: right, 6: left}.get((band.leg.bearing - bearing) % 8, max(right, left))

    def way(self, actor: Actor) -> Points:
        """The undisturbed line of an actor, points every half metre from the end of its leg on."""
        band = self.bands[actor.leg]
        near = self.setback(actor.leg, 1.0)
        s = np.arange(band.length, near - 0.01, -STEP)
        inbound = band.at(s, band.lane_in(actor.lane))
        out = actor.out if actor.out is not None else (actor.leg + 4) % 8
        if out not in self.bands or not self.bands[out].leg.lanes_out:
            ahead = inbound[-1] + (inbound[-1] - inbound[-2]) * np.arange(1, 60)[:, None]
            return np.concatenate((inbound, ahead))
        exit_band = self.bands[out]
        turn = (out - actor.leg) % 8
        lane = {2: exit_band.leg.lanes_out, 6: 1, 0: exit_band.leg.lanes_out}.get(
            turn, self._same_lane(band, exit_band, actor)
        )
        away = exit_band.at(np.arange(self.setback(out, 1.0), exit_band.length, STEP), exit_band.lane_out(lane))
        return np.concatenate((inbound, bend(inbound, away, turn), away))

    @staticmethod
    def _same_lane(band: Band, exit_band: Band, actor: Actor) -> int:
        right = sum(use == "right" for use in band.leg.turns_in)
        return max(1, min((actor.lane or 1) - right, exit_band.leg.lanes_out))


def bend(inbound: Points, away: Points, turn: int) -> Points:
    """The curve that joins two lines: a cubic whose ends keep the directions, nearly a chord for through traffic."""
    a, b = inbound[-1], away[0]
    u = (inbound[-1] - inbound[-2]) / STEP
    v = (away[1] - away[0]) / STEP
    reach = float(np.hypot(*(b - a))) * {0: 0.8, 4: 0.2}.get(turn, 0.45)
    t = np.linspace(0, 1, max(3, int(np.hypot(*(b - a)) / STEP * 1.3)))[1:-1, None]
    p, q = a + u * reach, b - v * reach
    curve: Points = a * (1 - t) ** 3 + 3 * p * t * (1 - t) ** 2 + 3 * q * t**2 * (1 - t) + b * t**3
    return curve


def headings(points: Points) -> NDArray[np.float64]:
    """Direction at every point, radians counter-clockwise from east."""
    step = np.gradient(points, axis=0)
    return np.arctan2(step[:, 1], step[:, 0])


def shift(points: Points, start: int, end: int, amount: float) -> Points:
    """Move a line sideways (left positive) smoothly between two indices, and keep it there."""
    u = np.clip((np.arange(len(points)) - start) / max(end - start, 1), 0, 1)
    u = u * u * (3 - 2 * u)
    h = headings(points)
    moved: Points = points + (amount * u)[:, None] * np.stack((-np.sin(h), np.cos(h)), axis=1)
    return moved
