"""The report's driver in closed loop: accelerations from the script at the place where the ego is.

By construction of the relative triggers it has the same crash; a crash that it misses is lost by them.
"""

from __future__ import annotations

from sgcad_core.case.driver_io import STEP_S, Command, Seat, Task, View
from sgcad_core.interfaces import Driver

_SLOW_MPS = 1.0


class Script(Driver):
    """Drives as the report's driver did, faster or slower by the factor of the hand-over."""

    def take_over(self, task: Task) -> Seat:
        """The report's driver."""
        return _Seat(task)


class _Seat(Seat):
    def __init__(self, task: Task) -> None:
        self._task = task
        self._factor: float | None = None

    def act(self, view: View) -> Command:
        """The script's speed at the next instant, times the factor with which the drive began."""
        scripted = self._task.way.speed_at(view.script_s)
        if self._factor is None:
            self._factor = view.ego.speed_mps / scripted if scripted > _SLOW_MPS else 1.0
        wanted = self._task.way.speed_at(view.script_s + STEP_S) * self._factor
        return Command((wanted - view.ego.speed_mps) / STEP_S)
