"""The simulation after a first touch: bodies push, turn, drag and stop each other until all stand.

Time-stepped rigid bodies in the plane: impulses at every touch, over all pairs until none approaches (sequential
impulses; E. Catto, Iterative Dynamics with Temporal Coherence, 2005), friction on the ground in between, steps short
enough that boxes sink into each other by centimetres only (conservative advancement; B. Mirtich, Impulse-based Dynamic
Simulation, 1996). Bodies without a touch follow their scripts. SI units.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.aftermath.blow import Blow, blow, lacking, most_restitution, part
from sgcad_core.planner.aftermath.crush import STEP_LONGEST_S, Crushes
from sgcad_core.planner.aftermath.ground_friction import apply_friction
from sgcad_core.planner.aftermath.hitch import Hitch, draw_together, equalize_velocities
from sgcad_core.planner.aftermath.impact import USUAL, Body, Impact, Point, approach, collide, slow_parting
from sgcad_core.planner.aftermath.wreck_bodies import (
    Mover,
    Pair,
    Separation,
    Touch,
    center_of,
    fastest_closing,
    first_sample,
    give_way,
    glances,
    key_of,
    last_move,
    may_meet,
    pairs_apart,
    separation,
    separations,
    set_on_script,
    shift,
    state_of,
    touch_points,
)
from sgcad_core.planner.motion import STEP_S

SEEN_M = 0.022
"""Depth at which a new touch takes effect: this much overlap is visible at the next sample."""
APART_M = 0.008
"""Gap that is left between bodies that touched."""
_PARTED_M = 0.05
"""Gap beyond which two bodies that meet again touch anew."""
_SHOWN_M = 0.008
"""Overlap that is left for the sample behind a touch."""
_SHORTEST_S, _LONGEST_S, _LEAST_LEFT_S, _SHORTEST_LEFT_S = 0.0005, 0.01, 0.1, 1e-3
_NEAR_M = 0.15
"""Bodies further apart move in steps of the clock, as long as these cannot bring them together."""
_HELD_S = 0.11
"""A touch is kept for two samples, so that samples, and files with fewer vertices, show it."""
_GIVES_S = 0.1
"""Time for which a thing that gives way is pushed along."""
_TOLD_S, _TOLD_HELD_S, _SLOW_MPS = 0.2, 0.25, 2.2
"""Time for which the bodies of a stated touch hold, and for which the touch is kept, as of bodies so slow that samples
lie nearer than the vertices of a file (0.11 m)."""
_DEEPEST_M = 0.03
"""Deeper overlaps are parted at once."""
_ROUNDS, _ROUNDS_OF_MANY = 6, 60
"""Rounds of impulses over all touching pairs in one step: a body between two that are much heavier needs many."""
_FASTER_MPS = 4.0
"""Gain in speed within a sample for which the room of `may_meet` (0.5 m) suffices."""


@dataclass
class Wreck:
    """Movers on one clock of `count` samples; all stand `ends` samples after the start of it."""

    movers: Sequence[Mover]
    count: int
    hitches: Sequence[Hitch] = ()
    impact: Impact = USUAL
    again: frozenset[frozenset[str]] = frozenset()
    """Pairs with a stated second touch: it is kept visible like the first."""
    told: frozenset[frozenset[str]] = frozenset()
    """Pairs with a stated later touch, however gentle."""
    past: list[tuple[float, tuple[str, str]]] = field(default_factory=list)
    """Touches of these pairs that are over."""
    touches: dict[tuple[str, str], float] = field(default_factory=dict)
    """Pairs that touched, with the time of it."""
    gone: set[tuple[str, str]] = field(default_factory=set)
    """Pairs of which one gave way to the other."""
    blows: dict[tuple[str, str], Blow] = field(default_factory=dict)
    """What pairs that hold each other lack of the velocities with which they part."""
    crushes: Crushes = field(init=False)
    now: float = 0.0

    def __post_init__(self) -> None:
        self.named: Mapping[str, Mover] = {m.name: m for m in self.movers}
        self.crushes = Crushes(self.impact)
        self._movable, self._lasting = [m for m in self.movers if not m.fixed], set(self.told)

    def settle(self, until: int | None = None) -> tuple[dict[str, Floats], list[Touch]]:
        """(count, 3) poses by name, and the touches in the order in which they happen. `until`: stop there; the bodies
        are then as they are at that sample, the poses behind it are the scripts'."""
        pairs = pairs_apart(self.movers)
        start = first_sample(pairs, self.count)
        poses = {m.name: m.script.copy() for m in self.movers}
        drives = {m.name: last_move(m.script) for m in self.movers}
        before, end = None, min(self.count - 1, until or self.count)
        for k in range(start, end):
            self._sample(k, pairs)
            state = [state_of(m.body) for m in self.movers]
            over = state == before and self._rests() and all(m.free or k > drives[m.name] for m in self.movers)
            for m in self.movers:
                if m.free:
                    poses[m.name][k + 1 : end + 1 if over else k + 2] = (m.body.x, m.body.y, m.body.heading)
            if over:
                break
            before = state
        seen = sorted([*self.past, *((t, pair) for pair, t in self.touches.items())])
        return poses, [Touch(t, *pair) for t, pair in seen]

    def _rests(self) -> bool:
        """Whether nothing moves and no touch is so new that time alone would change its effect."""
        latest = max(self.touches.values(), default=0.0)
        return self.now - latest > _TOLD_HELD_S + STEP_S and all(m.body.stands for m in self.movers)

    def _sample(self, k: int, pairs: Sequence[Pair]) -> None:
        for m in self.movers:
            if not m.free:
                set_on_script(m, k)
        self.now, end = k * STEP_S, (k + 1) * STEP_S
        self._let_go()
        near, fastest = self._near(pairs)
        seen = None
        while self.now < end - 1e-9:
            step = min(self._step(near, seen or separations(near)), end - self.now)
            self._advance(step)
            self.now += step
            seen = self._resolve(near, k, step)
            if any(m.body.speed > most for m, most in zip(self._movable, fastest, strict=True)):
                near, fastest = self._near(pairs)
                seen = None
        self._show(near, k)

    def _near(self, pairs: Sequence[Pair]) -> tuple[list[Pair], list[float]]:
        """Pairs that can meet within a sample, and the speeds of the movable bodies up to which this holds."""
        left = [pair for pair in pairs if key_of(*pair) not in self.gone] if self.gone else pairs
        return [pair for pair in left if may_meet(*pair)], [m.body.speed + _FASTER_MPS for m in self._movable]

    def _let_go(self) -> None:
        """Throws things that give way aside once their touch was seen; their vehicles then pass them."""
        for key, since in self.touches.items():
            a, b = (self.named[name] for name in key)
            if a.gives_way != b.gives_way and key not in self.gone and self.now - since >= _GIVES_S:
                thing, by = (a, b) if a.gives_way else (b, a)
                give_way(thing, by.body, self.now)
                self.gone.add(key)

    def _show(self, near: Sequence[Pair], sample: int) -> None:
        """Leaves the touches of this sample overlapping at its end, after any rotation."""
        for a, b in near:
            if self.touches.get(key_of(a, b), -1.0) > sample * STEP_S:
                seen = separation(a.body, b.body)
                shift(a, b, seen, min(-_SHOWN_M - seen.gap_m, 0.0))

    def _step(self, near: Sequence[Pair], gaps: Sequence[Separation]) -> float:
        """The longest step after which no pair has sunk deeper than it may; `gaps`: how far each is apart."""
        longest = _LONGEST_S if self.hitches else STEP_S
        for (a, b), (gap, normal) in zip(near, gaps, strict=True):
            if gap < _NEAR_M and longest > _LONGEST_S:
                longest = _LONGEST_S
            closing = fastest_closing(a.body, b.body, normal)
            if self.crushes.last(a, b, self.now):
                longest = min(longest, STEP_LONGEST_S)
            elif closing > 0:
                room = gap + 1.2 * SEEN_M if key_of(a, b) not in self.touches else max(gap, 0.0) + 0.3 * SEEN_M
                longest = min(longest, max(room / closing, _SHORTEST_S))
        return longest

    def _advance(self, step: float) -> None:
        left = max((self.count - 4) * STEP_S - self.now, _LEAST_LEFT_S)
        for m in self._movable:
            one = m.body
            one.x += one.vx * step
            one.y += one.vy * step
            one.heading += one.spin * step
            if m.free:
                apply_friction(one, m.drag, step, left, m.run_at(self.now), self.now)

    def _resolve(self, near: Sequence[Pair], sample: int, step: float) -> Sequence[Separation] | None:
        """Applies all touches at one time. Returns the separation of each pair; None where bodies were moved."""
        self._let_part(sample)
        gaps = separations(near)
        self.crushes.squeeze(near, self.now, step)
        touching = [(a, b, seen) for (a, b), seen in zip(near, gaps, strict=True) if self._touches(a, b, seen, sample)]
        if not touching and not self.hitches:
            return gaps
        corners = [touch_points(a.body, b.body) for a, b, _ in touching]
        new = [] if self.hitches or len(touching) > 1 else [t for t in touching if self._is_new(*t[:2])]
        wanted = [blow((a.body, b.body), (center_of(corners[0]), seen.normal), self.impact) for a, b, seen in new]
        for (a, b, seen), points in zip(touching, corners, strict=True):
            at = center_of(points)
            collide(a.body, b.body, at, seen.normal, self._bounce(a, b, seen, at, sample), self.impact.friction)
        for _ in range(_ROUNDS if len(touching) < 2 else _ROUNDS_OF_MANY):
            moved = False
            for (a, b, seen), points in zip(touching, corners, strict=True):
                for at in points:
                    moved |= collide(a.body, b.body, at, seen.normal, 0.0, self.impact.friction)
            for hitch in self.hitches:
                moved |= self._joined(hitch, equalize_velocities)
            if not moved:
                break
        parted = False
        for (a, b, seen), points in zip(touching, corners, strict=True):
            self._keep_seen(a, b, seen, points, sample)
            parted |= self._part(a, b, seen)
        self.blows |= {key_of(a, b): lacking(w, a.body, b.body) for (a, b, _), w in zip(new, wanted, strict=True)}
        for hitch in self.hitches:
            self._joined(hitch, draw_together)
        return None if parted or self.hitches else gaps

    def _is_new(self, a: Mover, b: Mover) -> bool:
        """Whether two bodies come to touch, and neither gives way."""
        return self.now - self.touches[key_of(a, b)] <= 1e-9 and not (a.gives_way or b.gives_way)

    def _let_part(self, sample: int) -> None:
        """Lets bodies part that no longer hold each other, or came apart before they were to."""
        for key in list(self.blows):
            a, b = self.named[key[0]], self.named[key[1]]
            if key not in self.touches or self._held_s(a, b, sample) <= 0.0:
                part(self.blows.pop(key), a.body, b.body)

    def _joined(self, hitch: Hitch, act: Callable[[Hitch, Body, Body], bool]) -> bool:
        """Applies a hitch to its two bodies, once both are free."""
        a, b = self.named[hitch.first], self.named[hitch.second]
        return a.free and b.free and act(hitch, a.body, b.body)

    def _touches(self, a: Mover, b: Mover, seen: Separation, sample: int) -> bool:
        """Whether a pair is in touch; both are free from the first time on."""
        if (key := key_of(a, b)) in self.gone:
            return False
        if key in self.touches and seen.gap_m > _PARTED_M and frozenset(key) in self.again:
            self.past.append((self.touches.pop(key), key))
        if key in self.touches:
            return seen.gap_m < APART_M and not self.crushes.last(a, b, self.now)
        if seen.gap_m > 0:
            return False
        coming = approach(a.body, b.body, center_of(touch_points(a.body, b.body)), seen.normal) > 0
        if coming and seen.gap_m > -SEEN_M:
            return False
        self.touches[key] = self.now
        self._lasting |= {frozenset(key)} if any(0.0 < m.body.speed < _SLOW_MPS for m in (a, b)) else set()
        for m in (a, b):
            self._release(m, sample)
        self.gone |= {key} if a.flat or b.flat or glances(a, b) else set()
        return key not in self.gone and not self.crushes.begins(a, b, seen, self.now)

    def _release(self, m: Mover, sample: int) -> None:
        """Frees a body and what is coupled to it."""
        if m.fixed or m.free:
            return
        m.free, m.hit = True, sample
        for hitch in self.hitches:
            for one, other in ((hitch.first, hitch.second), (hitch.second, hitch.first)):
                if one == m.name:
                    self._release(self.named[other], sample)

    def _bounce(self, a: Mover, b: Mover, seen: Separation, at: Point, sample: int) -> float:
        """Restitution of a new touch: no more than leaves the overlap visible at the next sample."""
        if self.now - self.touches[key_of(a, b)] > 1e-9:
            return 0.0
        closing = approach(a.body, b.body, at, seen.normal)
        left = max(self._held_s(a, b, sample), _SHORTEST_LEFT_S)
        most = min(self.impact.restitution, most_restitution(closing))
        return min(most, 0.5 * max(-seen.gap_m, 0.0) / (left * max(closing, 1e-6)))

    def _keep_seen(self, a: Mover, b: Mover, seen: Separation, points: list[Point], sample: int) -> None:
        """Keeps the bodies of a new touch together until the next sample: crushing bodies hold for 0.1 s."""
        left = self._held_s(a, b, sample)
        if left <= 0.0:
            return
        at = center_of(points)
        allowed = 0.5 * max(-seen.gap_m, 0.0) / max(left, _SHORTEST_LEFT_S)
        parting = -approach(a.body, b.body, at, seen.normal)
        if parting > allowed:
            slow_parting(a.body, b.body, at, seen.normal, parting - allowed)

    def _held_s(self, a: Mover, b: Mover, sample: int) -> float:
        """Time for which two touching bodies still hold; 0 or less where they may part."""
        since = self.touches[key_of(a, b)]
        if frozenset((a.name, b.name)) in self._lasting and key_of(a, b) not in self.crushes.pulses:
            return since + _TOLD_S - self.now
        return (sample + 1) * STEP_S - self.now if since > sample * STEP_S else 0.0

    def _part(self, a: Mover, b: Mover, seen: Separation) -> bool:
        """Moves two overlapping bodies apart, places only, without velocity. Whether they were moved."""
        for_s = _TOLD_HELD_S if frozenset((a.name, b.name)) in self._lasting else _HELD_S
        held = self.now - self.touches[key_of(a, b)] < for_s and seen.gap_m > -_DEEPEST_M
        if seen.gap_m >= APART_M or held:
            return False
        shift(a, b, seen, min(APART_M - seen.gap_m, self.crushes.parting_mps(a, b) * _LONGEST_S / 2))
        return True
