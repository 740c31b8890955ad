"""UN R157's careful and competent human driver: perceive for 0.4 s, decide, wait for 0.75 s, brake to 0.774 g.

UN Regulation No. 157 (ECE/TRANS/WP.29/2020/81), Annex 4, Appendix 3, paragraph 3.3 and its table "performance models
for vehicles": the risk is perceived where another vehicle's center has left its line by 0.375 m (cutting in, or out),
is evaluated for 0.4 s, is acted on 0.75 s after that, and 0.774 g is reached 0.6 s later (12.65 m/s3); what
counts as a danger is a time to collision under 2 s. The regulation (its 01 series of amendments has it in Annex 3)
speaks of lanes of a motorway.
For crossing and oncoming traffic the lane is replaced by the strip that the ego sweeps on its way, and a road user that
comes towards it by 0.375 m is a risk; the regulation does not contain this step.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from sgcad_core.case.driver_io import STEP_S, Task, View
from sgcad_core.handover.foresight import Ahead, meetings, users_ahead


@dataclass(frozen=True)
class CarefulParameters:
    """The regulation's figures."""

    wander_m: float = 0.375
    evaluation_s: float = 0.4
    delay_s: float = 0.75
    critical_s: float = 2.0
    jerk_mps3: float = 12.65
    braking_mps2: float = 0.774 * 9.81


@dataclass
class Careful:
    """The careful and competent driver's state: risks perceived so far, and whether braking is decided."""

    task: Task
    config: CarefulParameters = field(default_factory=CarefulParameters)
    _came_m: dict[str, float] = field(default_factory=dict)
    _seen_s: dict[str, float] = field(default_factory=dict)
    _decided_s: float | None = None
    _braking_mps2: float = 0.0

    def brake(self, view: View) -> float | None:
        """Deceleration until the next instant, m/s2, positive; None while the driver does not brake."""
        if self._decided_s is None and self._critical(view, self._perceived(view)):
            self._decided_s = view.t_s
        if self._decided_s is None or view.t_s < self._decided_s + self.config.delay_s - 1e-9:
            return None
        self._braking_mps2 = min(self._braking_mps2 + self.config.jerk_mps3 * STEP_S, self.config.braking_mps2)
        return self._braking_mps2

    def _perceived(self, view: View) -> set[str]:
        """Road users that have been a risk for at least the evaluation time."""
        risks = {a.user.actor for a in users_ahead(self.task, view) if self._risk(view, a)}
        self._seen_s = {name: self._seen_s.get(name, view.t_s) for name in risks}
        return {n for n, since in self._seen_s.items() if view.t_s - since >= self.config.evaluation_s - 1e-9}

    def _risk(self, view: View, a: Ahead) -> bool:
        """Whether a road user is in the ego's strip and slower, or has come towards it by more than vehicles wander."""
        name = a.user.actor
        self._came_m[name] = self._came_m.get(name, 0.0) + a.closing_mps * STEP_S if a.closing_mps > 0 else 0.0
        if a.aside_m <= 0:
            return a.along_mps < view.ego.speed_mps
        return self._came_m[name] > self.config.wander_m

    def _critical(self, view: View, perceived: set[str]) -> bool:
        """Whether boxes touch within 2 s on present courses; a vehicle that goes along in the strip stays in it."""
        if not perceived:
            return False
        if any(m.user.actor in perceived for m in meetings(self.task, view, self.config.critical_s)):
            return True
        return any(a.user.actor in perceived and self._closes_in(view, a) for a in users_ahead(self.task, view))

    def _closes_in(self, view: View, a: Ahead) -> bool:
        """The regulation's time to collision, along the lane: gap over speed difference."""
        nearing = view.ego.speed_mps - a.along_mps
        stays = a.aside_m <= 0 and a.along_mps > abs(a.closing_mps)
        return stays and 0 <= a.gap_m <= nearing * self.config.critical_s
