"""The outcome of a drive against the script: avoided, mitigated, unchanged, worse, or lost.

    avoided     the conflict came about and the ego touched no actor
    mitigated   the ego touched an actor, clearly softer than in the script
    unchanged   as hard as in the script, within the margins of `Margins`
    worse       clearly harder
    lost        the ego never came into the conflict, so that nothing can be credited to its driver

Whether the conflict came about is decided on the clock: had the ego gone on from the release in step with the others,
in proportion to the scripted speeds, it would have touched. Knows drives; no plugin.
"""

from __future__ import annotations

import math
from typing import Any, Literal, NamedTuple

import numpy as np

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import Floats, ObservedContact, Record, Trajectory
from sgcad_core.execution.contact import realised
from sgcad_core.geometry.plane import arc_lengths, box_gaps
from sgcad_core.handover.drive import Drive
from sgcad_core.handover.rules_of_drive import rules_of_drive
from sgcad_core.handover.severity import Severity, severity
from sgcad_core.metrics import conflict, displacement
from sgcad_core.metrics.swept_cells import Track
from sgcad_core.rules.records import RuleFinding

Outcome = Literal["avoided", "mitigated", "unchanged", "worse", "lost"]
OUTCOMES: tuple[Outcome, ...] = ("avoided", "mitigated", "unchanged", "worse", "lost")
_BRAKES_MPS2 = 1.0
"""Deceleration beyond the script's that counts as braking."""
_GRAIN_S = 0.05


class Margins(Record):
    """Margins of "clearly softer" or "harder", by the larger delta-v of the pair."""

    share: float = 0.1
    least_mps: float = 0.5


class DriveResult(Record):
    """The result of a drive: the figures of tables and drive.json."""

    ego: str
    outcome: Outcome
    reason: str
    as_declared: bool | None
    """Whether the contact is the declared pair with the declared sides; None where none is declared."""
    contact: ObservedContact | None
    severity: Severity | None
    scripted: Severity | None
    """Of the ego's contact in the script."""
    braked_s: float | None
    """Beginning of braking before the contact or, without one, before the closest approach."""
    braked_at_ttc_s: float | None
    hardest_mps2: float
    closest_m: float
    """Least clearance to any actor that is not coupled to the ego."""
    least_ttc_s: float | None
    pet_s: float | None
    pet_reason: str
    lag_s: float
    elsewhere: ObservedContact | None
    rules: tuple[RuleFinding, ...] = ()
    """Traffic rules, of every actor in the drive up to its first contact."""


def judge_drive(drive: Drive, margins: Margins | None = None) -> DriveResult:
    """Judges a drive."""
    staging, script = drive.staging, drive.staging.script
    infos = {a.id: a for a in script.actors}
    scripted = severity(staging.contact, script.trajectories, infos) if staging.contact else None
    now = severity(drive.contact, drive.trajectories, infos) if drive.contact else None
    outcome, reason = _outcome(drive, now, scripted, margins or Margins())
    near = _nearness(drive)
    nearest = int(near.clearance_m.argmin())
    onset = _braking(drive)
    until = drive.contact.t_s if drive.contact else float(drive.ego.t_s[nearest])
    seen = near.ttc_s[onset] if onset is not None else math.inf
    return DriveResult(
        ego=staging.ego, outcome=outcome, reason=reason,
        as_declared=realised(script.declared, drive.contact) if script.declared else None,
        contact=drive.contact, severity=now, scripted=scripted,
        braked_s=None if onset is None else round(until - onset * STEP_S, 3),
        braked_at_ttc_s=_finite(seen), hardest_mps2=round(float(max(-drive.accelerations.min(initial=0.0), 0.0)), 3),
        closest_m=round(float(near.clearance_m[nearest]), 3), least_ttc_s=_finite(float(near.ttc_s.min())),
        pet_s=near.pet.seconds, pet_reason=near.pet.reason,
        lag_s=round(drive.clock.lag_s, 3), elsewhere=drive.elsewhere, rules=rules_of_drive(drive),
    )  # fmt: skip


def _finite(value: float) -> float | None:
    return round(float(value), 3) if math.isfinite(value) else None


