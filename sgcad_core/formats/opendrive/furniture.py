"""OpenDRIVE elements of what stands on or beside roads: stop lines, signs, signal heads. Knows lxml."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from sgcad_core.formats.opendrive.areas import STALL_WIDTH_M, Cone, GroundArea, Stall
from sgcad_core.formats.opendrive.elements import add_child, decimal_text
from sgcad_core.formats.opendrive.signals import STOP_LINE_M, Signal, StopLine
from sgcad_core.formats.xml import Element
from sgcad_core.roads.areas.closures import CONE_M

STOP_LINE = "stopLine"
CONE_HEIGHT_M = 0.7
"""28 in, the least on faster roads (MUTCD 6F.64)."""


def add_objects(
    road: Element,
    stop_lines: Sequence[StopLine],
    areas: Sequence[GroundArea],
    stalls: Sequence[Stall],
    cones: Sequence[Cone] = (),
) -> None:
    """Stop lines, areas, parking spaces and cones; no <objects> where there are none."""
    if not (stop_lines or areas or stalls or cones):
        return
    objects = add_child(road, "objects")
    for line in stop_lines:
        made = add_child(
            objects, "object", id=line.id, type="roadMark", subtype=STOP_LINE, name="stop line", dynamic="no"
        )
        made.set("orientation", _orientation(line.side))
        _place(made, line.s_m, line.t_m, 0.0)
        made.set("hdg", decimal_text(0.0 if line.side == "right" else math.pi))
        for name, value in (("length", STOP_LINE_M), ("width", line.width_m), ("height", 0.0)):
            made.set(name, decimal_text(value))
        _validity(made, line.lanes)

    for area in areas:
        _add_area(objects, area)
    for stall in stalls:
        made = add_child(
            objects, "object", id=stall.id, type="parkingSpace", name="stall", dynamic="no", orientation="none"
        )
        _place(made, stall.s_m, stall.t_m, 0.0)
        sizes = ("hdg", stall.hdg_rad), ("length", stall.length_m), ("width", STALL_WIDTH_M), ("height", 0.0)
        for name, value in sizes:
            made.set(name, decimal_text(value))
        add_child(made, "parkingSpace", access="all")
    for cone in cones:
        made = add_child(objects, "object", id=cone.id, type="obstacle", subtype="cone", name="cone", dynamic="no")
        made.set("orientation", "none")
        _place(made, cone.s_m, cone.t_m, 0.0)
        for name, value in (("hdg", 0.0), ("radius", CONE_M / 2), ("height", CONE_HEIGHT_M)):
            made.set(name, decimal_text(value))


def _add_area(objects: Element, area: GroundArea) -> None:
    """An area where the street ends, its corners relative to there.

    A crosswalk lies beyond the street's end, in the junction.
    """
    kind, subtype, name = area.called
    made = add_child(objects, "object", id=area.id, type=kind, subtype=subtype, name=name, dynamic="no")
    made.set("orientation", "none")
    _place(made, area.s_m, 0.0, 0.0)
    (low_u, low_v), (high_u, high_v) = area.corners.min(axis=0), area.corners.max(axis=0)
    for key, value in (("hdg", 0.0), ("length", high_u - low_u), ("width", high_v - low_v), ("height", 0.0)):
        made.set(key, decimal_text(value))
    outline = add_child(add_child(made, "outlines"), "outline", id="0", closed="true", outer="true")
    for i, (u, v) in enumerate(area.corners):
        add_child(outline, "cornerLocal", id=str(i), u=decimal_text(u), v=decimal_text(v), z="0", height="0")


def add_signals(road: Element, signals: Sequence[Signal]) -> None:
    """Signs and signal heads; no <signals> where there are none."""
    if not signals:
        return
    parent = add_child(road, "signals")
    for signal in signals:
        made = add_child(parent, "signal", id=signal.id, name=signal.name, dynamic="yes" if signal.dynamic else "no")
        made.set("orientation", _orientation(signal.side))
        _place(made, signal.s_m, signal.t_m, signal.z_m)
        for name, text in (("country", signal.country), ("type", signal.type), ("subtype", "-1")):
            made.set(name, text)
        made.set("width", f"{signal.size_m[0]:g}")
        made.set("height", f"{signal.size_m[1]:g}")
        if signal.limit_mph is not None:
            made.set("value", f"{signal.limit_mph:g}")
            made.set("unit", "mph")
        _validity(made, signal.lanes)
        if signal.main:
            add_child(made, "reference", elementType="signal", elementId=signal.main, type="supplements")
        if signal.stop_line:
            add_child(made, "reference", elementType="object", elementId=signal.stop_line, type=STOP_LINE)


def _orientation(side: str) -> str:
    return "+" if side == "right" else "-"


def _place(element: Element, s_m: float, t_m: float, z_m: float) -> None:
    for name, value in (("s", s_m), ("t", t_m), ("zOffset", z_m)):
        element.set(name, decimal_text(value))


def _validity(element: Element, lanes: Iterable[int]) -> None:
    """Neighboring lane ids in one element."""
    runs: list[list[int]] = []
    for lane in sorted(lanes):
        if runs and lane == runs[-1][-1] + 1:
            runs[-1].append(lane)
        else:
            runs.append([lane])
    for run in runs:
        add_child(element, "validity", fromLane=str(run[0]), toLane=str(run[-1]))
