"""All actors on one world clock: tracks, their contacts, and what happens to them afterwards.

A track is (n, 3) poses 0.05 s apart from time 0. Knows motions and the wreck, no maneuvers.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from sgcad_core.case.records import ObservedContact, Trajectory
from sgcad_core.geometry.plane import Box, Floats, Size, contact_area, first_overlap, gaps_where_near
from sgcad_core.kinds import actor_kind, mass_kg
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.aftermath.ground_friction import Drag, RunOut
from sgcad_core.planner.aftermath.hitch import hitched
from sgcad_core.planner.aftermath.impact import USUAL, Impact, body
from sgcad_core.planner.aftermath.rollover import quarters_short, roll_angles, rolls_over, turned_over
from sgcad_core.planner.aftermath.wreck import Wreck
from sgcad_core.planner.aftermath.wreck_bodies import Mover, Touch
from sgcad_core.planner.lines.path import Path
from sgcad_core.planner.motion import STEP_S, Motion, clock
from sgcad_core.records.course import NOTHING_TOLD, Courses, CourseTold
from sgcad_core.records.specs import ActorKind, Area, Surface

AFTER_S = 5.0
"""From the first contact to the end: from 80 mph at 0.75 g all stand by then."""
BRAKED_MPS2 = 4.5
"""Of a struck vehicle along its wheels: some locked or bent, with the brake applied."""
ROLLING_MPS2 = 2.2
"""Of a vehicle that has a further contact."""
TUMBLING_MPS2 = 9.0
"""Of things that are knocked over: they dig in."""
THROWN_MPS2 = 5.5
"""Of pedestrians, and of two-wheelers on their side, over the ground."""
_REACTION_S = 0.5
_BRAKING_MPS2 = 5.0
_STANDS_MPS, _SHOWN_MPS = 0.02, 2.6
"""Between these speeds a vehicle moves less than 0.11 m in a sample. Players drop vertices that lie nearer, and with
them the moment of the impact."""
_UNSEEN_COST = 2.0
GIVES_WAY_KG = 60.0
"""Mass of things that give way: a breakaway post, a sign, a piece of fence."""
CLEAR_M = 0.25
"""Actors that do not touch pass each other at this distance or more where possible."""


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
    """Its mass where it differs from that of its kind, kg."""
    gives_way: bool = False
    """Whether what strikes it goes on past it."""
    firm: bool = False
    """Whether what strikes it glances off it and goes on, while it stays."""
    flat: bool = False
    """Whether what strikes it drives over it, while it stays."""
    driven: Floats = field(init=False)
    """Its poses without any contact."""

    def __post_init__(self) -> None:
        self.driven = self.poses

    def let_pass(self, *, glances: bool, stays: bool) -> None:
        """Lets what strikes it go on: it `glances` off a thing that stays, or along one, or goes past one that gives
        way."""
        self.firm = glances
        if not (glances or stays):
            self.give_way()

    def give_way(self) -> None:
        """Lets what strikes it go on past it: people are thrown aside, of things a breakaway post or a piece."""
        self.motion, self.gives_way = replace(self.motion, fixed=False), True
        self.mass = GIVES_WAY_KG if actor_kind(self.kind).thing else None


class _Settled(NamedTuple):
    """Result of a settled scene: poses, touches, and the index of the first impact by actor."""

    poses: dict[str, Floats]
    touches: list[Touch]
    hits: dict[str, int | None]
    driven: list[Floats]
    """The undisturbed poses; kept so that their ids stay valid as keys."""


@dataclass
class Scene:
    """Tracks by actor, in the order of placing; `contact` is the index of the first contact."""

    count: int
    contact: int
    rolling: frozenset[str] = frozenset()
    """Actors with a further contact ahead."""
    surface: Surface | None = None
    tracks: dict[str, Track] = field(default_factory=dict)
    aside: dict[str, Track] = field(default_factory=dict)
    """What is struck before the first contact and gives way: no bodies of the simulation."""
    hitches: list[tuple[str, str, float]] = field(default_factory=list)
    """Tractor, trailer, and how far behind the tractor's center they are coupled."""
    touches: list[Touch] = field(default_factory=list)
    """Touches in order, as of the last settling."""
    runs: dict[str, tuple[RunOut, ...]] = field(default_factory=dict)
    """Chosen run-outs after impacts, by actor, in order of time."""
    impact: Impact = USUAL
    again: frozenset[frozenset[str]] = frozenset()
    """Pairs with a stated second contact."""
    sides: dict[frozenset[str], dict[str, Area]] = field(default_factory=dict)
    """The sides of the second contacts, by actor."""
    told: frozenset[frozenset[str]] = frozenset()
    """Pairs with a stated contact after the first."""
    _settled: dict[Hashable, _Settled] = field(default_factory=dict, repr=False)

    @property
    def everybody(self) -> dict[str, Track]:
        """All tracks."""
        return {**self.tracks, **self.aside}

    def add(self, actor: str, kind: ActorKind, motion: Motion, own_at_contact_s: float, *, brakes: bool) -> Track:
        """Places an actor so that its own clock shows the given time at the first contact."""
        self.tracks[actor] = track = self.track(actor, kind, motion, own_at_contact_s, brakes=brakes)
        return track

    def track(self, actor: str, kind: ActorKind, motion: Motion, own_at_contact_s: float, *, brakes: bool) -> Track:
        """The track of an actor whose own clock shows the given time at the first contact, not yet placed."""
        own = own_at_contact_s if motion.standing else own_at_contact_s - self.contact * STEP_S
        return Track(actor, kind, motion.size, self.poses(motion, own_at_contact_s, brakes=brakes), motion, own)

    def poses(self, motion: Motion, own_at_contact_s: float, *, brakes: bool) -> Floats:
        """(count, 3) poses of a motion; `brakes`: it stops after the first contact."""
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
        """Simulates all actors until they stand; results are cached by their causes."""
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
        """All that determines the motion to rest."""
        movers = tuple(
            (t.actor, id(t.driven), t.size, t.mass, t.motion.fixed, t.gives_way, t.firm, t.flat)
            for t in self.tracks.values()
        )
        chosen = self.impact, self.again, self.told, tuple(self.runs.items())
        return movers, tuple(self.hitches), chosen, self.rolling, self.surface, self.count

    def wreck(self) -> Wreck:
        """The simulation from the first touch on."""
        movers = tuple(self._mover(track) for track in self.tracks.values())
        hitches = [
            hitched((a, b), self.tracks[a].driven[self.contact], self.tracks[b].driven[self.contact], behind_m)
            for a, b, behind_m in self.hitches
        ]
        return Wreck(movers, self.count, hitches, self.impact, self.again, self.told)

    def _mover(self, track: Track) -> Mover:
        mass = None if track.motion.fixed else track.mass or mass_kg(track.kind, track.size[0])
        start = body((0.0, 0.0, 0.0), track.size, mass)
        runs = self.runs.get(track.actor, ())
        return Mover(
            track.actor, start, track.driven, self.drag(track), runs, gives_way=track.gives_way, firm=track.firm,
            flat=track.flat, falls=actor_kind(track.kind).thing,
        )  # fmt: skip

    def drag(self, track: Track) -> Drag:
        """Deceleration of an actor without a chosen run-out."""
        along = ROLLING_MPS2 if track.actor in self.rolling else BRAKED_MPS2
        return usual_drag(track.kind, DRIVING.sliding_mps2(self.surface), along)

    def turn_over(self, told: Courses) -> Iterator[str]:
        """Lets vehicles without a contact roll over from the time of the first contact on, as told; notes on them."""
        for name, track in self.tracks.items():
            if name in told and rolls_over(told[name]) and track.hit is None:
                track.hit, track.poses = self.contact, turned_over(track.poses, self.contact, told[name])
                yield f"{name} rolls over and touches nobody"

    def last_fixed(self, name: str) -> Track | None:
        """What an actor touches last of the things that stay."""
        met = (t.second if t.first == name else t.first for t in reversed(self.touches) if name in (t.first, t.second))
        return next((self.tracks[other] for other in met if self.tracks[other].motion.fixed), None)

    def rolls_short(self, told: Courses) -> int:
        """The number of vehicles whose way to rest is too short for the told quarter turns."""
        hit = ((name, track, track.hit) for name, track in self.tracks.items() if track.hit is not None)
        rolls = ((track.poses, at, told[name], self._samples_of(name)) for name, track, at in hit if name in told)
        return sum(quarters_short(*roll) > 0 for roll in rolls)

    def first_contact(self) -> ObservedContact | None:
        """The first overlap of any two actors, as seen in the trajectories."""
        found: tuple[int, str, str] | None = None
        tracks = self.everybody
        for a, b in combinations(sorted(tracks), 2):
            one, two = tracks[a], tracks[b]
            hit = first_overlap(one.poses, one.size, two.poses, two.size)
            if hit is not None and (found is None or hit < found[0]):
                found = (hit, a, b)
        if found is None:
            return None
        k, a, b = found
        p, q = (Box.at(tracks[name].poses[k], tracks[name].size) for name in (a, b))
        t_s = round(k * STEP_S, 3)
        return ObservedContact(actor=a, other=b, actor_area=contact_area(p, q), other_area=contact_area(q, p), t_s=t_s)

    def replay(self, name: str, zero: int, from_s: float, to_s: float) -> Motion:
        """The track of an actor as a motion whose own time 0 is a sample, for an encounter within a time span."""
        track = self.tracks[name]
        times = clock(-zero, self.count - zero)
        path = Path(track.poses[:, :2], times, track.poses[:, 2])
        speed = np.hypot(*np.gradient(track.poses[:, :2], STEP_S, axis=0).T)
        unseen = (speed > _STANDS_MPS) & (speed < _SHOWN_MPS)
        outside = np.where((times < from_s) | (times > to_s), 50.0, 0.0) + _UNSEEN_COST * unseen
        return Motion(path, times, times, track.size, outside, 0.0)

    def trajectories(self, order: tuple[str, ...], told: Courses = NOTHING_TOLD) -> tuple[Trajectory, ...]:
        """All tracks as records, in the given order; `told`: stated courses, for rollovers."""
        return tuple(_trajectory(self.everybody[name], told.get(name), self._samples_of(name)) for name in order)

    def _samples_of(self, name: str) -> list[int]:
        """The samples at which an actor comes to touch others, in order."""
        return [round(touch.t_s / STEP_S) for touch in self.touches if name in (touch.first, touch.second)]


