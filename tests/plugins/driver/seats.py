"""Views for drivers: an ego on a straight way, and who else is there."""

from __future__ import annotations

import numpy as np

from sgcad_core.case.driver_io import RoadUser, Task, View, Way


def user(actor="V2", x=0.0, y=0.0, speed=0.0, course=0.0, kind="car", length=4.7, width=1.8):
    return RoadUser(actor, kind, length, width, x, y, course, speed, course)


def task(speed=20.0, friction=8.34, gives_way=None):
    """Eastwards along y = 0 from x = 0 at a steady speed."""
    t = np.arange(0.0, 40.0, 0.05)
    way = Way(t, np.column_stack((t * speed, 0 * t, 0 * t)), t * speed, np.full(len(t), speed))
    return Task(user("V1", speed=speed), way, friction, 25.0, gives_way, "", "made")


def view(made, t=0.0, x=0.0, speed=None, others=()):
    own = float(made.way.speed_mps[0]) if speed is None else speed
    return View(
        t, made.ego._replace(x_m=x, speed_mps=own), x, x / max(float(made.way.speed_mps[0]), 1e-9), tuple(others)
    )


def ride(seat, made, others_at, seconds=8.0):
    """Drive: (time, station, speed, acceleration) of each step; `others_at(t)` says who is where."""
    speed, x, rows = float(made.way.speed_mps[0]), 0.0, []
    for k in range(round(seconds / 0.05)):
        t = k * 0.05
        command = seat.act(view(made, t, x, speed, others_at(t)))
        a = min(max(command.acceleration_mps2, -made.friction_mps2), made.friction_mps2)
        rows.append((t, x, speed, a))
        after = max(speed + a * 0.05, 0.0)
        x, speed = x + (speed + after) / 2 * 0.05, after
    return np.array(rows)
