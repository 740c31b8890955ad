"""Comparison of two executions of one scenario by different simulators: motion and first contact.

Knows trajectories and contacts; no simulator.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from sgcad_core.case.records import Execution, ObservedContact, Record, RoadNetwork, Scenario, Trajectory
from sgcad_core.errors import SimulationFailed
from sgcad_core.execution.contact import realised
from sgcad_core.interfaces import Simulator
from sgcad_core.records.specs import Contact

TOLERANCE_M = 0.01
"""Box centers nearer than this are the same motion; players compute in doubles and write six digits."""


class Deviation(Record):
    """The largest distance between two box centers at one time, and where it was."""

    actor: str
    t_s: float
    distance_m: float = Field(ge=0)


class Judgement(Record):
    """The execution of a scenario by another simulator, compared with ours."""

    simulator: str
    failure: str = ""
    """Reason of a failure; all else is then empty."""
    complaints: tuple[str, ...] = ()
    """Errors and unsupported elements reported in a successful run."""
    deviation: Deviation | None = None
    observed: ObservedContact | None = None
    declared: bool = False
    """Whether the scenario declares a contact."""
    as_declared: bool = False
    """Whether its first contact is the declared one."""
    short_s: float = 0.0
    """Time by which it ends earlier than ours, seconds."""

    @property
    def loaded(self) -> bool:
        """Whether it ran without a complaint."""
        return not self.failure and not self.complaints

    @property
    def same_motion(self) -> bool:
        """Whether all actors move as in ours, to the end."""
        near = self.deviation is not None and self.deviation.distance_m <= TOLERANCE_M
        return near and self.short_s == 0.0

    def summary(self) -> dict[str, Any]:
        """All fields for result.json and metrics.json, JSON-able."""
        return self.model_dump() | {"loaded": self.loaded, "same_motion": self.same_motion}

    def lines(self) -> list[str]:
        """Messages on differences; empty where both agree."""
        if self.failure:
            return [f"{self.simulator}: did not run: {self.failure}"]
        told = [f"{self.simulator}: {complaint}" for complaint in self.complaints]
        if self.deviation and self.deviation.distance_m > TOLERANCE_M:
            where = f"{self.deviation.actor} at {self.deviation.t_s:.2f} s"
            limit = f"(limit {TOLERANCE_M} m)"
            told.append(f"{self.simulator}: {where} is {self.deviation.distance_m:.3f} m beside our playing {limit}")
        if self.short_s:
            told.append(f"{self.simulator}: ends {self.short_s:.2f} s before our playing")
        if self.declared and not self.as_declared:
            told.append(f"{self.simulator}: the first contact is not the declared one, but {_contact(self.observed)}")
        return told


def judge(simulator: Simulator, ours: Execution, scenario: Scenario, network: RoadNetwork) -> Judgement:
    """Executes in another simulator and compares. Its failure is a judgement, not an error; raises MissingTool."""
    name = type(simulator).__name__.lower()
    try:
        theirs = simulator.execute(scenario, network)
    except SimulationFailed as fault:
        return Judgement(simulator=name, failure=str(fault), declared=scenario.declared is not None)
    return compared(name, ours, theirs, scenario.declared)


def compared(name: str, ours: Execution, theirs: Execution, declared: Contact | None) -> Judgement:
    """The judgement on two executions, step by step."""
    other = {t.actor: t for t in theirs.trajectories}
    pairs = [(t, other[t.actor]) for t in ours.trajectories if t.actor in other]
    return Judgement(
        simulator=name,
        complaints=theirs.complaints,
        deviation=max((_deviation(a, b) for a, b in pairs), key=lambda d: d.distance_m, default=None),
        observed=theirs.contact,
        declared=declared is not None,
        as_declared=realised(declared, theirs.contact),
        short_s=max((round(max(0.0, float(a.t_s[-1] - b.t_s[-1])), 3) for a, b in pairs), default=0.0),
    )


def _deviation(ours: Trajectory, theirs: Trajectory) -> Deviation:
    """The deviation at the times of ours that theirs covers."""
    n = int(np.searchsorted(ours.t_s, theirs.t_s[-1] + 1e-6))
    t_s = ours.t_s[:n]
    x, y = (np.interp(t_s, theirs.t_s, values) for values in (theirs.x_m, theirs.y_m))
    away = np.hypot(ours.x_m[:n] - x, ours.y_m[:n] - y)
    k = int(away.argmax())
    return Deviation(actor=ours.actor, t_s=round(float(t_s[k]), 6), distance_m=round(float(away[k]), 6))


def _contact(contact: ObservedContact | None) -> str:
    if contact is None:
        return "none"
    return f"{contact.actor} ({contact.actor_area}) and {contact.other} ({contact.other_area}) at {contact.t_s:.2f} s"
