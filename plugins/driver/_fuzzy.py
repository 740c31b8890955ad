"""The fuzzy safety model (FSM): gentle braking in anticipation, hard braking only if nothing else avoids the contact.

Proposed for UN R157 by K. Mattas, G. Albano, R. Dona et al., Driver models for the definition of safety requirements of
automated vehicles in international regulations: application to motorway driving conditions, Accident Analysis and
Prevention 174 (2022) 106743, on the metrics of K. Mattas et al., Fuzzy Surrogate Safety Metrics for real-time
assessment of rear-end collision risk, ibid. 148 (2020) 105794; taken into the 01 series of amendments to UN R157
(ECE/TRANS/WP.29/2022/59/Rev.1), Annex 3, Appendix 3. Written from those formulas; parameters are theirs.

Proactive (PFS): may the one ahead brake at once? With u the own and l the other's speed along the way, t the reaction
time, d the gap less a margin:
    safe    u t + u^2 / (2 b_min) - l^2 / (2 b_l) + margin
    unsafe  u t + u^2 / (2 b_max) - l^2 / (2 b_l)
Critical (CFS): if both go on as they do (own acceleration a, not under -b_min, during t; u' = u + a t):
    safe    (u + a t / 2 - l) t + (u' - l)^2 / (2 b_min)
    unsafe  (u + a t / 2 - l) t + (u' - l)^2 / (2 b_max)
Each is 0 beyond the safe gap, 1 under the unsafe one, linear between. Answer: CFS (b_max - b_min) + b_min where
CFS > 0, else PFS b_min. Only a road user in the strip, or one that reaches it before the ego has passed, counts (the
lateral check). A driver that has reacted once stays alert: it holds its speed while no braking is needed, and brakes
again without another reaction time, as in the authors' own program (github.com/ec-jrc/JRC-FSM).
"""

from __future__ import annotations

from dataclasses import dataclass, field

from sgcad_core.case.driver_io import STEP_S, Task, View
from sgcad_core.handover.foresight import Ahead, users_ahead


@dataclass(frozen=True)
class FuzzyParameters:
    """The published figures."""

    reaction_s: float = 0.75
    gentle_mps2: float = 4.0
    hard_mps2: float = 6.0
    leader_mps2: float = 7.0
    margin_m: float = 2.0
    safe_margin_m: float = 2.0
    headway_margin_s: float = 0.1
    jerk_mps3: float = 12.65
    braking_mps2: float = 0.774 * 9.81


def proactive(gap_m: float, own: float, other: float, config: FuzzyParameters) -> float:
    """PFS of [0, 1]: how far the ego could not stop behind a vehicle ahead that brakes at once."""
    gap = gap_m - config.margin_m
    run = own * config.reaction_s - other**2 / (2 * config.leader_mps2)
    safe = run + own**2 / (2 * config.gentle_mps2) + config.safe_margin_m
    return _between(gap, safe, run + own**2 / (2 * config.hard_mps2))


def critical(gap_m: float, own: float, other: float, acceleration: float, config: FuzzyParameters) -> float:
    """CFS of [0, 1]: how far the ego would touch a vehicle ahead that keeps its speed."""
    if own <= other:
        return 0.0
    a, t = max(acceleration, -config.gentle_mps2), config.reaction_s
    then = own + a * t
    if then < other:
        return 1.0 if gap_m < (own - other) ** 2 / abs(2 * a) else 0.0
    run = (own + a * t / 2 - other) * t
    return _between(
        gap_m, run + (then - other) ** 2 / (2 * config.gentle_mps2), run + (then - other) ** 2 / (2 * config.hard_mps2)
    )


def _between(gap: float, safe: float, unsafe: float) -> float:
    if gap >= safe:
        return 0.0
    return 1.0 if gap <= unsafe else (safe - gap) / (safe - unsafe)


@dataclass
class Fuzzy:
    """The fuzzy safety model's state: reaction time, present deceleration and last speed."""

    task: Task
    config: FuzzyParameters = field(default_factory=FuzzyParameters)
    _since_s: float | None = None
    _braking_mps2: float = 0.0
    _before_mps: float | None = None

    def brake(self, view: View) -> float | None:
        """Deceleration until the next instant, m/s2, positive; None before the reaction."""
        own = view.ego.speed_mps
        acceleration = 0.0 if self._before_mps is None else (own - self._before_mps) / STEP_S
        self._before_mps = own
        wanted = max((self._answer(a, own, acceleration) for a in self._counting(view)), default=0.0)
        if self._since_s is None and wanted > 0.0:
            self._since_s = view.t_s
        if self._since_s is None or view.t_s < self._since_s + self.config.reaction_s - 1e-9:
            return None
        most = min(self._braking_mps2 + self.config.jerk_mps3 * STEP_S, self.config.braking_mps2)
        self._braking_mps2 = min(wanted, most)
        return self._braking_mps2

    def _counting(self, view: View) -> list[Ahead]:
        return [a for a in users_ahead(self.task, view) if a.gap_m > -view.ego.length_m and self._lateral(view, a)]

    def _lateral(self, view: View, a: Ahead) -> bool:
        """The lateral check: in the strip, or there before the ego has passed (headways with a margin of 0.1 s)."""
        if a.aside_m <= 0:
            return True
        if a.closing_mps <= 0:
            return False
        nearing = view.ego.speed_mps - a.along_mps
        passed = a.gap_m + view.ego.length_m + a.user.length_m
        return nearing > 0 and a.aside_m / a.closing_mps <= passed / nearing + self.config.headway_margin_s

    def _answer(self, a: Ahead, own: float, acceleration: float) -> float:
        gap, other = max(a.gap_m, 0.0), max(a.along_mps, 0.0)
        if a.along_mps < 0:  # oncoming: the gap closes at both speeds, of which only the own one can be braked away
            gap = max(gap + a.along_mps * own / max(own - a.along_mps, 1e-6), 0.0)
        sure = critical(gap, own, other, acceleration, self.config)
        if sure > 0:
            return sure * (self.config.hard_mps2 - self.config.gentle_mps2) + self.config.gentle_mps2
        return proactive(gap, own, other, self.config) * self.config.gentle_mps2
