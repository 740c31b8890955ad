"""A plan as maneuver events, for editing by hand and for players that hand over: the second encoding.

Motion along lanes is written as a route over junctions and a change of lane or lane offset; other actors follow
an untimed trajectory at their own speed. Speeds are few even changes. Each event starts where the others are or where
its actor is, not by the clock, as far as that is certain; the last piece of one of the two in contact is a meeting with
the other (SynchronizeAction). Both brake once they touch; the others do what was planned to the end. Places follow from
that: they are near the plan's until the contact, and free after it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from scenariogeneration import xosc
from scenariogeneration.xosc.enumerations import VersionBase

from sgcad_core.case.records import Floats, ObservedContact, Trajectory
from sgcad_core.formats.openscenario.roads.lane_motion import LaneMotion, Shift, lane_motion, start_place
from sgcad_core.formats.openscenario.roads.road_network import roads_of
from sgcad_core.formats.openscenario.roads.way import LanePlace
from sgcad_core.formats.openscenario.writing.occasions import EventTriggers
from sgcad_core.formats.openscenario.writing.pacing import pieces
from sgcad_core.formats.openscenario.writing.parts import (
    PlannedEvent,
    at_once,
    group,
    lane_position,
    positions,
    rounded,
    world_position,
)
from sgcad_core.formats.openscenario.writing.synchrony import Meeting, meeting_of
from sgcad_core.formats.openscenario.writing.vertices import path_rows
from sgcad_core.geometry.plane import arc_lengths, wrap_angle

BRAKE_MPS2 = 6.0
"""Deceleration of both actors after the contact."""
ONWARD_M = 100.0
"""Length of the straight path after the contact, should it come late: more than braking needs."""
STANDS_M = 0.2
"""An actor that moves less than this before the contact stands."""
STRAIGHT_RAD = 0.02
"""Largest turn of ways with a meeting: players measure distances in bends differently."""
_STEADY_MPS = 0.02


@dataclass(frozen=True)
class Fallbacks:
    """Simpler encodings after a failed trial: see `execution.event_encoding`."""

    paths: frozenset[str] = frozenset()
    """Actors whose way is a trajectory though lanes could express it."""
    alone: bool = False
    """Without SynchronizeAction."""
    clock: bool = False
    """Everything starts by the clock."""


@dataclass(frozen=True)
class EventOptions:
    """Inputs of events beside the motions: the contact that ends the plan, and the road (.xodr text)."""

    contact: ObservedContact | None = None
    xodr: str | None = None
    plainly: Fallbacks = Fallbacks()


@dataclass(frozen=True)
class EventActor:
    """One actor as events: its origin's motion up to the end of the plan, its placement and its route."""

    move: Trajectory
    ahead_m: float
    partner: str
    """The other actor of the contact, or empty."""
    place: LanePlace | None
    """Its start in lane coordinates, where it lies in a lane."""
    turn_rad: float
    """Its heading against the lane's driving direction."""
    lanes: LaneMotion | None
    """Its way by lanes, where lanes tell it."""
    occasions: EventTriggers
    meeting: Meeting | None = None
    """Its last piece of speed, where that is a meeting."""

    @property
    def along_m(self) -> Floats:
        """Distance gone at every row, metres."""
        return arc_lengths(self.move.points)

    @property
    def stands(self) -> bool:
        """Whether it stays where it is."""
        return _stands(self.move)

    def straight_from(self, begin_s: float) -> bool:
        """Whether it goes straight on from a time."""
        row = int(np.searchsorted(self.move.t_s, begin_s - 1e-6))
        headings = np.unwrap(self.move.heading_rad[row:])
        return bool(np.abs(headings - headings[0]).max() < STRAIGHT_RAD)

    @cached_property
    def knots(self) -> tuple[Floats, Floats]:
        """Times and speeds (backwards negative) between which it speeds up or slows down evenly."""
        if self.stands:
            return np.zeros(1), np.zeros(1)
        times, speeds = pieces(self.move.t_s, self.along_m)
        return times, speeds * self._sense()

    def _sense(self) -> int:
        """-1 where it drives backwards: players ask the speed's sign which way along a path that leads behind it."""
        gone = int(np.flatnonzero(self.along_m > STANDS_M / 2)[0])
        x, y = self.move.x_m[gone] - self.move.x_m[0], self.move.y_m[gone] - self.move.y_m[0]
        return 1 if math.cos(math.atan2(y, x) - self.move.heading_rad[0]) >= 0 else -1

    def start(self) -> xosc.LanePosition | xosc.WorldPosition:
        """Where it begins, as a place in a lane if there is one."""
        if self.place is None:
            return world_position(self.move.x_m[0], self.move.y_m[0], wrap_angle(self.move.heading_rad[0]))
        return lane_position(self.place, 0.0 if self.lanes else self.turn_rad)

    def init_actions(self) -> Iterator[object]:
        """Further Init actions: the route, where its lanes lead over a junction."""
        if self.lanes and self.lanes.route:
            route = xosc.Route(f"{self.move.actor}_route")
            for place in self.lanes.route:
                route.add_waypoint(lane_position(place), xosc.RouteStrategy.shortest)
            yield xosc.AssignRouteAction(route)

    @property
    def first_mps(self) -> float:
        """Speed at the start."""
        return float(self.knots[1][0])

    def group(self) -> xosc.ManeuverGroup:
        """Its events; an actor without any keeps its speed."""
        maneuvers = {"path": list(self._way()), "speed": [*self._speeds(), *self._meets(), *self._brake()]}
        if not any(maneuvers.values()):
            maneuvers["speed"] = [self._stays()]
        return group(self.move.actor, {f"{self.move.actor}_{name}": told for name, told in maneuvers.items() if told})

    def _way(self) -> Iterator[PlannedEvent]:
        if self.lanes and self.lanes.shift:
            yield self._shifts(self.lanes.shift)
        elif not self.stands and self.lanes is None:
            yield self._path()

    def _shifts(self, shift: Shift) -> PlannedEvent:
        """Into another lane, or to another offset in its own."""
        name = self.move.actor
        if shift.lanes:
            over = xosc.TransitionDynamics(
                getattr(xosc.DynamicsShapes, shift.shape), xosc.DynamicsDimension.time, rounded(shift.span_s, 3)
            )
            does: object = xosc.RelativeLaneChangeAction(shift.lanes, name, over, rounded(shift.offset_m, 3))
        else:
            shape = getattr(xosc.DynamicsShapes, shift.shape)
            does = xosc.AbsoluteLaneOffsetAction(
                rounded(shift.offset_m, 3), shape, rounded(shift.lateral_mps2, 4), continuous=False
            )
        when = self._from_place(f"{name}_there", shift)
        return PlannedEvent(f"{name}_shifts", f"{name}_aside", when, does)

    def _from_place(self, name: str, shift: Shift) -> xosc.ValueTrigger | xosc.EntityTrigger:
        if shift.ahead is None:
            return self.occasions.at(name, self.move.actor, float(self.move.t_s[shift.row]))
        place, x, y = shift.ahead
        return self.occasions.place(name, self.move.actor, shift.row, (x, y), lane_position(place))

    def _path(self) -> PlannedEvent:
        path, name = xosc.Trajectory(f"{self.move.actor}_path", False), self.move.actor
        line = self._onward() if self.partner else self.move
        rows = path_rows(line, self.ahead_m)
        times = (
            [rounded(line.t_s[k]) for k in rows] if VersionBase().isVersion(minor=0) else []
        )  # its schema wants them
        path.add_shape(xosc.Polyline(times, positions(line, rows)))
        follow = xosc.FollowTrajectoryAction(path, xosc.FollowingMode.position)
        return PlannedEvent(f"{name}_drives", f"{name}_follow", at_once(f"{name}_start"), follow)

    def _onward(self) -> Trajectory:
        """The motion with a straight way ahead, in the direction in which it last went."""
        points = self.move.points
        back = points[-1] - points
        away = np.hypot(*back.T)
        last = int(np.flatnonzero(away > STANDS_M / 2)[-1])
        x, y = points[-1] + back[last] / away[last] * ONWARD_M
        ends = {"t_s": self.move.t_s[-1] + 10.0, "x_m": x, "y_m": y, "heading_rad": self.move.heading_rad[-1]}
        ends["speed_mps"] = self.move.speed_mps[-1]
        return self.move.model_copy(
            update={name: np.append(getattr(self.move, name), value) for name, value in ends.items()}
        )

    def _speeds(self) -> Iterator[PlannedEvent]:
        name = self.move.actor
        until_s = self.meeting.begin_s - 1e-6 if self.meeting else math.inf
        changes = [
            (begin, end)
            for begin, end in pairwise(zip(*self.knots, strict=True))
            if abs(end[1] - begin[1]) > _STEADY_MPS and begin[0] < until_s
        ]
        for k, ((begin_s, _), (end_s, speed)) in enumerate(changes, 1):
            action = xosc.AbsoluteSpeedAction(rounded(speed), _evenly(xosc.DynamicsDimension.time, end_s - begin_s))
            begin = self.occasions.at(f"{name}_at_{k}", name, begin_s)
            yield PlannedEvent(f"{name}_speed_{k}", f"{name}_to_{k}", begin, action)

    def _meets(self) -> Iterator[PlannedEvent]:
        if (meeting := self.meeting) is None:
            return
        name = self.move.actor
        does = xosc.SynchronizeAction(meeting.master, lane_position(meeting.there), lane_position(meeting.here))
        when = self.occasions.at(f"{name}_in_time", name, meeting.begin_s)
        yield PlannedEvent(f"{name}_meets", f"{name}_with_{meeting.master}", when, does)

    def _stays(self) -> PlannedEvent:
        name = self.move.actor
        action = xosc.AbsoluteSpeedAction(rounded(self.first_mps), _evenly(xosc.DynamicsDimension.time, 0.1))
        return PlannedEvent(f"{name}_stays", f"{name}_keep", at_once(f"{name}_start"), action)

    def _brake(self) -> Iterator[PlannedEvent]:
        if not self.partner:
            return
        name, touched = self.move.actor, xosc.CollisionCondition(self.partner)
        begin = xosc.EntityTrigger(f"{name}_touched", 0.0, xosc.ConditionEdge.none, touched, name)
        stop = xosc.AbsoluteSpeedAction(0.0, _evenly(xosc.DynamicsDimension.rate, BRAKE_MPS2))
        yield PlannedEvent(f"{name}_stops", f"{name}_brake", begin, stop)


