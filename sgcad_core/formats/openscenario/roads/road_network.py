"""An OpenDRIVE network as the player drives it: poses in lanes, the lane at a pose, ways, routes and distances.

At junctions the straightest way is taken unless a route says otherwise. Knows no storyboard.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.timed_motion import angle_between
from sgcad_core.formats.openscenario.reading.budget import Budget
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.openscenario.reading.file_context import FileContext
from sgcad_core.formats.openscenario.roads.lane_vertices import LaneVertices, vertices
from sgcad_core.formats.openscenario.roads.road_lines import DRIVABLE, RoadLine
from sgcad_core.formats.openscenario.roads.road_links import Leg, RoadLinks, Step
from sgcad_core.formats.openscenario.roads.way import LanePlace, Route, Way, cut, way_of
from sgcad_core.geometry.plane import Floats, wrap_angle

AHEAD_M = 1500.0
MAX_ROADS_AHEAD = 100
MAX_LANES_M = 500_000.0
BESIDE_M = 3.0
"""Farther than this from every lane an entity is off the road."""
_TURNED_RAD = 1.3
"""A lane that points farther away than this from the entity's heading is not its lane."""


class RoadDistance(NamedTuple):
    """How far a place lies from another along the roads: ahead (behind: negative) and to the left, metres."""

    ahead_m: float
    left_m: float


@lru_cache(maxsize=2)
def roads_of(xodr: str) -> XodrRoads:
    """The roads of a .xodr, with what was measured on them before; the last few files are remembered."""
    return XodrRoads(xodr)


