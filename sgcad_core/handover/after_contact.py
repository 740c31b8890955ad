"""What follows the contact that ends a drive: bodies push each other, slide and stop, as behind a scripted contact.

For pages only: figures of a drive end at the ego's contact. The mechanics are those of the planner's aftermath. Knows a
drive; no page.
"""

from __future__ import annotations

import numpy as np

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import Trajectory
from sgcad_core.geometry.plane import Floats
from sgcad_core.handover.drive import Drive
from sgcad_core.kinds import mass_kg
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.aftermath.hitch import hitched
from sgcad_core.planner.aftermath.impact import body
from sgcad_core.planner.aftermath.wreck import Wreck
from sgcad_core.planner.aftermath.wreck_bodies import Mover
from sgcad_core.planner.scene import sample_speeds, usual_drag
from sgcad_core.planner.towing import coupling_m

SHOWN_S = 3.0
"""Time that is added behind the contact."""


def with_aftermath(drive: Drive) -> tuple[Trajectory, ...]:
    """The motion of a drive with what follows its contact; as it is without one."""
    if drive.contact is None or len(drive.ego.t_s) < 2:
        return drive.trajectories
    tables = {t.actor: np.vstack((t.pose, _further(drive, t))) for t in drive.trajectories}
    script, ego = drive.staging.script, drive.staging.ego
    count = len(tables[ego])
    movers = tuple(_mover(drive, name, table) for name, table in tables.items())
    hitches = [
        hitched((ego, trailer), tables[ego][0], tables[trailer][0], coupling_m(script.sizes[ego]))
        for trailer in drive.staging.coupled
        if script.info(trailer).record.pulled and trailer in tables
    ]
    poses, _ = Wreck(movers, count, hitches).settle()
    t_s = np.round(np.arange(count) * STEP_S, 3)
    return tuple(_longer(t, t_s, poses[t.actor]) for t in drive.trajectories)


def _further(drive: Drive, track: Trajectory) -> Floats:
    """(m, 3) poses behind the drive as if there were no contact: others on their lines, the ego straight on."""
    ahead = np.arange(1, round(SHOWN_S / STEP_S) + 1)
    if track.actor == drive.staging.ego or track.actor in drive.staging.coupled:
        found: Floats = track.pose[-1] + ahead[:, None] * (track.pose[-1] - track.pose[-2]) * np.array([1.0, 1.0, 0.0])
        return found
    rate = drive.clock.rate or 1.0
    own: Floats = np.asarray(float(drive.others_s[-1]) + ahead * STEP_S * rate, dtype=np.float64)
    return drive.staging.lines[track.actor].poses_when(own)


def _mover(drive: Drive, name: str, table: Floats) -> Mover:
    script = drive.staging.script
    info = script.info(name)
    mass = None if info.record.thing else mass_kg(info.type, info.length_m)
    grip = min(DRIVING.sliding_mps2(script.surface), script.friction_mps2)
    return Mover(name, body((0.0, 0.0, 0.0), (info.length_m, info.width_m), mass), table, usual_drag(info.type, grip))


def _longer(track: Trajectory, t_s: Floats, poses: Floats) -> Trajectory:
    """The motion with new samples behind its own."""
    n = len(track.t_s)
    speeds = np.concatenate((track.speed_mps, sample_speeds(poses)[n:]))
    heading = np.concatenate((track.heading_rad, np.unwrap(np.append(track.heading_rad[-1], poses[n:, 2]))[1:]))
    return Trajectory(actor=track.actor, t_s=t_s, x_m=np.append(track.x_m, poses[n:, 0]),
                      y_m=np.append(track.y_m, poses[n:, 1]), heading_rad=heading, speed_mps=speeds)  # fmt: skip
