"""Two or more drivers at once: the hardest braking counts, and the last driver in the list that steers.

driver: {name: combined, of: [{name: reference}, {name: aeb}]}
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

from pydantic import Field, field_validator

from sgcad_core.case.driver_io import Command, Seat, Task, View
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import Driver
from sgcad_core.registry import plugin_class


class Combined(Driver):
    """Combines several drivers: the least acceleration of all counts, and the steering of the last one that steers."""

    of: tuple[dict[str, Any], ...] = Field(min_length=2, max_length=6)
    """Drivers with their fields, as in `driver:`; a name alone is enough."""

    @field_validator("of", mode="before")
    @classmethod
    def _named(cls, value: Any) -> Any:
        entries = value if isinstance(value, list | tuple) else [value]
        named = [{"name": e} if isinstance(e, str) else e for e in entries]
        for entry in named:
            _built(entry)
        return named

    @cached_property
    def drivers(self) -> tuple[Driver, ...]:
        """The drivers, built."""
        return tuple(_built(entry) for entry in self.of)

    def take_over(self, task: Task) -> Seat:
        """A seat that asks all of them."""
        return _Seat([driver.take_over(task) for driver in self.drivers])


def _built(entry: Any) -> Driver:
    """A driver from its name and fields. Raises ValueError, which is reported with the config's other faults."""
    if not isinstance(entry, dict) or not isinstance(entry.get("name"), str):
        raise ValueError(f"expected drivers with a name, found {entry!r}")
    try:
        made = plugin_class("driver", entry["name"])(**{k: v for k, v in entry.items() if k != "name"})
    except ConfigError as fault:
        raise ValueError(str(fault)) from fault
    assert isinstance(made, Driver)  # noqa: S101 - the registry checks it
    return made


class _Seat(Seat):
    def __init__(self, seats: list[Seat]) -> None:
        self._seats = seats

    def act(self, view: View) -> Command:
        """Asks every driver, so that each has seen every instant."""
        asked = [seat.act(view) for seat in self._seats]
        posed = next((c for c in asked if c.pose is not None), None)
        steering = [c.steering_rad for c in asked if c.steering_rad is not None]
        least = min((c.acceleration_mps2 for c in asked if c.pose is None), default=0.0)
        if posed is not None and len(asked) == 1 + sum(c.pose is None for c in asked) and least >= 0:
            return posed
        return Command(least, steering[-1] if steering else None)

    def leave(self) -> None:
        """Ends the drive for every driver."""
        for seat in self._seats:
            seat.leave()
