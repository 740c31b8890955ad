"""What starts the others: the ego's time to the conflict, or how near its body has come. Knows a staging; no XML."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.geometry.plane import box_gaps
from sgcad_core.handover.script import Staging

MOVES_MPS = 0.5
"""A slower ego stands: it has no time to the conflict."""
LEAST_M = 1.0
"""Nearest place of the conflict: on a shorter way a time to it means nothing."""
MARGIN = 1.01
"""By so much later than scripted the time to the conflict may be, so that an ego at the scripted speed starts all at
once, whatever a player rounds."""
NEARER = 0.7
"""Share of the clearance at the start at which the others start in any case."""
LEAD_ROWS = 2
"""Rows (0.1 s) for which the others wait in any case: before, players know the speed of the file and not the driver's.
So they stand where the script has them then, and no driver at the scripted speed notices."""
FAR_M = 3.0
"""Least clearance at the start from which coming nearer tells anything."""


@dataclass(frozen=True)
class Cue:
    """The start of the others' motion, by what the ego does."""

    place: Pose
    """Where the conflict is: the ego's origin there."""
    contact_s: float
    """Time from the cue to the conflict, if both go on as in the report."""
    to_conflict_s: float | None
    """The ego's time to that place, straight and at its present speed, from which on they move; None: from the start
    on, since the ego stands (or backs) at first."""
    lead_rows: int
    """Rows of the script that the others leave out."""
    other: str
    """The actor that it meets, or empty."""
    clearance_m: float | None
    """Clearance of both bodies from which on they move in any case."""


@lru_cache(maxsize=2)
def cue_of(staging: Staging, ahead_m: float) -> Cue:
    """The cue of a staging; the last ones are remembered. `ahead_m`: from the ego's origin to the center of its box."""
    other, contact_s = _conflict(staging)
    way = staging.way
    row = min(round(contact_s / STEP_S), len(way.pose) - 1)
    there, lead = _origin(way.pose[row], ahead_m), min(LEAD_ROWS, max(row - 1, 0))
    start, speed = _origin(way.pose[lead], ahead_m), float(way.speed_mps[lead])
    away = float(np.hypot(there.x_m - start.x_m, there.y_m - start.y_m))
    ahead = (there.x_m - start.x_m) * np.cos(start.heading_rad) + (there.y_m - start.y_m) * np.sin(start.heading_rad)
    if min(speed, float(way.speed_mps[0])) < MOVES_MPS or away < LEAST_M or ahead <= 0:
        return Cue(there, contact_s, None, 0, other, None)
    gap = _clearance_m(staging, other) if other else 0.0
    near = round(NEARER * gap, 1) if gap > FAR_M else None
    return Cue(there, contact_s, round(MARGIN * away / speed + STEP_S, 3), lead, other, near)


def _conflict(staging: Staging) -> tuple[str, float]:
    """The actor that the ego meets, and when: contact, else closest approach; without others the end."""
    if staging.contact is not None:
        pair = (staging.contact.actor, staging.contact.other)
        return next(name for name in pair if name != staging.ego), staging.contact.t_s
    nearest = [(*_nearest(staging, name), name) for name in staging.lines if name not in staging.coupled]
    if not nearest:
        return "", staging.contact_s
    _, row, name = min(nearest)
    return name, row * STEP_S


def _nearest(staging: Staging, name: str) -> tuple[float, int]:
    """Least clearance of an actor in the script, and its row."""
    gaps = _gaps(staging, name, round(staging.contact_s / STEP_S) + 1)
    return float(gaps.min()), int(gaps.argmin())


def _clearance_m(staging: Staging, name: str) -> float:
    return float(_gaps(staging, name, 1)[0])


def _gaps(staging: Staging, name: str, rows: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    mine, theirs = staging.way.pose, staging.lines[name].pose
    n = min(len(mine), len(theirs), rows)
    sizes = staging.script.sizes
    return np.asarray(box_gaps(mine[:n], sizes[staging.ego], theirs[:n], sizes[name]))


def _origin(pose: np.ndarray[tuple[int], np.dtype[np.float64]], ahead_m: float) -> Pose:
    x, y, heading = (float(v) for v in pose)
    return Pose(x - ahead_m * float(np.cos(heading)), y - ahead_m * float(np.sin(heading)), heading)
