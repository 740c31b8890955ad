"""What an external driver may answer: a strict model. What the ego can do is checked for every driver (`reach`)."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from sgcad_core.case.driver_io import STEP_S, Command, RoadUser
from sgcad_core.geometry.plane import Floats

MAX_ROWS = 2_000
_Number = Annotated[float, Field(ge=-1e6, le=1e6)]


class _Strict(BaseModel):
    model_config = ConfigDict(strict=True, extra="ignore", allow_inf_nan=False)


class _Pedals(_Strict):
    acceleration_mps2: _Number
    steering_rad: _Number | None = None


class _Trajectory(_Strict):
    trajectory: Annotated[
        list[Annotated[list[_Number], Field(min_length=5, max_length=5)]], Field(min_length=1, max_length=MAX_ROWS)
    ]


_PEDALS, _TRAJECTORY = TypeAdapter(_Pedals), TypeAdapter(_Trajectory)


def command(said: Any, ego: RoadUser) -> Command:
    """The command of an answer. Raises ValueError for anything else."""
    if not isinstance(said, dict):
        raise ValueError("not a JSON object")
    if "trajectory" not in said:
        pedals = _PEDALS.validate_python(said)
        return Command(pedals.acceleration_mps2, pedals.steering_rad)
    rows = np.array(_TRAJECTORY.validate_python(said).trajectory)
    if (np.diff(rows[:, 0]) <= 0).any():
        raise ValueError("trajectory: rows of t_s, x_m, y_m, heading_rad, speed_mps with rising t_s")
    return Command(pose=_at_next_step(rows, ego))


def _at_next_step(rows: Floats, ego: RoadUser) -> tuple[float, float, float, float]:
    """The pose a step from now on the curve through the rows with their velocities (cubic Hermite); it begins at the
    ego where no row is of now."""
    if rows[0, 0] > 0:
        rows = np.vstack(([0.0, ego.x_m, ego.y_m, ego.heading_rad, ego.speed_mps], rows))
    k = int(np.searchsorted(rows[:, 0], STEP_S))
    if k == 0 or k == len(rows):
        x, y, heading, speed = (float(v) for v in rows[min(k, len(rows) - 1), 1:])
        return x, y, heading, speed
    (t, *first), (t2, *last) = rows[k - 1 : k + 1].tolist()
    span, u = t2 - t, (STEP_S - t) / (t2 - t)
    sense = -1.0 if math.cos(ego.course_rad - ego.heading_rad) < 0 else 1.0
    ends = [(p[3] * math.cos(p[2]) * span * sense, p[3] * math.sin(p[2]) * span * sense) for p in (first, last)]
    x, y = (_hermite(u, first[i], last[i], ends[0][i], ends[1][i]) for i in (0, 1))
    heading = first[2] + u * math.remainder(last[2] - first[2], math.tau)
    return x, y, heading, first[3] + u * (last[3] - first[3])


def _hermite(u: float, first: float, last: float, slope: float, slope2: float) -> float:
    """Between two values with their slopes, at a share of the way."""
    rest = 1 - u
    return first * rest**2 * (1 + 2 * u) + last * u**2 * (3 - 2 * u) + slope * u * rest**2 - slope2 * u**2 * rest
