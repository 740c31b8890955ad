"""Connectors of netconvert's OpenDRIVE: split where lanes part or merge, and drawn to meet what they join.

ASAM's rule (lane_smoothness.contact_point_no_horizontal_gaps) wants the borders of linked lanes within 0.01 m.
Only for roads as netconvert writes them: one-way, lanes on the right, one lane section.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping
from typing import NamedTuple

from lxml import etree

from sgcad_core.formats.opendrive.geometry import Pose, arc_lengths_of, geometries, hermite, number, wrap
from sgcad_core.formats.opendrive.lanes import border_t, contact_pose, lane_offset, lane_widths, width_at
from sgcad_core.formats.xml import Element

GAP_M = 0.002
"""A connector farther than this from the lanes it joins is drawn anew."""
PIVOT_M = 0.3


# ------------------------------------------------------------------ lengths
def true_lengths(roads: list[Element]) -> None:
    """Give every curve its arc length and every road the sum."""
    curves = [g for road in roads for g in geometries(road) if g.find("paramPoly3") is not None]
    for geometry, length in zip(curves, arc_lengths_of(curves), strict=True):
        geometry.set("length", f"{length:.8f}")
    for road in roads:
        _join_lines(road)
        measure(road)


def _join_lines(road: Element) -> None:
    """One <line> in place of several in a row (ASAM: performance.avoid_redundant_info)."""
    before: Element = None
    for part in geometries(road):
        straight = part.find("line") is not None
        if straight and before is not None and abs(number(part, "hdg") - number(before, "hdg")) < 2e-6:
            before.set("length", f"{number(before, 'length') + number(part, 'length'):.8f}")
            part.getparent().remove(part)
        else:
            before = part if straight else None


def measure(road: Element) -> None:
    """Accumulate s again and stretch everything that is placed along the road."""
    before, s = float(road.get("length", 0)), 0.0
    for geometry in geometries(road):
        geometry.set("s", f"{s:.8f}")
        s += float(geometry.get("length", 0))
    road.set("length", f"{s:.8f}")
    ratio = s / before if before > 0 else 1.0
    for element in road.iterfind(".//*[@s]"):
        if element.tag != "geometry" and element.get("s") not in ("0", "0.0"):
            element.set("s", f"{float(element.get('s')) * ratio:.8f}")


# ------------------------------------------------------------------ lanes that part or merge
def split_connectors(root: Element) -> None:
    """Cut connectors whose lanes are not side by side at both ends into connectors whose lanes are.

    netconvert puts all lanes from one road to another into one connector, also two that lead into one lane.
    """
    ids = [int(road.get("id")) for road in root.iterfind("road") if road.get("id", "").isdigit()]
    free = max(ids, default=0) + 1
    for road in root.findall("road"):
        runs = _runs(road) if road.get("junction", "-1") != "-1" else []
        for run in runs[1:]:
            _split_off(root, road, run, str(free))
            free += 1
        if len(runs) > 1:
            _keep(road, runs[0])


def _runs(road: Element) -> list[list[int]]:
    """Lane ids in groups that are neighbors before, in and behind the connector."""
    found: list[list[int]] = []
    last: tuple[int, int] | None = None
    for lane in road.iterfind("lanes/laneSection/right/lane"):
        ends = lane.find("link/predecessor"), lane.find("link/successor")
        if ends[0] is None or ends[1] is None:
            return []
        here = int(ends[0].get("id")), int(ends[1].get("id"))
        if last is None or here != (last[0] - 1, last[1] - 1):
            found.append([])
        found[-1].append(int(lane.get("id")))
        last = here
    return found


def _split_off(root: Element, road: Element, run: list[int], name: str) -> None:
    """A copy of a connector with only the lanes of `run`; its junction's connections follow."""
    twin = copy.deepcopy(road)
    twin.set("id", name)
    _keep(twin, run)
    road.addnext(twin)
    for connection in root.findall("junction/connection"):
        if connection.get("connectingRoad") == road.get("id"):
            _split_connection(connection, run, name)


def _split_connection(connection: Element, run: list[int], name: str) -> None:
    moved = [link for link in connection.findall("laneLink") if int(link.get("to")) in run]
    if not moved:
        return
    junction = connection.getparent()
    numbers = [int(c.get("id")) for c in junction.iterfind("connection")]
    twin = etree.Element("connection", id=str(max(numbers) + 1), connectingRoad=name)
    for key in ("incomingRoad", "contactPoint"):
        twin.set(key, connection.get(key, ""))
    for link in moved:
        link.set("to", str(-1 - run.index(int(link.get("to")))))
        twin.append(link)
    junction.findall("connection")[-1].addnext(twin)


