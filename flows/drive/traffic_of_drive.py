"""Traffic of a case in a drive: replayed on the clock of the others. It reacts to no driver, and no driver sees it.

What is told of it are the vehicles that the ego touches: an avoided crash may have been paid for with one of them.
"""

from __future__ import annotations

import numpy as np

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import Floats, Trajectory
from sgcad_core.case.traffic import Background
from sgcad_core.geometry.plane import first_overlap
from sgcad_core.handover.drive import Drive


def clock_s(drive: Drive, count: int) -> Floats:
    """(n,) time of the script at every row of a drive: that of the others, and on behind the contact."""
    later = drive.others_s[-1] + np.arange(1, count - len(drive.others_s) + 1) * STEP_S
    return np.concatenate((drive.others_s, later))[:count]


def replayed(drive: Drive, count: int) -> Background:
    """The script's traffic over so many rows of a drive; behind the end of the script it stays where it is."""
    at = clock_s(drive, count)
    t_s: Floats = np.arange(count, dtype=np.float64) * STEP_S
    return tuple((info, _at(track, at, t_s)) for info, track in drive.staging.script.background)


def _at(track: Trajectory, at: Floats, t_s: Floats) -> Trajectory:
    told = {name: np.interp(at, track.t_s, getattr(track, name)) for name in ("x_m", "y_m", "speed_mps")}
    heading = np.interp(at, track.t_s, np.unwrap(track.heading_rad))
    told["speed_mps"] = np.where(at > track.t_s[-1], 0.0, told["speed_mps"])
    return track.model_copy(update={**told, "heading_rad": heading, "t_s": t_s, "roll_rad": None})


def touched(drive: Drive) -> list[str]:
    """Vehicles of the traffic that the ego touches in its drive, the first one first."""
    ego = next(t for t in drive.trajectories if t.actor == drive.staging.ego)
    size = drive.staging.script.sizes[ego.actor]
    found: list[tuple[int, str]] = []
    for info, track in replayed(drive, len(ego.t_s)):
        hit = first_overlap(ego.pose, size, track.pose, (info.length_m, info.width_m))
        found += [] if hit is None else [(hit, info.id)]
    return [name for _, name in sorted(found)]
