"""A plan as maneuver events, for people who edit by hand and for players that hand over: the second encoding.

Who keeps a lane of a straight road needs no path; others follow an untimed trajectory at their own speed. Speeds are
few even changes, each started by the clock. Who meets in the first contact brakes once they touch; the others do what
was planned to the end. Places follow from that: they are near the plan's until the contact, and not told behind it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scenariogeneration import xosc
from scenariogeneration.xosc.enumerations import VersionBase

from sgcad_core.formats.openscenario.motion import Pose
from sgcad_core.formats.openscenario.pacing import pieces
from sgcad_core.formats.openscenario.parts import (
    Happening,
    at_once,
    from_time,
    group,
    number,
    positions,
    world_position,
)
from sgcad_core.formats.openscenario.roads import XodrRoads
from sgcad_core.formats.openscenario.vertices import vertex_rows
from sgcad_core.formats.openscenario.way import LanePlace
from sgcad_core.geometry.plane import arc_lengths, wrap_angle
from sgcad_core.records import Floats, ObservedContact, Trajectory

BRAKE_MPS2 = 6.0
"""Of who has been in the contact."""
ONWARD_M = 100.0
"""How far the path leads straight on behind the contact, should it come late: more than anybody needs to brake."""
STANDS_M = 0.2
"""Who goes less far than this before the contact stands."""
KEEPS_M, KEEPS_RAD = 0.1, 0.02
"""Beside its lane's line, and turned against it, at most: such a motion keeps the lane."""
LEFT_OUT_M, LEFT_OUT_RAD = 0.01, 0.005
"""A vertex of a path is left out where the way without it is this near."""
SAME_M = 1e-3
"""A lane place is written where it is this near to the pose."""
_STEADY_MPS = 0.02


@dataclass(frozen=True)
class Handover:
    """What events need to know beside the motions: the contact that ends the plan, and the road (.xodr text)."""

    contact: ObservedContact | None = None
    xodr: str | None = None


@dataclass(frozen=True)
class EventActor:
    """One actor as events: its origin's motion up to where it is told, and how it is placed."""

    move: Trajectory
    ahead_m: float
    partner: str
    """Whom it meets in the contact, or empty."""
    place: LanePlace | None
    """Its start in lane coordinates, where it lies in a lane."""
    turn_rad: float
    """Its heading against the lane's driving direction."""
    keeps: bool
    """Whether it keeps its lane all the way."""

    @property
    def along_m(self) -> Floats:
        """Distance gone at every row, metres."""
        return arc_lengths(np.column_stack((self.move.x_m, self.move.y_m)))

    @property
    def stands(self) -> bool:
        """Whether it stays where it is."""
        return bool(self.along_m[-1] < STANDS_M)

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
        road, lane, s_m, offset_m = self.place
        turned = 0.0 if self.keeps else number(self.turn_rad, 8)
        facing = xosc.Orientation(h=turned, reference=xosc.ReferenceContext.relative)
        return xosc.LanePosition(number(s_m), number(offset_m), str(lane), road, facing)

    @property
    def first_mps(self) -> float:
        """Speed at the start."""
        return float(self.knots[1][0])

    def group(self) -> xosc.ManeuverGroup:
        """Its events; who has nothing to do keeps its speed."""
        maneuvers = {"path": list(self._path()), "speed": [*self._speeds(), *self._brake()]}
        if not any(maneuvers.values()):
            maneuvers["speed"] = [self._stays()]
        return group(self.move.actor, {f"{self.move.actor}_{name}": told for name, told in maneuvers.items() if told})

    def _path(self) -> Iterator[Happening]:
        if self.stands or self.keeps:
            return
        path, name = xosc.Trajectory(f"{self.move.actor}_path", False), self.move.actor
        line = self._onward() if self.partner else self.move
        rows = _places(line, self.ahead_m)
        times = [number(line.t_s[k]) for k in rows] if VersionBase().isVersion(minor=0) else []  # its schema wants them
        path.add_shape(xosc.Polyline(times, positions(line, rows)))
        follow = xosc.FollowTrajectoryAction(path, xosc.FollowingMode.position)
        yield Happening(f"{name}_drives", f"{name}_follow", at_once(f"{name}_start"), follow)

    def _onward(self) -> Trajectory:
        """The motion with a straight way ahead, in the direction in which it last went."""
        points = np.column_stack((self.move.x_m, self.move.y_m))
        back = points[-1] - points
        away = np.hypot(*back.T)
        last = int(np.flatnonzero(away > STANDS_M / 2)[-1])
        x, y = points[-1] + back[last] / away[last] * ONWARD_M
        ends = {"t_s": self.move.t_s[-1] + 10.0, "x_m": x, "y_m": y, "heading_rad": self.move.heading_rad[-1]}
        ends["speed_mps"] = self.move.speed_mps[-1]
        return self.move.model_copy(
            update={name: np.append(getattr(self.move, name), value) for name, value in ends.items()}
        )

    def _speeds(self) -> Iterator[Happening]:
        name = self.move.actor
        changes = [
            piece for piece in pairwise(zip(*self.knots, strict=True)) if abs(piece[1][1] - piece[0][1]) > _STEADY_MPS
        ]
        for k, ((begin_s, _), (end_s, speed)) in enumerate(changes, 1):
            action = xosc.AbsoluteSpeedAction(number(speed), _evenly(xosc.DynamicsDimension.time, end_s - begin_s))
            begin = from_time(f"{name}_at_{k}", begin_s)
            yield Happening(f"{name}_speed_{k}", f"{name}_to_{k}", begin, action)

    def _stays(self) -> Happening:
        name = self.move.actor
        action = xosc.AbsoluteSpeedAction(number(self.first_mps), _evenly(xosc.DynamicsDimension.time, 0.1))
        return Happening(f"{name}_stays", f"{name}_keep", at_once(f"{name}_start"), action)

    def _brake(self) -> Iterator[Happening]:
        if not self.partner:
            return
        name, touched = self.move.actor, xosc.CollisionCondition(self.partner)
        begin = xosc.EntityTrigger(f"{name}_touched", 0.0, xosc.ConditionEdge.none, touched, name)
        stop = xosc.AbsoluteSpeedAction(0.0, _evenly(xosc.DynamicsDimension.rate, BRAKE_MPS2))
        yield Happening(f"{name}_stops", f"{name}_brake", begin, stop)