def _keep(road: Element, run: list[int]) -> None:
    """Only the lanes of `run`, numbered from -1."""
    for lane in road.findall("lanes/laneSection/right/lane"):
        if int(lane.get("id")) in run:
            lane.set("id", str(-1 - run.index(int(lane.get("id")))))
        else:
            lane.getparent().remove(lane)


# ------------------------------------------------------------------ connectors
class _End(NamedTuple):
    """Where a connector has to begin or end: pose of the inner border of its first lane, widths of its lanes."""

    pose: Pose
    widths: tuple[float, ...]

    def moved(self, t_m: float) -> Pose:
        """The pose t_m metres to the left."""
        return Pose(*self.pose.left(t_m), self.pose.heading_rad)


def meet_lanes(road: Element, roads: Mapping[str, Element]) -> None:
    """Draw a connector anew where it does not meet the lanes it joins, and give its lanes their widths."""
    start, end = _end(road, "predecessor", roads), _end(road, "successor", roads)
    first, last = contact_pose(road, "start"), contact_pose(road, "end")
    if start is None or end is None or first is None:
        return
    offsets = lane_offset(road, "start"), lane_offset(road, "end")
    if last is None or max(_apart(first, start.moved(-offsets[0])), _apart(last, end.moved(-offsets[1]))) > GAP_M:
        _redraw(road, start, end)
    length = number(road, "length")
    for lane, a, b in zip(road.iterfind("lanes/laneSection/right/lane"), start.widths, end.widths, strict=True):
        widths = lane.findall("width")
        if len(widths) == 1 and max(abs(width_at(widths, 0.0) - a), abs(width_at(widths, length) - b)) > 1e-4:
            _set_linear(widths[0], a, b, length)


def _end(road: Element, side: str, roads: Mapping[str, Element]) -> _End | None:
    """What the road before (or behind) demands of a connector whose lanes are numbered from -1."""
    link = road.find(f"link/{side}")
    other = roads.get(link.get("elementId", "")) if link is not None else None
    joined = [lane.find(f"link/{side}") for lane in road.iterfind("lanes/laneSection/right/lane")]
    if other is None or not joined or any(lane is None for lane in joined):
        return None
    ids = [int(lane.get("id")) for lane in joined]
    contact = link.get("contactPoint", "")
    if contact != {"predecessor": "end", "successor": "start"}[side]:
        return None  # netconvert writes one-way roads; others are left as they are
    pose, widths = contact_pose(other, contact), lane_widths(other, contact)
    if pose is None or any(i >= 0 or i not in widths for i in ids):
        return None
    x, y = pose.left(border_t(widths, ids[0] + 1) + lane_offset(other, contact))
    return _End(Pose(x, y, pose.heading_rad), tuple(widths[i] for i in ids))


def _apart(a: Pose, b: Pose) -> float:
    """Distance of two poses, a turn counted at a lever of 4 m (a lane's outer border)."""
    return math.hypot(a.x_m - b.x_m, a.y_m - b.y_m) + abs(wrap(a.heading_rad - b.heading_rad)) * 4


def _redraw(road: Element, start: _End, end: _End) -> None:
    """One cubic along the inner border; along the outer one where the inner border is the pivot of the bend."""
    pivot = math.dist(start.pose[:2], end.pose[:2]) < PIVOT_M
    offsets = (sum(start.widths), sum(end.widths)) if pivot else (0.0, 0.0)
    _draw(road, start.moved(-offsets[0]), end.moved(-offsets[1]))
    _set_offset(road, *offsets)


def _draw(road: Element, start: Pose, end: Pose) -> None:
    plan = road.find("planView")
    for geometry in list(plan):
        plan.remove(geometry)
    geometry = etree.SubElement(plan, "geometry", s="0.0", length="1")
    for name, value in (("x", start.x_m), ("y", start.y_m), ("hdg", start.heading_rad)):
        geometry.set(name, f"{value:.8f}")
    poly = etree.SubElement(geometry, "paramPoly3")
    for name, value in zip(("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV"), hermite(start, end), strict=True):
        poly.set(name, f"{value:.8f}")
    poly.set("pRange", "normalized")
    geometry.set("length", f"{arc_lengths_of([geometry])[0]:.8f}")
    measure(road)


def _set_offset(road: Element, first: float, last: float) -> None:
    lanes = road.find("lanes")
    for offset in lanes.findall("laneOffset"):
        lanes.remove(offset)
    if first or last:
        offset = etree.Element("laneOffset", s="0")
        _set_linear(offset, first, last, number(road, "length"))
        lanes.insert(0, offset)


def _set_linear(element: Element, first: float, last: float, length: float) -> None:
    """A cubic that is a straight line from `first` to `last` over the length."""
    slope = (last - first) / length if length > 0 else 0.0
    for name, value in (("a", first), ("b", slope), ("c", 0.0), ("d", 0.0)):
        element.set(name, f"{value:.8f}")
