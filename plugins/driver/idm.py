"""The intelligent driver model with gaps at junctions: keeps its distance and gives way.

    dv/dt = a (1 - (v / v0)^4 - (s* / s)^2),  s* = s0 + v T + v dv / (2 sqrt(a b))
M. Treiber, A. Hennecke, D. Helbing, Congested traffic states in empirical observations and microscopic simulations,
Physical Review E 62 (2000) 1805. The model runs on the ego's way and is not SUMO's implementation; v0 is the speed of
the report's driver at that place, which includes how fast a bend can be driven. Where the ego has to give way, the line
is a standing leader as long as a road user will cross the ego's strip within the accepted gap (critical gaps of Highway
Capacity Manual 2010, exhibit 19-10: 4.1 s for left turns from the major road to 7.1 s for those from the minor one).
With the right of way, the ego brakes for road users that are, or within a horizon would be, in its way.
"""

from __future__ import annotations

import math

from pydantic import Field

from sgcad_core.case.driver_io import Command, Seat, Task, View
from sgcad_core.handover.foresight import Ahead, meetings, users_ahead
from sgcad_core.interfaces import Driver

_CREEP_MPS = 0.5


class Idm(Driver):
    """Drives by the intelligent driver model: follows, gives way and otherwise keeps the speeds of the report's driver.

    acceleration_mps2 and hardest_mps2 bound the acceleration and the braking, headway_s is the time gap to a leader.
    """

    acceleration_mps2: float = Field(1.5, gt=0, le=5)
    braking_mps2: float = Field(2.0, gt=0, le=6)
    """Comfortable deceleration."""
    hardest_mps2: float = Field(8.0, gt=0, le=12)
    headway_s: float = Field(1.2, gt=0, le=5)
    gap_m: float = Field(2.0, gt=0, le=10)
    """To a standing leader."""
    accepts_s: float = Field(6.5, gt=0, le=15)
    """A road user that crosses within this time may pass first where the ego has to give way."""
    foresees_s: float = Field(3.0, gt=0, le=10)
    """With the right of way: how far ahead in time a contact on present courses is foreseen."""

    def take_over(self, task: Task) -> Seat:
        """A driver with these habits."""
        return _Seat(self, task)


class _Seat(Seat):
    def __init__(self, config: Idm, task: Task) -> None:
        self._config, self._task = config, task

    def act(self, view: View) -> Command:
        """The least acceleration that the free road and every leader allow."""
        seen = users_ahead(self._task, view)
        leaders = [(a.gap_m, a.along_mps) for a in seen if a.aside_m <= 0.2 and a.gap_m > -1.0]
        leaders += self._foreseen(view, seen) + self._line(view, seen)
        free = self._free(view)
        braked = [self._follow(view, max(gap, 0.1), speed) for gap, speed in leaders]
        return Command(max(min([free, *braked]), -self._config.hardest_mps2))

    def _free(self, view: View) -> float:
        """Acceleration towards the speed of the report's driver: exact while gentle, otherwise the model's."""
        wanted = self._task.way.speed_at(view.script_s + 0.05)
        change = (wanted - view.ego.speed_mps) / 0.05
        if change <= 0:
            return max(change, -self._config.hardest_mps2)
        slow = view.ego.speed_mps / max(wanted, _CREEP_MPS)
        return min(
            change, self._config.acceleration_mps2 * max(1 - slow**4, 0.0) + self._config.acceleration_mps2 * 0.1
        )

    def _follow(self, view: View, gap: float, leader_mps: float) -> float:
        config, v = self._config, view.ego.speed_mps
        closing = v - leader_mps
        wished = config.gap_m + max(
            v * config.headway_s + v * closing / (2 * math.sqrt(config.acceleration_mps2 * config.braking_mps2)), 0.0
        )
        v0 = max(self._task.way.speed_at(view.script_s), v, _CREEP_MPS)
        return config.acceleration_mps2 * (1 - (v / v0) ** 4 - (wished / gap) ** 2)

    def _foreseen(self, view: View, seen: list[Ahead]) -> list[tuple[float, float]]:
        """Road users that would soon be met on present courses, as leaders where they enter the strip."""
        met = {m.user.actor for m in meetings(self._task, view, self._config.foresees_s, 0.3)}
        return [
            (a.gap_m, max(a.along_mps, 0.0)) for a in seen if a.user.actor in met and a.aside_m > 0.2 and a.gap_m > 0
        ]

    def _line(self, view: View, seen: list[Ahead]) -> list[tuple[float, float]]:
        """The line at which to give way, as a standing leader while a road user crosses behind it."""
        line = self._task.gives_way_m
        if line is None or view.station_m > line + 0.5:
            return []
        left = line - view.station_m
        crossing = [a for a in seen if self._crosses(a, left)]
        return [(left + self._config.gap_m, 0.0)] if crossing else []

    def _crosses(self, a: Ahead, left: float) -> bool:
        if a.aside_m <= 0 or a.closing_mps <= 0.3 or a.gap_m + a.user.length_m < left:
            return False
        return a.aside_m / a.closing_mps <= self._config.accepts_s