def event_actors(moves: Sequence[Trajectory], ahead_m: Sequence[float], handover: Handover) -> list[EventActor]:
    """The motions of origins as events, in their order."""
    roads = XodrRoads(handover.xodr) if handover.xodr else None
    contact = handover.contact
    pair = {contact.actor: contact.other, contact.other: contact.actor} if contact else {}
    made = []
    for move, ahead in zip(moves, ahead_m, strict=True):
        partner = pair.get(move.actor, "")
        told = _until(move, contact.t_s) if contact and partner else move
        place, turn = _start(told, roads)
        keeps = place is not None and roads is not None and _keeps(told, roads, place, turn)
        made.append(EventActor(told, ahead, partner, place, turn, keeps))
    return made


def _evenly(dimension: xosc.DynamicsDimension, value: float) -> xosc.TransitionDynamics:
    return xosc.TransitionDynamics(xosc.DynamicsShapes.linear, dimension, number(value))


def _until(move: Trajectory, end_s: float) -> Trajectory:
    """The rows up to a time, two at least."""
    n = max(2, int(np.searchsorted(move.t_s, end_s + 1e-6)))
    names = ("t_s", "x_m", "y_m", "heading_rad", "speed_mps")
    return move.model_copy(update={name: getattr(move, name)[:n] for name in names})


def _places(line: Trajectory, ahead_m: float) -> list[int]:
    """Rows to write of an untimed path: of a timed one those that move on and do not lie between others."""
    poses = np.column_stack((line.x_m, line.y_m, np.unwrap(line.heading_rad)))
    rows = vertex_rows(line, ahead_m)
    moved = np.concatenate(([True], np.hypot(*np.diff(poses[rows, :2], axis=0).T) > 1e-4))
    return _bends(poses, np.array(rows)[moved])


def _bends(poses: Floats, rows: NDArray[np.intp]) -> list[int]:
    """The rows (of poses (n, 3), none in place) between which the way runs straight and turns evenly."""
    kept, at = [int(rows[0])], 0
    while at < len(rows) - 1:
        after = at + 1
        while after + 1 < len(rows) and _even(poses[rows[at : after + 2]]):
            after += 1
        kept, at = [*kept, int(rows[after])], after
    return kept


def _even(poses: Floats) -> bool:
    """Whether what lies between two poses can be left out of a path."""
    along = arc_lengths(poses[:, :2])
    share = (along / along[-1])[:, None]
    away = np.abs(poses[0] + share * (poses[-1] - poses[0]) - poses)
    return bool(np.hypot(away[:, 0], away[:, 1]).max() < LEFT_OUT_M and away[:, 2].max() < LEFT_OUT_RAD)


def _start(move: Trajectory, roads: XodrRoads | None) -> tuple[LanePlace | None, float]:
    """The first pose in lane coordinates, if it lies in a lane, and its turn against the lane."""
    pose = Pose(float(move.x_m[0]), float(move.y_m[0]), float(move.heading_rad[0]))
    place = roads.nearest(pose) if roads else None
    if roads is None or place is None or not roads.covers(pose):
        return None, 0.0
    there = roads.lane_pose(*place)
    if math.dist(there[:2], pose[:2]) > SAME_M:
        return None, 0.0
    return place, float(wrap_angle(pose.heading_rad - there.heading_rad))


def _keeps(move: Trajectory, roads: XodrRoads, place: LanePlace, turn_rad: float) -> bool:
    """Whether a motion goes along a straight lane of one road at one offset."""
    if abs(turn_rad) > KEEPS_RAD:
        return False
    line, headings = roads.road(place.road), np.unwrap(move.heading_rad)
    reach = np.column_stack((move.x_m, move.y_m)) - (move.x_m[0], move.y_m[0])
    ahead = roads.lane_pose(*place)
    c, s = math.cos(ahead.heading_rad), math.sin(ahead.heading_rad)
    gone, aside = reach @ (c, s), reach @ (-s, c)
    end_s = place.s_m + (gone.max() + _to_stop_m(move)) * line.sense(place.lane)
    straight = np.abs(aside).max() < KEEPS_M and np.abs(headings - headings[0]).max() < KEEPS_RAD
    return bool(straight and gone.min() > -KEEPS_M and _within(line.length_m, end_s) and _straight(roads, place, end_s))


def _to_stop_m(move: Trajectory) -> float:
    """Way in which it comes to rest from its last speed, and some more."""
    return float(move.speed_mps[-1] ** 2 / (2 * BRAKE_MPS2) + 5.0)


def _within(length_m: float, s_m: float) -> bool:
    return 0.0 <= s_m <= length_m


def _straight(roads: XodrRoads, place: LanePlace, end_s: float) -> bool:
    """Whether a lane's line runs straight from a place to another s of its road."""
    stations = np.linspace(place.s_m, end_s, 20)
    try:
        poses = np.array([roads.lane_pose(place.road, place.lane, float(s), place.offset_m) for s in stations])
    except ValueError:  # the lane ends on the way
        return False
    return bool(np.abs(wrap_angle(poses[:, 2] - poses[0, 2])).max() < KEEPS_RAD)
