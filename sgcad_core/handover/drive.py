"""A drive: a driver controls the ego, the others follow the relative clock, 20 steps a second.

It ends when the ego has touched another actor, or some time after the conflict. Knows the driver's seat; no plugin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sgcad_core.case.driver_io import STEP_S, Command, RoadUser, Seat, Task, View, Way
from sgcad_core.case.records import ObservedContact, Trajectory
from sgcad_core.errors import SimulationFailed
from sgcad_core.execution.contact import first_contact, first_with
from sgcad_core.geometry.plane import Floats, box_gaps
from sgcad_core.handover.bicycle import Ego
from sgcad_core.handover.reach import Reach
from sgcad_core.handover.relative_clock import RELEASE_S, Clock
from sgcad_core.handover.right_of_way import give_way_station, limit_mps
from sgcad_core.handover.script import Staging
from sgcad_core.interfaces import Driver
from sgcad_core.plugin_calls import fault_of, held

AFTER_S = 5.0
"""Time of the others' clock after the scripted contact at which a drive ends."""
LONGEST_S = 40.0
_CHECKED = 20
"""Steps between two tests for overlap: one test over many steps is cheap."""


@dataclass(frozen=True, eq=False)
class Drive:
    """Result of a drive. All trajectories have the same clock, 0 at the hand-over."""

    staging: Staging
    trajectories: tuple[Trajectory, ...]
    contact: ObservedContact | None
    """The ego's first contact."""
    elsewhere: ObservedContact | None
    """The first contact among the others before that; they do not react to each other."""
    accelerations: Floats
    """(n,) that the ego took, m/s2."""
    others_s: Floats
    """(n,) script time of the others."""
    clock: Clock
    steered: bool

    @property
    def ego(self) -> Trajectory:
        """The ego's motion."""
        return next(t for t in self.trajectories if t.actor == self.staging.ego)


def drive(staging: Staging, driver: Driver, *, release_s: float = RELEASE_S, factor: float = 1.0) -> Drive:
    """Hands the ego to a driver. `factor`: the speed at the hand-over, over the scripted one.

    Raises SimulationFailed where the driver is gone, or asks for what the ego cannot do, which is no crash avoided;
    PluginFault where it raises something else.
    """
    seat = driver.take_over(task_of(staging))
    try:
        run = _Run(staging, lambda view: _asked(driver, seat, view), release_s, factor)
        run.go()
        return run.drive()
    finally:
        with held(driver, "its seat's leave"):
            seat.leave()


def _asked(driver: Driver, seat: Seat, view: View) -> Command:
    """The command of a seat. Raises PluginFault where it is none."""
    with held(driver, "its seat's act"):
        command = seat.act(view)
    if not isinstance(command, Command):
        raise fault_of(driver, f"its seat's act returned {type(command).__name__}, expected Command")
    return command


def task_of(staging: Staging) -> Task:
    """The task record of a driver."""
    script, way = staging.script, staging.way
    ego = Ego.at_start(way)
    return Task(
        ego=_user(staging, staging.ego, way, 0.0, 1.0, ego),
        way=way,
        friction_mps2=script.friction_mps2,
        speed_limit_mps=limit_mps(script.graph, way),
        gives_way_m=give_way_station(script.graph, way, script.info(staging.ego).length_m),
        net_xml=script.net_xml,
        case=script.case,
    )


