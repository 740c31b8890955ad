"""How the roads of an OpenDRIVE network hang together: lane to lane, and road to road for routes and distances.

Knows links and junctions; no geometry.
"""

from __future__ import annotations

import heapq
import math
from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import NamedTuple

from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.openscenario.roads.road_lines import RoadLine

END = {1: "end", -1: "start"}
"""The end of a road that one reaches with a sense of driving."""
MAX_VISITED = 20_000


class Step(NamedTuple):
    """A lane of one lane section, and the sense in which it is driven (1: rising s)."""

    road: str
    section: int
    lane: int
    sense: int


class Leg(NamedTuple):
    """A road on a route and the sense in which it is driven."""

    road: str
    sense: int


class RoadLinks:
    """Links between the lanes and roads of a network."""

    def __init__(self, roads: Mapping[str, RoadLine], junctions: Mapping[str, XmlNode]) -> None:
        self._roads, self._junctions = roads, junctions
        self._behind: dict[Step, list[Step]] = {}
        self._routes: dict[tuple[Leg, str], dict[Leg, tuple[list[Leg], float]]] = {}

    # -------------------------------------------------------------- lanes
    def ahead(self, step: Step) -> list[Step]:
        """The lanes one may drive into behind a lane section: none at a dead end, several at a junction."""
        if step not in self._behind:
            self._behind[step] = found = self._ahead(step)
            self._roads[step.road].node.spend("roads on a way", 1 + len(found))
        return self._behind[step]

    def _ahead(self, step: Step) -> list[Step]:
        line, inner = self._roads[step.road], step.section + step.sense
        lane = line.sections[step.section].lanes.get(step.lane)
        if lane is None:  # lane 0, the center line: nothing is linked to it
            return []
        linked = lane.after if step.sense > 0 else lane.before
        if 0 <= inner < len(line.sections):
            return [Step(step.road, inner, linked, step.sense)] if linked in line.sections[inner].lanes else []
        target = _target(line, step.sense)
        if target is None:
            return []
        if target.text("elementType", "road") == "junction":
            return list(dict.fromkeys(self._through(step, target.text("elementId"))))
        entered = self._entered(target.text("elementId"), target.text("contactPoint", "start"), linked)
        return [entered] if entered else []

    def _entered(self, road: str, contact: str, lane: int | None) -> Step | None:
        if road not in self._roads or lane is None:
            return None
        sections = self._roads[road].sections
        section = 0 if contact == "start" else len(sections) - 1
        return Step(road, section, lane, 1 if contact == "start" else -1) if lane in sections[section].lanes else None

    def _through(self, step: Step, junction: str) -> Iterator[Step]:
        """Along the junction's connections, and back through connecting roads that lead out where one drives in."""
        for connection in self._incoming.get((junction, step.road), ()):
            for link in connection.children("laneLink"):
                contact = connection.text("contactPoint", "start")
                if link.whole("from") == step.lane:
                    into = self._entered(_led_to(connection), contact, link.whole("to"))
                    yield from [into] if into else []
        for leg in self._connecting.get((step.road, END[step.sense]), ()):
            section = self._roads[leg.road].sections[0 if leg.sense > 0 else -1]
            for number, lane in section.lanes.items():
                if (lane.before if leg.sense > 0 else lane.after) == step.lane:
                    index = 0 if leg.sense > 0 else len(self._roads[leg.road].sections) - 1
                    yield Step(leg.road, index, number, leg.sense)

    @cached_property
    def _incoming(self) -> dict[tuple[str, str], list[XmlNode]]:
        """Connections by junction and incoming road."""
        found: dict[tuple[str, str], list[XmlNode]] = defaultdict(list)
        for junction, node in self._junctions.items():
            for connection in node.children("connection"):
                found[junction, connection.text("incomingRoad", "")].append(connection)
        return dict(found)

    # -------------------------------------------------------------- roads
    @cached_property
    def _connecting(self) -> dict[tuple[str, str], list[Leg]]:
        """Connecting roads by the road and end that they link to, each with the sense in which one drives in."""
        found: dict[tuple[str, str], list[Leg]] = defaultdict(list)
        for line in self._roads.values():
            for sense in (1, -1):
                target = _target(line, -sense) if line.junction != "-1" else None
                if target is not None and target.text("elementType", "road") == "road":
                    contact = target.text("contactPoint", "start")
                    found[target.text("elementId"), contact].append(Leg(line.id, sense))
        for junction, node in self._junctions.items():
            for connection in node.children("connection"):
                self._add_direct(found, junction, connection)
        return dict(found)

    def _add_direct(self, found: dict[tuple[str, str], list[Leg]], junction: str, connection: XmlNode) -> None:
        """A direct junction has no connecting roads: one road leads onto the other, and back."""
        linked, line = connection.text("linkedRoad", ""), self._roads.get(connection.text("incomingRoad", ""))
        if line is None or linked not in self._roads:
            return
        contact = connection.text("contactPoint", "start")
        for sense in (1, -1):
            target = _target(line, sense)
            if target is not None and target.text("elementId", "") == junction:
                found[line.id, END[sense]].append(Leg(linked, 1 if contact == "start" else -1))
                found[linked, contact].append(Leg(line.id, -sense))

    def onward(self, leg: Leg) -> list[Leg]:
        """The roads one may drive onto behind a road."""
        target = _target(self._roads[leg.road], leg.sense)
        if target is None:
            return []
        if target.text("elementType", "road") == "junction":
            return self._connecting.get((leg.road, END[leg.sense]), [])
        road = target.text("elementId")
        return [Leg(road, 1 if target.text("contactPoint", "start") == "start" else -1)] if road in self._roads else []

    def path(self, start: Leg, rest_m: float, goals: Mapping[Leg, float]) -> tuple[list[Leg], float] | None:
        """Shortest chain of roads to one of `goals` (leg -> way on it in metres) and the way there; None without.

        `rest_m`: what lies ahead on the first road.
        """
        found = [(*self._route(start, goal.road).get(goal, ([], math.inf)), way) for goal, way in goals.items()]
        legs, over, way = min(found, key=lambda one: one[1] + one[2], default=([], math.inf, 0.0))
        return (legs, rest_m + over + way) if legs else None

    def _route(self, start: Leg, road: str) -> dict[Leg, tuple[list[Leg], float]]:
        """The shortest chains from a road onto another one, and the way over the roads between; remembered."""
        if (start, road) not in self._routes:
            self._routes[start, road] = self._searched(start, road)
        return self._routes[start, road]

    def _searched(self, start: Leg, road: str) -> dict[Leg, tuple[list[Leg], float]]:
        """Dijkstra over roads; each knows the one before it only, so that long ways take no memory."""
        queue: list[tuple[float, Leg, Leg]] = []
        before: dict[Leg, Leg] = {}
        found: dict[Leg, tuple[list[Leg], float]] = {}
        self._spread(queue, 0.0, start)
        while queue and len(before) < MAX_VISITED and len(found) < 2:
            over, leg, last = heapq.heappop(queue)
            if leg in before:
                continue
            before[leg] = last
            if leg.road == road:
                found[leg] = _chain(before, leg, start), over
            self._spread(queue, over + self._roads[leg.road].length_m, leg)
        return found

    def _spread(self, queue: list[tuple[float, Leg, Leg]], over_m: float, leg: Leg) -> None:
        onward = self.onward(leg)
        self._roads[leg.road].node.spend("roads on a way", 1 + len(onward))
        for further in onward:
            heapq.heappush(queue, (over_m, further, leg))


def _chain(before: Mapping[Leg, Leg], last: Leg, start: Leg) -> list[Leg]:
    """From the start to a leg; the start may come again at the end of a ring."""
    legs = [last]
    while True:
        legs.append(before[legs[-1]])
        if legs[-1] == start:
            return legs[::-1]


def _led_to(connection: XmlNode) -> str:
    """The connecting road, or the road that a direct junction links."""
    return connection.text("connectingRoad", connection.text("linkedRoad", ""))


def _target(line: RoadLine, sense: int) -> XmlNode | None:
    link = line.node.find("link")
    return link.find("successor" if sense > 0 else "predecessor") if link else None
