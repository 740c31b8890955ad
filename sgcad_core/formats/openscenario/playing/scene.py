"""The state of a played scenario that conditions and actions read: clock, bodies, roads, storyboard states.

Knows no XML beyond the node that is blamed for a fault.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.offset_course import OffsetCourse, beside, straight
from sgcad_core.formats.openscenario.playing.timed_motion import Transition
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.openscenario.roads.way import LanePlace, Route

TRANSITIONS = ("startTransition", "endTransition", "stopTransition", "skipTransition")


class ElementState:
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
    roads: XodrRoads | None = None
    step: int = 0
    stages: list[ElementState] = field(default_factory=list)
    parameters: dict[str, str] = field(default_factory=dict)
    variables: dict[str, str] = field(default_factory=dict)
    """Values that conditions read and actions set, by name."""
    selections: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """Members of entity selections by name."""
    signals: dict[str, str] = field(default_factory=dict)
    """State of traffic signals by id."""
    clock_s: float | None = None
    """Seconds since midnight at t = 0, where the file says it."""
    no_map: str = "needs a road network, and none was given"

    @property
    def t_s(self) -> float:
        """Simulation time, seconds."""
        return self.step * self.dt_s

    def body(self, name: str, blame: XmlNode) -> Body:
        """An entity. Raises InvalidOutput naming what there is."""
        if name not in self.bodies:
            raise blame.fault("unknown entity", name, f"entities: {', '.join(self.bodies) or 'none'}")
        return self.bodies[name]

    def members(self, name: str, blame: XmlNode) -> tuple[str, ...]:
        """The entities that a name stands for: one, or those of a selection."""
        return self.selections.get(name) or (self.body(name, blame).name,)

    def pose(self, name: str, blame: XmlNode) -> Pose:
        """Where an entity is. Raises InvalidOutput before it was placed."""
        if (pose := self.body(name, blame).pose) is None:
            raise blame.fault("entity has no place yet", name, "teleport it in Init before it is referred to")
        return pose

    def road_map(self, blame: XmlNode) -> XodrRoads:
        """The road network. Raises InvalidOutput where none was given."""
        if self.roads is None:
            raise blame.fault(self.no_map, remedy="use WorldPosition, or give the map")
        return self.roads

    def lane_place(self, body: Body) -> LanePlace | None:
        """The lane that an entity is in; None off the roads."""
        if body.place is None and self.roads is not None and body.pose is not None:
            body.place = self.roads.nearest(body.pose)
        return body.place

    def sense(self, body: Body, place: LanePlace) -> int:
        """Whether an entity drives along s (1) or against it (-1)."""
        assert self.roads is not None  # noqa: S101 - a place is known, so there are roads
        assert body.pose is not None  # noqa: S101 - as above
        return self.roads.sense(place, body.pose.heading_rad)

    def course_for(self, body: Body, backwards: bool = False) -> OffsetCourse:
        """The lane ahead of an entity (behind it: `backwards`), keeping the offset; straight on where there is none."""
        assert body.pose is not None  # noqa: S101 - only placed entities move
        x, y, h = body.pose
        pose = Pose(x, y, h + math.pi) if backwards else body.pose
        if body.at_end and body.course is not None and body.course.reverse == backwards:
            return body.course
        place = self.lane_place(body)
        course = self.lane_course(place, pose, body.route) if place else None
        course = course or straight(pose)
        course.reverse = backwards
        return course

    def lane_course(self, place: LanePlace, pose: Pose, route: Route | None = None) -> OffsetCourse | None:
        """The way ahead in a lane, from a pose beside its center; None at a dead end."""
        assert self.roads is not None  # noqa: S101 - a place is known, so there are roads
        way = self.roads.drive(place, self.roads.sense(place, pose.heading_rad), route)
        if len(way.points) < 2:
            return None
        ahead, side = beside(way.points, pose)
        return OffsetCourse(way.points, ahead, shift=Transition(side, side, "step", 0.0), way=way)

    def named(self, kind: str, ref: str) -> list[ElementState]:
        """Storyboard elements of a kind by name or by path ("act::group::maneuver")."""
        last = ref.rsplit("::", 1)[-1]
        return [s for s in self._by_name.get((kind, last), ()) if f"::{s.path}".endswith(f"::{ref}")]

    @cached_property
    def _by_name(self) -> dict[tuple[str, str], list[ElementState]]:
        """All stages by kind and own name; the storyboard is whole when the first condition asks."""
        found: dict[tuple[str, str], list[ElementState]] = {}
        for stage in self.stages:
            found.setdefault((stage.kind, stage.path.rsplit("::", 1)[-1]), []).append(stage)
        return found
