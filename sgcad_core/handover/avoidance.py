"""The last chances of the ego to avoid the contact: by braking and by steering, and the deceleration needed.

The others follow the script; the ego leaves it at an onset and brakes or moves aside. All onsets, 0.05 s apart, are
tested against the boxes of the others, so nothing is assumed on the kind of conflict. Braking is constant from the
onset on; late braking may also pass before or behind the other. Steering is a constant lateral acceleration until a
lane's width aside (left or right) at unchanged speed. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sgcad_core.case.driver_io import STEP_S, Way
from sgcad_core.case.records import Record
from sgcad_core.geometry.plane import Floats, box_gaps
from sgcad_core.handover.script import Staging

LOOK_BACK_S = 6.0
GRAIN_S = 0.01
"""Time between two tests for overlap: at 0.05 s crossing corners can miss each other by 0.5 m."""
_GRAINS = round(STEP_S / GRAIN_S)
AFTER_S = 6.0
"""Time after the scripted contact that is tested."""
ASIDE_M = 3.5
BEFORE_S = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0)
"""Onsets before the contact for which the least deceleration is computed."""
_BISECTIONS = 12
_GLANCE = 8
"""Every eighth sample is tested first."""
_STEER_SHARE = 0.7
"""Share of the friction for moving aside; the rest is for the recovery."""


class Avoidance(Record):
    """How near the script was to no crash; times are before the scripted contact, None: at no time that was tried."""

    brake_by_s: float | None
    """The last onset of full braking that avoids the contact."""
    brake_by_m: float | None
    """Distance of the ego at that onset from its place at the contact."""
    steer_by_s: float | None
    """The last onset of moving aside that avoids it."""
    steer_to: str | None
    """Side of that maneuver: left or right."""
    required_mps2: dict[str, float | None]
    """Least constant deceleration that avoids it, by onset (s before the contact); None: not even full braking does."""
    full_braking_mps2: float


def avoidance(staging: Staging, before_s: Sequence[float] = BEFORE_S) -> Avoidance | None:
    """The last chances before the ego's scripted contact; None without a contact.

    `before_s`: onsets for which the least deceleration is computed, seconds before the contact.
    """
    if staging.contact is None:
        return None
    others = _others(staging)
    full = staging.script.friction_mps2
    onsets = np.arange(staging.contact_s, max(staging.contact_s - LOOK_BACK_S, -1e-9), -STEP_S)
    brake = next((t for t in onsets if _clear(staging, others, _braked(staging.way, t, full))), None)
    steer = _steered_by(staging, others, onsets)
    at_contact_m = staging.way.station_at(staging.contact_s)
    asked = [b for b in before_s if b <= staging.contact_s]
    return Avoidance(
        brake_by_s=None if brake is None else round(staging.contact_s - float(brake), 3),
        brake_by_m=None if brake is None else round(at_contact_m - staging.way.station_at(float(brake)), 3),
        steer_by_s=steer and round(staging.contact_s - steer[0], 3),
        steer_to=steer and steer[1],
        required_mps2={f"{b:g}": _required(staging, others, staging.contact_s - b) for b in asked},
        full_braking_mps2=full,
    )


# ------------------------------------------------------------------ the others, and whether they are met
def _others(staging: Staging) -> dict[str, Floats]:
    """(n, 3) poses of the others on the clock of the script, up to the end of the tested time."""
    times = np.arange(0.0, staging.contact_s + AFTER_S, GRAIN_S)
    return {name: line.poses_when(times) for name, line in staging.lines.items() if name not in staging.coupled}


def _clear(staging: Staging, others: dict[str, Floats], poses: tuple[int, Floats]) -> bool:
    """Whether an ego with these poses, from a sample on, touches none of the others."""
    start, mine = poses
    size = staging.script.sizes
    for name, theirs in others.items():
        rows = theirs[start : start + len(mine)]
        own = mine[: len(rows)]
        reach = (math.hypot(*size[staging.ego]) + math.hypot(*size[name])) / 2
        dx, dy = own[:, 0] - rows[:, 0], own[:, 1] - rows[:, 1]
        near = np.flatnonzero(dx * dx + dy * dy <= reach * reach)
        for some in (near[::_GLANCE], near):  # most answers fail, and a few looks tell
            if len(some) and (box_gaps(own[some], size[staging.ego], rows[some], size[name]) <= 0).any():
                return False
    return True


# ------------------------------------------------------------------ braking
def _braked(way: Way, onset_s: float, deceleration: float) -> tuple[int, Floats]:
    """First sample, and poses from there on, of an ego that brakes at an onset."""
    k = round(onset_s / GRAIN_S)
    ran = np.arange(0.0, AFTER_S + LOOK_BACK_S, GRAIN_S)
    speed = way.speed_at(onset_s)
    stops = speed / max(deceleration, 1e-9)
    braking = np.minimum(ran, stops)
    return k, way.poses_at(way.station_at(onset_s) + speed * braking - deceleration * braking**2 / 2)


def _required(staging: Staging, others: dict[str, Floats], onset_s: float) -> float | None:
    """Least deceleration that avoids the contact from an onset on; None: full braking does not."""
    full = staging.script.friction_mps2
    if not _clear(staging, others, _braked(staging.way, onset_s, full)):
        return None
    low, high = 0.0, full
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        clear = _clear(staging, others, _braked(staging.way, onset_s, middle))
        low, high = (low, middle) if clear else (middle, high)
    return round(high, 3)


# ------------------------------------------------------------------ steering
def _steered_by(staging: Staging, others: dict[str, Floats], onsets: Floats) -> tuple[float, str] | None:
    """The last onset, and the side, of moving aside that avoids the contact."""
    aside = _Aside(staging, float(onsets[0]), len(onsets))
    for number, t in enumerate(onsets):
        for side, name in ((1.0, "left"), (-1.0, "right")):
            if _clear(staging, others, aside.poses(number, side)):
                return float(t), name
    return None


class _Aside:
    """An ego that moves aside at an onset: half the way with the lateral acceleration, half against it.

    Onsets are STEP_S apart, so that one table of the way, GRAIN_S apart, serves them all.
    """

    def __init__(self, staging: Staging, last_s: float, count: int) -> None:
        self.way, self.last_s = staging.way, last_s
        self.before = count * _GRAINS
        """Row of the table at the last onset."""
        times = last_s + GRAIN_S * np.arange(-self.before, round(AFTER_S / GRAIN_S) + _GRAINS)
        self.table = self.way.poses_at(np.interp(times, self.way.t_s, self.way.s_m))
        course = _course(self.table)
        self.left = np.column_stack((-np.sin(course), np.cos(course)))
        ran = GRAIN_S * np.arange(len(times))
        lateral = _STEER_SHARE * staging.script.friction_mps2
        half_s = math.sqrt(ASIDE_M / lateral)
        first, second = np.minimum(ran, half_s), np.clip(ran - half_s, 0.0, half_s)
        self.moved = lateral * first**2 / 2 + lateral * half_s * second - lateral * second**2 / 2
        self.rate = lateral * (first - second)

    def poses(self, number: int, side: float) -> tuple[int, Floats]:
        """First sample, and poses from there on, of a move to a side (1 left, -1 right) at an onset."""
        onset_s = self.last_s - number * STEP_S
        poses = self.table[self.before - number * _GRAINS :].copy()
        moved, rate = side * self.moved[: len(poses)], side * self.rate[: len(poses)]
        poses[:, :2] += moved[:, None] * self.left[-len(poses) :]
        poses[:, 2] += np.arctan2(rate, max(self.way.speed_at(onset_s), 1.0))
        return round(onset_s / GRAIN_S), poses


def _course(poses: Floats) -> Floats:
    """(n,) direction of motion of a box; while it stands that of its last motion, before any its heading."""
    step = np.diff(poses[:, :2], axis=0)
    moving = np.hypot(*step.T) > 1e-6
    if not moving.any():
        course: Floats = poses[:, 2]
        return course
    angle = np.arctan2(step[:, 1], step[:, 0])
    known = np.maximum.accumulate(np.where(moving, np.arange(len(step)), -1))
    found = np.where(known < 0, poses[:-1, 2], angle[known])
    return np.append(found, found[-1])
