"""Who stands where in the drawing: the contact first, then poses before and after it.

At a contact the two boxes touch with the sides that the crash names. The actor that keeps its course is put on
its way; the other is put against it and turned as far as its side demands. Knows no pixels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from random import Random

import numpy as np

from mini.generator.world import Actor, Crash
from mini.renderer.lines import STEP, Ground, Points, headings, shift

SIZES = {
    "car": (4.8, 2.0),
    "suv": (4.9, 2.1),
    "pickup": (5.6, 2.1),
    "van": (5.1, 2.1),
    "truck": (13.0, 2.7),
    "bus": (11.0, 2.7),
    "motorcycle": (3.4, 1.5),
    "bicycle": (3.0, 1.3),
    "pedestrian": (1.2, 1.2),
    "object": (1.4, 1.4),
    "trailer": (10.0, 2.6),
}
"""Length and width in metres as drawn: what is small is drawn larger than it is, or nobody could tell what it is."""
SIDE = {"front": 0.0, "left": math.pi / 2, "back": math.pi, "right": -math.pi / 2}
KEEPS = ("straight", "negotiating_curve", "stopped", "parked", "slowing")


@dataclass
class Pose:
    """Center and heading, metres and radians."""

    x: float
    y: float
    heading: float


@dataclass
class Track:
    """An actor's drawn poses in order; `contact` is the index of the impact pose."""

    actor: Actor
    size: tuple[float, float]
    poses: list[Pose] = field(default_factory=list)
    contact: int = 0


def wrap(angle: float) -> float:
    """To (-pi, pi]."""
    return (angle + math.pi) % (2 * math.pi) - math.pi


def half(size: tuple[float, float], area: str) -> float:
    """From the center to a side."""
    return size[0] / 2 if area in ("front", "back") else size[1] / 2


