"""Who takes part in a wreck: bodies with the ways that they would go undisturbed, and what two are to each other.

Knows one sample of the clock at most; no touches and no time. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.aftermath.ground_friction import Drag, RunOut
from sgcad_core.planner.aftermath.impact import Body
from sgcad_core.planner.encounter.box_scalar import Apart, apart
from sgcad_core.planner.motion import STEP_S

Pair = tuple["Mover", "Mover"]


@dataclass
class Mover:
    """One body with the (n, 3) poses that it would follow undisturbed; `free` once it was touched."""

    name: str
    body: Body
    script: Floats
    drag: Drag
    run: RunOut | None = None
    """How it runs out; None: it slides with its drag."""
    free: bool = False
    hit: int | None = None
    """The last sample before its first touch takes effect."""

    @property
    def fixed(self) -> bool:
        """Whether nothing moves it."""
        return self.body.inverse_mass == 0.0


class Touch(NamedTuple):
    """Two movers touch."""

    t_s: float
    first: str
    second: str


def shift(a: Mover, b: Mover, seen: Apart, by_m: float) -> None:
    """Move two apart along their axis (together where negative): places only, no motion comes of it."""
    total = a.body.inverse_mass + b.body.inverse_mass
    for one, sign in ((a.body, -1), (b.body, 1)):
        share = sign * by_m * one.inverse_mass / total
        one.x += share * seen.normal[0]
        one.y += share * seen.normal[1]


def all_apart(near: Sequence[Pair]) -> list[Apart]:
    """How far each pair is apart."""
    return [apart(a.body, b.body) for a, b in near]


def state_of(one: Body) -> tuple[float, float, float, float, float, float]:
    """All that a step changes: place, heading, velocity, spin."""
    return one.x, one.y, one.heading, one.vx, one.vy, one.spin


def last_move(script: Floats) -> int:
    """The last sample that differs from the one before it."""
    moves = np.flatnonzero((np.diff(script, axis=0) != 0.0).any(axis=1))
    return int(moves[-1]) + 1 if len(moves) else 0


def key_of(a: Mover, b: Mover) -> tuple[str, str]:
    """A pair by its names."""
    return a.name, b.name


def follow(m: Mover, k: int) -> None:
    """Put a mover where its script has it at sample k, on the way to the next."""
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
