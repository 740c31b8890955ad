"""Records of the traffic around a crash: how dense it is, what a simulator is asked to drive, what it drove.

Background vehicles are no actors of the crash: they stand in records of their own, so that metrics, account, verdict
and rules, which look at the actors, do not see them. Knows no simulator.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from sgcad_core.case.density import PER_KM, Density
from sgcad_core.case.records import ActorInfo, Floats, Trajectory
from sgcad_core.record_base import Record

ROLE = "traffic"
"""What the column `role` of trajectories.csv, properties of entities and pages call a background vehicle."""

BRAKING_MPS2 = 4.5
"""By which its vehicles stop where nothing drives them: SUMO's usual deceleration, on which their gaps are built."""


@dataclass(frozen=True, eq=False)
class CrashScene:
    """An executed crash: the roads and the actors on them, in one order."""

    case: str
    actors: tuple[ActorInfo, ...]
    trajectories: tuple[Trajectory, ...]
    net_xml: str
    xosc: str | None = None
    """The scenario file: it has the plan of the signals."""


class Entrant(NamedTuple):
    """A background vehicle before it drives: its size, its way, and where and when its front bumper is on the roads."""

    id: str
    kind: str
    length_m: float
    width_m: float
    route: tuple[str, ...]
    lane: int
    at_m: float
    depart_s: float


class Fixture(NamedTuple):
    """An actor of the crash as the traffic meets it: size, and (n, 4) box center x, y, heading and speed by row."""

    id: str
    length_m: float
    width_m: float
    poses: Floats


class TrafficOrder(NamedTuple):
    """What a simulator drives: entrants among fixtures; `signals`: by program its states, a string a row."""

    net_xml: str
    fixtures: tuple[Fixture, ...]
    entrants: tuple[Entrant, ...]
    signals: Mapping[str, tuple[str, ...]]
    seed: int


class Driven(NamedTuple):
    """A background vehicle's motion while it was on the roads: its first row, and (m, 4) poses from there on."""

    id: str
    first: int
    poses: Floats


Background = tuple[tuple[ActorInfo, Trajectory], ...]
"""Vehicles of the traffic with their motions."""


class Traffic(Record):
    """The traffic around a crash; trajectories on the crash's clock, in the order of the vehicles."""

    density: Density
    seed: int
    wanted: int
    """Vehicles that the density asks for."""
    vehicles: tuple[ActorInfo, ...] = ()
    trajectories: tuple[Trajectory, ...] = ()
    entrants: tuple[Entrant, ...] = ()
    """The vehicles as SUMO starts them, under their final ids."""
    moved: int = 0
    """Vehicles that began elsewhere, since they came too near to an actor."""
    removed: Mapping[str, int] = {}
    """Vehicles that were left out, by reason."""
    notes: tuple[str, ...] = ()

    @property
    def background(self) -> Background:
        """The vehicles with their motions."""
        return tuple(zip(self.vehicles, self.trajectories, strict=True))

    def summary(self) -> dict[str, Any]:
        """For result.json."""
        return {
            "density": self.density, "per_km_and_lane": PER_KM[self.density], "seed": self.seed, "wanted": self.wanted,
            "vehicles": [vehicle.model_dump() for vehicle in self.vehicles], "moved": self.moved,
            "removed": dict(self.removed), "notes": list(self.notes),
        }  # fmt: skip
