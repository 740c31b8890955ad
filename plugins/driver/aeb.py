"""Automatic emergency braking: full brakes when the time to collision falls under a threshold.

The report's driver drives otherwise. The sensor looks ahead in a cone; the brake acts after a delay, is bounded by the
tires' friction, and is held to a standstill. Thresholds are of the kind that UN R152 and Euro NCAP's test protocols
imply; they are of no particular product.
"""

from __future__ import annotations

import math

from pydantic import Field

from sgcad_core.case.driver_io import Command, RoadUser, Seat, Task, View, script_acceleration
from sgcad_core.handover.foresight import meetings
from sgcad_core.interfaces import Driver


class Aeb(Driver):
    """Drives as the report's driver, with automatic emergency braking on the time to collision."""

    ttc_s: float = Field(1.3, gt=0, le=5)
    """Braking is decided where boxes would touch within this time on present courses."""
    delay_s: float = Field(0.2, ge=0, le=2)
    """From the decision to full deceleration."""
    deceleration_mps2: float = Field(8.0, gt=0, le=12)
    """Of the brakes; the surface may allow less."""
    half_view_deg: float = Field(50.0, gt=0, le=180)
    """To either side of ahead, seen from the front."""
    range_m: float = Field(80.0, gt=0, le=300)
    """How far the sensor sees."""

    def take_over(self, task: Task) -> Seat:
        """The report's driver with the brake assistant."""
        return _Seat(self, task)


class _Seat(Seat):
    def __init__(self, config: Aeb, task: Task) -> None:
        self._config, self._task = config, task
        self._decided_s: float | None = None

    def act(self, view: View) -> Command:
        """Full brakes once decided, else the report's driver."""
        seen = view._replace(others=tuple(u for u in view.others if self._sees(view.ego, u)))
        if self._decided_s is None and meetings(self._task, seen, self._config.ttc_s):
            self._decided_s = view.t_s
        onward = script_acceleration(self._task, view)
        if self._decided_s is None or view.t_s < self._decided_s + self._config.delay_s - 1e-9:
            return Command(onward)
        return Command(min(-self._config.deceleration_mps2, onward))

    def _sees(self, ego: RoadUser, user: RoadUser) -> bool:
        """Whether the center, or the nearest end, of a box lies in the cone."""
        front = (
            ego.x_m + math.cos(ego.heading_rad) * ego.length_m / 2,
            ego.y_m + math.sin(ego.heading_rad) * ego.length_m / 2,
        )
        for share in (0.0, 0.5, -0.5):
            x = user.x_m + share * user.length_m * math.cos(user.heading_rad) - front[0]
            y = user.y_m + share * user.length_m * math.sin(user.heading_rad) - front[1]
            off = abs(math.remainder(math.atan2(y, x) - ego.heading_rad, 2 * math.pi))
            if off <= math.radians(self._config.half_view_deg) and math.hypot(x, y) <= self._config.range_m:
                return True
        return False
