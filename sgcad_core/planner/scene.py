"""All actors on one world clock: tracks, their contacts, and what happens to them afterwards.

A track is (n, 3) poses 0.05 s apart from time 0. Knows motions and the wreck, no maneuvers.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from sgcad_core.case.records import ObservedContact, Trajectory
from sgcad_core.geometry.plane import SIDES, Box, Floats, Size, contact_area, gaps_where_near
from sgcad_core.kinds import actor_kind, mass_kg
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.aftermath.ground_friction import Drag, RunOut
from sgcad_core.planner.aftermath.hitch import Hitch, hitched
from sgcad_core.planner.aftermath.impact import FRICTION, RESTITUTION, body
from sgcad_core.planner.aftermath.rollover import rolled, rolls_over
from sgcad_core.planner.aftermath.wreck import Wreck
from sgcad_core.planner.aftermath.wreck_bodies import Mover, Touch
from sgcad_core.planner.lines.path import Path
from sgcad_core.planner.motion import STEP_S, Motion, clock
from sgcad_core.records.course import NOTHING_TOLD, Courses, CourseTold
from sgcad_core.records.specs import ActorKind, Area, Surface

AFTER_S = 5.0
"""From the first contact to the end: from 80 mph at 0.75 g all stand by then."""
BRAKED_MPS2 = 4.5
"""Of a struck vehicle along its wheels: some of them locked or bent, its driver on the brake."""
ROLLING_MPS2 = 2.2
"""Of a vehicle that is to reach something else."""
THROWN_MPS2 = 5.5
"""Of people, and of two-wheelers on their side, over the ground."""
_REACTION_S = 0.5
_BRAKING_MPS2 = 5.0
_STANDS_MPS, _SHOWN_MPS = 0.02, 2.6
"""Between the two a vehicle moves less than 0.11 m in a sample: vertices that lie nearer are dropped by players, and
with them the moment at which it is struck."""
_UNSEEN_COST = 2.0
CLEAR_M = 0.25
"""Actors that do not touch pass each other at least this far apart where that can be had."""


@dataclass
class Track:
    """One actor's poses on the world clock."""

    actor: str
    kind: ActorKind
    size: Size
    poses: Floats
    motion: Motion
    own_s: float
    """The motion's own time at world time 0 (its place where it is standing)."""
    hit: int | None = None
    """Index of its first impact."""
    mass: float | None = None
    """Its mass, where it is not that of its kind, kg."""
    driven: Floats = field(init=False)
    """Its poses where nobody touches it."""

    def __post_init__(self) -> None:
        self.driven = self.poses


class _Settled(NamedTuple):
    """What came of a settled scene: poses, touches, and the index of the first impact by actor."""

    poses: dict[str, Floats]
    touches: list[Touch]
    hits: dict[str, int | None]
    driven: list[Floats]
    """The undisturbed poses behind it, so that they stay what their ids stand for."""


