"""How a vehicle crushes at a narrow thing that stays: it slows over a distance, not at once, and rolls back off it.

The deceleration is even over the pulse of a crash into a pole (0.1 s at most, so that 15 m/s take 0.7 m); meanwhile the
boxes overlap by the depth of the crush. Then the vehicle rebounds with a share of the speed, and the boxes, which do
not crush, are moved apart as fast. Knows two bodies and the clock. SI units.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from sgcad_core.planner.aftermath.impact import Point, approach, slow_parting
from sgcad_core.planner.aftermath.wreck_bodies import Mover, Pair, Separation, key_of

NARROW_M, _WIDE_M = 1.2, 1.5
"""A wider thing is met by the whole of a side, which crushes little; a narrower body (a bicycle) hardly crushes."""
_LEAST_MPS = 5.0
"""A slower vehicle stops within the depth at which any touch takes effect."""
_PULSE_S, DEEPEST_M = 0.1, 0.8
"""Duration of the pulse, and the most crush: a faster vehicle slows in less time."""
_REBOUND = 0.12
"""Share of the speed with which a vehicle rolls back off a pole."""
_PARTING_MPS, _OFF_IT_MPS = 0.3, 1.2
"""Speed at which overlapping bodies are moved apart; those that crushed part as they rebound, not by creeping."""
STEP_LONGEST_S = 0.005


@dataclass
class _Pulse:
    """One crush: its end, the deceleration, the normal at its beginning, and the speed of the rebound."""

    until_s: float
    mps2: float
    normal: Point
    rebound_mps: float


@dataclass
class Crushes:
    """The crushes of a simulation by pair."""

    pulses: dict[tuple[str, str], _Pulse] = field(default_factory=dict)

    def begins(self, a: Mover, b: Mover, seen: Separation, now_s: float) -> bool:
        """Whether two bodies that come to touch crush; they then do so from now on."""
        thing, by = (a, b) if a.fixed else (b, a)
        if not thing.fixed or max(thing.body.size) > NARROW_M or by.fixed or min(by.body.size) < _WIDE_M:
            return False
        closing = approach(a.body, b.body, (thing.body.x, thing.body.y), seen.normal)
        if closing < _LEAST_MPS:
            return False
        lasts_s = min(_PULSE_S, 2 * DEEPEST_M / closing)
        self.pulses[key_of(a, b)] = _Pulse(now_s + lasts_s, closing / lasts_s, seen.normal, _REBOUND * closing)
        return True

    def last(self, a: Mover, b: Mover, now_s: float) -> bool:
        """Whether two still crush."""
        pulse = self.pulses.get(key_of(a, b))
        return pulse is not None and now_s <= pulse.until_s

    def parting_mps(self, a: Mover, b: Mover) -> float:
        """The speed at which two bodies are moved apart that still overlap."""
        return _OFF_IT_MPS if key_of(a, b) in self.pulses else _PARTING_MPS

    def squeeze(self, pairs: Iterable[Pair], now_s: float, step_s: float) -> None:
        """Slows the approach of those that crush over a step; they part with the rebound where it ends."""
        for a, b in pairs:
            if self.last(a, b, now_s):
                self._squeeze(a, b, now_s, step_s)

    def _squeeze(self, a: Mover, b: Mover, now_s: float, step_s: float) -> None:
        pulse, thing = self.pulses[key_of(a, b)], a if a.fixed else b
        at = thing.body.x, thing.body.y
        closing = approach(a.body, b.body, at, pulse.normal)
        left = closing - pulse.mps2 * step_s
        if left <= 0.0 or now_s + step_s > pulse.until_s:
            left, pulse.until_s = -pulse.rebound_mps, now_s
        slow_parting(a.body, b.body, at, pulse.normal, left - closing)
