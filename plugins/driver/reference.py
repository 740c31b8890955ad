"""The reference drivers of UN R157: drive as the report's driver did until the danger is perceived, then brake.

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
    """Drives as the report's driver and brakes as a reference driver of UN R157 does.

    model: careful, the careful and competent human driver, or fuzzy, the fuzzy safety model.
    """

    model: Literal["careful", "fuzzy"] = "careful"

    def take_over(self, task: Task) -> Seat:
        """A reference driver that sees every road user, whatever stands between."""
        return _Seat(task, Careful(task) if self.model == "careful" else Fuzzy(task))


class _Seat(Seat):
    def __init__(self, task: Task, mind: Careful | Fuzzy) -> None:
        self._task, self._mind = task, mind

    def act(self, view: View) -> Command:
        """The model's braking, else the acceleration of the report's driver."""
        brake = self._mind.brake(view)
        onward = script_acceleration(self._task, view)
        return Command(onward if brake is None else min(-brake, onward))
