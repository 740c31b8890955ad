"""FollowTrajectoryAction: polylines, timed or untimed. Clothoids, NURBS and catalogs are not supported."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sgcad_core.formats.openscenario.motion import Course, Timed, tangents
from sgcad_core.formats.openscenario.positions import Where, has_heading, position
from sgcad_core.formats.openscenario.read import Node
from sgcad_core.formats.openscenario.scene import Scene
from sgcad_core.geometry.plane import Floats

MAX_VERTICES = 50_000


@dataclass(frozen=True)
class _Polyline:
    node: Node
    times_s: list[float]
    places: list[Where]
    with_heading: bool

    def rows(self, scene: Scene) -> tuple[Floats, Floats]:
        """Points (n, 2) and headings (n,) now."""
        rows = np.array([where(scene) for where in self.places])
        return rows[:, :2], rows[:, 2] if self.with_heading else tangents(rows[:, :2])


def trajectory(node: Node) -> Callable[[Scene], Timed | Course]:
    """Compile a <FollowTrajectoryAction> into what a body follows once it starts."""
    holder = node.find("TrajectoryRef") or node
    line = _polyline(holder.need("Trajectory"))
    timing = node.need("TimeReference").only()
    if timing.tag == "None":
        start = node.number("initialDistanceOffset", 0.0)
        return lambda scene: _course(line, scene, start)
    if node.number("initialDistanceOffset", 0.0):
        raise node.unsupported("the player does not support initialDistanceOffset with timing")
    return _timed(line, timing)


def _timed(line: _Polyline, timing: Node) -> Callable[[Scene], Timed]:
    """Vertex times are scaled, moved by the offset and, in the relative domain, count from the action's start."""
    relative = timing.choice("domainAbsoluteRelative", ("absolute", "relative")) == "relative"
    scale, offset = timing.positive("scale"), timing.number("offset")
    times = np.array(line.times_s)
    if len(times) < len(line.places):
        raise line.node.fault("a vertex has no time", remedy="give every vertex one, or use <None/> as time reference")
    if (np.diff(times) < 0).any():
        raise line.node.fault("vertex times fall", remedy="order the vertices by time")

    def make(scene: Scene) -> Timed:
        points, headings = line.rows(scene)
        begin = scene.t_s if relative else 0.0
        return Timed(times * scale + offset + begin, points, headings, (scene.step, scene.dt_s))

    return make


def _course(line: _Polyline, scene: Scene, start_m: float) -> Course:
    points = line.rows(scene)[0]
    apart = np.concatenate(([True], np.hypot(*np.diff(points, axis=0).T) > 1e-6))
    if apart.sum() < 2:
        raise line.node.fault("all vertices lie in one place", remedy="an untimed trajectory needs two places")
    return Course(points[apart], start_m)


def _polyline(node: Node) -> _Polyline:
    node = node.scoped()
    if node.flag("closed", False):
        raise node.unsupported("the player does not support closed trajectories")
    shape = node.need("Shape").only()
    if shape.tag != "Polyline":
        raise shape.unsupported()
    vertices = shape.children("Vertex")
    if not 2 <= len(vertices) <= MAX_VERTICES:
        raise shape.fault("a polyline needs 2 to 50000 vertices", str(len(vertices)))
    places = [v.need("Position") for v in vertices]
    times = [v.number("time") for v in vertices if v.element.get("time") is not None]
    return _Polyline(node, times, [position(p) for p in places], all(map(has_heading, places)))
