"""Trajectories: timed or untimed, followed as they are, and positions along them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.offset_course import OffsetCourse
from sgcad_core.formats.openscenario.playing.positions import POSITIONS, LocatedPose, PositionFunction, orientation
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.timed_motion import TimedMotion, tangents
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.openscenario.roads.shapes import SHAPES, Drawn, Line
from sgcad_core.geometry.plane import Floats, arc_lengths

FollowedLine = Callable[[Scene, str], TimedMotion | OffsetCourse]
"""What a body follows once its action starts."""

CORNER_S = 1e-6
"""In which the heading turns at a vertex."""
_UNTIMED = "give every vertex one, or use <None/> as time reference"


def trajectory(node: XmlNode) -> FollowedLine:
    """Compile a <FollowTrajectoryAction>."""
    holder = node.find("TrajectoryRef") or node
    shape = holder.either("Trajectory")
    drawn, closed = _shape(shape), shape.flag("closed", False)
    reference = node.find("TimeReference")
    timing = reference.only() if reference else None
    start = node.number("initialDistanceOffset", 0.0)
    if timing is None or timing.tag == "None":
        return lambda scene, actor: _course(shape, drawn(scene, actor), start, closed)
    return _timed(shape, drawn, timing, start)


def _shape(node: XmlNode) -> Drawn:
    return SHAPES.compile(node.need("Shape").only())


def _timed(node: XmlNode, drawn: Drawn, timing: XmlNode, start_m: float) -> FollowedLine:
    """Vertex times are scaled, moved by the offset and, in the relative domain, count from the action's start.

    An entity that starts along the line is there at once: relative times count from that place.
    """
    relative = timing.choice("domainAbsoluteRelative", ("absolute", "relative")) == "relative"
    scale, offset = timing.positive("scale"), timing.number("offset")
    _check_times(node)

    def make(scene: Scene, actor: str) -> TimedMotion:
        line = drawn(scene, actor)
        node.spend("vertices of trajectories", len(line.points))
        if line.times_s is None:
            raise node.fault("a vertex has no time", remedy=_UNTIMED)
        begin = scene.t_s if relative else 0.0
        if start_m and relative:
            begin -= scale * float(np.interp(start_m, arc_lengths(line.points), line.times_s))
        times, points, headings = line.times_s * scale + offset + begin, line.points, line.headings
        if headings is None:
            times, points, headings = _cornered(times, points)
        rolls = line.rolls if len(times) == len(line.points) else None
        return TimedMotion(times, points, headings, (scene.step, scene.dt_s), rolls)

    return make


def _cornered(times_s: Floats, points: Floats) -> tuple[Floats, Floats, Floats]:
    """Vertices that state no heading: along each piece its own, so every inner vertex stands twice, a moment apart."""
    ahead = tangents(points)
    inner = np.arange(1, len(points) - 1)
    rows = np.column_stack((times_s, points, ahead))
    before = np.column_stack((times_s[inner] - CORNER_S, points[inner], ahead[inner - 1]))
    both = np.vstack((rows, before))
    both = both[np.lexsort((np.arange(len(both)) < len(rows), both[:, 0]))]
    return both[:, 0], both[:, 1:3], both[:, 3]


def _check_times(node: XmlNode) -> None:
    """Times of vertices, as far as they are known before the action starts."""
    vertices = node.need("Shape").only().children("Vertex", "ControlPoint")
    times = [v.number("time") for v in vertices if v.has("time")]
    if len(times) < len(vertices):
        raise node.fault("a vertex has no time", remedy=_UNTIMED)
    if (np.diff(times) < 0).any():
        raise node.fault("vertex times fall", remedy="order the vertices by time")


def _course(node: XmlNode, line: Line, start_m: float, closed: bool) -> OffsetCourse:
    node.spend("vertices of trajectories", len(line.points))
    points, headings = line.points, line.headings
    if closed:
        points = np.vstack((points, points[:1]))
        headings = None if headings is None else np.append(headings, headings[0])
    apart = np.concatenate(([True], np.hypot(*np.diff(points, axis=0).T) > 1e-6))
    if apart.sum() < 2:
        raise node.fault("all vertices lie in one place", remedy="an untimed trajectory needs two places")
    course = OffsetCourse(points[apart], start_m, closed=closed)
    course.headings = None if headings is None else np.unwrap(headings[apart])
    return course


@POSITIONS.plays("TrajectoryPosition")
def _trajectory_position(node: XmlNode) -> PositionFunction:
    shape = node.need("TrajectoryRef").either("Trajectory")
    drawn, s_m, t_m, turn = _shape(shape), node.number("s"), node.number("t", 0.0), orientation(node)

    def where(scene: Scene) -> LocatedPose:
        line = drawn(scene, "")
        pose = _along(line.points, s_m)
        x, y, h = pose
        return LocatedPose(turn(Pose(x - t_m * math.sin(h), y + t_m * math.cos(h), h)))

    return where


def _along(points: Floats, s_m: float) -> Pose:
    """The pose at a distance along a line. Raises ValueError beyond it."""
    along = arc_lengths(points)
    if not -1e-6 <= s_m <= along[-1] + 1e-3:
        raise ValueError(f"s = {s_m:g} m lies beyond the trajectory, which is {along[-1]:g} m long")
    i = int(np.clip(np.searchsorted(along, s_m, side="right") - 1, 0, len(points) - 2))
    (x, y), (x2, y2) = points[i], points[i + 1]
    heading = math.atan2(y2 - y, x2 - x)
    over = s_m - along[i]
    return Pose(float(x + over * math.cos(heading)), float(y + over * math.sin(heading)), heading)
