"""Lanes of an OpenDRIVE road where it begins and ends: widths, borders, poses. Metres and radians."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sgcad_core.formats.opendrive.geometry import Pose, end_pose, geometries, number, start_pose
from sgcad_core.formats.xml import Element


def contact_pose(road: Element, contact: str) -> Pose | None:
    """Pose of the road's reference line at its "start" or "end", in the road's own direction."""
    parts = geometries(road)
    if not parts:
        return None
    return start_pose(parts[0]) if contact == "start" else end_pose(parts[-1])


def lane_widths(road: Element, contact: str) -> dict[int, float]:
    """Lane id -> width at the "start" or "end" of the road (lane 0 left out)."""
    sections = road.findall("lanes/laneSection")
    if not sections:
        return {}
    section, length = sections[0 if contact == "start" else -1], number(road, "length")
    ds = 0.0 if contact == "start" else length - number(section, "s")
    return {int(number(lane, "id")): width_at(lane.findall("width"), ds) for lane in section.iterfind("*/lane[width]")}


def width_at(widths: Sequence[Element], ds_m: float, key: str = "sOffset") -> float:
    """Value of a row of cubic <width> (or, by key "s", <laneOffset>) elements at ds_m; 0 where there is none."""
    entry = next((w for w in reversed(widths) if number(w, key) <= ds_m + 1e-9), None)
    if entry is None:
        return 0.0
    d = ds_m - number(entry, key)
    return number(entry, "a") + d * (number(entry, "b") + d * (number(entry, "c") + d * number(entry, "d")))


def lane_offset(road: Element, contact: str) -> float:
    """t of lane 0 at the "start" or "end" of the road (laneOffset)."""
    return width_at(road.findall("lanes/laneOffset"), 0.0 if contact == "start" else number(road, "length"), "s")


def border_t(widths: Mapping[int, float], lane: int) -> float:
    """t coordinate of a lane's outer border (0 for lane 0), left positive."""
    if lane == 0:
        return 0.0
    sign = 1 if lane > 0 else -1
    return sign * sum(widths.get(sign * i, 0.0) for i in range(1, abs(lane) + 1))
