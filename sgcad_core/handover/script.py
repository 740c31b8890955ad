"""A written crash for a hand-over: the motion of each actor up to the contact, and as if there were none.

A line has a pose every 0.05 s. It follows the script until its actor touches the ego, then goes on undisturbed at the
same speed. Contacts of the others with each other stay as scripted. Knows trajectories, sizes and the lane graph; no
driver.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from sgcad_core.case.driver_io import STEP_S, Way
from sgcad_core.case.records import ActorInfo, ObservedContact, Trajectory, sizes_of
from sgcad_core.case.traffic import Background
from sgcad_core.errors import ConfigError
from sgcad_core.execution.contact import first_with
from sgcad_core.geometry.plane import Floats, Size, arc_lengths
from sgcad_core.handover.lane_following import Start, continued_line
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.records.specs import Contact, Surface
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.rules.lights import Lights, lights_of

BEYOND_S = 15.0
"""Time for which lines go on after the contact."""
_SLOW_MPS = 0.3
_TREND = 4
"""Steps over which the trend of an actor's course is taken."""
_TIGHTEST_PER_M = 0.2
_COUPLED_M = 1.5
"""Largest variation of the distance of a coupled trailer."""


@dataclass(frozen=True, eq=False)
class Script:
    """A crash as it was written; sizes and kinds by actor."""

    case: str
    actors: tuple[ActorInfo, ...]
    trajectories: tuple[Trajectory, ...]
    graph: LaneGraph
    declared: Contact | None = None
    roles: Mapping[str, str] = field(default_factory=dict)
    surface: Surface | None = None
    net_xml: str = ""
    grip: float | None = None
    """Peak friction, where it is given; else that of the surface."""
    xosc: str | None = field(default=None, repr=False)
    """The scenario file: it has the plan of the signals."""
    background: Background = field(default=(), repr=False)
    """Traffic around the crash. No driver sees it, and it sees none."""

    @cached_property
    def lights(self) -> Lights | None:
        """What the signals show; None where the scenario has no plan of them."""
        return lights_of(self.graph, self.xosc)

    @property
    def sizes(self) -> dict[str, Size]:
        """Length and width by actor."""
        return sizes_of(self.actors)

    @property
    def friction_mps2(self) -> float:
        """The most that tires transmit on the surface that is told."""
        return DRIVING.friction_mps2(self.surface) if self.grip is None else DRIVING.gravity_mps2 * self.grip

    def info(self, actor: str) -> ActorInfo:
        """An actor by id. Raises ConfigError naming those there are."""
        found = next((a for a in self.actors if a.id == actor), None)
        if found is None:
            raise ConfigError(f"{self.case}: no actor {actor!r}; it has {', '.join(a.id for a in self.actors)}")
        return found

    def ego_of(self, role: str) -> str | None:
        """The first actor of a role that a driver can control."""
        return next((a.id for a in self.actors if self.roles.get(a.id) == role and a.record.driven), None)

    def contact_of(self, ego: str) -> ObservedContact | None:
        """The first scripted contact of an actor with an actor that is not coupled to it."""
        track = {t.actor: t for t in self.trajectories}
        coupled = self.coupled_to(ego)
        others = [t for a, t in track.items() if a != ego and a not in coupled]
        return first_with(track[ego], others, self.sizes)

    def coupled_to(self, ego: str) -> frozenset[str]:
        """Actors that keep their distance from the ego while moving, where either is a trailer."""
        track = {t.actor: t for t in self.trajectories}
        pulled = {a.id: a.record.pulled for a in self.actors}
        pairs = [a for a in track if a != ego and (pulled[a] or pulled[ego])]
        return frozenset(a for a in pairs if _coupled(track[ego], track[a], self.sizes))


def _coupled(a: Trajectory, b: Trajectory, sizes: Mapping[str, Size]) -> bool:
    n = min(len(a.t_s), round(2.0 / STEP_S))
    apart = np.hypot(a.x_m[:n] - b.x_m[:n], a.y_m[:n] - b.y_m[:n])
    reach = (sizes[a.actor][0] + sizes[b.actor][0]) / 2 + 3.0
    moving = math.hypot(a.x_m[n - 1] - a.x_m[0], a.y_m[n - 1] - a.y_m[0]) > 2.0
    return moving and bool(apart[0] < reach and np.ptp(apart) < _COUPLED_M)


