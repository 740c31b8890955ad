"""Criticality of an execution: collision and near-miss probability, interaction intensity, S_e, levels.

Functions of arrays and numbers that `conflict` measures; thresholds come in as a record.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from sgcad_core.case.records import Floats
from sgcad_core.metrics.thresholds import Thresholds

Level = Literal["critical", "high", "moderate", "low"]


def share_of_instances(events: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> float:
    """P_c and P_nm of the paper: instances with the event over all instances (so it depends on the clock's length)."""
    return float(events.mean()) if events.size else 0.0


def near_miss(
    distance_m: Floats, length_m: float, thresholds: Thresholds
) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """d(t) < L_vehicle + delta_safety, one value an instance."""
    return distance_m < length_m + thresholds.safety_margin_m


def interaction_intensity(distances_m: Floats, thresholds: Thresholds) -> Floats:
    """I(t) of the paper, 1/m: sum over actors in range of 1 / max(d_j, d_min); distances are (actors, n)."""
    if not distances_m.size:
        return np.zeros(distances_m.shape[-1])
    near = distances_m <= thresholds.interaction_range_m
    total: Floats = np.where(near, 1 / np.maximum(distances_m, thresholds.interaction_floor_m), 0.0).sum(axis=0)
    return total


def emergency_score(
    collision: bool,
    time_to_collision_s: float | None,
    post_encroachment_time_s: float | None,
    distance_m: float | None,
    thresholds: Thresholds,
) -> float:
    """S_e of the paper: weighted sum of four indicators; None stands for "not met"."""
    met = (
        (thresholds.weight_collision, collision),
        (thresholds.weight_time_to_collision, _below(time_to_collision_s, thresholds.time_to_collision_s)),
        (thresholds.weight_post_encroachment_time,
         _below(post_encroachment_time_s, thresholds.post_encroachment_time_s)),
        (thresholds.weight_distance, _below(distance_m, thresholds.distance_m)),
    )  # fmt: skip
    return float(sum(weight for weight, is_met in met if is_met))


def emergency_level(score: float, thresholds: Thresholds) -> Level:
    """The paper's four levels of S_e."""
    if score >= thresholds.level_critical:
        return "critical"
    if score >= thresholds.level_high:
        return "high"
    return "moderate" if score >= thresholds.level_moderate else "low"


def _below(value: float | None, threshold: float) -> bool:
    return value is not None and value < threshold