# ------------------------------------------------------------------ the verdict
def _outcome(drive: Drive, now: Severity | None, scripted: Severity | None, margins: Margins) -> tuple[Outcome, str]:
    if now is None:
        why = _lost(drive)
        return ("lost", why) if why else ("avoided", "the conflict came about and nobody was touched")
    if scripted is None:
        return "worse", "the script has no contact of the ego"
    before, after = scripted.worst_delta_v_mps, now.worst_delta_v_mps
    slack = max(margins.share * before, margins.least_mps)
    told = f"delta-v {after:.1f} m/s, in the script {before:.1f} m/s"
    if after < before - slack:
        return "mitigated", told
    return ("worse" if after > before + slack else "unchanged"), told


def _lost(drive: Drive) -> str:
    """The reason why the conflict never came about; empty where it did."""
    clock = drive.clock
    if drive.staging.contact is None:
        return "the ego has no contact in the script"
    if not clock.released:
        return "the ego never came near enough for the others to be released"
    if drive.staging.way.speed_mps.max() < 0.1:  # it stands in the script: the others come to it
        return ""
    return "" if _would_touch(drive) else f"at the release the ego was {clock.lag_s:+.2f} s off the others' clock"


def _would_touch(drive: Drive) -> bool:
    """Whether the ego, in step with the others, would have touched its partner of the script."""
    staging, clock = drive.staging, drive.clock
    contact = staging.contact
    other = contact.other if contact and contact.actor == staging.ego else contact.actor if contact else ""
    t = np.arange(0.0, 3 * clock.release_s + 4.0, _GRAIN_S)
    begun = staging.contact_s - clock.release_s
    mine = staging.way.poses_when(begun + clock.lag_s + clock.rate * t)
    theirs = staging.lines[other].poses_when(begun + clock.rate * t)
    sizes = staging.script.sizes
    return bool((box_gaps(mine, sizes[staging.ego], theirs, sizes[other]) <= 0).any())


# ------------------------------------------------------------------ figures on the way
def _track(t: Trajectory, size: tuple[float, float]) -> Track:
    return Track(t.t_s, t.pose, displacement.velocities(t), size)


class _Nearness(NamedTuple):
    """(n,) clearance (m) and time to collision (s), the least over all others; PET with the one that comes nearest."""

    clearance_m: Floats
    ttc_s: Floats
    pet: conflict.Encroachment


def _nearness(drive: Drive) -> _Nearness:
    sizes, staging = drive.staging.script.sizes, drive.staging
    ego = _track(drive.ego, sizes[staging.ego])
    clearance, ttc = np.full((2, len(ego.t_s)), math.inf)
    pet = conflict.Encroachment(None, "no common area")
    for t in drive.trajectories:
        if t.actor == staging.ego or t.actor in staging.coupled:
            continue
        other = _track(t, sizes[t.actor])
        ttc = np.minimum(ttc, conflict.time_to_collision(ego, other))
        gap = conflict.box_distance(ego, other)
        if gap.min() < clearance.min():
            pet = conflict.post_encroachment_time(ego, other)
        clearance = np.minimum(clearance, gap)
    return _Nearness(clearance, ttc, pet)


def _braking(drive: Drive) -> int | None:
    """The step at which the ego began to brake harder than the report's driver at the same place."""
    way = drive.staging.way
    own = np.interp(arc_lengths(drive.ego.points), way.s_m, way.t_s)  # script time at the places of the ego
    scripted = np.interp(own, way.t_s, np.gradient(way.speed_mps, STEP_S) if len(way.speed_mps) > 1 else way.speed_mps)
    harder = np.flatnonzero(drive.accelerations < scripted - _BRAKES_MPS2)
    return int(harder[0]) if len(harder) else None


def time_series(drive: Drive) -> dict[str, Any]:
    """Time series: TTC, clearance, acceleration of the ego, script time of the others; rounded, None: infinite."""
    near = _nearness(drive)
    return {
        "t_s": [round(float(t), 2) for t in drive.ego.t_s],
        "time_to_collision_s": [_finite(float(v)) for v in near.ttc_s],
        "clearance_m": [_finite(float(v)) for v in near.clearance_m],
        "acceleration_mps2": [round(float(v), 3) for v in drive.accelerations],
        "others_script_s": [round(float(v), 3) for v in drive.others_s],
    }
