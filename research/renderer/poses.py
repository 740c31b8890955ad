"""Poses of all actors in the drawing: the contact first, then those before and after it.

At a contact the two boxes touch with the sides that the crash names. The actor that keeps its course is put on
its way, where the other, put against it and turned as far as its side demands, is nearest to its own. Knows no pixels.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from random import Random

import numpy as np

from research.generator.crash.world import Actor, Contact, Crash
from research.renderer.boxes import SIDE, Pose, Size, distances_to, half, overlap, wrap
from research.renderer.lines import STEP, Ground, Points, headings, shift
from sgcad_core.kinds import actor_kind

NEAR = 0.8
"""Metres by which one may be put beside its own way and is still on it."""
ASKEW = math.radians(10)
"""So far turned from its way is as bad as a metre beside it."""
TURNED = math.radians(20)
"""A turn that is seen at the impact."""
CLOSE, APART = (2.0, 6.0), (5.0, 16.0)
"""Metres between one place of an actor and its next, in a queue and elsewhere."""
KEEPS = ("straight", "negotiating_curve", "stopped", "parked", "slowing")
"""Maneuvers of those who keep their line, if they can, at the contact."""


@dataclass
class Track:
    """An actor's drawn poses in order; `contact` is the index of the impact pose."""

    actor: Actor
    size: Size
    poses: list[Pose] = field(default_factory=list)
    contact: int = 0
    ahead: Points | None = None
    """Where it would have driven on, of one whose turn nobody could see yet."""


def _scaled(size: Size, scale: float) -> Size:
    return scale * size[0], scale * size[1]


