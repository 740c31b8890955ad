"""Inputs and outputs of a driver, 20 times a second: the records between a hand-over and the plugin kind `driver`.

A `Task` stands for the whole drive, a `View` for one instant, a `Command` for what the driver does until the next.
Knows numpy and specs; no simulation. SI units, radians counter-clockwise from east, points are box centers.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.records.specs import ActorKind

STEP_S = 0.05
"""From one view to the next: 20 Hz."""


class RoadUser(NamedTuple):
    """One road user at one instant; `speed_mps` along its way, `course_rad` the direction in which it moves."""

    actor: str
    kind: ActorKind
    length_m: float
    width_m: float
    x_m: float
    y_m: float
    heading_rad: float
    speed_mps: float
    course_rad: float

    @property
    def velocity(self) -> tuple[float, float]:
        """East and north, m/s."""
        return self.speed_mps * float(np.cos(self.course_rad)), self.speed_mps * float(np.sin(self.course_rad))


@dataclass(frozen=True, eq=False)
class Way:
    """The intended line of the ego and the motion of the report's driver on it: n samples, 0.05 s apart.

    Where the report's driver was stopped by the contact, the line goes on as it would have.
    """

    t_s: Floats
    """Script time of each sample."""
    pose: Floats
    """(n, 3) x, y, heading of the box."""
    s_m: Floats
    """(n,) distance driven."""
    speed_mps: Floats

    def pose_at(self, s_m: float) -> tuple[float, float, float]:
        """The pose at a station; clamped to the ends."""
        s, pose = self._by_station
        return float(np.interp(s_m, s, pose[:, 0])), float(np.interp(s_m, s, pose[:, 1])), float(
            np.interp(s_m, s, pose[:, 2])
        )  # fmt: skip

    def poses_at(self, s_m: Floats) -> Floats:
        """(m, 3) poses at stations."""
        s, pose = self._by_station
        return np.column_stack([np.interp(s_m, s, pose[:, i]) for i in range(3)])

    def poses_when(self, t_s: Floats) -> Floats:
        """(m, 3) poses at script times; clamped to the ends."""
        return np.column_stack([np.interp(t_s, self.t_s, self.pose[:, i]) for i in range(3)])

    def speed_at(self, t_s: float) -> float:
        """Speed of the report's driver at a script time."""
        return float(np.interp(t_s, self.t_s, self.speed_mps))

    def station_at(self, t_s: float) -> float:
        """Station of the report's driver at a script time."""
        return float(np.interp(t_s, self.t_s, self.s_m))

    def times_at(self, s_m: float) -> tuple[float, float]:
        """First and last time of the report's driver at a station (equal unless the vehicle stood there)."""
        low = int(np.searchsorted(self.s_m, s_m - 1e-3, side="left"))
        high = int(np.searchsorted(self.s_m, s_m + 1e-3, side="right")) - 1
        if high < low:  # between two samples
            t = float(np.interp(s_m, *self._times))
            return t, t
        n = len(self.t_s) - 1
        return float(self.t_s[min(low, n)]), float(self.t_s[min(high, n)])

    def __post_init__(self) -> None:
        kept = np.append(True, np.diff(self.s_m) > 1e-6)
        object.__setattr__(self, "_by_station", (self.s_m[kept], self.pose[kept]))
        object.__setattr__(self, "_times", (self.s_m[kept], self.t_s[kept]))

    _by_station = (np.zeros(1), np.zeros((1, 3)))
    _times = (np.zeros(1), np.zeros(1))


@dataclass(frozen=True, eq=False)
class Task:
    """The inputs of a driver at the start of a drive."""

    ego: RoadUser
    way: Way
    friction_mps2: float
    """The most that tires transmit on the surface that the report tells."""
    speed_limit_mps: float | None = None
    gives_way_m: float | None = None
    """Station of the center of the box where its front stands at the line at which the ego has to give way."""
    net_xml: str = ""
    case: str = ""


class View(NamedTuple):
    """The driver's observation at one instant."""

    t_s: float
    """Since the hand-over."""
    ego: RoadUser
    station_m: float
    """Of the ego on its way."""
    script_s: float
    """Script time at which the report's driver was where the ego is now."""
    others: tuple[RoadUser, ...]


class Command(NamedTuple):
    """The driver's control input until the next view.

    Without steering the vehicle keeps to its way; with it (angle of the front wheels, left positive) it goes as a
    kinematic bicycle; `pose` (x, y, heading, speed) is where it is at the next instant, whatever the rest says.
    """

    acceleration_mps2: float = 0.0
    steering_rad: float | None = None
    pose: tuple[float, float, float, float] | None = None


class Seat(ABC):
    """A driver during one drive; may keep state between views."""

    @abstractmethod
    def act(self, view: View) -> Command:
        """The command until the next view. Raises SimulationFailed where the driver is gone."""

    def leave(self) -> None:
        """Called at the end of the drive."""
        return


def script_acceleration(task: Task, view: View) -> float:
    """Acceleration of the report's driver at this station, m/s2."""
    wanted = task.way.speed_at(view.script_s + STEP_S)
    return (wanted - view.ego.speed_mps) / STEP_S
