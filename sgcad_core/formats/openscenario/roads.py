"""An OpenDRIVE network as the player drives it: poses in lanes, the lane at a pose, the way ahead.

At junctions the straightest way is taken. Knows no storyboard.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.openscenario.motion import Pose, angle_between
from sgcad_core.formats.openscenario.read import Node
from sgcad_core.formats.openscenario.road_lines import DRIVABLE, RoadLine
from sgcad_core.formats.openscenario.scene import LanePlace
from sgcad_core.formats.xml import parse_xml
from sgcad_core.geometry.plane import Floats, wrap_angle

AHEAD_M = 1500.0
MAX_ROADS_AHEAD = 100
MAX_LANES_M = 500_000.0
BESIDE_M = 3.0
"""Farther than this from every lane center an entity is off the road."""
_TURNED_RAD = 1.3
"""A lane that points farther away than this from the entity's heading is not its lane."""


class _Step(NamedTuple):
    """A lane of one lane section, and the way one drives along it (1: rising s)."""

    road: str
    section: int
    lane: int

    @property
    def sense(self) -> int:
        return 1 if self.lane < 0 else -1


class XodrRoads:
    """Implements `xosc_scene.Roads` for a .xodr, read when first asked. Raises InvalidOutput where it is none."""

    def __init__(self, xodr: str) -> None:
        self._xodr = xodr

    @cached_property
    def _root(self) -> Node:
        root = Node(parse_xml(self._xodr, "xodr"), {})
        if root.tag != "OpenDRIVE":
            raise root.fault("no OpenDRIVE file", remedy="the root element is <OpenDRIVE>")
        return root

    @cached_property
    def _roads(self) -> dict[str, RoadLine]:
        roads = {node.text("id"): RoadLine(node) for node in self._root.children("road")}
        total = sum(road.length_m * sum(len(part.lanes) for part in road.sections) for road in roads.values())
        if total > MAX_LANES_M:
            raise self._root.fault(f"more than {MAX_LANES_M:g} m of lanes", f"{total:g}", "cut the network")
        return roads

    @cached_property
    def _junctions(self) -> dict[str, Node]:
        return {node.text("id"): node for node in self._root.children("junction")}

    def road_pose(self, road: str, s_m: float, t_m: float) -> Pose:
        """Pose at road coordinates; heading along the reference line."""
        return self._road(road).pose(s_m, t_m)

    def lane_pose(self, road: str, lane: int, s_m: float, offset_m: float) -> Pose:
        """Pose in a lane; heading in its driving direction (traffic keeps to the right)."""
        line = self._road(road)
        x, y, heading = line.pose(s_m, line.lane_t(lane, s_m) + offset_m)
        return Pose(x, y, heading if lane < 0 else float(wrap_angle(heading + np.pi)))

    def nearest(self, pose: Pose) -> LanePlace | None:
        """The drivable lane whose center is nearest among those that point the entity's way."""
        x, y, heading, s, which = self._centers
        away = np.hypot(x - pose.x_m, y - pose.y_m) + np.where(
            np.abs(wrap_angle(heading - pose.heading_rad)) > _TURNED_RAD, 1e9, 0.0
        )
        best = int(away.argmin()) if len(away) else -1
        if best < 0 or away[best] > BESIDE_M:
            return None
        step = self._drivable[int(which[best])]
        here = Pose(float(x[best]), float(y[best]), float(heading[best]))
        over, left = _local(here, pose)
        road = self._roads[step.road]
        s_m = float(np.clip(s[best] + step.sense * over, 0.0, road.length_m))
        return LanePlace(step.road, step.lane, s_m, left)

    def way(self, road: str, lane: int, s_m: float) -> Floats:
        """(n, 2) lane center ahead, over successors, up to 1500 m. Raises ValueError for what does not exist."""
        line = self._road(road)
        line.lane_t(lane, s_m)
        step: _Step | None = _Step(road, line.section_index(s_m), lane)
        parts, length, begin = list[Floats](), 0.0, s_m
        for _ in range(MAX_ROADS_AHEAD):
            if step is None or length > AHEAD_M:
                break
            part = self._ahead(step, begin)
            parts.append(part[:, :2])
            length += float(np.hypot(*np.diff(part[:, :2], axis=0).T).sum())
            step = self._next(step)
            begin = -1.0
        points = np.vstack(parts)
        apart = np.concatenate(([True], np.hypot(*np.diff(points, axis=0).T) > 1e-3))
        way: Floats = points[apart]
        return way

    def lane_center(self, road: str, lane: int) -> Floats:
        """(n, 2) center of a lane in driving direction, through the sections that have it. Raises ValueError."""
        line = self._road(road)
        with_lane = [i for i, section in enumerate(line.sections) if lane in section.lanes]
        if not with_lane:
            raise ValueError(f"road {road!r} has no lane {lane}")
        points: Floats = np.vstack([line.center(i, lane)[:, 1:3] for i in with_lane])
        return points if lane < 0 else points[::-1]

    # -------------------------------------------------------------- lanes
    def _road(self, road: str) -> RoadLine:
        if road not in self._roads:
            known = ", ".join(list(self._roads)[:20]) or "none"
            raise ValueError(f"no road {road!r} in the .xodr; roads: {known}")
        return self._roads[road]

    @cached_property
    def _drivable(self) -> list[_Step]:
        return [
            _Step(road.id, i, lane)
            for road in self._roads.values()
            for i, section in enumerate(road.sections)
            for lane, node in section.lanes.items()
            if lane != 0 and node.text("type", "driving") in DRIVABLE
        ]

    @cached_property
    def _centers(self) -> tuple[Floats, ...]:
        """x, y, driving heading, s and index into `_drivable` of every vertex of every drivable lane."""
        parts = [self._roads[step.road].center(step.section, step.lane) for step in self._drivable]
        if not parts:
            return (np.empty(0),) * 5
        turned = [np.where(step.sense > 0, 0.0, np.pi) for step in self._drivable]
        rows = np.vstack([np.column_stack((p, np.full(len(p), i))) for i, p in enumerate(parts)])
        heading = rows[:, 3] + np.concatenate([np.full(len(p), t) for p, t in zip(parts, turned, strict=True)])
        return rows[:, 1], rows[:, 2], heading, rows[:, 0], rows[:, 4]

    def _ahead(self, step: _Step, begin_m: float) -> Floats:
        """(n, 3) x, y, reference heading of a lane section in driving direction, from s = begin_m if not negative."""
        line = self._roads[step.road]
        rows = line.center(step.section, step.lane)
        if begin_m >= 0:
            inside = rows[(rows[:, 0] - begin_m) * step.sense > 1e-6]
            here = line.pose(begin_m, line.lane_t(step.lane, begin_m))
            rows = np.vstack(([begin_m, *here], inside if step.sense > 0 else inside[::-1]))
            return rows[:, 1:]
        return rows[:: step.sense, 1:]

    # -------------------------------------------------------------- links
    def _next(self, step: _Step) -> _Step | None:
        """The lane one drives into next; at a junction the straightest."""
        line = self._roads[step.road]
        inner = step.section + step.sense
        side = "successor" if step.sense > 0 else "predecessor"
        lane = self._linked_lane(line.sections[step.section].lanes[step.lane], side)
        if 0 <= inner < len(line.sections):
            return _Step(step.road, inner, lane) if lane in line.sections[inner].lanes else None
        link = line.node.find("link")
        target = link.find(side) if link else None
        if target is None:
            return None
        if target.text("elementType", "road") == "junction":
            return self._straightest(step, target.text("elementId"))
        return self._entered(target.text("elementId"), target.text("contactPoint", "start"), lane)

    def _linked_lane(self, lane: Node, side: str) -> int | None:
        link = lane.find("link")
        target = link.find(side) if link else None
        return int(target.number("id")) if target else None

    def _entered(self, road: str, contact: str, lane: int | None) -> _Step | None:
        if road not in self._roads or lane is None:
            return None
        sections = self._roads[road].sections
        section = 0 if contact == "start" else len(sections) - 1
        return _Step(road, section, lane) if lane in sections[section].lanes else None

    def _straightest(self, step: _Step, junction: str) -> _Step | None:
        options = [s for s in self._through(step, junction) if s is not None]
        return min(options, key=self._turn, default=None)

    def _through(self, step: _Step, junction: str) -> Iterator[_Step | None]:
        node = self._junctions.get(junction)
        for connection in node.children("connection") if node else []:
            if connection.text("incomingRoad", "") == step.road:
                for link in connection.children("laneLink"):
                    if int(link.number("from")) == step.lane:
                        contact = connection.text("contactPoint", "start")
                        yield self._entered(connection.text("connectingRoad", ""), contact, int(link.number("to")))

    def _turn(self, step: _Step) -> float:
        rows = self._ahead(step, -1.0)
        return angle_between(float(rows[0, 2]), float(rows[-1, 2]))


def _local(here: Pose, other: Pose) -> tuple[float, float]:
    """Another pose's place as seen from here: ahead and to the left, metres."""
    dx, dy = other.x_m - here.x_m, other.y_m - here.y_m
    c, s = np.cos(here.heading_rad), np.sin(here.heading_rad)
    return float(dx * c + dy * s), float(dy * c - dx * s)
