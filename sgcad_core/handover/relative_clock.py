"""The clock of the other actors, which keep the conflict with an ego that drives otherwise than the script.

Triggers are relative. Until the release each other actor is where it was when the report's driver was at the ego's
place (the same time to the conflict point), at a speed in proportion to the ego's. From the release on, a set time
before the contact, each keeps its proportion and no longer depends on the ego. So a driver like the report's meets the
same crash, faster or slower, and a reaction has the whole time since the release. Nothing depends on a fixed time or on
distances of centers. Knows one way; no simulation.
"""

from __future__ import annotations

from dataclasses import dataclass

from sgcad_core.case.driver_io import STEP_S, Way

RELEASE_S = 4.0
"""Before the scripted contact. Gentle braking (3 m/s2) stops from 12 m/s in that time."""
_SLOW_MPS = 1.0
_SLOWEST, _FASTEST = 0.3, 1.7
"""Range of the proportion to the scripted speeds."""
_CATCH_UP_S = 1.0
_GENTLE_MPS2 = 3.0
"""Acceleration of the fastest of them at a change of proportion."""


@dataclass
class Clock:
    """Script time of the others, step by step."""

    way: Way
    contact_s: float
    top_mps: float
    """The fastest of the others in the script."""
    release_s: float = RELEASE_S
    now_s: float = 0.0
    rate: float = 0.0
    """Script seconds per second; 0 before the first step."""
    released: bool = False
    lag_s: float = 0.0
    """At the release: lead of the ego's script time over that of the others."""

    def advance(self, script_s: float, speed_mps: float) -> None:
        """Advances by one step: the ego is where the report's driver was at `script_s`, with that speed."""
        if not self.released:
            self._follow(script_s, speed_mps)
            if self.now_s >= self.contact_s - self.release_s:
                self.released, self.lag_s = True, script_s - self.now_s
        self.now_s += self.rate * STEP_S

    def _follow(self, script_s: float, speed_mps: float) -> None:
        scripted = self.way.speed_at(script_s)
        wanted = speed_mps / scripted if scripted > _SLOW_MPS else 1.0
        wanted += (script_s - self.now_s) / _CATCH_UP_S
        most = _GENTLE_MPS2 / max(self.top_mps, _GENTLE_MPS2) * STEP_S
        step = min(max(wanted - self.rate, -most), most) if self.rate else wanted
        self.rate = min(max(self.rate + step, _SLOWEST), _FASTEST)
