"""Checks that the declared contact happens in ordinary driving, and finds the fact that was most likely misread.

A behavior whose vehicles must skid, spin or leave the road to meet as declared can be planned, but a report that tells
no loss of control seldom means it. Facts that the narrative leaves open (a start, a maneuver) are tried in turn; the
finding holds further answers to those that meet in ordinary driving.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

from plugins.validator._courses import Course, approaches, course, heading, held, straight_on
from sgcad_core.case.records import Evidence, Finding, Hold, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.interfaces import Validator
from sgcad_core.kinds import is_vehicle_id
from sgcad_core.planner import plan
from sgcad_core.planner.lines.turning import WIDE
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.layout.road_ways import Way, ways_of
from sgcad_core.reading.text.compass import angle_of
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Maneuver, RoadSpec
from sgcad_core.roads.lane_graph import LaneGraph


class Meeting(Validator):
    """Doubts contacts that happen only with skids, spins or maneuvers that the report does not tell."""

    stage: ClassVar[str] = "scenario"
    version: ClassVar[str] = "2"
    odd: Literal["doubt", "note"] = "doubt"
    """Severity of the finding."""
    odd_from: float = 0.5
    """Oddity (`Plan.oddity`) from which a contact is doubted."""
    try_others: bool = False
    """Plan the open starts and maneuvers, and hold those that meet in ordinary driving; needs `hold_findings`."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """At most one finding; none if control was lost or the contact is not between two vehicles."""
        if not isinstance(artifact, Scenario) or artifact.behavior is None or artifact.declared is None:
            return []
        if not is_vehicle_id(artifact.declared.striker) or not is_vehicle_id(artifact.declared.struck):
            return []
        network, reading = evidence.network, evidence.report.reading
        if network is None or network.net_xml is None:
            return []
        ordinary = artifact.oddity < self.odd_from and not _swings_untold(artifact, reading.crash)
        if ordinary or reading.lost_control:
            return []
        holds: tuple[Hold, ...] = ()
        if self.try_others and network.spec is not None:
            graph = parse_net(network.net_xml)
            trials = _Trials(artifact.behavior, artifact.declared, network.spec, graph, self.odd_from)
            holds = trials.holds(reading.crash)
        what = "the declared contact comes about only by what the report does not tell"
        remedy = "choose roads, exit roads, maneuvers and sides that meet in ordinary driving"
        seen = "; ".join(artifact.notes) or f"oddity {artifact.oddity:g}"
        return [Finding(source="meeting", severity=self.odd, what=what, where="contacts[0]", value=seen, remedy=remedy,
                        holds=holds)]  # fmt: skip


def _swings_untold(scenario: Scenario, facts: CrashFacts) -> bool:
    """Whether a vehicle swings wide in a turn that the report does not tell."""
    return any(not v.maneuver_stated and f"{v.id} {WIDE}" in scenario.notes for v in facts.vehicles)


@dataclass(frozen=True)
class _Trials:
    """Other readings of a behavior, planned one by one."""

    behavior: BehaviorSpec
    contact: Contact
    spec: RoadSpec
    graph: LaneGraph
    odd_from: float

    def holds(self, facts: CrashFacts) -> tuple[Hold, ...]:
        """The open fact that, changed alone, meets in ordinary driving: starts before maneuvers."""
        pair = [a for a in self.behavior.actors if a.id in (self.contact.striker, self.contact.struck)]
        known = [(a, v) for a in pair if (v := facts.vehicle(a.id)) is not None]
        starts = [(a, v, a.maneuver) for a, v in known if not (v.heading_stated and v.heading)]
        deeds: list[tuple[Actor, VehicleFacts, Maneuver]]
        deeds = [(a, v, "straight") for a, v in known if not v.maneuver_stated and a.maneuver != "straight"]
        for actor, fact, maneuver in [*starts, *deeds]:
            if either := list(self._courses(actor, fact, maneuver)):
                return (held(actor.id, either),)
        return ()

    def _courses(self, actor: Actor, fact: VehicleFacts, maneuver: Maneuver) -> Iterator[Course]:
        """Starts and exits of one actor that meet the other as declared."""
        ways = ways_of(self.spec)
        for way in self._starts(ways, fact):
            found = course(way, ways, maneuver) | {"maneuver": (maneuver,)}
            onward = straight_on(way, ways)
            exits: tuple[str | None, ...] = found.get("exit_road", (onward,))
            same = (actor.road, actor.direction, actor.maneuver) == (way.road.id, way.direction, maneuver)
            met = [] if same else [road for road in exits if self._meet(actor, way, maneuver, road)]
            if met:
                yield found | ({"exit_road": tuple(road for road in met if road)} if all(met) else {})

    def _meet(self, actor: Actor, way: Way, maneuver: Maneuver, exit_road: str | None) -> bool:
        """Whether the pair meets in ordinary driving with one actor on another course."""
        changed = actor.model_copy(update={
            "road": way.road.id, "direction": way.direction, "maneuver": maneuver, "exit_road": exit_road, "lane": None,
        })  # fmt: skip
        actors = tuple(changed if a.id == actor.id else a for a in self.behavior.actors)
        try:
            planned = plan(self.behavior.model_copy(update={"actors": actors}), self.graph)
        except InvalidOutput:
            return False
        return planned.realised and planned.oddity < self.odd_from

    def _starts(self, ways: Sequence[Way], fact: VehicleFacts) -> tuple[Way, ...]:
        """Ways on which a vehicle may start, by its heading if it is stated."""
        if fact.heading is not None and fact.heading_stated:
            ways = heading(ways, angle_of(fact.heading))
        return approaches(ways, self.spec)
