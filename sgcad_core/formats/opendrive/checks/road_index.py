"""Which roads, lanes and stations an OpenDRIVE file has, and which SUMO lanes they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from sgcad_core.formats.opendrive.elements import LANE_CODE
from sgcad_core.formats.opendrive.geometry import number
from sgcad_core.formats.xml import Element, parse_xml


class LaneAt(NamedTuple):
    """A lane of a road."""

    road: str
    lane: int


@dataclass(frozen=True)
class RoadEntry:
    """One OpenDRIVE road: length, junction it belongs to ("-1": none), lanes by section, SUMO lane -> lane id."""

    id: str
    length_m: float
    junction: str
    sections: tuple[tuple[float, frozenset[int]], ...]
    sumo_lanes: Mapping[str, int] = field(default_factory=dict)

    def lanes_at(self, s_m: float) -> frozenset[int]:
        """Lane ids (0 left out) at s."""
        return next((lanes for start, lanes in reversed(self.sections) if start <= s_m + 1e-9), frozenset())


@dataclass(frozen=True)
class RoadIndex:
    """Roads by id; answers whether a lane position exists."""

    roads: Mapping[str, RoadEntry]

    def fault(self, road: str, lane: int | None = None, s_m: float | None = None) -> str:
        """Why a position does not exist, "" if it does."""
        entry = self.roads.get(road)
        if entry is None:
            return f"road {road!r} is not in the .xodr (roads: {', '.join(list(self.roads)[:30])})"
        if s_m is not None and not -1e-6 <= s_m <= entry.length_m + 1e-6:
            return f"s = {s_m:g} m is beyond road {road!r}, which is {entry.length_m:.2f} m long"
        lanes = entry.lanes_at(s_m or 0.0)
        if lane is not None and lane not in lanes:
            return f"lane {lane} is not on road {road!r} (lanes: {', '.join(map(str, sorted(lanes)))})"
        return ""

    def lane(self, edge: str, index: int) -> LaneAt | None:
        """The lane that is a SUMO lane (index 0 at the right curb); None where the file does not say so."""
        return self._by_lane.get(f"{edge}_{index}")

    def by_edge(self, edge: str) -> RoadEntry | None:
        """The road that holds a SUMO edge's lanes; a two-way road holds two edges."""
        place = self.lane(edge, 0)
        return None if place is None else self.roads[place.road]

    @property
    def edges(self) -> frozenset[str]:
        """SUMO edges whose lanes are in the file."""
        return frozenset(lane.rpartition("_")[0] for lane in self._by_lane)

    @cached_property
    def _by_lane(self) -> dict[str, LaneAt]:
        return {
            lane: LaneAt(road.id, number) for road in self.roads.values() for lane, number in road.sumo_lanes.items()
        }


def lane_index(xodr: str) -> RoadIndex:
    """Which roads, lanes and lengths an OpenDRIVE file has. Raises InvalidOutput where it is no XML."""
    root = parse_xml(xodr, "xodr")
    return RoadIndex({road.get("id", ""): _entry(road) for road in root.iterfind("road")})


def _entry(road: Element) -> RoadEntry:
    sections = tuple((number(sec, "s"), _lane_ids(sec)) for sec in road.iterfind("lanes/laneSection"))
    codes = {
        data.get("value", ""): int(number(data.getparent(), "id"))
        for data in road.iterfind(f"lanes/laneSection/*/lane/userData[@code='{LANE_CODE}']")
    }
    return RoadEntry(road.get("id", ""), number(road, "length"), road.get("junction", "-1"), sections, codes)


def _lane_ids(section: Element) -> frozenset[int]:
    return frozenset(int(number(lane, "id")) for lane in section.iterfind("*/lane")) - {0}
