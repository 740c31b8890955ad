"""Checks of an OpenDRIVE file.

Schema 1.7 (from the installed scenariogeneration package), references, lane links, lengths and gaps: what
ASAM's rules demand of a network, so that a bad file is known before another tool meets it.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import pairwise

from sgcad_core.case.records import Finding
from sgcad_core.errors import InvalidOutput
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.opendrive.checks.check_control import control_findings
from sgcad_core.formats.opendrive.geometry import Pose, arc_lengths_of, end_pose, geometries, number, start_pose
from sgcad_core.formats.opendrive.lanes import border_t, contact_pose, lane_offset, lane_widths
from sgcad_core.formats.xml import Element, asam_schema, parse_xml, schema_errors

_finding = FindingFactory("opendrive")

GAP_M = 0.01
LENGTH_M = 0.001
"""ASAM's limits (lane_smoothness.contact_point_no_horizontal_gaps, parampoly3.length_match)."""
_NETCONVERT = "draw the junction less sharp or the roads longer"


# ------------------------------------------------------------------ findings
def xodr_findings(xodr: str) -> list[Finding]:
    """Schema faults first; where it holds, references, links, lengths and gaps, then signals. Empty is a pass."""
    try:
        root = parse_xml(xodr, "opendrive")
    except InvalidOutput as fault:
        return list(fault.findings)
    broken = [
        _finding(m, f"line {n}", "", "follow OpenDRIVE 1.7")
        for n, m in schema_errors(asam_schema("opendrive_17_core"), root)
    ]
    found = broken or [*_doubles(root), *_references(root), *_lengths(root), *_gaps(root)]
    return found or control_findings(root)


def _doubles(root: Element) -> Iterator[Finding]:
    for kind in ("road", "junction"):
        for name, count in Counter(e.get("id", "") for e in root.iterfind(kind)).items():
            if count > 1:
                yield _finding(f"{count} {kind}s have one id", kind, name, "give each an id of its own")


# ------------------------------------------------------------------ references
def _references(root: Element) -> Iterator[Finding]:
    roads = {road.get("id"): road for road in root.iterfind("road")}
    known = {"road": set(roads), "junction": {j.get("id") for j in root.iterfind("junction")}}
    for road in roads.values():
        yield from _road_links(road, roads, known)
    for junction in root.iterfind("junction"):
        for connection in junction.iterfind("connection"):
            yield from _connection(junction.get("id"), connection, roads)


def _road_links(road: Element, roads: Mapping[str, Element], known: Mapping[str, set[str]]) -> Iterator[Finding]:
    where = f"road {road.get('id')}"
    if road.get("junction", "-1") not in known["junction"] | {"-1"}:
        yield _finding("belongs to a junction that is not in the file", where, road.get("junction"), "add the junction")
    for side in ("predecessor", "successor"):
        link = road.find(f"link/{side}")
        if link is None:
            continue
        kind, target = link.get("elementType"), link.get("elementId")
        if target not in known.get(kind, set()):
            yield _finding(f"{side} is a {kind} that is not in the file", where, target, "drop the link or add it")
        elif kind == "road":
            yield from _lane_links(road, side, lane_widths(roads[target], link.get("contactPoint", "start")))


def _lane_links(road: Element, side: str, there: Mapping[int, float]) -> Iterator[Finding]:
    sections = road.findall("lanes/laneSection")
    section = sections[0 if side == "predecessor" else -1]
    for lane in section.iterfind("*/lane"):
        for link in lane.iterfind(f"link/{side}"):
            if int(number(link, "id")) not in there:
                where = f"road {road.get('id')}, lane {lane.get('id')}"
                yield _finding(f"{side} is a lane that is not there", where, link.get("id"), "link an existing lane")