class _Run:
    """A running drive."""

    def __init__(self, staging: Staging, ask: Callable[[View], Command], release_s: float, factor: float) -> None:
        self.staging, self.ask = staging, ask
        self.ego = Ego.at_start(staging.way, factor)
        self.info = staging.script.info(staging.ego)
        moving = [float(w.speed_mps.max()) for w in staging.lines.values()]
        self.clock = Clock(staging.way, staging.contact_s, max(moving, default=0.0), release_s)
        self.script_s = 0.0
        self.rows: dict[str, list[tuple[float, float, float, float]]] = {n: [] for n in (staging.ego, *staging.lines)}
        self.taken: list[float] = []
        self.seen_s: list[float] = []
        self.reach = Reach(self._me(), staging.script.friction_mps2)

    def go(self) -> None:
        until = self.staging.contact_s + AFTER_S
        while self.clock.now_s < until and len(self.taken) * STEP_S < LONGEST_S:
            users = [self._other(name) for name in self.staging.lines]
            self._note(users)
            view = self._view(users)
            command = self.ask(view)
            try:
                self.reach.check(view.ego, command)
            except ValueError as fault:
                if self._touched():  # the drive is over, whatever the driver says of it
                    return
                raise SimulationFailed(f"the driver of {self.staging.ego} asks for {fault}") from fault
            self._step(self.reach.pedalled(view.ego, command))
            if len(self.taken) % _CHECKED == 0 and self._touched():
                return

    def _me(self) -> RoadUser:
        return _user(self.staging, self.staging.ego, self.staging.way, self.script_s, 1.0, self.ego)

    def _view(self, users: Sequence[RoadUser]) -> View:
        me = self._me()
        seen = tuple(u for u in users if u.actor not in self.staging.coupled)
        return View(len(self.taken) * STEP_S, me, self.ego.station_m, self.script_s, seen)

    def _note(self, users: Sequence[RoadUser]) -> None:
        e = self.ego
        self.rows[self.staging.ego].append((e.x_m, e.y_m, e.heading_rad, e.speed_mps))
        for u in users:
            self.rows[u.actor].append((u.x_m, u.y_m, u.heading_rad, u.speed_mps))
        self.seen_s.append(self.clock.now_s)

    def _step(self, command: Command) -> None:
        self.clock.advance(self.script_s, self.ego.speed_mps)
        friction = self.staging.script.friction_mps2
        self.taken.append(self.ego.move(command, self.staging.way, self.info.length_m, friction))
        first, last = self.staging.way.times_at(self.ego.station_m)
        self.script_s = min(max(self.script_s + STEP_S, first), last)

    def _other(self, name: str) -> RoadUser:
        line = self.staging.lines[name]
        if name in self.staging.coupled:
            return _user(self.staging, name, line, self.script_s, 1.0)
        return _user(self.staging, name, line, self.clock.now_s, self.clock.rate or 1.0)

    def _touched(self) -> bool:
        """Whether the ego has touched another actor since the last test."""
        sizes, ego = self.staging.script.sizes, self.staging.ego
        mine = np.array(self.rows[ego][-_CHECKED - 1 :])
        return any(
            (box_gaps(mine, sizes[ego], np.array(rows[-_CHECKED - 1 :]), sizes[name]) <= 0).any()
            for name, rows in self.rows.items()
            if name != ego and name not in self.staging.coupled
        )

    def _tracks(self, count: int | None) -> dict[str, Trajectory]:
        """All motions, up to a number of samples."""
        return {name: _trajectory(name, rows[:count]) for name, rows in self.rows.items()}

    def drive(self) -> Drive:
        """The drive, cut behind the ego's first contact."""
        tracks = self._tracks(None)
        sizes, ego = self.staging.script.sizes, self.staging.ego
        others = [t for name, t in tracks.items() if name != ego]
        contact = first_with(tracks[ego], [t for t in others if t.actor not in self.staging.coupled], sizes)
        last = round(contact.t_s / STEP_S) + 1 if contact else len(self.taken)
        cut = self._tracks(last)
        elsewhere = first_contact([t for name, t in cut.items() if name != ego], sizes)
        order = [a.id for a in self.staging.script.actors if a.id in cut]
        taken, seen = np.array(self.taken[:last]), np.array(self.seen_s[:last])
        found = tuple(cut[name] for name in order)
        return Drive(self.staging, found, contact, elsewhere, taken, seen, self.clock, self.ego.free)


def _user(staging: Staging, name: str, line: Way, script_s: float, rate: float, ego: Ego | None = None) -> RoadUser:
    """A road user at a script time on its line with the rate of its clock; the ego in its own state."""
    info = staging.script.info(name)
    if ego is not None:
        course = ego.heading_rad + (math.pi if ego.backing else 0.0)
        at = ego.x_m, ego.y_m, ego.heading_rad, ego.speed_mps, course
        return RoadUser(name, info.type, info.length_m, info.width_m, *at)
    k = min(script_s / STEP_S, len(line.t_s) - 1.0)
    low = min(int(k), len(line.t_s) - 2) if len(line.t_s) > 1 else 0
    high, part = min(low + 1, len(line.t_s) - 1), k - low
    p, q = line.pose[low], line.pose[high]
    x, y, heading = (float(a + part * (b - a)) for a, b in zip(p, q, strict=True))
    way = q - p
    moved = math.hypot(way[0], way[1])
    speed = moved / STEP_S * rate if script_s <= line.t_s[-1] else 0.0
    course = math.atan2(way[1], way[0]) if moved > 1e-4 else heading
    return RoadUser(name, info.type, info.length_m, info.width_m, x, y, heading, speed, course)


def _trajectory(name: str, rows: Sequence[tuple[float, float, float, float]]) -> Trajectory:
    table = np.array(rows)
    t_s = np.round(np.arange(len(rows)) * STEP_S, 3)
    x, y, heading, speed = (table[:, i].copy() for i in range(4))
    return Trajectory(actor=name, t_s=t_s, x_m=x, y_m=y, heading_rad=np.unwrap(heading), speed_mps=speed)