@dataclass
class Scene:
    """Tracks by actor, in the order of placing; `contact` is the index of the first contact."""

    count: int
    contact: int
    rolling: frozenset[str] = frozenset()
    """Actors that have a further contact before them."""
    surface: Surface | None = None
    tracks: dict[str, Track] = field(default_factory=dict)
    hitches: list[tuple[str, str, float]] = field(default_factory=list)
    """Tractor, trailer, and how far behind the tractor's center they are coupled."""
    touches: list[Touch] = field(default_factory=list)
    """What touched, in order, when the scene was last settled."""
    runs: dict[str, RunOut] = field(default_factory=dict)
    """How actors run out from their blow, where that was chosen."""
    friction: float = FRICTION
    restitution: float = RESTITUTION
    again: frozenset[frozenset[str]] = frozenset()
    """Pairs that touch a second time as told."""
    told: frozenset[frozenset[str]] = frozenset()
    """Pairs that touch behind the first contact as told."""
    _settled: dict[Hashable, _Settled] = field(default_factory=dict, repr=False)

    def add(self, actor: str, kind: ActorKind, motion: Motion, own_at_contact_s: float, *, brakes: bool) -> Track:
        """Place an actor so that its own clock shows the given time at the first contact."""
        own = own_at_contact_s if motion.standing else own_at_contact_s - self.contact * STEP_S
        track = Track(actor, kind, motion.size, self.poses(motion, own_at_contact_s, brakes=brakes), motion, own)
        self.tracks[actor] = track
        return track

    def poses(self, motion: Motion, own_at_contact_s: float, *, brakes: bool) -> Floats:
        """(count, 3) poses of a motion; `brakes`: it comes to a stop behind the first contact."""
        if motion.standing:
            return np.repeat(motion.poses([own_at_contact_s]), self.count, axis=0)
        own = own_at_contact_s + clock(-self.contact, self.count - self.contact)
        if brakes:
            own = _braked(motion, own, self.contact + round(_REACTION_S / STEP_S))
        return motion.poses(own)

    def clear_until(self, poses: Floats, size: Size, margin_m: float, *, but: frozenset[str] = frozenset()) -> int:
        """Index of the first sample at which a box comes nearer than a margin to any track; count if never."""
        first = self.count
        for name, track in self.tracks.items():
            if name not in but:
                near = np.flatnonzero(gaps_where_near(poses, size, track.poses, track.size, margin_m) <= margin_m)
                first = min(first, int(near[0]) if len(near) else self.count)
        return first

    def settle(self) -> None:
        """Let everybody drive, and whatever touches push, until all stand; what was settled before is looked up."""
        cause = self._cause()
        if cause not in self._settled:
            wreck = self.wreck()
            poses, touches = wreck.settle()
            hits = {name: mover.hit for name, mover in wreck.named.items()}
            self._settled[cause] = _Settled(poses, touches, hits, [t.driven for t in self.tracks.values()])
        found = self._settled[cause]
        self.touches = list(found.touches)
        for name, track in self.tracks.items():
            track.poses, track.hit = found.poses[name], found.hits[name]

    def _cause(self) -> Hashable:
        """All that the way to rest depends on."""
        movers = tuple((t.actor, id(t.driven), t.size, t.mass, t.motion.fixed) for t in self.tracks.values())
        chosen = self.friction, self.restitution, self.again, self.told, tuple(self.runs.items())
        return movers, tuple(self.hitches), chosen, self.rolling, self.surface, self.count

    def wreck(self) -> Wreck:
        """The simulation of what follows from the first touch."""
        movers = tuple(self._mover(track) for track in self.tracks.values())
        hitches = [self._hitch(*coupled) for coupled in self.hitches]
        return Wreck(movers, self.count, hitches, self.friction, self.restitution, self.again, self.told)

    def _hitch(self, tractor: str, trailer: str, behind_m: float) -> Hitch:
        first, second = (self.tracks[name].driven[self.contact] for name in (tractor, trailer))
        return hitched((tractor, trailer), first, second, behind_m)

    def _mover(self, track: Track) -> Mover:
        mass = None if track.motion.fixed else track.mass or mass_kg(track.kind, track.size[0])
        start = body((0.0, 0.0, 0.0), track.size, mass)
        return Mover(track.actor, start, track.driven, self.drag(track), self.runs.get(track.actor))

    def drag(self, track: Track) -> Drag:
        """What slows an actor of whom nothing is chosen."""
        grip = DRIVING.sliding_mps2(self.surface)
        if actor_kind(track.kind).tumbles:
            return Drag(min(THROWN_MPS2, grip), min(THROWN_MPS2, grip))
        return Drag(min(ROLLING_MPS2 if track.actor in self.rolling else BRAKED_MPS2, grip), grip)

    def first_contact(self) -> ObservedContact | None:
        """The first overlap of any two actors, as any observer of the trajectories sees it."""
        names = sorted(self.tracks)
        found: tuple[int, str, str] | None = None
        for i, a in enumerate(names):
            for b in names[i + 1 :]:
                one, two = self.tracks[a], self.tracks[b]
                hits = np.flatnonzero(gaps_where_near(one.poses, one.size, two.poses, two.size) <= 0)
                if len(hits) and (found is None or hits[0] < found[0]):
                    found = (int(hits[0]), a, b)
        return None if found is None else self._observed(*found)

    def _observed(self, k: int, a: str, b: str) -> ObservedContact:
        p, q = self._box(a, k), self._box(b, k)
        sides = _area(contact_area(p, q)), _area(contact_area(q, p))
        return ObservedContact(actor=a, other=b, actor_area=sides[0], other_area=sides[1], t_s=round(k * STEP_S, 3))

    def _box(self, name: str, k: int) -> Box:
        track = self.tracks[name]
        x, y, heading = (float(v) for v in track.poses[k])
        return Box(x, y, heading, *track.size)

    def replay(self, name: str, from_s: float, to_s: float) -> Motion:
        """An actor's track as a motion whose own time 0 is the first contact; to be met in a span of time."""
        track = self.tracks[name]
        times = clock(-self.contact, self.count - self.contact)
        path = Path(track.poses[:, :2], times, track.poses[:, 2])
        speed = np.hypot(*np.gradient(track.poses[:, :2], STEP_S, axis=0).T)
        unseen = (speed > _STANDS_MPS) & (speed < _SHOWN_MPS)
        outside = np.where((times < from_s) | (times > to_s), 50.0, 0.0) + _UNSEEN_COST * unseen
        return Motion(path, times, times, track.size, outside, 0.0)

    def trajectories(self, order: tuple[str, ...], told: Courses = NOTHING_TOLD) -> tuple[Trajectory, ...]:
        """All tracks as records, in the given order; `told`: who rolls over."""
        return tuple(_trajectory(self.tracks[name], told.get(name)) for name in order)


def _trajectory(track: Track, told: CourseTold | None) -> Trajectory:
    """Speeds are those of the positions, taken apart before and behind an impact."""
    poses = track.poses
    step = np.hypot(*np.diff(poses[:, :2], axis=0).T) / STEP_S
    speed = np.concatenate((step[:1], (step[1:] + step[:-1]) / 2, step[-1:]))
    if track.hit is not None and 0 < track.hit < len(step):
        speed[track.hit] = step[track.hit - 1]
    t = np.round(np.arange(len(poses)) * STEP_S, 3)
    return Trajectory(
        actor=track.actor, t_s=t, x_m=poses[:, 0].copy(), y_m=poses[:, 1].copy(),
        heading_rad=poses[:, 2].copy(), speed_mps=speed,
        roll_rad=rolled(poses, track.hit, told) if told and rolls_over(told) and track.hit is not None else None,
    )  # fmt: skip


def _area(name: str) -> Area:
    names: tuple[Area, ...] = ("front", "left", "back", "right")
    return names[SIDES.index(name)]


def _braked(motion: Motion, own: Floats, start: int) -> Floats:
    """Own times that run slower and slower from sample `start` on, so that the motion stops."""
    if start >= len(own):
        return own
    speed = abs(float(np.diff(motion.stations(own[start] + np.array([0.0, STEP_S])))[0])) / STEP_S
    lasts = max(speed / _BRAKING_MPS2, STEP_S)
    since = np.minimum(np.maximum(np.arange(len(own)) - start, 0) * STEP_S, lasts)
    slowed: Floats = np.where(np.arange(len(own)) <= start, own, own[start] + since - since**2 / (2 * lasts))
    return slowed