class Stage:
    """Places all actors of a crash on its ground."""

    def __init__(self, rng: Random, crash: Crash, ground: Ground, scale: float) -> None:
        self.rng, self.crash, self.ground = rng, crash, ground
        self.sizes = [tuple(scale * v for v in SIZES[a.kind]) for a in crash.actors]
        self.ways = [self._parked(ground.way(a), a) if a.maneuver == "parked" else ground.way(a) for a in crash.actors]
        self.at: dict[int, Pose] = {}
        self.index: dict[int, int] = {}

    def tracks(self) -> list[Track]:
        """Every actor with its poses."""
        for contact in self.crash.contacts:
            first, second = contact.striker, contact.struck
            if first not in self.at and second not in self.at:
                self._anchor(self._keeper(first, second), second if self._keeper(first, second) == first else first)
            if first in self.at and second in self.at:
                continue
            placed, other = (first, second) if first in self.at else (second, first)
            areas = {contact.striker: contact.striker_area, contact.struck: contact.struck_area}
            self._attach(placed, other, areas[placed], areas[other])
        found = [self._track(i) for i in range(len(self.crash.actors)) if i in self.at]
        for track in found:
            track.poses += self._after(track, [other for other in found if other is not track])
        return found

    def _parked(self, way: Points, actor: Actor) -> Points:
        """At the curb or beyond it, where nobody drives."""
        band = self.ground.bands[actor.leg]
        return shift(way, -2, -1, -(band.right - band.lane_in(actor.lane)) * self.rng.uniform(0.6, 1.3))

    def _keeper(self, first: int, second: int) -> int:
        """Who stays on its line at the contact."""
        actors = self.crash.actors
        for i in (second, first):
            if actors[i].maneuver in KEEPS and actors[i].kind not in ("object", "pedestrian", "bicycle"):
                return i
        return second if actors[second].kind not in ("object", "pedestrian", "bicycle") else first

    # -------------------------------------------------------------- contact
    def _anchor(self, keeper: int, other: int) -> None:
        index = self._meeting(keeper, other)
        way, h = self.ways[keeper], headings(self.ways[keeper])
        turned = math.pi if self.crash.actors[keeper].maneuver == "backing" else 0.0
        self.at[keeper] = Pose(*way[index], wrap(float(h[index]) + turned))
        self.index[keeper] = index

    def _meeting(self, keeper: int, other: int) -> int:
        """Index on the keeper's way at which it is met."""
        mine, actor, by = self.ways[keeper], self.crash.actors[keeper], self.crash.actors[other]
        self._departures(keeper, other)
        mine = self.ways[keeper]
        before = int((self.ground.bands[actor.leg].length - self.ground.setback(actor.leg, 1.0)) / STEP)
        same_road = actor.leg % 4 == by.leg % 4 and by.maneuver not in ("turn_left", "turn_right", "u_turn")
        if actor.maneuver in ("stopped", "slowing") and actor.leg == by.leg:
            back = self.rng.choice((3, 3, 6, 12, 18)) if not self.ground.plain else self.rng.randint(-16, 16)
            return min(max(before - int(back / STEP), 20), len(mine) - 8)
        if same_road or by.kind in ("object", "pedestrian", "bicycle"):
            near = before + int(
                self.rng.uniform(-14 if self.ground.plain else -30, 8 if self.ground.plain else -2) / STEP
            )
            return min(max(near, 20), len(mine) - 8)
        gaps = np.hypot(*(mine[:, None] - self.ways[other][None]).transpose(2, 0, 1))
        return int(min(max(np.unravel_index(gaps.argmin(), gaps.shape)[0], 10), len(mine) - 6))

    def _departures(self, keeper: int, other: int) -> None:
        """Bend the ways of those who leave their lane."""
        for i in (keeper, other):
            actor, way = self.crash.actors[i], self.ways[i]
            band = self.ground.bands[actor.leg]
            middle = int((band.length - self.ground.setback(actor.leg, 1.0)) / STEP)
            amount = {
                "crossing_centerline": band.lane + band.middle,
                "overtaking": band.lane + band.middle,
                "lane_change_left": band.lane,
                "lane_change_right": -band.lane,
                "departing_road_right": -(band.right - band.lane_in(actor.lane) + 3.0),
                "departing_road_left": band.lane_in(actor.lane) - band.left + 3.0,
            }.get(actor.maneuver)
            if amount is not None:
                start = max(2, middle - int(self.rng.uniform(16, 30) / STEP))
                self.ways[i] = shift(way, start, middle, amount)

    def _attach(self, placed: int, other: int, placed_area: str, other_area: str) -> None:
        """Put `other` against `placed`, sides touching."""
        anchor, size, mine = self.at[placed], self.sizes[placed], self.sizes[other]
        toward = anchor.heading + SIDE[placed_area]
        slide = self.rng.uniform(-0.3, 0.3) * (size[1] if placed_area in ("front", "back") else size[0])
        px = anchor.x + half(size, placed_area) * math.cos(toward) - slide * math.sin(toward)
        py = anchor.y + half(size, placed_area) * math.sin(toward) + slide * math.cos(toward)
        own = self._own_heading(other, anchor)
        wanted = wrap(toward + math.pi - SIDE[other_area])
        off = wrap(own - wanted)
        most = math.radians(self.rng.uniform(10, 40))
        heading = wrap(wanted + max(-most, min(most, off)))
        normal = heading + SIDE[other_area]
        reach = half(mine, other_area)
        self.at[other] = Pose(px - reach * math.cos(normal), py - reach * math.sin(normal), heading)

    def _own_heading(self, other: int, anchor: Pose) -> float:
        way = self.ways[other]
        index = int(np.hypot(way[:, 0] - anchor.x, way[:, 1] - anchor.y).argmin())
        index = min(max(index, 4), len(way) - 3)
        self.index[other] = index
        turned = math.pi if self.crash.actors[other].maneuver == "backing" else 0.0
        return wrap(float(headings(way)[index]) + turned)

    # -------------------------------------------------------------- tracks
    def _track(self, index: int) -> Track:
        actor = self.crash.actors[index]
        track = Track(actor, self.sizes[index])  # type: ignore[arg-type]
        at = self.at[index]
        still = actor.maneuver in ("stopped", "parked") or actor.kind == "object"
        if not still:
            track.poses += self._before(index, at)
        track.contact = len(track.poses)
        track.poses.append(at)
        return track

    def _before(self, index: int, at: Pose) -> list[Pose]:
        actor, rng = self.crash.actors[index], self.rng
        if actor.kind in ("pedestrian", "bicycle"):
            return [Pose(at.x - 6 * math.cos(at.heading), at.y - 6 * math.sin(at.heading), at.heading)]
        way, h = self.ways[index], headings(self.ways[index])
        turned = math.pi if actor.maneuver == "backing" else 0.0
        found, gap = [], rng.uniform(7, 14) + self.sizes[index][0] * 0.6
        place = self.index[index] - int(gap / STEP)
        if place < 1 and self.index[index] * STEP > self.sizes[index][0] + 1:
            place = 1  # met near the end of its leg: closer together, but seen to have moved
        for _ in range(rng.choice((1, 1, 2, 2, 3))):
            while place >= 1 and self._hidden(index, Pose(*way[place], float(h[place]))):
                place -= 4
            if place < 1:
                break
            found.append(Pose(*way[place], wrap(float(h[place]) + turned)))
            place -= int(gap * rng.uniform(0.9, 1.6) / STEP)
        return found[::-1]

    def _hidden(self, index: int, pose: Pose) -> bool:
        """Whether a box would lie on another actor's place of impact, so that nobody could tell them apart."""
        return any(
            overlap(pose, self.sizes[index], at, self.sizes[other]) for other, at in self.at.items() if other != index
        )

    def _after(self, track: Track, others: list[Track]) -> list[Pose]:
        """Poses on the way to rest, now and then; up to the first that would hide how another actor came."""
        rng, at, found = self.rng, track.poses[track.contact], []
        if track.actor.kind in ("object", "pedestrian", "bicycle") or rng.random() >= 0.5:
            return []
        away, turn = at.heading + rng.uniform(-1.2, 1.2), rng.uniform(-2.5, 2.5)
        for k in range(rng.choice((1, 1, 2))):
            reach = (k + 1) * rng.uniform(6, 12)
            pose = Pose(
                at.x + reach * math.cos(away), at.y + reach * math.sin(away), wrap(at.heading + turn * (k + 1) / 2)
            )
            taken = ((other, one) for other in others for one in other.poses[: other.contact + 1])
            if any(overlap(pose, track.size, one, other.size) for other, one in taken):
                break
            found.append(pose)
        return found


def overlap(first: Pose, size: tuple[float, float], second: Pose, other: tuple[float, float]) -> bool:
    """Whether two boxes share ground (separating axes)."""
    boxes = corners(first, size), corners(second, other)
    for heading in (first.heading, second.heading):
        for angle in (heading, heading + math.pi / 2):
            a, b = (box @ (math.cos(angle), math.sin(angle)) for box in boxes)
            if a.max() <= b.min() or b.max() <= a.min():
                return False
    return True


def corners(pose: Pose, size: tuple[float, float]) -> Points:
    """The four corners of a box, (4, 2), front left first."""
    return within(pose, size, [(0.5, 0.5), (0.5, -0.5), (-0.5, -0.5), (-0.5, 0.5)])


def within(pose: Pose, size: tuple[float, float], shares: Sequence[tuple[float, float]]) -> Points:
    """World points (n, 2) of shares of a box: ahead and to the left of its middle."""
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    laid: Points = np.array(shares) * size @ np.array([(c, s), (-s, c)]) + (pose.x, pose.y)
    return laid
