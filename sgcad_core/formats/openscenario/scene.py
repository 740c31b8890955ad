"""The state of a played scenario that conditions and actions read: clock, bodies, roads, storyboard states.

Knows no XML beyond the node that is blamed for a fault.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from sgcad_core.formats.openscenario.motion import Body, Course, Pose, Transition, straight
from sgcad_core.formats.openscenario.read import Node
from sgcad_core.geometry.plane import Floats

TRANSITIONS = ("startTransition", "endTransition", "stopTransition", "skipTransition")


class LanePlace(NamedTuple):
    """A place in lane coordinates: road id, lane id, s along the road and offset to the left of the lane center."""

    road: str
    lane: int
    s_m: float
    offset_m: float


class Roads(Protocol):
    """What the player asks of a road network. Faults are ValueErrors that say what there is instead."""

    def road_pose(self, road: str, s_m: float, t_m: float) -> Pose:
        """Pose on a road; heading along its reference line."""

    def lane_pose(self, road: str, lane: int, s_m: float, offset_m: float) -> Pose:
        """Pose in a lane; heading in its driving direction, `offset_m` to the left of the reference direction."""

    def nearest(self, pose: Pose) -> LanePlace | None:
        """The lane one drives in there, if any."""

    def way(self, road: str, lane: int, s_m: float) -> Floats:
        """(n, 2) lane center ahead of a place in driving direction, over its successors."""


class Stage:
    """One storyboard element while it is played: its state and when its transitions happened."""

    def __init__(self, kind: str, path: str) -> None:
        self.kind, self.path = kind, path
        self.state = "standbyState"
        self.moments: dict[str, int] = {}

    def turn(self, transition: str, state: str, step: int) -> None:
        """Change state."""
        self.state = state
        self.moments[transition] = step


@dataclass(eq=False)
class Scene:
    """Everything at one step; time is step * dt_s, never accumulated."""

    dt_s: float
    bodies: dict[str, Body]
    roads: Roads | None = None
    step: int = 0
    stages: list[Stage] = field(default_factory=list)

    @property
    def t_s(self) -> float:
        """Simulation time, seconds."""
        return self.step * self.dt_s

    def body(self, name: str, blame: Node) -> Body:
        """An entity. Raises InvalidOutput naming what there is."""
        if name not in self.bodies:
            raise blame.fault("unknown entity", name, f"entities: {', '.join(self.bodies) or 'none'}")
        return self.bodies[name]

    def pose(self, name: str, blame: Node) -> Pose:
        """Where an entity is. Raises InvalidOutput before it was placed."""
        if (pose := self.body(name, blame).pose) is None:
            raise blame.fault("entity has no place yet", name, "teleport it in Init before it is referred to")
        return pose

    def road_map(self, blame: Node) -> Roads:
        """The road network. Raises InvalidOutput where none was given."""
        if self.roads is None:
            raise blame.fault("needs a road network, and none was given", remedy="use WorldPosition")
        return self.roads

    def course_from(self, pose: Pose) -> Course:
        """The lane ahead of a pose, keeping the offset to its center; straight on where there is none."""
        if self.roads is None or (place := self.roads.nearest(pose)) is None:
            return straight(pose)
        return lane_course(self.roads, place, pose) or straight(pose)

    def named(self, kind: str, ref: str) -> Iterator[Stage]:
        """Storyboard elements of a kind by name or by path ("act::group::maneuver")."""
        return (s for s in self.stages if s.kind == kind and f"::{s.path}".endswith(f"::{ref}"))


def lane_course(roads: Roads, place: LanePlace, pose: Pose) -> Course | None:
    """The way ahead in a lane, from a pose beside its center; None at a dead end."""
    points = roads.way(place.road, place.lane, place.s_m)
    if len(points) < 2:
        return None
    side = lateral_m(points, pose)
    return Course(points, shift=Transition(side, side, "step", 0.0))


def lateral_m(points: Floats, pose: Pose) -> float:
    """How far a pose lies to the left of a polyline's first segment, metres."""
    (x, y), (x2, y2) = points[0], points[1]
    length = float(((x2 - x) ** 2 + (y2 - y) ** 2) ** 0.5)
    return float((x2 - x) * (pose.y_m - y) - (y2 - y) * (pose.x_m - x)) / max(length, 1e-9)
