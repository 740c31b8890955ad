"""Displacement errors: between two trajectories, and of a constant-velocity prediction.

The error of the simplest predictor measures how much happens, since crashes worth testing are hard to predict. Knows no
interaction.
"""

from __future__ import annotations

import numpy as np

from sgcad_core.case.records import Floats, Trajectory


def average_displacement_error(predicted: Floats, truth: Floats) -> float:
    """ADE of the paper: mean Euclidean distance over the common steps of two (n, 2) tracks, metres."""
    n = min(len(predicted), len(truth))
    return float(np.hypot(*(predicted[:n] - truth[:n]).T).mean())


def final_displacement_error(predicted: Floats, truth: Floats) -> float:
    """FDE of the paper: Euclidean distance at the last common step, metres."""
    n = min(len(predicted), len(truth))
    return float(np.hypot(*(predicted[n - 1] - truth[n - 1])))


def velocities(trajectory: Trajectory) -> Floats:
    """(n, 2) velocities by central differences of the positions, m/s."""
    if len(trajectory.t_s) < 2:
        return np.zeros((len(trajectory.t_s), 2))
    return np.gradient(trajectory.points, trajectory.t_s, axis=0)


def constant_velocity_error(trajectory: Trajectory) -> tuple[float, float]:
    """`paper` reading: ADE and FDE of one prediction from the first instance to the last, metres."""
    truth = trajectory.points
    predicted = truth[0] + np.outer(trajectory.t_s - trajectory.t_s[0], velocities(trajectory)[0])
    return average_displacement_error(predicted, truth), final_displacement_error(predicted, truth)


def windowed_velocity_error(trajectory: Trajectory, horizon_s: float) -> tuple[float, float] | None:
    """`exact` reading: ADE and FDE over every window of the horizon, averaged, metres; None if it is too short.

    The reading of prediction benchmarks: independent of how long the clock runs.
    """
    dt = float(trajectory.t_s[1] - trajectory.t_s[0]) if len(trajectory.t_s) > 1 else 0.0
    steps = round(horizon_s / dt) if dt else 0
    truth, speed = trajectory.points, velocities(trajectory)
    starts = len(truth) - steps
    if steps < 1 or starts < 1:
        return None
    ahead = np.arange(1, steps + 1)
    index = np.arange(starts)[:, None] + ahead
    predicted = truth[:starts, None] + speed[:starts, None] * (ahead * dt)[None, :, None]
    error = np.hypot(*np.moveaxis(predicted - truth[index], -1, 0))
    return float(error.mean()), float(error[:, -1].mean())