@dataclass(frozen=True, eq=False)
class Staging:
    """A script with the ego taken out: its way, the others' lines, and the contact that ends the script for it."""

    script: Script
    ego: str
    way: Way
    lines: Mapping[str, Way]
    coupled: frozenset[str]
    contact: ObservedContact | None

    @property
    def contact_s(self) -> float:
        """Script time of the ego's contact; of a script without one its end."""
        return self.contact.t_s if self.contact else float(self.script.trajectories[0].t_s[-1])


@lru_cache(maxsize=4)
def staging_for(script: Script, ego: str) -> Staging:
    """The staging with an actor as the ego; the last few are remembered.

    Raises ConfigError for an actor that no driver can control.
    """
    info = script.info(ego)
    if not info.record.driven:
        known = ", ".join(a.id for a in script.actors if a.record.driven) or "none"
        raise ConfigError(f"{script.case}: {ego} is a {info.type}, which no driver drives; drivable: {known}")
    contact = script.contact_of(ego)
    lines = {t.actor: _line(script, t, _cut(script, ego, t)) for t in script.trajectories}
    others = {name: line for name, line in lines.items() if name != ego}
    return Staging(script, ego, lines[ego], others, script.coupled_to(ego), contact)


def _cut(script: Script, ego: str, track: Trajectory) -> int | None:
    """The last sample before the ego disturbs the actor (the ego: before any contact); None without one."""
    if track.actor == ego or track.actor in script.coupled_to(ego):
        contact = script.contact_of(ego)
    else:
        own = next(t for t in script.trajectories if t.actor == ego)
        contact = first_with(own, [track], script.sizes)
    return None if contact is None else max(round(contact.t_s / STEP_S) - 1, 0)


def _line(script: Script, track: Trajectory, cut: int | None) -> Way:
    """An actor's line: its script up to the cut, then on as before."""
    table: Floats = track.pose
    last = len(table) - 1 if cut is None else min(cut, len(table) - 1)
    table = table[: last + 1].copy()
    table[:, 2] = np.unwrap(table[:, 2])
    start, speed = _start(table)
    if cut is not None and speed > _SLOW_MPS:
        table = np.vstack((table, _beyond(script, track.actor, table[-1], start, speed)))
    s = arc_lengths(table[:, :2])
    rate: Floats = np.gradient(s, STEP_S) if len(s) > 1 else np.zeros(1)
    t_s = np.arange(len(table), dtype=np.float64) * STEP_S
    return Way(t_s, table, s, rate)


def _start(table: Floats) -> tuple[Start, float]:
    """Start of the continuation from the last samples: place, course and bend, and the speed."""
    steps = np.diff(table[-_TREND - 1 :, :2], axis=0)
    moved = np.hypot(*steps.T) if len(steps) else np.zeros(1)
    x, y, heading = (float(v) for v in table[-1])
    if not len(steps) or moved[-1] < 1e-4:
        return Start(x, y, heading), 0.0
    course = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    moving = moved > 1e-3
    bend = (course[-1] - course[0]) / moved[1:].sum() if len(course) > 1 and moving.all() else 0.0
    bend = min(max(float(bend), -_TIGHTEST_PER_M), _TIGHTEST_PER_M)
    return Start(x, y, float(course[-1]) + bend * float(moved[-1]) / 2, bend), float(moved[-1]) / STEP_S


def _beyond(script: Script, actor: str, pose: Floats, start: Start, speed_mps: float) -> Floats:
    """(m, 3) poses from the next sample on, along the lanes; the box keeps its angle to its way."""
    info = script.info(actor)
    graph = script.graph if info.record.axles else LaneGraph({}, (), {})
    points = continued_line(graph, start, speed_mps * BEYOND_S, info.maneuver)
    along = arc_lengths(points)
    way = np.diff(points, axis=0)
    course = np.unwrap(np.concatenate(([start.course_rad], np.arctan2(way[:, 1], way[:, 0]))))
    middle = np.concatenate(([0.0], (along[1:] + along[:-1]) / 2))
    at = np.arange(1, round(BEYOND_S / STEP_S) + 1) * STEP_S * speed_mps
    x, y = (np.interp(at, along, points[:, i]) for i in (0, 1))
    return np.column_stack((x, y, np.interp(at, middle, course) + float(pose[2]) - start.course_rad))
