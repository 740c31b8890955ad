"""Shapes of trajectories as dense polylines: Polyline, Clothoid, ClothoidSpline, Nurbs.

A curve's vertices lie at most 0.25 m apart. Formulas: ASAM OpenSCENARIO 1.3, section 7.4; de Boor's algorithm.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.playing.positions import has_heading, position, rolls_of
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.geometry.plane import Floats, arc_lengths

STEP_M = 0.25
MAX_VERTICES = 50_000
MAX_ORDER = 10


class Line(NamedTuple):
    """A trajectory's vertices now: points (n, 2), headings where stated, times where stated, roll where stated."""

    points: Floats
    headings: Floats | None
    times_s: Floats | None
    rolls: Floats | None = None


Drawn = Callable[[Scene, str], Line]
"""The line of a shape for an actor, once it starts."""
SHAPES: Family[Drawn] = Family("trajectory shape")


@SHAPES.plays("Polyline")
def _polyline(shape: XmlNode) -> Drawn:
    vertices = shape.children("Vertex")
    if not 2 <= len(vertices) <= MAX_VERTICES:
        raise shape.fault("a polyline needs 2 to 50000 vertices", str(len(vertices)))
    holders = [v.need("Position") for v in vertices]
    places = [position(p) for p in holders]
    times = [v.number("time") for v in vertices if v.has("time")]
    timed = np.array(times) if len(times) == len(places) else None
    stated = all(map(has_heading, holders))
    rolls = rolls_of(holders)

    def drawn(scene: Scene, actor: str) -> Line:
        rows = np.array([where(scene).pose for where in places])
        return Line(rows[:, :2], rows[:, 2] if stated else None, timed, rolls)

    return drawn


@SHAPES.plays("Clothoid")
def _clothoid(shape: XmlNode) -> Drawn:
    """Curvature rises evenly with the length; 1.0 says curvatureDot, later versions curvaturePrime."""
    rate = shape.number("curvaturePrime" if shape.has("curvaturePrime") else "curvatureDot")
    first, length = shape.number("curvature"), shape.positive("length")
    start = position(shape.need("Position"))
    times = (shape.number("startTime"), shape.number("stopTime")) if shape.has("startTime") else None

    def drawn(scene: Scene, actor: str) -> Line:
        rows = _curve(start(scene).pose, first, first + rate * length, length)
        return Line(rows[:, :2], None, None if times is None else np.linspace(*times, len(rows)))

    _bounded(shape, length)
    return drawn


@SHAPES.plays("ClothoidSpline")
def _clothoid_spline(shape: XmlNode) -> Drawn:
    """Segments in a row; one without <PositionStart> begins where the one before ends, the first at the actor."""
    segments = shape.children("ClothoidSplineSegment")
    if not segments:
        raise shape.fault("needs a <ClothoidSplineSegment>")
    _bounded(shape, sum(s.positive("length") for s in segments))
    read = [_segment(s) for s in segments]
    end_s = shape.number("timeEnd") if shape.has("timeEnd") else None

    def drawn(scene: Scene, actor: str) -> Line:
        here: Pose | None = None
        parts: list[Floats] = []
        for start, turn, curve in read:
            begin = start(scene) if start else here or scene.pose(actor, shape)
            parts.append(_curve(Pose(begin.x_m, begin.y_m, begin.heading_rad + turn), *curve))
            here = Pose(*parts[-1][-1])
        rows = np.vstack([part if i == 0 else part[1:] for i, part in enumerate(parts)])
        times = None if end_s is None else arc_lengths(rows[:, :2]) / arc_lengths(rows[:, :2])[-1] * end_s
        return Line(rows[:, :2], None, times)

    return drawn


def _segment(node: XmlNode) -> tuple[Callable[[Scene], Pose] | None, float, tuple[float, float, float]]:
    where = node.find("PositionStart")
    start = position(where) if where else None
    curve = node.number("curvatureStart"), node.number("curvatureEnd"), node.number("length")
    return (None if start is None else lambda scene: start(scene).pose), node.number("hOffset", 0.0), curve


def _curve(start: Pose, first: float, last: float, length_m: float) -> Floats:
    """(n, 3) x, y, heading of a clothoid, by the midpoint rule over steps of 0.25 m."""
    s = np.linspace(0.0, length_m, max(2, math.ceil(length_m / STEP_M) + 1))
    heading = start.heading_rad + s * (first + (last - first) * s / (2 * length_m))
    step, middle = np.diff(s), (heading[1:] + heading[:-1]) / 2
    chord = step * np.sinc(np.diff(heading) / (2 * math.pi))
    x = start.x_m + np.concatenate(([0.0], np.cumsum(chord * np.cos(middle))))
    y = start.y_m + np.concatenate(([0.0], np.cumsum(chord * np.sin(middle))))
    return np.column_stack((x, y, heading))


@SHAPES.plays("Nurbs", remark="times of control points are a coordinate of the curve")
def _nurbs(shape: XmlNode) -> Drawn:
    controls, order = shape.children("ControlPoint"), shape.whole("order")
    knots = np.array([k.number("value") for k in shape.children("Knot")])
    if not (2 <= order <= MAX_ORDER and order <= len(controls) <= MAX_VERTICES):
        raise shape.fault(f"needs an order from 2 to {MAX_ORDER} and at least that many control points", str(order))
    if len(knots) != len(controls) + order or (np.diff(knots) < 0).any() or knots[order - 1] >= knots[len(controls)]:
        raise shape.fault("needs as many rising knots as control points and order together", str(len(knots)))
    places = [position(c.need("Position")) for c in controls]
    weights = np.array([c.number("weight", 1.0) for c in controls])
    times = [c.number("time") for c in controls if c.has("time")]
    if (weights <= 0).any():
        raise shape.fault("weights of control points must be above 0", f"{weights.min():g}")

    def drawn(scene: Scene, actor: str) -> Line:
        rows = np.array([where(scene).pose[:2] for where in places])
        timed = len(times) == len(places)
        columns = np.column_stack((rows, times)) if timed else rows
        reach = float(arc_lengths(rows)[-1])
        _bounded(shape, reach)
        u = np.linspace(knots[order - 1], knots[len(controls)], max(2, math.ceil(reach / STEP_M) + 1, 20 * len(places)))
        weighted = np.column_stack((columns * weights[:, None], weights))
        curve = np.array([_de_boor(x, order, knots, weighted) for x in u])
        curve = curve[:, :-1] / curve[:, -1:]
        return Line(curve[:, :2], None, np.maximum.accumulate(curve[:, 2]) if timed else None)

    return drawn


def _de_boor(u: float, order: int, knots: Floats, controls: Floats) -> Floats:
    """A point of a B-spline."""
    k = int(np.clip(np.searchsorted(knots, u, side="right") - 1, order - 1, len(controls) - 1))
    d = controls[k - order + 1 : k + 1].copy()
    for r in range(1, order):
        for j in range(order - 1, r - 1, -1):
            low, high = knots[j + k - order + 1], knots[j + 1 + k - r]
            share = (u - low) / (high - low) if high > low else 0.0
            d[j] = (1 - share) * d[j - 1] + share * d[j]
    last: Floats = d[order - 1]
    return last


def _bounded(shape: XmlNode, length_m: float) -> None:
    if length_m / STEP_M > MAX_VERTICES:
        raise shape.fault(f"longer than {MAX_VERTICES * STEP_M:g} m", f"{length_m:g}", "shorten the trajectory")
