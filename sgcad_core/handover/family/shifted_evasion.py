"""A stated evasion that begins earlier or later: the actor keeps its speed until then, then brakes as before.

The scripted braking is moved along the way by the distance that the delay takes; the actor still reaches the place of
the contact at its time, faster after later braking. Within its range the time at which a sample of the line is passed
is a cubic function of the delay, so that an expression in a scenario file can state it; it is exact at four delays.
Knows one line; no other actor. SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sgcad_core.case.driver_io import STEP_S, Way
from sgcad_core.geometry.plane import Floats

SOONER_S, LATER_S = 0.4, 0.8
"""M. Green, How long does it take to stop?, Transportation Human Factors 2 (2000) 195: 0.7 s where one expects it,
1.25 s where not, 1.5 s and more by surprise; about a script's usual reaction so much sooner and later."""
_BRAKES_MPS2 = 1.5
_LEAST_MPS = 1.0
"""Least speed at the contact; a slower actor would stop before it."""
_LEAST_DROP_MPS = 0.5
_ENDS_S = 1.0
"""Braking that ends earlier before the contact is no evasion."""


@dataclass(frozen=True, eq=False)
class Delay:
    """By sample of a line when it is passed: t + d * (linear + d * (square + d * cube)); d in [low, high]."""

    t_s: Floats
    linear: Floats
    square: Floats
    cube: Floats
    low_s: float
    high_s: float

    def times(self, by_s: float) -> Floats:
        """(n,) times at which the line's samples are passed."""
        found: Floats = self.t_s + by_s * (self.linear + by_s * (self.square + by_s * self.cube))
        return found

    def own(self, at_s: Floats, by_s: float) -> Floats:
        """Times of the undelayed line at which it is where the delayed one is at these."""
        passed = self.times(by_s)
        own = np.interp(at_s, passed, self.t_s)
        before = at_s < passed[0]
        own[before] = self.t_s[0] + (at_s[before] - passed[0])
        return own


def delay_of(line: Way, contact_s: float) -> Delay | None:
    """The possible delay of a line's braking before the contact; None without such braking."""
    contact = min(round(contact_s / STEP_S), len(line.t_s) - 1)
    onset = _onset(line, contact)
    if onset is None:
        return None
    low, high = _range(line, onset, contact)
    if high - low < 0.2:
        return None
    points = [low, high / 2, high] if low < -0.05 else [high / 3, 2 * high / 3, high]
    rows = np.array([_passed(line, onset, contact, d) - line.t_s for d in points])
    scale = np.array([[d, d**2, d**3] for d in points])
    linear, square, cube = np.linalg.solve(scale, rows)
    made = Delay(line.t_s, linear, square, cube, low if low < -0.05 else 0.0, high)
    rising = all((np.diff(made.times(d)) > 1e-4).all() for d in np.linspace(low, high, 9))
    return made if rising else None


def _onset(line: Way, contact: int) -> int | None:
    """The sample at which the braking before the contact begins; None where there is none."""
    rate = np.diff(line.speed_mps[: contact + 1]) / STEP_S
    braking = np.flatnonzero(rate < -_BRAKES_MPS2)
    if not len(braking) or (contact - braking[-1]) * STEP_S > _ENDS_S:
        return None
    onset = int(braking[-1])
    while onset > 0 and rate[onset - 1] < -_BRAKES_MPS2 / 2:
        onset -= 1
    drop = float(line.speed_mps[onset] - line.speed_mps[contact])
    return onset if drop >= _LEAST_DROP_MPS and line.speed_mps[contact] > _LEAST_MPS else None


def _range(line: Way, onset: int, contact: int) -> tuple[float, float]:
    """Range of delays that leave some braking and still reach the contact."""
    before, at = float(line.speed_mps[onset]), float(line.speed_mps[contact])
    left = float(line.s_m[contact] - line.s_m[onset])
    braking = (before**2 - at**2) / (2 * max(left, 1e-6))
    least = (_LEAST_MPS**2 - at**2) / (2 * max(braking, 1e-6) * before)  # v(contact)^2 + 2 a v(onset) d = least^2
    return max(-SOONER_S, 0.9 * least, -0.9 * float(line.t_s[onset])), min(LATER_S, 0.9 * left / before)


def _passed(line: Way, onset: int, contact: int, by_s: float) -> Floats:
    """(n,) times at which the samples are passed with a delay; that of the contact stays."""
    before = float(line.speed_mps[onset])
    moved = before * by_s
    s, t = _braking(line, onset, contact)
    wanted = line.s_m - moved
    found = line.t_s.copy()
    later = np.arange(len(found)) > onset
    first = float(line.s_m[onset])
    coasting = later & (wanted < first)
    found[coasting] = line.t_s[onset] + (line.s_m[coasting] - first) / before
    profile = (wanted >= first) if by_s < 0 else later & (wanted >= first)
    found[profile] = np.interp(wanted[profile], s, t) + by_s
    there = float(line.s_m[contact])
    arrives = float(np.interp(there - moved, s, t)) + by_s
    speed = max(float(np.interp(there - moved, s, np.gradient(s, t))), _LEAST_MPS)
    beyond = np.arange(len(found)) > contact
    found[beyond] = arrives + (line.s_m[beyond] - there) / speed
    found[contact] = arrives
    shifted: Floats = found + (line.t_s[contact] - arrives)
    return shifted


def _braking(line: Way, onset: int, contact: int) -> tuple[Floats, Floats]:
    """(station, time) of the braking from its onset on, continued past the contact with its mean deceleration."""
    s, t = line.s_m[onset : contact + 1], line.t_s[onset : contact + 1]
    before, at = float(line.speed_mps[onset]), float(line.speed_mps[contact])
    braking = max((before - at) / max(float(t[-1] - t[0]), STEP_S), 0.1)
    more = np.arange(STEP_S, max(at - _LEAST_MPS / 2, STEP_S) / braking + STEP_S, STEP_S)
    further = s[-1] + at * more - braking * more**2 / 2
    rising = np.append(True, np.diff(np.concatenate((s, further))) > 1e-6)
    return np.concatenate((s, further))[rising], np.concatenate((t, t[-1] + more))[rising]
