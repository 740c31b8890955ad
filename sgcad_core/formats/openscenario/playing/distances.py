"""Distances between played entities and to places: in an entity's axes, along roads, or as the crow flies.

Metres; longitudinal and lateral ones are signed: ahead and to the left are positive.
"""

from __future__ import annotations

import math

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.timed_motion import BoxShape
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.geometry.distances import box_distance
from sgcad_core.geometry.plane import Box

STRAIGHT = ("cartesianDistance", "euclidianDistance", "euclideanDistance")
KINDS = ("longitudinal", "lateral", *STRAIGHT)
SYSTEMS = ("entity", "lane", "road", "trajectory")
_POINT = BoxShape(0.0, 0.0)


def system_of(node: XmlNode) -> str:
    """The coordinate system of a condition; up to version 1.0 `alongRoute` says it."""
    default = "road" if node.has("alongRoute") and node.flag("alongRoute") else "entity"
    return node.choice("coordinateSystem", SYSTEMS, default)


def box_of(body: Body) -> Box:
    """A body's box where it is."""
    return Box(*body.center(), body.box.length_m, body.box.width_m)


def ahead_of(scene: Scene, body: Body, other: Body, system: str, freespace: bool, node: XmlNode) -> float:
    """How far another entity is ahead of a body; infinite where no road leads there."""
    return apart(scene, body, other, ("longitudinal", system, freespace), node)


def apart(scene: Scene, body: Body, other: Body | Pose, how: tuple[str, str, bool], node: XmlNode) -> float:
    """Distance by kind, coordinate system and whether from box to box; infinite where no road leads there."""
    kind, system, freespace = how
    scene.pose(body.name, node)
    if isinstance(other, Body):
        scene.pose(other.name, node)
    if kind in STRAIGHT:
        return _crow(body, other, freespace)
    if system == "entity" or (system == "trajectory" and not (body.course and body.course.fixed)):
        return _in_axes(body, other, kind, freespace)
    return _along_road(scene, body, other, kind, freespace, node)


def _crow(body: Body, other: Body | Pose, freespace: bool) -> float:
    if freespace:
        return box_distance(box_of(body), box_of(other) if isinstance(other, Body) else Box(*other, 0.0, 0.0))
    assert body.pose is not None  # noqa: S101 - the caller checks it
    there = other.pose if isinstance(other, Body) else other
    assert there is not None  # noqa: S101 - as above
    return math.dist(body.pose[:2], there[:2])


def _in_axes(body: Body, other: Body | Pose, kind: str, freespace: bool) -> float:
    """In the body's own axes: between origins, or between boxes (0 where they overlap along the axis)."""
    a = body.center() if freespace else body.pose
    b = (other.center() if freespace else other.pose) if isinstance(other, Body) else other
    assert a is not None  # noqa: S101 - the caller checks it
    assert b is not None  # noqa: S101 - as above
    axis = a.heading_rad + (math.pi / 2 if kind == "lateral" else 0.0)
    gap = (b.x_m - a.x_m) * math.cos(axis) + (b.y_m - a.y_m) * math.sin(axis)
    if not freespace:
        return gap
    box = other.box if isinstance(other, Body) else _POINT
    return math.copysign(max(0.0, abs(gap) - _reach(body.box, a, axis) - _reach(box, b, axis)), gap)


def _reach(box: BoxShape, pose: Pose, axis_rad: float) -> float:
    """How far a box reaches from its center along an axis."""
    turn = pose.heading_rad - axis_rad
    return box.length_m / 2 * abs(math.cos(turn)) + box.width_m / 2 * abs(math.sin(turn))


def _along_road(scene: Scene, body: Body, other: Body | Pose, kind: str, freespace: bool, node: XmlNode) -> float:
    """Along the roads between the lanes that both are in."""
    roads = scene.road_map(node)
    first = scene.lane_place(body)
    second = scene.lane_place(other) if isinstance(other, Body) else roads.nearest(other)
    if first is None or second is None:
        return math.inf
    found = roads.apart(first, scene.sense(body, first), second)
    if found is None:
        return math.inf
    gap = found.left_m if kind == "lateral" else found.ahead_m
    if not freespace:
        return gap
    box = other.box if isinstance(other, Body) else _POINT
    if kind == "lateral":
        return math.copysign(max(0.0, abs(gap) - (body.box.width_m + box.width_m) / 2), gap)
    turned = (
        isinstance(other, Body) and scene.sense(other, second) != scene.sense(body, first) and first.road == second.road
    )
    return _bumpers(gap, body.box, box, -1 if turned else 1)


def _bumpers(gap: float, first: BoxShape, second: BoxShape, facing: int) -> float:
    """From bumper to bumper, given the gap between origins; `facing` -1: the second comes the other way."""
    if gap >= 0:
        inside = first.length_m / 2 + first.center_x_m + second.length_m / 2 - facing * second.center_x_m
    else:
        inside = first.length_m / 2 - first.center_x_m + second.length_m / 2 + facing * second.center_x_m
    return math.copysign(max(0.0, abs(gap) - inside), gap)