def event_actors(moves: Sequence[Trajectory], ahead_m: Sequence[float], handover: EventOptions) -> list[EventActor]:
    """The motions of origins as events, in their order."""
    roads = roads_of(handover.xodr) if handover.xodr else None
    contact, plainly = handover.contact, handover.plainly
    pair = {contact.actor: contact.other, contact.other: contact.actor} if contact else {}
    occasions = EventTriggers({move.actor: move for move in moves}, pair, plainly.clock)
    made = []
    for move, ahead in zip(moves, ahead_m, strict=True):
        partner = pair.get(move.actor, "")
        told = _until(move, contact.t_s) if contact and partner else move
        place, turn = start_place(told, roads) if roads else (None, 0.0)
        plain = roads is None or move.actor in plainly.paths or _stands(told)
        lanes = None if plain or roads is None else lane_motion(told, roads, _to_stop_m(told))
        made.append(EventActor(told, ahead, partner, place, turn, lanes, occasions))
    return made if plainly.alone or not pair else _met({actor.move.actor: actor for actor in made})


def _met(actors: Mapping[str, EventActor]) -> list[EventActor]:
    """The actors, the first of the pair that can meet the other doing so; the report's first actor is the master."""
    for name in sorted((name for name, actor in actors.items() if actor.partner), reverse=True):
        mine, master = actors[name], actors[actors[name].partner]
        if not (mine.lanes and master.lanes):
            continue
        found = meeting_of((mine.knots, mine.lanes.end), (master.move.actor, master.knots, master.lanes.end))
        if found and mine.straight_from(found.begin_s) and master.straight_from(found.begin_s):
            return list({**actors, name: replace(mine, meeting=found)}.values())
    return list(actors.values())


def _stands(move: Trajectory) -> bool:
    return bool(arc_lengths(move.points)[-1] < STANDS_M)


def _evenly(dimension: xosc.DynamicsDimension, value: float) -> xosc.TransitionDynamics:
    return xosc.TransitionDynamics(xosc.DynamicsShapes.linear, dimension, rounded(value))


def _until(move: Trajectory, end_s: float) -> Trajectory:
    """The rows up to a time, two at least."""
    n = max(2, int(np.searchsorted(move.t_s, end_s + 1e-6)))
    names = ("t_s", "x_m", "y_m", "heading_rad", "speed_mps")
    return move.model_copy(update={name: getattr(move, name)[:n] for name in names})


def _to_stop_m(move: Trajectory) -> float:
    """Way in which it comes to rest from its last speed, and some more."""
    return float(move.speed_mps[-1] ** 2 / (2 * BRAKE_MPS2) + 5.0)
