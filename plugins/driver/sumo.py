"""SUMO's own driver model for the ego: its car following, its right of way at junctions.

The external counterpart of `idm`: SUMO decides (P. Alvarez Lopez et al., Microscopic traffic simulation using SUMO,
ITSC 2018), with the intelligent driver model or Krauss's. Each step the others are put on their places, and the ego
drives on its own way at the speed that SUMO gives it; the free speed is that of the report's driver at that place. A
road user whose turn cannot be known yet is taken to go straight on. SUMO's lane changes are left out: the ego keeps to
its way.
"""

from __future__ import annotations

import functools
import math
from typing import Literal

from pydantic import Field

from plugins.driver._sumo_messages import Begin, End, Habits, Mover, Place, Step
from sgcad_core.case.driver_io import STEP_S, Command, RoadUser, Seat, Task, View
from sgcad_core.errors import SimulationFailed
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.handover.foresight import Ahead, users_ahead
from sgcad_core.handover.lane_following import poses_of, route_of
from sgcad_core.interfaces import Driver
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.system.worker_process import Worker

_IN_THE_WAY_M = 0.2
"""From the strip that the ego sweeps."""


@functools.cache
def _worker() -> Worker:
    """One SUMO process for all drives of this process, since its start takes half a second."""
    return Worker("plugins.driver._sumo_worker:obey")


class Sumo(Driver):
    """Lets SUMO drive the ego: at the speeds of the report's driver, following and giving way as SUMO does.

    model is SUMO's car-following model; the other fields are its parameters.
    """

    model: Literal["IDM", "Krauss"] = "IDM"
    acceleration_mps2: float = Field(2.6, gt=0, le=5)
    """SUMO's default for passenger cars, as are the next four."""
    braking_mps2: float = Field(4.5, gt=0, le=9)
    hardest_mps2: float = Field(9.0, gt=0, le=12)
    headway_s: float = Field(1.0, gt=0, le=5)
    gap_m: float = Field(2.5, gt=0, le=10)
    timeout_s: float = Field(30.0, gt=0, le=600)
    """Longest wait for one step."""

    def take_over(self, task: Task) -> Seat:
        """A SUMO vehicle on the ego's way. Raises SimulationFailed if the way is on no lane."""
        graph = _graph(task.net_xml)
        route = route_of(graph, poses_of(task.way.pose))
        if not route:
            raise SimulationFailed(
                f"{task.case}: SUMO drives on lanes, and the ego's way is on none; take another driver"
            )
        habits = Habits(
            self.model, self.acceleration_mps2, self.braking_mps2, self.hardest_mps2, self.headway_s, self.gap_m
        )
        _worker().call(Begin(task.net_xml, _place(task.ego), route, habits), timeout_s=self.timeout_s)
        return _Seat(self, task, graph)


class _Seat(Seat):
    def __init__(self, config: Sumo, task: Task, graph: LaneGraph) -> None:
        self._config, self._task, self._graph = config, task, graph
        self._routes: dict[str, tuple[str, ...]] = {}

    def act(self, view: View) -> Command:
        """The acceleration towards SUMO's speed."""
        before = {
            a.user.actor: a for a in users_ahead(self._task, view) if a.aside_m <= _IN_THE_WAY_M and a.gap_m > -1.0
        }
        movers = tuple(
            self._leader(view, before[u.actor]) if u.actor in before else self._mover(u) for u in view.others
        )
        free = self._task.way.speed_at(view.script_s + STEP_S)
        speed = _worker().call(Step(movers, view.ego.speed_mps, free), timeout_s=self._config.timeout_s)
        return Command((speed - view.ego.speed_mps) / STEP_S)

    def _mover(self, user: RoadUser) -> Mover:
        if user.actor not in self._routes:
            self._routes[user.actor] = route_of(self._graph, [(user.x_m, user.y_m, user.course_rad)])
        own = self._routes[user.actor]
        return Mover(user.actor, _place(user), own or (next(iter(self._graph.edges)),), bool(own))

    def _leader(self, view: View, a: Ahead) -> Mover:
        """A box that reaches into the ego's strip, however it stands there, as one on the ego's way.

        SUMO locates a vehicle by the middle of its front bumper, so it would not see a car that stands across the lane.
        """
        user = a.user
        station = view.station_m + view.ego.length_m / 2 + a.gap_m + user.length_m / 2
        x, y, _ = self._task.way.pose_at(station)
        ahead_x, ahead_y, _ = self._task.way.pose_at(station + 0.5)
        moved = math.hypot(ahead_x - x, ahead_y - y) > 0.1
        heading = math.atan2(ahead_y - y, ahead_x - x) if moved else view.ego.course_rad
        place = Place(x, y, heading, max(a.along_mps, 0.0), user.length_m, user.width_m)
        return self._mover(user)._replace(place=place, known=False)

    def leave(self) -> None:
        """Closes SUMO; its process stays for the next drive."""
        _worker().call(End(), timeout_s=self._config.timeout_s)


@functools.lru_cache(maxsize=4)
def _graph(net_xml: str) -> LaneGraph:
    return parse_net(net_xml)


def _place(user: RoadUser) -> Place:
    return Place(user.x_m, user.y_m, user.heading_rad, user.speed_mps, user.length_m, user.width_m)
