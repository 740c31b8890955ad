"""The bodies of the simulation after a contact: their scripts, and the separation of two.

Knows one sample of the clock at most; no touches and no time. Two boxes in plain floats are the scalar twin of
`geometry.plane.box_gaps`, since arrays of one row cost more than they save in small time steps. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats, box_gaps, first_overlap
from sgcad_core.planner.aftermath.ground_friction import Drag, RunOut
from sgcad_core.planner.aftermath.impact import Body, Point
from sgcad_core.planner.motion import STEP_S

Pair = tuple["Mover", "Mover"]
_ASIDE_S, _PASSES_M = 0.2, 0.15
"""Time in which a thing that gives way is out of the way, and the gap at which it is then passed."""
FALLEN_MPS2 = 50.0
"""Of a post that has fallen over: its lower end digs in. From 15 m/s it lies 2 m further."""
_LEAST_ASIDE_MPS, _MOST_ASIDE_MPS = 1.0, 8.0
LOST, _CLEARS_M = 2.0, 0.1
"""Share of its speed that a body loses when it glances off a firm thing, for the share of its width that overlaps (half
at a quarter, about as cars do in the small-overlap test), and the gap at which it then passes."""
_NEAR_M = 0.03
"""Corners this close to the other box take part in a touch."""


@dataclass
class Mover:
    """One body with the (n, 3) poses that it would follow undisturbed; `free` once it was touched."""

    name: str
    body: Body
    script: Floats
    drag: Drag
    runs: tuple[RunOut, ...] = ()
    """Its run-outs, each from its time on; before the first it slides with its drag."""
    free: bool = False
    hit: int | None = None
    """The last sample before its first touch takes effect."""
    gives_way: bool = False
    """Whether what strikes it goes on past it."""
    firm: bool = False
    """Whether what strikes it glances off it and goes on, while it stays."""
    flat: bool = False
    """Whether what strikes it drives over it, while it stays."""
    falls: bool = False
    """Whether it falls over where it gives way, and digs in."""

    def run_at(self, now_s: float) -> RunOut | None:
        """The run-out that counts at a time."""
        return next((run for run in reversed(self.runs) if now_s >= run.from_s), None) if self.runs else None

    @property
    def fixed(self) -> bool:
        """Whether nothing moves it."""
        return self.body.inverse_mass == 0.0


class Separation(NamedTuple):
    """Separation along the best axis (negative: overlap) and that axis, a unit vector from the first to the second."""

    gap_m: float
    normal: Point


class Touch(NamedTuple):
    """Two movers touch."""

    t_s: float
    first: str
    second: str


def shift(a: Mover, b: Mover, seen: Separation, by_m: float) -> None:
    """Moves two bodies apart along their axis (together where negative), places only, without velocity."""
    total = a.body.inverse_mass + b.body.inverse_mass
    for one, sign in ((a.body, -1), (b.body, 1)):
        share = sign * by_m * one.inverse_mass / total
        one.x += share * seen.normal[0]
        one.y += share * seen.normal[1]


def give_way(thing: Mover, by: Body, now_s: float) -> None:
    """Throws a thing out of the way of what struck it; what falls over lies there a few metres further."""
    _throw_aside(thing.body, by)
    if thing.falls:
        thing.runs = (RunOut(now_s + _ASIDE_S, FALLEN_MPS2, slides=True),)


def _throw_aside(thing: Body, by: Body) -> None:
    """Gives a struck thing the speed of what struck it, and throws it to the nearer side of the way of that."""
    dx, dy = thing.x - by.x, thing.y - by.y
    c, s = math.cos(by.heading), math.sin(by.heading)
    left = dy * c - dx * s
    clear = by.size[1] / 2 + _half_across(thing, by.heading) + _PASSES_M - abs(left)
    aside = math.copysign(min(max(clear / _ASIDE_S, _LEAST_ASIDE_MPS), _MOST_ASIDE_MPS), left)
    thing.vx, thing.vy, thing.spin = by.vx - aside * s, by.vy + aside * c, 0.0


def glances(a: Mover, b: Mover) -> bool:
    """Leads a body that comes to touch a firm thing past it; whether one of the two is such a thing."""
    if a.firm != b.firm:
        thing, by = (a, b) if a.firm else (b, a)
        _glance(thing.body, by.body, by.drag.across)
    return a.firm != b.firm


def _glance(thing: Body, by: Body, across_mps2: float) -> None:
    """Leads a body past a firm thing before one of its corners: it loses some of its speed, its corner is held back,
    and it is pushed as far to the other side as the two overlap, against the friction of the ground."""
    speed = by.speed
    c, s = (by.vx / speed, by.vy / speed) if speed > 0.0 else (math.cos(by.heading), math.sin(by.heading))
    dx, dy = thing.x - by.x, thing.y - by.y
    left, way = dy * c - dx * s, math.atan2(s, c)
    half = _half_across(by, way)
    overlap = min(max(half + _half_across(thing, way) - abs(left), 0.0), half)
    aside = -math.copysign(math.sqrt(2 * across_mps2 * (overlap + _CLEARS_M)), left)
    lost = LOST * overlap / (2 * half) * speed
    by.vx -= lost * c + aside * s
    by.vy -= lost * s - aside * c
    by.spin += math.copysign(half - overlap / 2, left) * lost * by.inverse_inertia / by.inverse_mass


def _half_across(one: Body, way_rad: float) -> float:
    """Half of the width of a body across a direction."""
    off = way_rad - one.heading
    return (one.size[0] * abs(math.sin(off)) + one.size[1] * abs(math.cos(off))) / 2


def separations(near: Sequence[Pair]) -> list[Separation]:
    """The separation of each pair."""
    return [separation(a.body, b.body) for a, b in near]


def state_of(one: Body) -> tuple[float, float, float, float, float, float]:
    """All that a step changes: place, heading, velocity, spin."""
    return one.x, one.y, one.heading, one.vx, one.vy, one.spin


def last_move(script: Floats) -> int:
    """The last sample that differs from the one before it."""
    moves = np.flatnonzero((np.diff(script, axis=0) != 0.0).any(axis=1))
    return int(moves[-1]) + 1 if len(moves) else 0


def pairs_apart(movers: Sequence[Mover]) -> list[Pair]:
    """All pairs but those that overlap from the start: parts of one thing, or scenery."""
    found = []
    for a, b in combinations(movers, 2):
        first = box_gaps(a.script[:1], a.body.size, b.script[:1], b.body.size)[0]
        if first > 0 and not (a.fixed and b.fixed):
            found.append((a, b))
    return found


def first_sample(pairs: Sequence[Pair], count: int) -> int:
    """The sample before the first overlap of any two scripts; the last of `count` where there is none."""
    first = count
    for a, b in pairs:
        hit = first_overlap(a.script, a.body.size, b.script, b.body.size)
        first = first if hit is None else min(first, hit)
    return max(first - 1, 0)


def key_of(a: Mover, b: Mover) -> tuple[str, str]:
    """A pair by its names."""
    return a.name, b.name


def set_on_script(m: Mover, k: int) -> None:
    """Puts a body on its script at sample k, moving to the next."""
    here, there = m.script[k], m.script[k + 1]
    m.body.x, m.body.y, m.body.heading = (float(v) for v in here)
    m.body.vx, m.body.vy, m.body.spin = (float(v) for v in (there - here) / STEP_S)


def may_meet(a: Mover, b: Mover) -> bool:
    """Whether two can come into touch within a sample."""
    if not (a.free or b.free or _moves(a) or _moves(b)):
        return False
    reach = a.body.radius + b.body.radius + (a.body.speed + b.body.speed) * STEP_S + 0.5
    return math.hypot(a.body.x - b.body.x, a.body.y - b.body.y) < reach


def _moves(m: Mover) -> bool:
    return bool(m.body.vx or m.body.vy or m.body.spin)


# ------------------------------------------------------------------ two boxes, in plain floats
def separation(a: Body, b: Body) -> Separation:
    """The separating-axis test: exact in sign, a lower bound of the distance where positive."""
    dx, dy = b.x - a.x, b.y - a.y
    ca, sa, cb, sb = math.cos(a.heading), math.sin(a.heading), math.cos(b.heading), math.sin(b.heading)
    along, across = abs(ca * cb + sa * sb), abs(ca * sb - sa * cb)
    al, aw, bl, bw = a.size[0] / 2, a.size[1] / 2, b.size[0] / 2, b.size[1] / 2
    rows = (
        (dx * ca + dy * sa, al + bl * along + bw * across, ca, sa),
        (dy * ca - dx * sa, aw + bl * across + bw * along, -sa, ca),
        (dx * cb + dy * sb, bl + al * along + aw * across, cb, sb),
        (dy * cb - dx * sb, bw + al * across + aw * along, -sb, cb),
    )
    gap, best = -math.inf, rows[0]
    for row in rows:  # the first of the widest; max() with a key takes three times as long
        if (wide := abs(row[0]) - row[1]) > gap:
            gap, best = wide, row
    way, _, x, y = best
    return Separation(gap, (x, y) if way >= 0 else (-x, -y))


def fastest_closing(one: Body, other: Body, normal: Point) -> float:
    """The speed at which any points of two bodies can come together along a normal (from the first), m/s."""
    closing = (one.vx - other.vx) * normal[0] + (one.vy - other.vy) * normal[1]
    return closing + abs(one.spin) * one.radius + abs(other.spin) * other.radius


def touch_points(a: Body, b: Body) -> list[Point]:
    """The corners of either box in (or within centimetres of) the other; the point midway where there are none."""
    one, two = _frame(a), _frame(b)
    points = [*_held(one, two), *_held(two, one)]
    return points or [((a.x + b.x) / 2, (a.y + b.y) / 2)]


def center_of(points: list[Point]) -> Point:
    """The center of some points."""
    if len(points) == 1:
        return points[0]
    return sum([p[0] for p in points]) / len(points), sum([p[1] for p in points]) / len(points)


_Frame = tuple[float, float, float, float, float, float]
"""Center, cosine and sine of the heading, half length and half width of a box."""


def _frame(a: Body) -> _Frame:
    return a.x, a.y, math.cos(a.heading), math.sin(a.heading), a.size[0] / 2, a.size[1] / 2


def _held(one: _Frame, other: _Frame) -> list[Point]:
    """The corners of a box in (or within centimetres of) another, counter-clockwise from front left."""
    x, y, c, s, length, width = one
    lc, ls, wc, ws = length * c, length * s, width * c, width * s
    corners = (
        (x + lc - ws, y + ls + wc), (x - lc - ws, y - ls + wc), (x - lc + ws, y - ls - wc), (x + lc + ws, y + ls - wc)
    )  # fmt: skip
    x, y, c, s, length, width = other
    length, width = length + _NEAR_M, width + _NEAR_M
    return [
        p for p in corners
        if abs((p[0] - x) * c + (p[1] - y) * s) <= length and abs((p[1] - y) * c - (p[0] - x) * s) <= width
    ]  # fmt: skip