class Stage:
    """Places all actors of a crash on its ground."""

    def __init__(self, rng: Random, crash: Crash, ground: Ground, scale: float, rests: float = 0.5) -> None:
        """`scale`: of the vehicles; `rests`: share of them whose way to rest is drawn."""
        self.rng, self.crash, self.ground, self.rests = rng, crash, ground, rests
        self.sizes: list[Size] = [_scaled(actor_kind(a.kind).drawn_m, scale) for a in crash.actors]
        self.ways = [self._parked(ground.way(a), a) if a.maneuver == "parked" else ground.way(a) for a in crash.actors]
        self.faces = [headings(way) for way in self.ways]
        """Radians along every way."""
        self.at: dict[int, Pose] = {}
        self.index: dict[int, int] = {}

    def tracks(self) -> list[Track]:
        """Every actor with its poses."""
        for contact in self.crash.contacts:
            first, second = contact.striker, contact.struck
            if first not in self.at and second not in self.at:
                self._anchor(contact)
            if first in self.at and second in self.at:
                continue
            placed, other = (first, second) if first in self.at else (second, first)
            areas, most = _areas(contact), math.radians(self.rng.uniform(10, 40))
            along = self.sizes[placed][areas[placed] in ("front", "back")]
            slide = self.rng.uniform(-0.3, 0.3) * min(along, 2 * self.sizes[placed][1])  # of long ones as of cars
            self._attach(placed, other, areas, slide, most)
        tracks: dict[int, Track] = {}
        for i in sorted(self.at, key=self._ahead):
            tracks[i] = self._track(i, tracks)
        found = [tracks[i] for i in sorted(tracks)]
        for track in found:
            track.poses += self._after(track, [other for other in found if other is not track])
        return found

    def _parked(self, way: Points, actor: Actor) -> Points:
        """At the curb or beyond it, where no traffic is."""
        band = self.ground.bands[actor.leg]
        return shift(way, -2, -1, -(band.right - band.lane_in(actor.lane)) * self.rng.uniform(0.6, 1.3))

    def _keeper(self, first: int, second: int) -> int:
        """The actor that stays on its line at the contact."""
        actors = self.crash.actors
        for i in (second, first):
            if actors[i].maneuver in KEEPS and actors[i].vehicle:
                return i
        return second if actors[second].vehicle else first

    # -------------------------------------------------------------- contact
    def _anchor(self, contact: Contact) -> None:
        """Put the one that keeps its line where the other meets it."""
        keeper = self._keeper(contact.striker, contact.struck)
        other = contact.struck if keeper == contact.striker else contact.striker
        index = self._along(keeper, other)
        for i in (keeper, other):
            self._depart(i, self.ways[keeper][index] if index is not None else None)
        self._stand(keeper, self._crossing(contact, keeper, other) if index is None else index)

    def _stand(self, actor: int, index: int) -> None:
        self.at[actor], self.index[actor] = self._on_way(actor, index), index

    def _on_way(self, actor: int, index: int) -> Pose:
        """An actor where its way has an index."""
        (x, y), face = self.ways[actor][index], float(self.faces[actor][index])
        return Pose(x, y, wrap(face + _turned(self.crash.actors[actor])))

    def _along(self, keeper: int, other: int) -> int | None:
        """Index on the keeper's way at which it is met by one of its own road; None: where their ways cross."""
        mine, actor, by = self.ways[keeper], self.crash.actors[keeper], self.crash.actors[other]
        before = int((self.ground.bands[actor.leg].length - self.ground.setback(actor.leg, 1.0)) / STEP)
        same_road = actor.leg % 4 == by.leg % 4 and by.maneuver not in ("turn_left", "turn_right", "u_turn")
        if actor.maneuver in ("stopped", "slowing") and actor.leg == by.leg:
            back = self.rng.choice((3, 3, 6, 12, 18)) if not self.ground.plain else self.rng.randint(-16, 16)
            return min(max(before - int(back / STEP), 20), len(mine) - 8)
        if same_road or not by.vehicle:
            early = -14 if self.ground.plain or actor.leg == by.leg else -30
            near = before + int(self.rng.uniform(early, 8 if self.ground.plain else -2) / STEP)
            return min(max(near, 20), len(mine) - 8)
        return None

    def _crossing(self, contact: Contact, keeper: int, other: int) -> int:
        """Index on the keeper's way at which the other, put against it, is nearest to its own way; of ways that run
        into one the first that is near enough."""
        way, areas = self.ways[other], _areas(contact)
        gaps = np.hypot(*(self.ways[keeper][:, None] - way[None]).transpose(2, 0, 1)).min(axis=1)
        near = gaps < gaps.min() + NEAR
        first = int(np.argmax(near))
        if self.crash.actors[keeper].leg == self.crash.actors[other].leg:  # one way until one of them turns off it
            first += int(np.argmin(near[first:]))
        room = int(self.sizes[keeper][0] / STEP)
        lowest, highest = 10, max(10, len(self.ways[keeper]) - 6)
        off = {}
        for index in range(max(lowest, first - room), min(highest, first + room) + 1, 2):
            self._stand(keeper, index)
            self._attach(keeper, other, areas, slide=0.0, most=math.radians(25))
            at = self.at.pop(other)
            aside = float(distances_to(way, at).min())
            off[index] = aside + abs(wrap(at.heading - self._own_heading(other, at))) / ASKEW
        if not off:
            return min(max(first, lowest), highest)
        return next(index for index, gap in off.items() if gap <= min(off.values()) + NEAR / 2)

    def _depart(self, index: int, met: Points | None) -> None:
        """Bend the way of one that leaves its lane, so that it has left it where it is met, and not long before."""
        actor, way = self.crash.actors[index], self.ways[index]
        band = self.ground.bands[actor.leg]
        amount = {
            "crossing_centerline": band.lane + band.middle,
            "overtaking": band.lane + band.middle,
            "lane_change_left": band.lane,
            "lane_change_right": -band.lane,
            "departing_road_right": -(band.right - band.lane_in(actor.lane) + 3.0),
            "departing_road_left": band.lane_in(actor.lane) - band.left + 3.0,
        }.get(actor.maneuver)
        if amount is None:
            return
        junction = int((band.length - self.ground.setback(actor.leg, 1.0)) / STEP)
        end = junction if met is None else int(np.hypot(*(way - met).T).argmin())
        start = max(2, end - int(self.rng.uniform(11, 20) / STEP))
        self.ways[index] = shift(way, start, max(end, start + 8), amount)
        self.faces[index] = headings(self.ways[index])

    def _attach(self, placed: int, other: int, areas: Mapping[int, str], slide: float, most: float) -> None:
        """Put `other` against `placed`, touching with the sides of `areas`: `slide` metres along that of `placed`, and
        turned from standing square to it as its own way is, by at most so many radians."""
        anchor, out = self.at[placed], half(self.sizes[placed], areas[placed])
        toward = anchor.heading + SIDE[areas[placed]]
        px = anchor.x + out * math.cos(toward) - slide * math.sin(toward)
        py = anchor.y + out * math.sin(toward) + slide * math.cos(toward)
        own = self._own_heading(other, anchor)
        wanted = wrap(toward + math.pi - SIDE[areas[other]])
        off = wrap(own - wanted)
        heading = wrap(wanted + max(-most, min(most, off)))
        normal = heading + SIDE[areas[other]]
        reach = half(self.sizes[other], areas[other])
        self.at[other] = Pose(px - reach * math.cos(normal), py - reach * math.sin(normal), heading)
        self.index[other] = self._nearest(other, self.at[other])

    def _nearest(self, actor: int, pose: Pose) -> int:
        """Index on an actor's way nearest to a pose."""
        way = self.ways[actor]
        return min(max(int(distances_to(way, pose).argmin()), 4), len(way) - 3)

    def _own_heading(self, actor: int, pose: Pose) -> float:
        """Which way it faces where its way passes a pose."""
        return self._on_way(actor, self._nearest(actor, pose)).heading

    # -------------------------------------------------------------- tracks
    def _track(self, index: int, others: Mapping[int, Track]) -> Track:
        actor = self.crash.actors[index]
        track = Track(actor, self.sizes[index])
        if actor.maneuver not in ("stopped", "parked") and not actor_kind(actor.kind).thing:
            track.poses += self._before(index, others)
            track.ahead = self._unseen_turn(index)
        track.contact = len(track.poses)
        track.poses.append(self.at[index])
        return track

    def _leader(self, index: int) -> int | None:
        """The actor that another runs into from behind, on the same road."""
        return next((c.struck for c in self.crash.queue if c.striker == index and c.struck in self.at), None)

    def _ahead(self, index: int) -> int:
        """How many drive ahead of an actor in a queue that runs up."""
        count, at = 0, self._leader(index)
        while at is not None and count < len(self.at):
            count, at = count + 1, self._leader(at)
        return count

    def _unseen_turn(self, index: int) -> Points | None:
        """The rest of the way of one that turns and is met before that can be seen."""
        actor, way = self.crash.actors[index], self.ways[index]
        if actor.maneuver not in ("turn_left", "turn_right", "u_turn") or len(way) < self.index[index] + 12:
            return None
        h = self.faces[index]
        if abs(wrap(self.at[index].heading - float(h[2]))) > TURNED:
            return None
        rest: Points = way[self.index[index] + int(0.5 * self.sizes[index][0] / STEP) :]
        turned = np.abs(wrap(headings(rest) - h[2])) if len(rest) > 2 else np.zeros(1)
        if turned.max() < math.radians(30):  # the way into a driveway that is no leg is not known
            return None
        around = int(np.argmax(turned > min(math.radians(70), 0.9 * turned.max())))
        return rest[: around + int(6 / STEP)]  # and some metres of the road that it turns into

    def _before(self, index: int, others: Mapping[int, Track]) -> list[Pose]:
        at, rng = self.at[index], self.rng
        if actor_kind(self.crash.actors[index].kind).exposed:
            return [Pose(at.x - 6 * math.cos(at.heading), at.y - 6 * math.sin(at.heading), at.heading)]
        lead = self._leader(index)
        ahead = others[lead] if lead is not None else None
        queues = lead is not None or any(self._leader(i) == index for i in self.at)
        found, gap = [], rng.uniform(*(CLOSE if queues else APART)) + self.sizes[index][0]
        place = self.index[index] - int(gap / STEP)
        if place < 1 and self.index[index] * STEP > self.sizes[index][0] + 1:
            place = 1  # met near the end of its leg: closer together, but seen to have moved
        for _ in range(1 if queues else rng.choice((1, 1, 1, 2, 2, 3))):
            if ahead is not None and ahead.contact:  # it came behind the one that it hits
                first, between = ahead.poses[0], 0.6 * (ahead.size[0] + self.sizes[index][0])
                place = min(place, int(distances_to(self.ways[index], first).argmin()) - int(between / STEP))
            while place >= 1 and self._hidden(index, self._on_way(index, place), others):
                place -= 4
            if place < 1:
                break
            found.append(self._on_way(index, place))
            place -= int(gap * rng.uniform(1.0, 1.6) / STEP)
        return found[::-1]

    def _hidden(self, index: int, pose: Pose, others: Mapping[int, Track]) -> bool:
        """Whether a box would lie where another actor is hit or came from, so that the two could not be told apart."""
        taken = [(at, self.sizes[other]) for other, at in self.at.items() if other != index]
        taken += [(one, other.size) for other in others.values() for one in other.poses[: other.contact]]
        return any(overlap(pose, self.sizes[index], one, size) for one, size in taken)

    def _after(self, track: Track, others: list[Track]) -> list[Pose]:
        """Poses on the way to rest, now and then; up to the first that would hide how another actor came."""
        rng, at, found = self.rng, track.poses[track.contact], []
        if not track.actor.vehicle or rng.random() >= self.rests:
            return []
        away, turn = self._pushed(track, others), rng.uniform(-2.5, 2.5) * min(1.0, 5.5 / track.size[0])
        taken = [(one, other.size) for other in others for one in other.poses]
        taken += [(one, track.size) for one in track.poses[: track.contact]]
        for k in range(rng.choice((1, 1, 2, 3))):
            reach, faces = (k + 1) * (0.5 * track.size[0] + rng.uniform(4, 9)), wrap(at.heading + turn * (k + 1) / 2)
            halfway, pose = (
                Pose(at.x + far * math.cos(away), at.y + far * math.sin(away), faces) for far in (reach / 2, reach)
            )
            if any(overlap(where, track.size, one, size) for where in (halfway, pose) for one, size in taken):
                break
            found.append(pose)
        return found

    def _pushed(self, track: Track, others: list[Track]) -> float:
        """About which way (radians) an actor goes from the impact: on, and with the other vehicles of the crash."""
        x = y = 0.0
        for one, weight in ((track, 1.0), *((other, 0.7) for other in others)):
            if one.contact and one.actor.vehicle:
                heading = one.poses[one.contact].heading + _turned(one.actor)
                x, y = x + weight * math.cos(heading), y + weight * math.sin(heading)
        if math.hypot(x, y) < 0.4:
            return track.poses[track.contact].heading + self.rng.uniform(-1.2, 1.2)
        return math.atan2(y, x) + self.rng.uniform(-0.6, 0.6)


def _turned(actor: Actor) -> float:
    """Radians from where an actor drives to where its nose points."""
    return math.pi if actor.maneuver == "backing" else 0.0


def _areas(contact: Contact) -> dict[int, str]:
    """The touched sides, by actor."""
    return {contact.striker: contact.striker_area, contact.struck: contact.struck_area}
