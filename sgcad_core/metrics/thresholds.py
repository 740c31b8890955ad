"""Every threshold and weight of the criticality metrics in one frozen record, printed with each result.

Values are the paper's where it gives one; where it names a constant without a value, ours stands with
its reason. Knows no metric.
"""

from __future__ import annotations

from sgcad_core.records import Record


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
