"""Displacement of an arm's motion from the reference arm's, since trajectories of real crashes are unknown.

Networks have different frames, so two runs are aligned at V1's pose at the first contact.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from flows.results.reading import FinishedCase, Study, paths_of
from sgcad_core.case.records import Floats
from sgcad_core.metrics.displacement import average_displacement_error, final_displacement_error
from sgcad_core.metrics.labels.motion_label_match import Path

BEFORE_S = 3.0
STEP_S = 0.05


class Displacement(NamedTuple):
    """Displacement of one case between two arms, mean over its common vehicles, metres."""

    average_m: float
    final_m: float


def displacements_from(study: Study, reference: str | None) -> dict[str, list[Displacement]]:
    """Label of each other arm -> displacement of every case that touched in both; empty without a second arm."""
    if reference is None:
        return {}
    found = {}
    for arm in study.arms:
        if arm.name != reference:
            pairs = ((study.ran[reference].get(case), ran) for case, ran in study.ran[arm.name].items())
            errors = [e for first, second in pairs if first and (e := displacement_between(first, second))]
            if errors:
                found[arm.label] = errors
    return found


def no_displacement_reason(study: Study) -> str:
    """Reason why `displacements_from` is empty."""
    if len(study.arms) < 2:
        return "There is one arm and no trajectory of the real crash, so nothing to hold it against."
    return "No case touched in the reference arm and another, so arms are not held against each other."


def displacement_between(first: FinishedCase, second: FinishedCase) -> Displacement | None:
    """Displacement of the second run from the first over the 3 s before contact; None without contact in one.

    The final displacement is that 3 s before contact, or at the earliest common instant.
    """
    tracks = [_before_contact(ran) for ran in (first, second)]
    if tracks[0] is None or tracks[1] is None:
        return None
    common = sorted(set(tracks[0]) & set(tracks[1]))
    pairs = [(tracks[1][a], tracks[0][a]) for a in common]
    pairs = [(a, b) for a, b in pairs if len(a) and len(b)]
    if not pairs:
        return None
    average = float(np.mean([average_displacement_error(a, b) for a, b in pairs]))
    return Displacement(average, float(np.mean([final_displacement_error(a, b) for a, b in pairs])))


def _before_contact(ran: FinishedCase) -> Mapping[str, Floats] | None:
    """actor -> (n, 2) places from contact backwards, in the frame of V1's pose at contact."""
    observed = (ran.result.get("collision") or {}).get("observed")
    paths = {a: p for a, p in paths_of(ran.folder, ran.result).items() if a.startswith("V")} if ran.generated else {}
    if not observed or "V1" not in paths:
        return None
    origin = _at(paths["V1"], float(observed["t_s"]))
    return {actor: _backwards(path, float(observed["t_s"]), origin) for actor, path in paths.items()}


def _at(path: Path, t_s: float) -> Floats:
    pose: Floats = path.pose[int(np.abs(path.t_s - t_s).argmin())]
    return pose


def _backwards(path: Path, t_s: float, origin: Floats) -> Floats:
    wanted = t_s - np.arange(0, BEFORE_S + STEP_S / 2, STEP_S)
    wanted = wanted[wanted >= path.t_s[0] - 1e-6]
    x, y = (np.interp(wanted, path.t_s, path.pose[:, k]) - origin[k] for k in (0, 1))
    c, s = np.cos(origin[2]), np.sin(origin[2])
    return np.column_stack((x * c + y * s, y * c - x * s))
