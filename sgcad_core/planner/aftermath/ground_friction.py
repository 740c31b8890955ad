"""Friction of the ground on a sliding or rolling body, against its motion and its rotation.

Plain floats, one time step after another; `run_out_paths` computes many run-outs at once. Knows one body; no touches,
and of the clock only the time that is left. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.aftermath.impact import Body

_SLIP_LEVER = 0.25
"""Mean lever of ground friction against turning, as a share of the box's diagonal."""
_STIFF_RAD = 0.14
"""Slip angle at which rolling tires give their full side force (R. Rajamani, Vehicle Dynamics and Control, ch. 2)."""
_STEERED_SHARE = 0.7
"""Share of the side force for a steered bend; the rest is for the slide."""
_STEERS_MPS = 1.0
"""Slower wheels have no steering effect."""
_TURNS_M = 1.4
"""Mean distance of the tires from the center: what turns at 1 rad/s moves over the ground with so many m/s."""


_GOING_SHARE = 0.8
"""Where fewer of the bodies move, only these are computed any further."""


class Drag(NamedTuple):
    """Deceleration along and across the box by tires, brakes and ground, m/s2."""

    along: float
    across: float


class RunOut(NamedTuple):
    """Effect of wheels and driver during the run-out from an impact: all within the means of a damaged car."""

    from_s: float
    """World time from which on it counts; before that the body slides with its drag."""
    along_mps2: float
    bend_per_m: float = 0.0
    """Curvature of the steered way, left positive."""
    turning: float = 1.0
    """Resistance to turning, as a share of that of four locked wheels."""
    rolls_s: float = 0.0
    """Time from `from_s` on for which the engine makes up for the losses of the wheels; then it brakes."""
    slides: bool = False
    """Whether bent or locked wheels slide: friction acts against the motion of every tire, and none steers."""
    yaws_radps2: float = 0.0
    """Moment of wheels that drag on one side of a body that slides, as an angular acceleration, left positive."""
    yaws_s: float = math.inf
    """Time from `from_s` on for which they drag."""

    def along_at(self, now_s: float) -> float:
        """Deceleration along the box at a time, m/s2."""
        return 0.0 if now_s < self.from_s + self.rolls_s else self.along_mps2


class Released(NamedTuple):
    """A body at the beginning of its run-out."""

    body: Body
    at_s: float


def apply_friction(
    one: Body, drag: Drag, step: float, left_s: float, run: RunOut | None = None, now_s: float = 0.0
) -> None:
    """Applies ground friction over a step; more of it where the body would not stand in the time that is left.

    `now_s`: world time, which only a `run` asks for.
    """
    vx, vy, spin = one.vx, one.vy, one.spin
    if vx == vy == spin == 0.0:
        return
    if run and run.slides:
        _slide(one, drag, run, step, left_s, now_s)
        return
    speed = math.hypot(vx, vy)
    target = 0.0
    if speed > 0.0:
        c, s = math.cos(one.heading), math.sin(one.heading)
        along, across = (vx * c + vy * s) / speed, (vy * c - vx * s) / speed
        way = run.along_at(now_s) if run else drag.along
        side = across if run is None else max(-1.0, min(1.0, across / _STIFF_RAD))
        brake = math.hypot(way * along, drag.across * across)
        more = max(1.0, speed / (left_s * max(brake, 1e-6)))
        if brake * more * step >= speed:
            one.vx = one.vy = 0.0
        else:
            ahead, left = way * along * more * step, drag.across * side * (more if run is None else 1.0) * step
            if run:
                left = math.copysign(min(abs(left), abs(across) * speed), left)
            one.vx = vx - (ahead * c - left * s)
            one.vy = vy - (ahead * s + left * c)
            if run and speed > _STEERS_MPS:
                target = _steered(run.bend_per_m, speed, drag.across) * along * speed
    if target == spin:
        return
    off = spin - target
    turning = locked_turning(one, drag) * (run.turning if run else 1.0)
    turning = max(turning, abs(off) / left_s) * step
    one.spin = target if abs(off) <= turning else spin - math.copysign(turning, off)


def _slide(one: Body, drag: Drag, run: RunOut, step: float, left_s: float, now_s: float) -> None:
    """Coulomb friction under a body that slides and turns: what turns fast is slowed less along its way, and the
    reverse (R. M. Brach, Vehicle Accident Analysis and Reconstruction Methods, ch. 5)."""
    speed, turns = math.hypot(one.vx, one.vy), abs(one.spin) * _TURNS_M
    both = max(math.hypot(speed, turns), 1e-9)
    brake = run.along_mps2 * speed / both
    brake *= max(1.0, speed / (left_s * max(brake, 1e-6)))
    left = 0.0 if brake * step >= speed else 1.0 - brake * step / speed
    one.vx, one.vy = one.vx * left, one.vy * left
    turning = max(locked_turning(one, drag) * run.turning * turns / both, abs(one.spin) / left_s) * step
    one.spin = 0.0 if abs(one.spin) <= turning else one.spin - math.copysign(turning, one.spin)
    if speed > _STEERS_MPS and now_s < run.from_s + run.yaws_s:
        one.spin += run.yaws_radps2 * step


def _steered(bend: float, speed: float, across_mps2: float) -> float:
    """The curvature that tires allow at a speed."""
    most = _STEERED_SHARE * across_mps2 / max(speed, 1.0) ** 2
    return max(-most, min(most, bend))


def locked_turning(one: Body, drag: Drag) -> float:
    """Angular deceleration of a body on locked wheels, rad/s2; 0 of a fixed body."""
    if one.inverse_mass == 0.0:
        return 0.0
    return one.inverse_inertia / one.inverse_mass * _SLIP_LEVER * 2 * one.radius * drag.across


