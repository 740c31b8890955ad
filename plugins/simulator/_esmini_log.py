"""Reads esmini's CSV log as trajectories of box centers, and its messages as complaints. Starts no process.

The log has seven header lines, one line of column names and one row for each step; a row holds a block of columns for
every entity, with the pose of the entity's origin and the offset of its box center.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from itertools import dropwhile

import numpy as np

from sgcad_core.case.records import Floats, Trajectory
from sgcad_core.errors import SimulationFailed

STEP_TOLERANCE_S = 1e-3
_UNIT = re.compile(r"\s*\[[^\]]*\]\s*$")
_NUMBER = re.compile(r"^#(\d+)\s+")
_NAME = "Entity_Name"
_WANTED = ("World_Position_X", "World_Position_Y", "World_Heading_Angle", "bb_x", "bb_y")
_COMPLAINT = re.compile(r"\[error\]|\bunsupported\b|not supported|missing OSC element", re.IGNORECASE)
_TIME_STAMP = re.compile(r"^\[[^\]]*\]\s*")


def complaints(said: str) -> tuple[str, ...]:
    """Errors and unsupported elements in esmini's messages, each once, without their times."""
    lines = (_TIME_STAMP.sub("", line.strip()) for line in said.splitlines() if _COMPLAINT.search(line))
    return tuple(dict.fromkeys(lines))


def trajectories(text: str, actors: Sequence[str], dt_s: float) -> list[Trajectory]:
    """Box centers of the actors every dt_s from 0. Raises SimulationFailed if the log cannot be read."""
    rows = list(csv.reader(io.StringIO(text), skipinitialspace=True))
    table = list(dropwhile(lambda row: not row or not row[0].startswith("Index"), rows))
    if len(table) < 3:
        raise SimulationFailed("esmini's log has no rows: it ended as soon as it began")
    columns = _columns(table[0])
    found = _poses([row for row in table[1:] if len(row) > 2], columns)
    if missing := [name for name in actors if name not in found]:
        raise SimulationFailed(f"esmini's log lacks {', '.join(missing)}; it has {', '.join(found) or 'nobody'}")
    return [_trajectory(name, found[name], dt_s) for name in actors]


def _columns(head: Sequence[str]) -> dict[str, int]:
    """Where the wanted values stand in an entity's block, and the block's width under ""."""
    blocks = [_NUMBER.match(name) for name in head]
    first = [i for i, match in enumerate(blocks) if match and match[1] == "1"]
    names = [_UNIT.sub("", _NUMBER.sub("", head[i])) for i in first]
    if lacking := [name for name in (_NAME, *_WANTED) if name not in names]:
        raise SimulationFailed(f"esmini's log has no column {', '.join(lacking)}: use esmini 2.37 or newer")
    return {"": len(names)} | {name: names.index(name) for name in (_NAME, *_WANTED)}


def _poses(rows: Sequence[Sequence[str]], columns: dict[str, int]) -> dict[str, list[tuple[float, ...]]]:
    """Time and the wanted values by entity."""
    found: dict[str, list[tuple[float, ...]]] = {}
    for row in rows:
        for begin in range(2, len(row) - columns[""] + 1, columns[""]):
            block = row[begin : begin + columns[""]]
            try:
                values = (float(row[1]), *(float(block[columns[name]]) for name in _WANTED))
            except ValueError as fault:
                raise SimulationFailed(f"esmini's log has a row that is no numbers: {','.join(row)[:200]}") from fault
            found.setdefault(block[columns[_NAME]].strip(), []).append(values)
    return found


def _trajectory(name: str, rows: Sequence[tuple[float, ...]], dt_s: float) -> Trajectory:
    """Every dt_s from 0; speeds are those of the box center."""
    seen = np.array(rows)
    t_s = np.arange(int(seen[-1, 0] / dt_s + STEP_TOLERANCE_S) + 1) * dt_s
    nearest = np.abs(seen[:, 0][None, :] - t_s[:, None]).argmin(axis=1)
    seen = seen[nearest]
    if len(t_s) < 2 or np.abs(seen[:, 0] - t_s).max() > STEP_TOLERANCE_S:
        raise SimulationFailed(f"esmini's log has no row every {dt_s:g} s for {name}")
    x, y = _centers(seen)
    speed = np.hypot(np.gradient(x, t_s), np.gradient(y, t_s))
    heading = np.unwrap(seen[:, 3])
    return Trajectory(actor=name, t_s=t_s, x_m=x, y_m=y, heading_rad=heading, speed_mps=speed)


def _centers(rows: Floats) -> tuple[Floats, Floats]:
    x, y, heading, ahead, left = rows[:, 1:6].T
    c, s = np.cos(heading), np.sin(heading)
    return x + ahead * c - left * s, y + ahead * s + left * c
