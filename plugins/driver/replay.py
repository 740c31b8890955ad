"""A trajectory from a file: the ego follows it whatever happens.

The file is a CSV with t_s, x_m, y_m, heading_rad and, if wanted, speed_mps; of one with a column actor the ego's rows
count (a `trajectories.csv`). Times are from the hand-over on; behind the last one the ego goes on straight. It begins
where the ego is, and is one that the ego can drive.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

from sgcad_core.case.driver_io import STEP_S, Command, Seat, Task, View
from sgcad_core.errors import ConfigError
from sgcad_core.geometry.plane import Floats
from sgcad_core.interfaces import Driver

_NEEDED = ("t_s", "x_m", "y_m", "heading_rad")


class Replay(Driver):
    """Replays a trajectory of the ego from a CSV file."""

    file: Path
    """CSV; a relative path is looked for where the command is run. `{case}` stands for the case's name."""

    def take_over(self, task: Task) -> Seat:
        """A driver on the file's trajectory. Raises ConfigError for a file without a usable one."""
        place = Path(str(self.file).replace("{case}", task.case))
        return _Seat(_table(place, task.ego.actor))


class _Seat(Seat):
    def __init__(self, table: Floats) -> None:
        self._table = table

    def act(self, view: View) -> Command:
        """The pose of the file at the next instant."""
        t = view.t_s + STEP_S
        at = min(t, float(self._table[-1, 0]))
        x, y, heading, speed = (float(np.interp(at, self._table[:, 0], self._table[:, i])) for i in range(1, 5))
        beyond = (t - at) * speed
        return Command(pose=(x + beyond * math.cos(heading), y + beyond * math.sin(heading), heading, speed))


def _table(file: Path, actor: str) -> Floats:
    """(n, 5) t, x, y, heading, speed."""
    try:
        with file.open(encoding="utf-8", newline="") as lines:
            rows = [r for r in csv.DictReader(lines) if r.get("actor", actor) == actor]
        table = np.array([[float(r[name]) for name in _NEEDED] for r in rows])
    except (OSError, ValueError, KeyError, TypeError) as fault:
        raise ConfigError(f"driver replay: {file}: no trajectory ({fault}); it needs {', '.join(_NEEDED)}") from fault
    if len(table) < 2 or not np.isfinite(table).all() or (np.diff(table[:, 0]) <= 0).any():
        raise ConfigError(
            f"driver replay: {file}: {len(table)} rows of {actor}; two or more, with rising t_s, are needed"
        )
    table[:, 3] = np.unwrap(table[:, 3])
    speed = np.gradient(np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(table[:, 1:3], axis=0).T)))), table[:, 0])
    return np.column_stack((table, speed))
