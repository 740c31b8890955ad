"""Checks that every vehicle starts and drives in a lane of its direction up to its first contact.

Says of every vehicle and every sample which lane it is on (`sgcad_core.metrics.lane_places`). What the report tells is
no finding: a crossed center line, a departure, a swerve, a loss of control, a start from beside the road.
"""

from __future__ import annotations

from typing import ClassVar, Literal

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.interfaces import Validator
from sgcad_core.metrics.lane_places import lane_steps
from sgcad_core.metrics.untold_places import untold_places
from sgcad_core.reading.reading_with_acts import with_acts


class Places(Validator):
    """Doubts vehicles that are on the wrong side of the road, beside or off its lanes, and are not told to be."""

    stage: ClassVar[str] = "scenario"
    version: ClassVar[str] = "1"
    odd: Literal["doubt", "note"] = "doubt"
    """Severity of the finding."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """One for each such vehicle, in the order of the actors, with the lanes that it is on in turn."""
        network = evidence.network
        if not isinstance(artifact, Scenario) or not artifact.planned or network is None or network.net_xml is None:
            return []
        try:
            graph = parse_net(network.net_xml)
        except InvalidOutput:
            return []
        reading = with_acts(evidence.report.reading, artifact.behavior)
        poses = {motion.actor: motion.pose for motion in artifact.planned}
        what, remedy = "it drives where the report does not have it", "choose a road, lane and maneuver that keep it"
        return [
            Finding(source="places", severity=self.odd, what=what, where=f"actor {one.actor}",
                    value=f"{one.words()}: {lane_steps(graph, poses[one.actor][: one.until]).in_turn()}", remedy=remedy)
            for one in untold_places(graph, artifact.planned, artifact.actors, reading.crash, reading.lost_control)
        ]  # fmt: skip
