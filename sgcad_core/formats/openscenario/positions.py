"""OpenSCENARIO positions to poses: world, road, lane, and relative to an object.

Knows no geometry of its own: the scene's road network answers.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from sgcad_core.formats.openscenario.motion import Pose
from sgcad_core.formats.openscenario.read import Node
from sgcad_core.formats.openscenario.scene import Scene

Where = Callable[[Scene], Pose]


def position(node: Node) -> Where:
    """Compile a <Position>. Raises InvalidOutput on what is not supported."""
    child = node.only()
    if child.tag not in _KINDS:
        raise child.unsupported(f"the player does not support <{child.tag}>")
    return _KINDS[child.tag](child)


def has_heading(node: Node) -> bool:
    """Whether a <Position> states the heading (else a trajectory's tangent counts)."""
    child = node.only()
    return child.element.get("h") is not None or child.find("Orientation") is not None


def _world(node: Node) -> Where:
    pose = Pose(node.number("x"), node.number("y"), node.number("h", 0.0))
    return lambda scene: pose


def _lane(node: Node) -> Where:
    road, lane = node.text("roadId"), _lane_id(node)
    s_m, offset, turn = node.number("s"), node.number("offset", 0.0), _orientation(node)

    def where(scene: Scene) -> Pose:
        try:
            return turn(scene.road_map(node).lane_pose(road, lane, s_m, offset))
        except ValueError as fault:
            raise node.fault(str(fault)) from fault

    return where


def _road(node: Node) -> Where:
    road, s_m, t_m, turn = node.text("roadId"), node.number("s"), node.number("t"), _orientation(node)

    def where(scene: Scene) -> Pose:
        try:
            return turn(scene.road_map(node).road_pose(road, s_m, t_m))
        except ValueError as fault:
            raise node.fault(str(fault)) from fault

    return where


def _relative_world(node: Node) -> Where:
    name, dx, dy, turn = node.text("entityRef"), node.number("dx"), node.number("dy"), _orientation(node)

    def where(scene: Scene) -> Pose:
        x, y, heading = scene.pose(name, node)
        return turn(Pose(x + dx, y + dy, heading))

    return where


def _relative_object(node: Node) -> Where:
    name, dx, dy, turn = node.text("entityRef"), node.number("dx"), node.number("dy"), _orientation(node)

    def where(scene: Scene) -> Pose:
        x, y, h = scene.pose(name, node)
        c, s = math.cos(h), math.sin(h)
        return turn(Pose(x + dx * c - dy * s, y + dx * s + dy * c, h))

    return where


def _relative_lane(node: Node) -> Where:
    name, by, turn = node.text("entityRef"), int(node.number("dLane")), _orientation(node)
    ds, offset = node.number("ds", 0.0), node.number("offset", 0.0)

    def where(scene: Scene) -> Pose:
        roads = scene.road_map(node)
        place = roads.nearest(scene.pose(name, node))
        if place is None:
            raise node.fault("the reference entity is in no lane", name)
        try:
            return turn(roads.lane_pose(place.road, shifted(place.lane, by), place.s_m + ds, offset))
        except ValueError as fault:
            raise node.fault(str(fault)) from fault

    return where


def shifted(lane: int, by: int) -> int:
    """The lane id `by` lanes to the left; there is no lane 0."""
    moved = lane + by
    return moved + (1 if by > 0 else -1) if lane * moved <= 0 else moved


def _lane_id(node: Node) -> int:
    text = node.text("laneId")
    try:
        return int(text)
    except ValueError as fault:
        raise node.fault("attribute 'laneId' is no whole number", text) from fault


def _orientation(node: Node) -> Callable[[Pose], Pose]:
    """Turn a pose as <Orientation> says: relative to it by default, else the absolute heading."""
    orientation = node.find("Orientation")
    if orientation is None:
        return lambda pose: pose
    h = orientation.number("h", 0.0)
    if orientation.choice("type", ("relative", "absolute"), "absolute") == "absolute":
        return lambda pose: Pose(pose.x_m, pose.y_m, h)
    return lambda pose: Pose(pose.x_m, pose.y_m, pose.heading_rad + h)


_KINDS: dict[str, Callable[[Node], Where]] = {
    "WorldPosition": _world, "LanePosition": _lane, "RoadPosition": _road, "RelativeWorldPosition": _relative_world,
    "RelativeObjectPosition": _relative_object, "RelativeLanePosition": _relative_lane,
}  # fmt: skip