class XodrRoads:
    """The roads of a .xodr, read at the first question. Unknown roads, lanes and places raise ValueErrors that say what
    there is instead; what is no OpenDRIVE raises InvalidOutput."""

    def __init__(self, xodr: str) -> None:
        self._xodr, self._book = xodr, FileContext()
        self._straightest: dict[Step, Step | None] = {}

    @property
    def budget(self) -> Budget:
        """What was spent on reading and measuring it."""
        return self._book.budget

    @cached_property
    def _root(self) -> XmlNode:
        root = XmlNode(self._book.read(self._xodr, "xodr"), {}, self._book)
        if root.tag != "OpenDRIVE":
            raise root.fault("no OpenDRIVE file", remedy="the root element is <OpenDRIVE>")
        return root

    @cached_property
    def _roads(self) -> dict[str, RoadLine]:
        roads = {node.text("id"): RoadLine(node) for node in self._root.children("road")}
        total = sum(road.length_m * sum(len(part.lanes) for part in road.sections) for road in roads.values())
        if total > MAX_LANES_M * 4:
            raise self._root.fault(f"more than {MAX_LANES_M:g} m of lanes", f"{total:g}", "cut the network")
        return roads

    @cached_property
    def _links(self) -> RoadLinks:
        return RoadLinks(self._roads, {node.text("id"): node for node in self._root.children("junction")})

    def road(self, road: str) -> RoadLine:
        """A road. Raises ValueError that names those there are."""
        if road not in self._roads:
            known = ", ".join(list(self._roads)[:20]) or "none"
            raise ValueError(f"no road {road!r} in the .xodr; roads: {known}")
        return self._roads[road]

    # -------------------------------------------------------------- places
    def road_pose(self, road: str, s_m: float, t_m: float) -> Pose:
        """Pose at road coordinates; heading along the reference line."""
        return self.road(road).pose(s_m, t_m)

    def lane_pose(self, road: str, lane: int, s_m: float, offset_m: float) -> Pose:
        """Pose in a lane; heading in its driving direction."""
        line = self.road(road)
        x, y, heading = line.pose(s_m, line.lane_t(lane, s_m) + offset_m)
        return Pose(x, y, heading if line.sense(lane) > 0 else float(wrap_angle(heading + np.pi)))

    def place_at(self, road: str, s_m: float, t_m: float) -> LanePlace:
        """Road coordinates as a place in the lane that holds them."""
        line = self.road(road)
        lane = line.lane_at(s_m, t_m)
        return LanePlace(road, lane, s_m, t_m - line.lane_t(lane, s_m))

    def t_of(self, place: LanePlace) -> float:
        """A lane place's t on its road, metres."""
        return self.road(place.road).lane_t(place.lane, place.s_m) + place.offset_m

    def beyond(self, road: str, s_m: float) -> float:
        """How far s lies behind a road's end (before its start: negative), metres."""
        return s_m - min(max(s_m, 0.0), self.road(road).length_m)

    def sense(self, place: LanePlace, heading_rad: float) -> int:
        """1 where a heading leads along s there, -1 where against it."""
        return 1 if angle_between(self.road(place.road).pose(place.s_m).heading_rad, heading_rad) <= np.pi / 2 else -1

    def nearest(self, pose: Pose) -> LanePlace | None:
        """The drivable lane that holds a pose: of several the one that best points its way and is nearest."""
        lanes = self._centers
        near, gap = self._near(lanes, pose, BESIDE_M + 1.0)
        half = lanes.half_m[near]
        turned = np.abs(wrap_angle(lanes.heading_rad[near] - pose.heading_rad))
        against = turned > np.pi / 2
        turned = np.where(against, np.pi - turned, turned)
        beyond = np.maximum(gap - half, 0.0)
        cost = gap + 4 * turned + 2 * against + 50 * beyond + np.where(turned > _TURNED_RAD, 1e9, 0.0)
        if not len(near) or cost.min() >= 1e9:
            return None
        best = int(near[cost.argmin()])
        step = self._drivable[int(lanes.lane[best])]
        here = Pose(float(lanes.x_m[best]), float(lanes.y_m[best]), float(lanes.heading_rad[best]))
        over, left = _local(here, pose)
        if max(abs(left), abs(over)) > lanes.half_m[best] + BESIDE_M:
            return None
        section = self._roads[step.road].sections[step.section]
        s_m = float(np.clip(lanes.s_m[best] + step.sense * over, section.begin_m, section.end_m))
        return LanePlace(step.road, step.lane, s_m, left * step.sense)

    def covers(self, pose: Pose) -> bool:
        """Whether a point lies on a drivable lane, whatever its heading."""
        return len(self._near(self._centers, pose, 0.05)[0]) > 0

    def on_road(self, pose: Pose) -> bool:
        """Whether a point lies on a lane of any kind but "none": shoulders, borders and sidewalks are road."""
        return self.covers(pose) or len(self._near(self._beside, pose, 0.05)[0]) > 0

    def _near(self, lanes: LaneVertices, pose: Pose, beyond_m: float) -> tuple[NDArray[np.intp], Floats]:
        found, gaps, looked_at = lanes.near(pose.x_m, pose.y_m, beyond_m)
        self._root.spend("points looked at", 1000 + looked_at)
        return found, gaps

    def lane_center(self, road: str, lane: int) -> Floats:
        """(n, 2) center of a lane in driving direction, through the sections that have it. Raises ValueError."""
        line = self.road(road)
        with_lane = [i for i, section in enumerate(line.sections) if lane in section.lanes]
        if not with_lane:
            raise ValueError(f"road {road!r} has no lane {lane}")
        points: Floats = np.vstack([line.center(i, lane)[:, 1:3] for i in with_lane])
        return points if line.sense(lane) > 0 else points[::-1]

    def strips(self) -> Iterator[tuple[Floats, float, bool]]:
        """(n, 2) center, width in metres and whether cars drive there, of every lane of every section, to be drawn."""
        for road in self._roads.values():
            for i, section in enumerate(road.sections):
                for number, lane in section.lanes.items():
                    rows = (
                        road.center(i, number)[::4] if section.end_m - section.begin_m > 4 else road.center(i, number)
                    )
                    if (width := 2 * float(rows[:, 4].mean())) > 0.1:
                        yield rows[:, 1:3], width, lane.kind in DRIVABLE

    # -------------------------------------------------------------- ways
    def way(self, road: str, lane: int, s_m: float) -> Floats:
        """(n, 2) lane center ahead, over successors, up to 1500 m. Raises ValueError for what does not exist."""
        return self.drive(LanePlace(road, lane, s_m, 0.0), self.road(road).sense(lane)).points

    def drive(self, place: LanePlace, sense: int, route: Route | None = None) -> Way:
        """The lane center ahead of a place in a sense of driving. Raises ValueError for what does not exist."""
        line = self.road(place.road)
        line.lane_t(place.lane, place.s_m)
        step: Step | None = Step(place.road, line.section_index(place.s_m), place.lane, sense)
        parts, length, begin = list[tuple[Floats, tuple[str, int, int]]](), 0.0, place.s_m
        while step is not None and length <= AHEAD_M and len(parts) < MAX_ROADS_AHEAD:
            part, along = cut(self._ahead(step, begin), AHEAD_M - length)
            self._root.spend("points looked at", 5000 + len(part))
            parts.append((part, (step.road, step.lane, step.sense)))
            length += along
            if length <= AHEAD_M:
                step, begin = self._next(step, route), -1.0
        return way_of(parts, dead_end=step is None)

    def route(self, places: Sequence[LanePlace], sense: int | None = None) -> Route:
        """Shortest roads over places in order; the first is driven in its lane's direction unless `sense` is given.

        Raises ValueError where no road leads on.
        """
        first = places[0]
        legs = [Leg(first.road, sense or self.road(first.road).sense(first.lane or -1))]
        here = first
        for place in places[1:]:
            found = self._onward(here, legs[-1], place) or (
                self._onward(here, Leg(legs[0].road, -legs[0].sense), place) if len(legs) == 1 else None
            )
            if found is None:
                raise ValueError(f"no road leads from road {here.road!r} to road {place.road!r}")
            legs[-1:], here = found, place
        return Route(tuple(legs), tuple(self._roads[leg.road].length_m for leg in legs), first.s_m)

    def apart(self, first: LanePlace, sense: int, second: LanePlace) -> RoadDistance | None:
        """Where the second place lies as seen along the roads from the first; None where no road leads there."""
        t, t2, line = self.t_of(first), self.t_of(second), self.road(first.road)
        if first.road == second.road:
            return RoadDistance((second.s_m - first.s_m) * sense, (t2 - t) * sense)
        options = []
        for way in (1, -1):
            ahead = (line.length_m - first.s_m) if sense * way > 0 else first.s_m
            if found := self._links.path(Leg(first.road, sense * way), ahead, self._goals(second)):
                options.append(RoadDistance(way * found[1], t2 * found[0][-1].sense * way - t * sense))
        return min(options, key=lambda option: abs(option.ahead_m), default=None)

    # -------------------------------------------------------------- inside
    def _goals(self, place: LanePlace) -> dict[Leg, float]:
        length = self.road(place.road).length_m
        return {Leg(place.road, 1): place.s_m, Leg(place.road, -1): length - place.s_m}

    def _onward(self, here: LanePlace, leg: Leg, place: LanePlace) -> list[Leg] | None:
        """Roads from `leg`, which holds `here`, to the place."""
        if here.road == place.road and (place.s_m - here.s_m) * leg.sense >= 0:
            return [leg]
        length = self._roads[here.road].length_m
        found = self._links.path(leg, length - here.s_m if leg.sense > 0 else here.s_m, self._goals(place))
        return found[0] if found else None

    def _of_kind(self, wanted: Callable[[str], bool]) -> list[Step]:
        return [
            Step(road.id, i, lane, road.sense(lane))
            for road in self._roads.values()
            for i, section in enumerate(road.sections)
            for lane, found in section.lanes.items()
            if wanted(found.kind)
        ]

    @cached_property
    def _drivable(self) -> list[Step]:
        return self._of_kind(DRIVABLE.__contains__)

    @cached_property
    def _centers(self) -> LaneVertices:
        """Of the drivable lanes; places in `_drivable`."""
        return self._vertices(self._drivable)

    @cached_property
    def _beside(self) -> LaneVertices:
        """Of the other lanes that are road."""
        return self._vertices(self._of_kind(lambda kind: kind not in (*DRIVABLE, "none")))

    def _vertices(self, lanes: Sequence[Step]) -> LaneVertices:
        total = sum(s.end_m - s.begin_m for s in (self._roads[d.road].sections[d.section] for d in lanes))
        if total > MAX_LANES_M:
            raise self._root.fault(f"more than {MAX_LANES_M:g} m of lanes", f"{total:g}", "cut the network")
        parts = [self._roads[step.road].center(step.section, step.lane) for step in lanes]
        return vertices(parts, [step.sense < 0 for step in lanes])

    def _ahead(self, step: Step, begin_m: float) -> Floats:
        """(n, 3) s, x, y of a lane section in driving direction, from s = begin_m if not negative."""
        line = self._roads[step.road]
        rows = line.center(step.section, step.lane)[:, :3]
        if begin_m >= 0:
            inside = rows[(rows[:, 0] - begin_m) * step.sense > 1e-6]
            x, y, _ = line.pose(begin_m, line.lane_t(step.lane, begin_m))
            return np.vstack(([begin_m, x, y], inside if step.sense > 0 else inside[::-1]))
        return rows[:: step.sense]

    def _next(self, step: Step, route: Route | None) -> Step | None:
        """The lane one drives into next: the route's, else the straightest, which is looked for once."""
        if not route and step in self._straightest:
            return self._straightest[step]
        options = self._links.ahead(step)
        self._root.spend("points looked at", 150 * len(options))
        if route and len(options) > 1:
            options = self._onto(options, route.legs_after(step.road)) or options
        taken = min(options, key=self._turn, default=None)
        return taken if route else self._straightest.setdefault(step, taken)

    def _onto(self, options: list[Step], ahead: Sequence[Leg]) -> list[Step]:
        """The options that a route takes: onto its next road, or over a neighbour of it onto the one behind."""
        exact = [o for o in options if ahead and o.road == ahead[0].road]
        target = {leg.road for leg in ahead[1:2]}
        return exact or [o for o in options if target & {leg.road for leg in self._links.onward(Leg(o.road, o.sense))}]

    def _turn(self, step: Step) -> float:
        reference = self._roads[step.road].reference
        return angle_between(float(reference[0, 3]), float(reference[-1, 3]))


def _local(here: Pose, other: Pose) -> tuple[float, float]:
    """Another pose's place as seen from here: ahead and to the left, metres."""
    dx, dy = other.x_m - here.x_m, other.y_m - here.y_m
    c, s = np.cos(here.heading_rad), np.sin(here.heading_rad)
    return float(dx * c + dy * s), float(dy * c - dx * s)
