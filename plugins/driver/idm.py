"""The intelligent driver model with gaps at junctions: a driver who keeps his distance and gives way where he must.

    dv/dt = a (1 - (v / v0)^4 - (s* / s)^2),  s* = s0 + v T + v dv / (2 sqrt(a b))
M. Treiber, A. Hennecke, D. Helbing, Congested traffic states in empirical observations and microscopic simulations,
Physical Review E 62 (2000) 1805. Formulas of our own on the ego's way, not SUMO's implementation; v0 is the report's
driver's speed at that place, since he knew how fast the bend can be driven. Where the road makes the ego give way, the
line is a standing leader as long as somebody will cross the ego's strip within the gap that is asked for (critical gaps
of Highway Capacity Manual 2010, exhibit 19-10: 4.1 s for left turns from the major road to 7.1 s for those from the
minor one); one that has the right of way brakes for what is, or within a horizon would be, in the way.
"""

from __future__ import annotations

import math

from pydantic import Field

from sgcad_core.case.driver_io import Command, Seat, Task, View
from sgcad_core.handover.foresight import Ahead, meetings, users_ahead
from sgcad_core.interfaces import Driver

_CREEP_MPS = 0.5


class Idm(Driver):
    """Follows, gives way and otherwise drives at the report's driver's speeds."""

    acceleration_mps2: float = Field(1.5, gt=0, le=5)
    braking_mps2: float = Field(2.0, gt=0, le=6)
    """The comfortable one."""
    hardest_mps2: float = Field(8.0, gt=0, le=12)
    headway_s: float = Field(1.2, gt=0, le=5)
    gap_m: float = Field(2.0, gt=0, le=10)
    """To a standing leader."""
    accepts_s: float = Field(6.5, gt=0, le=15)
    """Whoever crosses within this time is let pass where the ego has to give way."""
    foresees_s: float = Field(3.0, gt=0, le=10)
    """How far ahead a meeting on present courses is seen by one who has the right of way."""

    def take_over(self, task: Task) -> Seat:
        """A driver with these habits."""
        return _Seat(self, task)


class _Seat(Seat):
    def __init__(self, say: Idm, task: Task) -> None:
        self._say, self._task = say, task

    def act(self, view: View) -> Command:
        """The least of what the free road and every leader allow."""
        seen = users_ahead(self._task, view)
        leaders = [(a.gap_m, a.along_mps) for a in seen if a.aside_m <= 0.2 and a.gap_m > -1.0]
        leaders += self._foreseen(view, seen) + self._line(view, seen)
        free = self._free(view)
        braked = [self._follow(view, max(gap, 0.1), speed) for gap, speed in leaders]
        return Command(max(min([free, *braked]), -self._say.hardest_mps2))

    def _free(self, view: View) -> float:
        """Towards the report's driver's speed: exactly while that is gentle, as the model says otherwise."""
        wanted = self._task.way.speed_at(view.script_s + 0.05)
        change = (wanted - view.ego.speed_mps) / 0.05
        if change <= 0:
            return max(change, -self._say.hardest_mps2)
        slow = view.ego.speed_mps / max(wanted, _CREEP_MPS)
        return min(change, self._say.acceleration_mps2 * max(1 - slow**4, 0.0) + self._say.acceleration_mps2 * 0.1)

    def _follow(self, view: View, gap: float, leader_mps: float) -> float:
        say, v = self._say, view.ego.speed_mps
        closing = v - leader_mps
        wished = say.gap_m + max(
            v * say.headway_s + v * closing / (2 * math.sqrt(say.acceleration_mps2 * say.braking_mps2)), 0.0
        )
        v0 = max(self._task.way.speed_at(view.script_s), v, _CREEP_MPS)
        return say.acceleration_mps2 * (1 - (v / v0) ** 4 - (wished / gap) ** 2)

    def _foreseen(self, view: View, seen: list[Ahead]) -> list[tuple[float, float]]:
        """Those who would be met soon on present courses, as leaders at the place where they come in."""
        met = {m.user.actor for m in meetings(self._task, view, self._say.foresees_s, 0.3)}
        return [
            (a.gap_m, max(a.along_mps, 0.0)) for a in seen if a.user.actor in met and a.aside_m > 0.2 and a.gap_m > 0
        ]

    def _line(self, view: View, seen: list[Ahead]) -> list[tuple[float, float]]:
        """The line at which to give way, a standing leader while somebody crosses behind it."""
        line = self._task.gives_way_m
        if line is None or view.station_m > line + 0.5:
            return []
        left = line - view.station_m
        crossing = [a for a in seen if self._crosses(a, left)]
        return [(left + self._say.gap_m, 0.0)] if crossing else []

    def _crosses(self, a: Ahead, left: float) -> bool:
        if a.aside_m <= 0 or a.closing_mps <= 0.3 or a.gap_m + a.user.length_m < left:
            return False
        return a.aside_m / a.closing_mps <= self._say.accepts_s
