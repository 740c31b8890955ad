"""Every threshold and weight of the criticality metrics in one frozen record, printed with results; limits of driving.

Values are the paper's where it gives one; where it names a constant without a value, ours stands with
its reason. Knows no metric.
"""

from __future__ import annotations

from collections.abc import Mapping

from sgcad_core.case.records import Record
from sgcad_core.records.specs import Surface


class Thresholds(Record):
    """Constants of the `paper` and `exact` readings; SI units."""

    time_to_collision_s: float = 1.0
    """theta_TTC."""
    post_encroachment_time_s: float = 1.5
    """theta_PET."""
    collision_probability: float = 0.3
    """theta_c, a share of frames."""
    distance_m: float = 2.0
    """theta_d."""
    safety_margin_m: float = 1.0
    """delta_safety of P_nm; not given in the paper: half the proximity threshold."""
    interaction_range_m: float = 50.0
    """N(t) of I(t); not given in the paper: about 3 s at urban speed."""
    interaction_floor_m: float = 1.0
    """d_min of I(t); not given in the paper: keeps one neighbour's share at or under 1 per metre."""
    prediction_horizon_s: float = 3.0
    """Horizon of the exact displacement errors, the field's usual short horizon."""
    weight_collision: float = 5.0
    weight_time_to_collision: float = 5.0
    weight_post_encroachment_time: float = 4.0
    weight_distance: float = 3.0
    level_critical: float = 10.0
    level_high: float = 6.0
    level_moderate: float = 3.0


class DrivingLimits(Record):
    """Limits of a vehicle before a contact without loss of control; SI units.

    Friction is the peak coefficient of road adhesion of J. Y. Wong, Theory of Ground Vehicles, table 1.3 (asphalt dry
    0.8 to 0.9, wet 0.5 to 0.7, snow packed 0.2, ice 0.1), sliding the coefficient of locked wheels there.
    """

    gravity_mps2: float = 9.81
    peak: Mapping[str, float] = {"dry": 0.85, "wet": 0.6, "snow": 0.2, "ice": 0.1}
    sliding: Mapping[str, float] = {"dry": 0.75, "wet": 0.5, "snow": 0.15, "ice": 0.07}
    yaw_radps: float = 1.5
    slip_deg: float = 10.0
    """Between a vehicle's heading and the way of its rear axle; beyond it tires are saturated."""

    def friction_mps2(self, surface: Surface | None) -> float:
        """Highest acceleration that tires transmit on a surface (None: dry)."""
        return self.gravity_mps2 * self.peak[surface or "dry"]

    def sliding_mps2(self, surface: Surface | None) -> float:
        """Deceleration of a body that slides over a surface."""
        return self.gravity_mps2 * self.sliding[surface or "dry"]


DRIVING = DrivingLimits()
