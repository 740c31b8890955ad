"""Routes: waypoints to chains of roads, and positions along them."""

from __future__ import annotations

from collections.abc import Callable

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.positions import (
    POSITIONS,
    LocatedPose,
    PositionFunction,
    orientation,
    position,
)
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.openscenario.roads.way import LanePlace, Route

MAX_WAYPOINTS = 1000
RouteOf = Callable[[Scene], Route]


def route(holder: XmlNode) -> RouteOf:
    """Compile the <Route> (inline or from a catalog) of an element. Its waypoints must lie on roads."""
    node = holder.either("Route")
    waypoints = node.children("Waypoint")
    if not 1 <= len(waypoints) <= MAX_WAYPOINTS:
        raise node.fault(f"a route needs 1 to {MAX_WAYPOINTS} waypoints", str(len(waypoints)))
    places = [(position(w.need("Position")), w) for w in waypoints]

    def made(scene: Scene) -> Route:
        roads = scene.road_map(node)
        try:
            return roads.route([_on_road(scene, roads, where, blame) for where, blame in places])
        except ValueError as fault:
            raise node.fault(str(fault), remedy="let each waypoint be reached from the one before") from fault

    return made


def _on_road(scene: Scene, roads: XodrRoads, where: PositionFunction, blame: XmlNode) -> LanePlace:
    spot = where(scene)
    if (place := spot.place or roads.nearest(spot.pose)) is None:
        raise blame.fault("the waypoint lies on no road", f"{spot.pose.x_m:g}, {spot.pose.y_m:g}")
    return place


@POSITIONS.plays("RoutePosition", remark="pathS counts from the first waypoint")
def _route_position(node: XmlNode) -> PositionFunction:
    made, turn = route(node.need("RouteRef")), orientation(node)
    inner = (node.find("InRoutePosition") or node.need("Position")).only()
    if inner.tag in ("FromCurrentEntity", "PositionOfCurrentEntity"):
        return _of_entity(inner, made, turn)
    return _in_route(inner, made, turn)


def _of_entity(inner: XmlNode, made: RouteOf, turn: Callable[[Pose], Pose]) -> PositionFunction:
    name = inner.text("entityRef")

    def where(scene: Scene) -> LocatedPose:
        made(scene)
        return LocatedPose(turn(scene.pose(name, inner)), scene.lane_place(scene.body(name, inner)))

    return where


def _in_route(inner: XmlNode, made: RouteOf, turn: Callable[[Pose], Pose]) -> PositionFunction:
    """Road and lane coordinates as they are on the road reached, whichever way the route leads over it."""
    path_m, with_lane = inner.number("pathS"), "Lane" in inner.tag
    lane, across = (
        (inner.whole("laneId"), inner.number("laneOffset", 0.0)) if with_lane else (0, inner.number("t", 0.0))
    )

    def where(scene: Scene) -> LocatedPose:
        roads = scene.road_map(inner)
        road, s_m, _ = made(scene).at(path_m)
        if not with_lane:
            x, y, h = roads.road_pose(road, s_m, across)
            return LocatedPose(turn(Pose(x, y, h)), roads.place_at(road, s_m, across))
        place = LanePlace(road, lane, s_m, across)
        return LocatedPose(turn(roads.lane_pose(*place)), place)

    return where
