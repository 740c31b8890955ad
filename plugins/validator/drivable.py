"""Checks that planned motions can be driven up to the contact: lateral acceleration, yaw rate, slip at the rear axle.

A contact whose sides no steering brings about is still planned, with boxes that slide or with more lateral acceleration
than the surface allows; a report that tells no loss of control seldom means that. Knows limits
(`sgcad_core.metrics.thresholds`) and the trajectories, but not which fact was misread.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import ClassVar, Literal

import numpy as np

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario, Trajectory
from sgcad_core.interfaces import Validator
from sgcad_core.metrics.drivability import deepest_overlap, driving_peaks, first_touches
from sgcad_core.records.specs import Actor, BehaviorSpec, size_m

_MOVED_M = 0.1
"""A thing that ends further from where it stood was knocked down."""
_SLIDES_S = 1.5
"""As long before it rolls over a vehicle slides already, and nobody drives it."""


class Drivable(Validator):
    """Doubts vehicles that exceed the limits of driving before their first contact, and boxes that overlap at rest."""

    stage: ClassVar[str] = "scenario"
    version: ClassVar[str] = "1"
    odd: Literal["doubt", "note"] = "doubt"
    """Severity of both findings."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """One for each such vehicle, in the behavior's order, if no loss of control is told; one for an overlap."""
        if not isinstance(artifact, Scenario) or artifact.behavior is None or not artifact.planned:
            return []
        rest = self._at_rest(artifact, artifact.behavior)
        if evidence.report.reading.lost_control:
            return rest
        remedy = "choose roads, maneuvers, speeds and sides that steering alone brings about"
        return [
            Finding(source="drivable", severity=self.odd, what="nobody can drive so before the contact",
                    where=f"actor {actor.id}", value="; ".join(over), remedy=remedy)
            for actor, over in _excesses(artifact, artifact.behavior)
        ] + rest  # fmt: skip

    def _at_rest(self, scenario: Scenario, behavior: BehaviorSpec) -> list[Finding]:
        """At most one finding: boxes that overlap after all have come to rest."""
        down = _knocked_down(scenario, behavior)  # a vehicle may lie over these
        left = [motion for motion in scenario.planned if motion.actor not in down]
        depth, pair = deepest_overlap(left, {a.id: size_m(a) for a in behavior.actors}, at_rest=True)
        what, remedy = "two boxes overlap at rest", "let them push each other apart"
        found = Finding(
            source="drivable", severity=self.odd, what=what, where=pair, value=f"{depth:.2f} m", remedy=remedy
        )
        return [found] if depth > 0 else []


def _knocked_down(scenario: Scenario, behavior: BehaviorSpec) -> set[str]:
    """Things that gave way, which do not stay where they stood, and those on the ground."""
    yielding = {actor.id for actor in behavior.actors if actor.record.thing and not actor.firm}
    return {actor.id for actor in behavior.actors if actor.flat} | {
        motion.actor for motion in scenario.planned if motion.actor in yielding
        and math.dist(motion.pose[0, :2], motion.pose[-1, :2]) > _MOVED_M
    }  # fmt: skip


def _driven_until(motion: Trajectory, touch: int | None) -> int | None:
    """The sample up to which a vehicle is driven: its first contact, or so long before its roll that it slides."""
    rolls = np.flatnonzero(np.abs(motion.rolls) > 0.0)
    slides = [max(int(np.searchsorted(motion.t_s, motion.t_s[k] - _SLIDES_S)), 1) for k in rolls[:1]]
    return min([*slides, *([] if touch is None else [touch])], default=None)


def _excesses(scenario: Scenario, behavior: BehaviorSpec) -> Iterator[tuple[Actor, tuple[str, ...]]]:
    """Vehicles with each quantity over its limit before their first contact, as text with value and limit."""
    sizes = {a.id: size_m(a) for a in behavior.actors}
    touches = first_touches(scenario.planned, sizes)
    motions = {m.actor: m for m in scenario.planned}
    for actor in behavior.actors:
        if not actor.record.wheeled or actor.id not in motions:
            continue
        until = _driven_until(motions[actor.id], touches.get(actor.id))
        seen = driving_peaks(motions[actor.id], sizes[actor.id][0], until, backing=actor.maneuver == "backing")
        if over := seen.excesses(behavior.surface):
            yield actor, over
