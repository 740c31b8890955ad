"""The state of a played scenario that conditions and actions read: clock, bodies, roads, storyboard states.

Knows no XML beyond the node that is blamed for a fault.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.offset_course import Course, beside, straight
from sgcad_core.formats.openscenario.playing.timed_motion import Pose, Transition
from sgcad_core.formats.openscenario.reading.elements import Node
from sgcad_core.formats.openscenario.roads.way import LanePlace, Route, Way

TRANSITIONS = ("startTransition", "endTransition", "stopTransition", "skipTransition")


class Apart(Protocol):
    """How far a place lies from another along the roads."""

    @property
    def ahead_m(self) -> float:
        """Ahead, metres; behind: negative."""

    @property
    def left_m(self) -> float:
        """To the left, metres."""


class Roads(Protocol):
    """What the player asks of a road network. Faults are ValueErrors that say what there is instead."""

    def road_pose(self, road: str, s_m: float, t_m: float) -> Pose:
        """Pose on a road; heading along its reference line."""

    def lane_pose(self, road: str, lane: int, s_m: float, offset_m: float) -> Pose:
        """Pose in a lane; heading in its driving direction, `offset_m` to the left of the reference direction."""

    def place_at(self, road: str, s_m: float, t_m: float) -> LanePlace:
        """Road coordinates as a place in the lane that holds them."""

    def t_of(self, place: LanePlace) -> float:
        """A lane place's t on its road, metres."""

    def beyond(self, road: str, s_m: float) -> float:
        """How far s lies behind a road's end (before its start: negative), metres."""

    def sense(self, place: LanePlace, heading_rad: float) -> int:
        """1 where a heading leads along s there, -1 where against it."""

    def nearest(self, pose: Pose) -> LanePlace | None:
        """The lane one drives in there, if any."""

    def on_road(self, pose: Pose) -> bool:
        """Whether a point lies on a lane of any kind but "none"."""

    def drive(self, place: LanePlace, sense: int, route: Route | None = None) -> Way:
        """The lane center ahead of a place in a sense of driving, over its successors."""

    def route(self, places: Sequence[LanePlace], sense: int | None = None) -> Route:
        """Shortest roads over places in order."""

    def apart(self, first: LanePlace, sense: int, second: LanePlace) -> Apart | None:
        """Where the second place lies as seen along the roads from the first; None where no road leads there."""


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

    def body(self, name: str, blame: Node) -> Body:
        """An entity. Raises InvalidOutput naming what there is."""
        if name not in self.bodies:
            raise blame.fault("unknown entity", name, f"entities: {', '.join(self.bodies) or 'none'}")
        return self.bodies[name]

    def members(self, name: str, blame: Node) -> tuple[str, ...]:
        """The entities that a name stands for: one, or those of a selection."""
        return self.selections.get(name) or (self.body(name, blame).name,)

    def pose(self, name: str, blame: Node) -> Pose:
        """Where an entity is. Raises InvalidOutput before it was placed."""
        if (pose := self.body(name, blame).pose) is None:
            raise blame.fault("entity has no place yet", name, "teleport it in Init before it is referred to")
        return pose

    def road_map(self, blame: Node) -> Roads:
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

    def course_for(self, body: Body, backwards: bool = False) -> Course:
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

    def lane_course(self, place: LanePlace, pose: Pose, route: Route | None = None) -> Course | None:
        """The way ahead in a lane, from a pose beside its center; None at a dead end."""
        assert self.roads is not None  # noqa: S101 - a place is known, so there are roads
        way = self.roads.drive(place, self.roads.sense(place, pose.heading_rad), route)
        if len(way.points) < 2:
            return None
        ahead, side = beside(way.points, pose)
        return Course(way.points, ahead, shift=Transition(side, side, "step", 0.0), way=way)

    def named(self, kind: str, ref: str) -> Iterator[Stage]:
        """Storyboard elements of a kind by name or by path ("act::group::maneuver")."""
        return (s for s in self.stages if s.kind == kind and f"::{s.path}".endswith(f"::{ref}"))
