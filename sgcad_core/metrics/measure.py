"""Measures one execution: the contents of metrics.json, in two readings that are never mixed.

`paper` looks from the ego (the first vehicle, V1) at every other road user; `exact` looks at every pair,
so that a crash between others is not lost. Infinite and undefined values are null with a reason.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import combinations
from typing import Any

import numpy as np

from sgcad_core.case.records import Execution, Floats, Scenario, Trajectory, sizes_of
from sgcad_core.metrics import conflict, criticality, displacement, precontact_metrics
from sgcad_core.metrics.conflict import Encroachment
from sgcad_core.metrics.swept_cells import Track
from sgcad_core.metrics.thresholds import Thresholds


def measure(execution: Execution, scenario: Scenario, thresholds: Thresholds | None = None) -> dict[str, Any]:
    """Measure an execution: {"ego", "thresholds", "paper": {...}, "exact": {...}}; SI units, JSON-able."""
    limits = thresholds or Thresholds()
    sizes = sizes_of(scenario.actors)
    tracks = {t.actor: _track(t, sizes.get(t.actor, (4.6, 1.8))) for t in execution.trajectories}
    ego = ego_of(tracks)
    motion = {t.actor: t for t in execution.trajectories}
    return {
        "ego": ego,
        "instances": len(execution.trajectories[0].t_s) if execution.trajectories else 0,
        "thresholds": limits.model_dump(),
        "paper": _paper(ego, tracks, motion, limits) if ego else {},
        "exact": _exact(ego, tracks, motion, limits) if ego else {},
    }


def ego_of(actors: Iterable[str]) -> str | None:
    """V1, else the first vehicle, else the first actor."""
    names = sorted(actors)
    vehicles = sorted((a for a in names if a[0:1] == "V" and a[1:].isdecimal()), key=lambda a: int(a[1:]))
    return next(iter([*vehicles, *names]), None)


def _track(trajectory: Trajectory, size: tuple[float, float]) -> Track:
    return Track(trajectory.t_s, trajectory.pose, displacement.velocities(trajectory), size)


def _paper(ego: str, tracks: dict[str, Track], motion: dict[str, Trajectory], limits: Thresholds) -> dict[str, Any]:
    me = tracks[ego]
    others = [t for a, t in tracks.items() if a != ego]
    n = len(me.t_s)
    distances = np.array([conflict.center_distance(me, o) for o in others]).reshape(len(others), n)
    nearest = distances.min(axis=0) if others else np.full(n, np.inf)
    hit = np.any([conflict.overlaps(me, o) for o in others], axis=0) if others else np.zeros(n, bool)
    ttc = _least([conflict.time_to_collision_paper(me, o).min() for o in others])
    pet = _soonest([conflict.post_encroachment_time_paper(me, o) for o in others])
    collision_probability = criticality.share_of_instances(hit)
    near = criticality.share_of_instances(criticality.near_miss(nearest, me.size[0], limits))
    intensity = criticality.interaction_intensity(distances, limits)
    ade, fde = displacement.constant_velocity_error(motion[ego])
    distance = _finite(float(nearest.min())) if n else None
    score = criticality.emergency_score(
        collision_probability > limits.collision_probability, ttc, pet.seconds, distance, limits
    )
    return {
        "collision_probability": collision_probability, "near_miss_probability": near,
        "time_to_collision_s": ttc, "post_encroachment_time_s": pet.seconds,
        "post_encroachment_time_reason": pet.reason, "minimum_distance_m": distance,
        "interaction_intensity_mean": float(intensity.mean()), "interaction_intensity_max": float(intensity.max()),
        "average_displacement_error_m": ade, "final_displacement_error_m": fde,
        "emergency_score": score, "emergency_level": criticality.emergency_level(score, limits),
    }  # fmt: skip


def _exact(ego: str, tracks: dict[str, Track], motion: dict[str, Trajectory], limits: Thresholds) -> dict[str, Any]:
    pairs = [(tracks[a], tracks[b]) for a, b in combinations(sorted(tracks), 2) if _counts(tracks[a], tracks[b])]
    collision = any(conflict.overlaps(a, b).any() for a, b in pairs)
    ttc = _least([conflict.time_to_collision(a, b).min() for a, b in pairs])
    pet = _soonest([conflict.post_encroachment_time(a, b) for a, b in pairs])
    needed = [conflict.required_deceleration(a, b)[: conflict.first_overlap(a, b)] for a, b in pairs]
    distance = _least([conflict.box_distance(a, b).min() for a, b in pairs])
    errors = displacement.windowed_velocity_error(motion[ego], limits.prediction_horizon_s)
    score = criticality.emergency_score(collision, ttc, pet.seconds, distance, limits)
    return {
        "collision": collision,
        "collision_speed_mps": _impact_speed(pairs),
        "time_to_collision_s": ttc,
        "time_to_collision_reason": "measured" if ttc is not None else "never on a collision course",
        "post_encroachment_time_s": pet.seconds, "post_encroachment_time_reason": pet.reason,
        "required_deceleration_mps2": _most(needed),
        "minimum_distance_m": distance,
        "average_displacement_error_m": errors[0] if errors else None,
        "final_displacement_error_m": errors[1] if errors else None,
        "emergency_score": score, "emergency_level": criticality.emergency_level(score, limits),
        **precontact_metrics.precontact_figures(tracks),
    }  # fmt: skip


def _counts(a: Track, b: Track) -> bool:
    """Whether one of the two moves; pairs that never move have no conflict."""
    return bool(np.ptp(a.pose[:, :2], axis=0).max() > 0.1 or np.ptp(b.pose[:, :2], axis=0).max() > 0.1)


def _impact_speed(pairs: list[tuple[Track, Track]]) -> float | None:
    """Relative speed over the step that ends in the first overlap of any pair, m/s.

    From positions before the contact: velocities are central differences, which would include its effect.
    """
    first: tuple[float, float] | None = None
    for a, b in pairs:
        hit = conflict.first_overlap(a, b)
        if hit is not None and (first is None or a.t_s[hit] < first[0]):
            first = float(a.t_s[hit]), float(np.hypot(*(_arriving(a, hit) - _arriving(b, hit))))
    return first[1] if first else None


def _most(values: list[Floats]) -> float | None:
    """The largest of all; None without any."""
    tops = [float(v.max()) for v in values if v.size]
    return _finite(max(tops)) if tops else None


def _arriving(track: Track, k: int) -> Floats:
    """(2,) velocity over the step that ends in instance k; of the first step for k = 0."""
    k = max(k, 1)
    step: Floats = (track.pose[k, :2] - track.pose[k - 1, :2]) / (track.t_s[k] - track.t_s[k - 1])
    return step


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _least(values: list[Any]) -> float | None:
    return _finite(float(min(values))) if values else None


def _soonest(values: list[Encroachment]) -> Encroachment:
    """The pair with the least time; a pair without a common area has none."""
    timed = [v for v in values if v.seconds is not None]
    if timed:
        return min(timed, key=lambda v: v.seconds or 0.0)
    return next((v for v in values if v.reason != "no common area"), Encroachment(None, "no common area"))
