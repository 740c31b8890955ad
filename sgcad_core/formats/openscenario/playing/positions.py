"""OpenSCENARIO positions to poses: world, road, lane, route, trajectory, and relative to an entity.

Knows no geometry of its own: the scene's road network answers. Without <Orientation> a road's or lane's direction
counts; one without `type` is absolute, as the standard has it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.openscenario.roads.way import LanePlace
from sgcad_core.geometry.plane import Floats


class LocatedPose(NamedTuple):
    """A pose, and the lane place that it was told by, if any."""

    pose: Pose
    place: LanePlace | None = None


PositionFunction = Callable[[Scene], LocatedPose]
POSITIONS: Family[PositionFunction] = Family("position")
POSITIONS.refuses("GeoPosition", remark="latitude and longitude need the map's projection", remedy="use WorldPosition")


def position(node: XmlNode) -> PositionFunction:
    """Compile a <Position> (or an element that holds one position). Raises Unsupported for one that it lacks."""
    where, compiled = node.only(), POSITIONS.compile(node.only())

    def located(scene: Scene) -> LocatedPose:
        where.spend("places found")
        try:
            return compiled(scene)
        except ValueError as fault:
            raise where.fault(str(fault)) from fault

    return located


def on_road(node: XmlNode, scene: Scene, road: str, s_m: float) -> float:
    """s on the road: positions of third-party files beyond an end are moved to the end, as other players do."""
    beyond = scene.road_map(node).beyond(road, s_m)
    if beyond and not node.book.strict:
        node.note(f"s = {s_m:g} m lies beyond road {road!r}: its end is taken")
        return s_m - beyond
    return s_m


def has_heading(node: XmlNode) -> bool:
    """Whether a <Position> states the heading (else a trajectory's tangent counts)."""
    child = node.only()
    return child.has("h") or child.find("Orientation") is not None


def rolls_of(nodes: Sequence[XmlNode]) -> Floats | None:
    """(n,) stated roll of world <Position>s, radians; None where all are 0."""
    places = [node.only() for node in nodes]
    rolls = np.array([place.number("r", 0.0) if place.has("r") else 0.0 for place in places])
    return rolls if rolls.any() else None


# ------------------------------------------------------------------ absolute
@POSITIONS.plays("WorldPosition", "InertialPosition", remark="motion is plane; the roll of timed vertices is kept")
def _world(node: XmlNode) -> PositionFunction:
    spot = LocatedPose(Pose(node.number("x"), node.number("y"), node.number("h", 0.0)))
    return lambda scene: spot


@POSITIONS.plays("LanePosition")
def _lane(node: XmlNode) -> PositionFunction:
    road, lane = node.text("roadId"), node.whole("laneId")
    s_m, offset, turn = node.number("s"), node.number("offset", 0.0), orientation(node)

    def where(scene: Scene) -> LocatedPose:
        place = LanePlace(road, lane, on_road(node, scene, road, s_m), offset)
        return LocatedPose(turn(scene.road_map(node).lane_pose(*place)), place)

    return where


@POSITIONS.plays("RoadPosition")
def _road(node: XmlNode) -> PositionFunction:
    road, told_m, t_m, turn = node.text("roadId"), node.number("s"), node.number("t"), orientation(node)

    def where(scene: Scene) -> LocatedPose:
        roads, s_m = scene.road_map(node), on_road(node, scene, road, told_m)
        return LocatedPose(turn(roads.road_pose(road, s_m, t_m)), roads.place_at(road, s_m, t_m))

    return where


# ------------------------------------------------------------------ relative
@POSITIONS.plays("RelativeWorldPosition")
def _relative_world(node: XmlNode) -> PositionFunction:
    name, dx, dy, turn = node.text("entityRef"), node.number("dx"), node.number("dy"), orientation(node)

    def where(scene: Scene) -> LocatedPose:
        x, y, heading = scene.pose(name, node)
        return LocatedPose(turn(Pose(x + dx, y + dy, heading)))

    return where


@POSITIONS.plays("RelativeObjectPosition")
def _relative_object(node: XmlNode) -> PositionFunction:
    name, dx, dy, turn = node.text("entityRef"), node.number("dx"), node.number("dy", 0.0), orientation(node)

    def where(scene: Scene) -> LocatedPose:
        x, y, h = scene.pose(name, node)
        c, s = math.cos(h), math.sin(h)
        return LocatedPose(turn(Pose(x + dx * c - dy * s, y + dx * s + dy * c, h)))

    return where


@POSITIONS.plays("RelativeRoadPosition", remark="ds counts along the road's reference line")
def _relative_road(node: XmlNode) -> PositionFunction:
    name, turn = node.text("entityRef"), orientation(node)
    ds, dt = node.number("ds"), node.number("dt")

    def where(scene: Scene) -> LocatedPose:
        roads, place = scene.road_map(node), _lane_of(scene, name, node)
        moved, sense = _moved(roads, place, ds, 1)
        t_m = roads.t_of(place) + dt if moved.road == place.road else (roads.t_of(moved) + dt * sense)
        return LocatedPose(
            turn(roads.road_pose(moved.road, moved.s_m, t_m)), roads.place_at(moved.road, moved.s_m, t_m)
        )

    return where


@POSITIONS.plays(
    "RelativeLanePosition", remark="ds counts along the road's reference line, dsLane in driving direction"
)
def _relative_lane(node: XmlNode) -> PositionFunction:
    name, by, turn, offset = node.text("entityRef"), node.whole("dLane"), orientation(node), node.number("offset", 0.0)
    driven = node.has("dsLane")
    ds = node.number("dsLane" if driven else "ds", 0.0)

    def where(scene: Scene) -> LocatedPose:
        roads, place = scene.road_map(node), _lane_of(scene, name, node)
        sense = scene.sense(scene.body(name, node), place) if driven else 1
        moved, sense = _moved(roads, place, ds, sense)
        lane = shifted(moved.lane, by * sense)
        there = LanePlace(moved.road, lane, moved.s_m, offset * sense)
        return LocatedPose(turn(roads.lane_pose(*there)), there)

    return where


def _moved(roads: XodrRoads, place: LanePlace, ds: float, sense: int) -> tuple[LanePlace, int]:
    """A place moved along its lane, over the ends of roads; and the sense of driving there."""
    try:
        roads.road_pose(place.road, place.s_m + ds * sense, 0.0)
    except ValueError:
        way = roads.drive(place, sense if ds > 0 else -sense)
        rest = abs(ds)
        for i in range(len(way.points) - 1):
            step = math.dist(way.points[i], way.points[i + 1])
            if rest <= step:
                found, driven = way.place(i, rest / max(step, 1e-9), 0.0)
                return found, driven if ds > 0 else -driven
            rest -= step
        raise
    return place._replace(s_m=place.s_m + ds * sense, offset_m=0.0), sense


def _lane_of(scene: Scene, name: str, node: XmlNode) -> LanePlace:
    scene.pose(name, node)
    if (place := scene.lane_place(scene.body(name, node))) is None:
        raise node.fault("the reference entity is in no lane", name)
    return place


def shifted(lane: int, by: int) -> int:
    """The lane id `by` lanes to the left; there is no lane 0."""
    moved = lane + by
    return moved + (1 if by > 0 else -1) if by and lane * moved <= 0 else moved


def orientation(node: XmlNode) -> Callable[[Pose], Pose]:
    """Turn a pose as <Orientation> says: relative to it, else the absolute heading."""
    found = node.find("Orientation")
    if found is None:
        return lambda pose: pose
    h = found.number("h", 0.0)
    if found.choice("type", ("relative", "absolute"), "absolute" if found.has("h") else "relative") == "absolute":
        return lambda pose: Pose(pose.x_m, pose.y_m, h)
    return lambda pose: Pose(pose.x_m, pose.y_m, pose.heading_rad + h)