def usual_drag(kind: ActorKind, grip_mps2: float, along_mps2: float = BRAKED_MPS2) -> Drag:
    """Deceleration after a blow on a surface of some grip: vehicles slow along their wheels, people slide."""
    if actor_kind(kind).tumbles:
        return Drag(min(THROWN_MPS2, grip_mps2), min(THROWN_MPS2, grip_mps2))
    if actor_kind(kind).thing:
        return Drag(TUMBLING_MPS2, TUMBLING_MPS2)
    return Drag(min(along_mps2, grip_mps2), grip_mps2)


def sample_speeds(poses: Floats) -> Floats:
    """(n,) m/s at (n, 3) poses STEP_S apart: the mean of the steps before and behind each."""
    step = np.hypot(*np.diff(poses[:, :2], axis=0).T) / STEP_S
    return np.concatenate((step[:1], (step[1:] + step[:-1]) / 2, step[-1:]))


def _trajectory(track: Track, told: CourseTold | None, touches: Sequence[int]) -> Trajectory:
    """Speeds follow from the positions, separately before and after an impact."""
    poses = track.poses
    speed = sample_speeds(poses)
    if track.hit is not None and 0 < track.hit < len(poses) - 1:
        speed[track.hit] = np.hypot(*(poses[track.hit, :2] - poses[track.hit - 1, :2])) / STEP_S
    t = np.round(np.arange(len(poses)) * STEP_S, 3)
    over = told is not None and rolls_over(told) and track.hit is not None
    return Trajectory(
        actor=track.actor, t_s=t, x_m=poses[:, 0].copy(), y_m=poses[:, 1].copy(),
        heading_rad=poses[:, 2].copy(), speed_mps=speed,
        roll_rad=roll_angles(poses, track.hit, told, touches) if over else None,  # type: ignore[arg-type]
    )  # fmt: skip


def _braked(motion: Motion, own: Floats, start: int) -> Floats:
    """Own times that run slower and slower from sample `start` on, so that the motion stops."""
    if start >= len(own):
        return own
    speed = abs(float(np.diff(motion.stations(own[start] + np.array([0.0, STEP_S])))[0])) / STEP_S
    lasts = max(speed / _BRAKING_MPS2, STEP_S)
    since = np.minimum(np.maximum(np.arange(len(own)) - start, 0) * STEP_S, lasts)
    slowed: Floats = np.where(np.arange(len(own)) <= start, own, own[start] + since - since**2 / (2 * lasts))
    return slowed