def _connection(junction: str, connection: Element, roads: Mapping[str, Element]) -> Iterator[Finding]:
    where = f"junction {junction}, connection {connection.get('id')}"
    ends = [connection.get("incomingRoad"), connection.get("connectingRoad")]
    missing = [end for end in ends if end not in roads]
    if missing:
        yield _finding("names a road that is not in the file", where, ", ".join(map(str, missing)), "add the road")
        return
    inner, contact = roads[ends[1]], connection.get("contactPoint", "start")
    if inner.get("junction") != junction:
        yield _finding("its connecting road belongs to another junction", where, ends[1], f"set junction={junction!r}")
    link = inner.find("link/predecessor" if contact == "start" else "link/successor")
    if link is None or link.get("elementId") != ends[0]:
        yield _finding("its connecting road does not link back to the incoming road", where, ends[1], "add the link")
        return
    here = lane_widths(roads[ends[0]], link.get("contactPoint", "end")), lane_widths(inner, contact)
    for lane in connection.iterfind("laneLink"):
        for name, lanes in zip(("from", "to"), here, strict=True):
            if int(number(lane, name)) not in lanes:
                what = f"laneLink {name} is no lane of that road"
                yield _finding(what, where, lane.get(name), "link an existing lane")


# ------------------------------------------------------------------ lengths and gaps
def _lengths(root: Element) -> Iterator[Finding]:
    curves = root.findall("road/planView/geometry[paramPoly3]")
    for geometry, length in zip(curves, arc_lengths_of(curves), strict=True):
        if abs(number(geometry, "length") - length) > LENGTH_M:
            where = f"road {geometry.getparent().getparent().get('id')}, s {geometry.get('s')}"
            yield _finding("a curve's length is not its arc length", where, geometry.get("length"), f"{length:.6f}")
    for road in root.iterfind("road"):
        s = 0.0
        for geometry in geometries(road):
            if abs(number(geometry, "s") - s) > LENGTH_M:
                yield _finding("geometries do not add up", f"road {road.get('id')}", geometry.get("s"), f"s is {s:.6f}")
            s += number(geometry, "length")
        if abs(number(road, "length") - s) > LENGTH_M:
            where = f"road {road.get('id')}"
            yield _finding("length is not that of its geometries", where, road.get("length"), f"{s:.6f}")


def _gaps(root: Element) -> Iterator[Finding]:
    roads = {road.get("id"): road for road in root.iterfind("road")}
    for road in roads.values():
        parts = geometries(road)
        for one, two in pairwise(parts):
            pose = end_pose(one)
            gap = math.dist(pose[:2], start_pose(two)[:2]) if pose else 0.0
            if gap > GAP_M:
                where = f"road {road.get('id')}, s {two.get('s')}"
                yield _finding("a gap between two pieces of the reference line", where, f"{gap:.3f} m", _NETCONVERT)
        for side in ("predecessor", "successor"):
            yield from _lane_gaps(road, side, roads)


def _lane_gaps(road: Element, side: str, roads: Mapping[str, Element]) -> Iterator[Finding]:
    link = road.find(f"link/{side}")
    other = roads.get(link.get("elementId")) if link is not None and link.get("elementType") == "road" else None
    if other is None:
        return
    near, far = "start" if side == "predecessor" else "end", link.get("contactPoint", "start")
    poses = contact_pose(road, near), contact_pose(other, far)
    if poses[0] is None or poses[1] is None:
        return
    widths = lane_widths(road, near), lane_widths(other, far)
    offsets = lane_offset(road, near), lane_offset(other, far)
    section = road.findall("lanes/laneSection")[0 if near == "start" else -1]
    for lane in section.iterfind("*/lane[link]"):
        for goal in lane.iterfind(f"link/{side}"):
            a, b = int(number(lane, "id")), int(number(goal, "id"))
            gap = _lane_gap(poses, widths, offsets, (a, b))
            if gap > GAP_M:
                where = f"road {road.get('id')}, lane {a}, {side}"
                yield _finding("a gap between two linked lanes", where, f"{gap:.3f} m", _NETCONVERT)


def _lane_gap(
    poses: tuple[Pose | None, Pose | None],
    widths: tuple[Mapping[int, float], Mapping[int, float]],
    offsets: tuple[float, float],
    lanes: tuple[int, int],
) -> float:
    """The larger of the gaps between the inner and between the outer borders of two linked lanes, metres."""
    gaps = []
    for inward in (0, 1):
        points = []
        for pose, width, offset, lane in zip(poses, widths, offsets, lanes, strict=True):
            border = lane - (inward if lane > 0 else -inward)
            points.append(pose.left(offset + border_t(width, border)) if pose else (0.0, 0.0))
        gaps.append(math.dist(*points))
    return max(gaps)