def run_out_paths(
    released: Sequence[Released],
    drags: Sequence[Drag],
    runs: Sequence[Sequence[RunOut]],
    end_s: float,
    step: float,
) -> list[Floats]:
    """(m, n, 3) poses of each body that runs out in n ways, a step apart, from its release to rest at `end_s`.

    The bodies are released at one time and do not interact: the run-outs of all are computed in one array.
    """
    counts = [len(ways) for ways in runs]
    state = np.repeat([_moving(one.body) for one in released], counts, axis=0).T
    turns = [locked_turning(one.body, drag) for one, drag in zip(released, drags, strict=True)]
    way, bend, share, rolls, slides, yaws, drags_s = np.array([run[1:] for ways in runs for run in ways], dtype=float).T
    wheels = np.array([
        way, bend, np.repeat(turns, counts) * share, np.repeat([drag.across for drag in drags], counts), rolls, yaws,
        drags_s,
    ])  # fmt: skip
    lasts_s = end_s - released[0].at_s
    found = np.empty((max(round(lasts_s / step), 1), len(way), 3))
    for chosen, onward in ((slides == 0.0, _run_on), (slides != 0.0, _slide_on)):
        found[:, chosen] = _traced((state[:, chosen], wheels[:, chosen]), onward, len(found), lasts_s, step)
    return np.split(found, np.cumsum(counts)[:-1], axis=1)


class _Clock(NamedTuple):
    """Time since the release, time that is left, and the step, s."""

    since: float
    left: float
    step: float


def _traced(
    start: tuple[Floats, Floats], onward: Callable[[Floats, Floats, _Clock], Floats], count: int, lasts_s: float,
    step: float,
) -> Floats:  # fmt: skip
    """(count, n, 3) poses of bodies with (6, n) states and wheels; those that stand are not computed any further."""
    (state, wheels), moving = start, np.arange(start[0].shape[1])
    found = np.empty((count, len(moving), 3))
    for k in range(count):
        state = onward(state, wheels, _Clock(k * step, max(lasts_s - k * step, 0.1), step))
        found[k] = found[k - 1] if k else 0.0
        found[k, moving] = state[:3].T
        going = state[3:].any(axis=0)
        if going.sum() < _GOING_SHARE * len(moving):
            moving, state, wheels = moving[going], state[:, going], wheels[:, going]
            if not len(moving):
                found[k + 1 :] = found[k]
                break
    return found


def _moving(one: Body) -> tuple[float, ...]:
    return one.x, one.y, one.heading, one.vx, one.vy, one.spin


def _run_on(state: Floats, wheels: Floats, clock: _Clock) -> Floats:
    """(6, n) place, heading, velocity, spin a step later; `wheels`: (7, n) braking, bend, turning, grip, the time for
    which it rolls on, the moment of wheels that drag, and the time for which they do."""
    (way, bend, turning, grip, rolls, *_), step, left_s = wheels, clock.step, clock.left
    way = np.where(clock.since < rolls, 0.0, way)
    moved = state[:3] + state[3:] * step
    vx, vy, spin = state[3:]
    c, s, speed = np.cos(moved[2]), np.sin(moved[2]), np.hypot(vx, vy)
    moving = np.maximum(speed, 1e-9)
    along, across = (vx * c + vy * s) / moving, (vy * c - vx * s) / moving
    side = np.minimum(np.maximum(across / _STIFF_RAD, -1.0), 1.0)
    pull = way * along
    brake = np.hypot(pull, grip * across)
    more = np.maximum(1.0, speed / (left_s * np.maximum(brake, 1e-6)))
    stands = brake * more * step >= speed
    ahead = pull * more * step
    left = np.copysign(np.minimum(np.abs(grip * side * step), np.abs(across) * speed), side)
    most = _STEERED_SHARE * grip / np.maximum(speed, 1.0) ** 2
    steers = ~stands & (speed > _STEERS_MPS)
    target = np.where(steers, np.minimum(np.maximum(bend, -most), most) * along * speed, 0.0)
    off = spin - target
    by = np.maximum(turning, np.abs(off) / left_s) * step
    turned = np.where(np.abs(off) <= by, target, spin - np.copysign(by, off))
    slowed = (np.where(stands, 0.0, vx - ahead * c + left * s), np.where(stands, 0.0, vy - ahead * s - left * c))
    return np.concatenate((moved, (*slowed, turned)))


def _slide_on(state: Floats, wheels: Floats, clock: _Clock) -> Floats:
    """(6, n) as `_run_on`, of bodies that slide (`_slide`)."""
    (way, _, turning, _, _, yaws, drags_s), step, left_s = wheels, clock.step, clock.left
    moved = state[:3] + state[3:] * step
    vx, vy, spin = state[3:]
    speed, turns = np.hypot(vx, vy), np.abs(spin) * _TURNS_M
    both = np.maximum(np.hypot(speed, turns), 1e-9)
    brake = way * speed / both
    brake = brake * np.maximum(1.0, speed / (left_s * np.maximum(brake, 1e-6)))
    left = np.where(brake * step >= speed, 0.0, 1.0 - brake * step / np.maximum(speed, 1e-9))
    by = np.maximum(turning * turns / both, np.abs(spin) / left_s) * step
    turned = np.where(np.abs(spin) <= by, 0.0, spin - np.copysign(by, spin))
    turned = turned + np.where((speed > _STEERS_MPS) & (clock.since < drags_s), yaws * step, 0.0)
    return np.concatenate((moved, (vx * left, vy * left, turned)))
