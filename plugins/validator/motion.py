"""Whether the planned motions can be driven: friction, yaw and slip of every vehicle before it is touched.

A motion that no vehicle can do explains no crash, however well the sides fit. A report that tells a loss of control
excuses slip and yaw, never friction. Judges the played scenario; knows no planner.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Literal

from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.playback import sizes_of
from sgcad_core.formats.openscenario.player import play
from sgcad_core.interfaces import Validator
from sgcad_core.metrics.driving import WHEELED, deepest, driven, first_touches
from sgcad_core.narrative.losses import tells_lost_control
from sgcad_core.records import ActorInfo, Evidence, Finding, RoadNetwork, Scenario, Trajectory
from sgcad_core.specs import Surface


class Motion(Validator):
    """Findings on vehicles beyond the limits of driving, and on boxes that overlap where all have come to rest."""

    stage: ClassVar[str] = "scenario"
    over: Literal["repair", "doubt", "note"] = "repair"
    """Severity of a motion that cannot be driven, and of an overlap at rest."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """One a vehicle and one for an overlap; what another validator finds unreadable is passed over."""
        if not isinstance(artifact, Scenario) or artifact.xosc is None:
            return []
        try:
            motions = artifact.planned or play(artifact.xosc, evidence.network.xodr if evidence.network else None)
        except InvalidOutput:
            return []
        sizes = sizes_of(artifact)
        motions = tuple(m for m in motions if m.actor in sizes)
        touches = first_touches(motions, sizes)
        actors = {a.id: a for a in artifact.actors}
        lost = tells_lost_control(evidence.report.narrative)
        surface = artifact.behavior.surface if artifact.behavior else None
        found = [self._driven(m, actors[m.actor], touches, (lost, surface)) for m in motions]
        depth, pair = deepest(motions, sizes, at_rest=True)
        rest = [self._finding("two boxes overlap at rest", pair, f"{depth:.2f} m", "let them push each other apart")]
        return [f for f in found if f] + (rest if depth > 0 else [])

    def _driven(
        self, motion: Trajectory, actor: ActorInfo, touches: Mapping[str, int], told: tuple[bool, Surface | None]
    ) -> Finding | None:
        if actor.type not in WHEELED:
            return None
        lost, surface = told
        seen = driven(motion, actor.length_m, touches.get(actor.id), backing=actor.maneuver == "backing")
        over = [e for e in seen.excesses(surface) if not (lost and not e.startswith("lateral"))]
        if not over:
            return None
        remedy = "drive slower, shift over a longer way, or choose sides that meet in ordinary driving"
        return self._finding(f"{actor.id} moves as no vehicle can before contact", actor.id, "; ".join(over), remedy)

    def _finding(self, what: str, where: str, value: str, remedy: str) -> Finding:
        return Finding(source="motion", severity=self.over, what=what, where=where, value=value, remedy=remedy)
