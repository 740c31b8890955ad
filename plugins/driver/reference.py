"""The reference driver of UN R157: drives as the report's driver did until he sees the danger, then brakes.

Two models: `careful`, the careful and competent human driver (`_careful`), and `fuzzy`, the fuzzy safety model
(`_fuzzy`). Neither steers, as the regulation's do not.
"""

from __future__ import annotations

from typing import Literal

from plugins.driver._careful import Careful
from plugins.driver._fuzzy import Fuzzy
from sgcad_core.case.driver_io import Command, Seat, Task, View, script_acceleration
from sgcad_core.interfaces import Driver


class Reference(Driver):
    """UN R157's careful and competent human driver, or its fuzzy safety model."""

    model: Literal["careful", "fuzzy"] = "careful"

    def take_over(self, task: Task) -> Seat:
        """A reference driver who sees everybody, through nothing."""
        return _Seat(task, Careful(task) if self.model == "careful" else Fuzzy(task))


class _Seat(Seat):
    def __init__(self, task: Task, mind: Careful | Fuzzy) -> None:
        self._task, self._mind = task, mind

    def act(self, view: View) -> Command:
        """Brake as the model says, else drive on as the report's driver."""
        brake = self._mind.brake(view)
        onward = script_acceleration(self._task, view)
        return Command(onward if brake is None else min(-brake, onward))
