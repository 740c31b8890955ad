"""Routing actions: FollowTrajectoryAction, AssignRouteAction and AcquirePositionAction."""

from __future__ import annotations

import math

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.actions.running import PRIVATE, ActionStart, RunningAction, at_once, nested
from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.playing.offset_course import OffsetCourse
from sgcad_core.formats.openscenario.playing.positions import position
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.trajectory import trajectory
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.openscenario.roads.routes import route
from sgcad_core.formats.openscenario.roads.way import LanePlace, Route

ROUTING: Family[ActionStart] = Family("routing action")
PRIVATE.plays("RoutingAction")(lambda node: nested(ROUTING, node))
ROUTING.refuses("RandomRouteAction", remark="its random routes are the simulator's own", remedy="assign a route")
JUMP_M = 1.0
"""A trajectory that begins farther away than this is noted."""
_FOLLOW = "followingMode 'follow' is driven exactly on the path: the standard leaves the steering to the simulator"
_REMARK = (
    "followingMode 'follow' is driven exactly on the path, at even accelerations between timed vertices, with a note"
)


@ROUTING.plays("FollowTrajectoryAction", remark=_REMARK)
def _follow(node: XmlNode) -> ActionStart:
    make = trajectory(node)
    mode = node.find("TrajectoryFollowingMode", "TrajectoryFollowing")
    word = "followingMode" if mode and mode.has("followingMode") else "mode"
    follows = mode is not None and mode.choice(word, ("position", "follow")) == "follow"
    if follows and mode:
        mode.note(_FOLLOW)
    eases = follows and next(node.element.iter("Polyline"), None) is not None

    def begin(scene: Scene, actor: str) -> RunningAction:
        body = scene.body(actor, node)
        made, before = make(scene, actor), body.pose if body.present else None
        body.course = body.timed = body.place = None
        body.present, body.at_end = True, False
        if isinstance(made, OffsetCourse):
            running = _untimed(body, made)
            _note_jump(node, actor, before, body)
            return running
        body.timed = timed = made.eased(abs(body.speed_mps), scene.dt_s) if eases else made
        body.pace = body.next_mps = None
        body.pose, body.speed_mps = body.seated(timed.pose(scene.step)), timed.speed(scene.step)
        _note_jump(node, actor, before, body)
        return RunningAction(body, ("path", "speed"), lambda scene: scene.t_s >= timed.end_s - 1e-9).claim()

    return begin


def _note_jump(node: XmlNode, actor: str, before: Pose | None, body: Body) -> None:
    """Note that the trajectory does not begin where the entity is: it is put there at once."""
    if before is None or body.pose is None:
        return
    gap = math.dist(before[:2], body.pose[:2])
    if gap > JUMP_M:
        node.note("the entity jumps onto the trajectory", f"{actor}: {gap:.1f} m", "let it begin where the entity is")


def _untimed(body: Body, course: OffsetCourse) -> RunningAction:
    """At the entity's own speed; backwards it faces against the line unless headings are stated."""
    first = course.headings[0] if course.headings is not None else None
    ahead_x, ahead_y = course.points[1] - course.points[0]
    against = first is not None and math.cos(first - math.atan2(ahead_y, ahead_x)) < 0
    course.reverse = body.speed_mps < 0 and (first is None or against)
    body.course = course
    body.pose = body.seated(course.pose)
    return RunningAction(body, ("path",), lambda scene: course.rest_m <= 1e-6).claim()


@ROUTING.plays("AssignRouteAction", remark="where the lane does not lead onto the route, the straightest way is driven")
def _assign(node: XmlNode) -> ActionStart:
    made = route(node)

    def begin(scene: Scene, actor: str) -> RunningAction:
        return _sent(scene.body(actor, node), made(scene))

    return begin


@ROUTING.plays("AcquirePositionAction", remark="drives there by the shortest roads and goes on behind it")
def _acquire(node: XmlNode) -> ActionStart:
    where = position(node.need("Position"))

    def begin(scene: Scene, actor: str) -> RunningAction:
        body, roads = scene.body(actor, node), scene.road_map(node)
        here, spot = scene.lane_place(body), where(scene)
        there: LanePlace | None = spot.place or roads.nearest(spot.pose)
        if here is None or there is None:
            raise node.fault("needs an entity and a place that are on the roads", actor)
        try:
            return _sent(body, roads.route([here, there], scene.sense(body, here)))
        except ValueError as fault:
            raise node.fault(str(fault)) from fault

    return begin


def _sent(body: Body, way: Route) -> RunningAction:
    body.route = way
    if body.course is not None and body.course.way is not None:
        body.course = None
    return at_once(body)
