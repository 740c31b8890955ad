"""One member of a family: the script with other speeds, times, offsets and sizes, and the same crash.

The declared pair keeps its lines, at another pace so that both reach the place of the contact at its time (the struck
one later or earlier, if so drawn), beside their lines, in other lanes and sizes; an actor that crosses a shifted lane
comes sooner or later accordingly. A stated evasion may begin later. A clock that begins before the script continues it
straight back. A sample with another first contact is no member. After the contact the planner simulates anew. Knows
scripts and parameters; no file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from sgcad_core.case.driver_io import STEP_S, Way
from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.execution.contact import first_contact, realised
from sgcad_core.geometry.plane import Floats, Size
from sgcad_core.handover.family.discrete_parameters import PAIR
from sgcad_core.handover.family.shifted_evasion import Delay, delay_of
from sgcad_core.handover.script import Script, staging_for
from sgcad_core.kinds import mass_kg
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.aftermath.hitch import hitched
from sgcad_core.planner.aftermath.impact import body
from sgcad_core.planner.aftermath.wreck import Wreck
from sgcad_core.planner.aftermath.wreck_bodies import Mover
from sgcad_core.planner.scene import AFTER_S, sample_speeds, usual_drag
from sgcad_core.planner.towing import coupling_m

Values = Mapping[str, float]
_CREEPS_MPS = 1.0


@dataclass(frozen=True, eq=False)
class FamilyBasis:
    """A script with the undisturbed line of every actor and the time of the declared contact."""

    script: Script
    lines: Mapping[str, Way]
    contact_s: float
    coupled: Mapping[str, frozenset[str]]
    """By actor of the pair: actors that are coupled to it and move with it."""
    delays: Mapping[str, Delay] = field(default_factory=dict)
    """By actor of the pair: the possible delay of its braking before the contact."""
    crossed: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """By actor: the one whose line it crosses, and the delay on its own line a metre of that one's lane, s/m."""

    def owner(self, actor: str) -> str:
        """The actor whose parameters move an actor: itself, or the one that it is coupled to."""
        return next((n for n, with_it in self.coupled.items() if actor in with_it), actor)

    def lane_m(self, who: str, values: Values) -> float:
        """Offset of an actor of the pair to the left of the script's lane, metres."""
        return values.get(f"{who}_lane_m", 0.0) + (values.get(f"{PAIR}_lane_m", 0.0) if who in self.coupled else 0.0)

    def further_s(self, who: str, values: Values) -> float:
        """Advance of an actor on the clock of its own line at the contact, for another lane of the other one,
        seconds."""
        other, per_m = self.crossed.get(who, ("", 0.0))
        return per_m * values.get(f"{other}_lane_m", 0.0)


def basis_of(script: Script) -> FamilyBasis | None:
    """The basis of a family; None where the first contact is not the declared one, or no driver can control either."""
    contact = first_contact(script.trajectories, script.sizes)
    if script.declared is None or contact is None or not realised(script.declared, contact):
        return None
    lines: dict[str, Way] = {}
    for name in (contact.actor, contact.other):
        with_it = staging_for(script, name) if script.info(name).record.driven else None
        if with_it is not None:
            lines |= dict(with_it.lines) | {name: with_it.way}
    if len(lines) < len(script.trajectories):
        return None
    pair = contact.actor, contact.other
    coupled = {n: script.coupled_to(n) for n in pair}
    delays = {n: d for n in pair if (d := delay_of(lines[n], contact.t_s)) is not None}
    crossed = {a: (b, _crossing(lines[a], lines[b], contact.t_s)) for a, b in (pair, pair[::-1])}
    return FamilyBasis(script, lines, contact.t_s, coupled, delays, crossed)


def _crossing(line: Way, other: Way, contact_s: float) -> float:
    """Seconds on a line's clock until it meets the other's line a metre further to that one's left."""
    k = [min(round(contact_s / STEP_S), len(w.t_s) - 1) for w in (line, other)]
    speed = float(line.speed_mps[k[0]])
    step = line.pose[k[0], :2] - line.pose[max(k[0] - 1, 0), :2]
    length = float(np.hypot(*step))
    if speed < _CREEPS_MPS or length < 1e-6:
        return 0.0
    heading = float(other.pose[k[1], 2])
    return float(-step[0] * np.sin(heading) + step[1] * np.cos(heading)) / length / speed


def undisturbed(basis: FamilyBasis, values: Values) -> Script:
    """The script of a member without contacts: motion through all obstacles."""
    script = basis.script
    actors = tuple(_sized(a, values) for a in script.actors)
    tracks = tuple(_moved(basis, t.actor, values) for t in script.trajectories)
    return replace(script, actors=actors, trajectories=tracks, grip=values.get("friction"))


def member(basis: FamilyBasis, values: Values) -> Script | None:
    """The member simulated from the contact on; None where it is another crash."""
    made = undisturbed(basis, values)
    if not realised(made.declared, first_contact(made.trajectories, made.sizes)):
        return None
    settled = replace(made, trajectories=_settled(made, basis))
    return settled if realised(made.declared, first_contact(settled.trajectories, made.sizes)) else None


def with_earlier_start(made: Script, back_s: float) -> tuple[Trajectory, ...]:
    """The motion of a member with a straight run before it, so that the contact is later by `back_s`."""
    n = round(back_s / STEP_S)
    found = []
    for t in made.trajectories:
        pose = t.pose
        step = pose[1, :2] - pose[0, :2]
        run = np.repeat(pose[:1], n, axis=0)
        run[:, :2] += np.arange(-n, 0)[:, None] * step
        whole = np.vstack((run, pose))
        found.append(_trajectory(t.actor, np.round(np.arange(len(whole)) * STEP_S, 3), whole))
    return tuple(found)


def _sized(info: ActorInfo, values: Values) -> ActorInfo:
    length, width = values.get(f"{info.id}_length", 1.0), values.get(f"{info.id}_width", 1.0)
    size = {"length_m": round(info.length_m * length, 4), "width_m": round(info.width_m * width, 4)}
    return info.model_copy(update=size)


def _moved(basis: FamilyBasis, actor: str, values: Values) -> Trajectory:
    """An actor's motion at its pace, through its line, past the place of the contact."""
    line = basis.lines[actor]
    who = basis.owner(actor)
    pace, late = values.get(f"{who}_pace", 1.0), values.get(f"{who}_late_s", 0.0)
    t = np.round(np.arange(round((basis.contact_s + AFTER_S) / STEP_S) + 1) * STEP_S, 3)
    own = basis.contact_s + (t - late - basis.contact_s) * pace + basis.further_s(who, values)
    if who in basis.delays and f"{who}_reaction_s" in values:
        own = basis.delays[who].own(own, values[f"{who}_reaction_s"])
    pose = _poses(line, own)
    left = values.get(f"{who}_aside_m", 0.0) + basis.lane_m(who, values)
    pose[:, 0] -= left * np.sin(pose[:, 2])
    pose[:, 1] += left * np.cos(pose[:, 2])
    return _trajectory(actor, t, pose)


def _poses(line: Way, own: Floats) -> Floats:
    """Poses at own times; before the line begins straight back at its first speed."""
    pose = line.poses_when(own)
    before = own < 0
    if before.any() and len(line.t_s) > 1:
        step = (line.pose[1, :2] - line.pose[0, :2]) / STEP_S
        pose[before, :2] = line.pose[0, :2] + own[before, None] * step
    return pose


def _trajectory(actor: str, t: Floats, pose: Floats) -> Trajectory:
    return Trajectory(actor=actor, t_s=t, x_m=pose[:, 0].copy(), y_m=pose[:, 1].copy(),
                      heading_rad=np.unwrap(pose[:, 2]), speed_mps=sample_speeds(pose))  # fmt: skip


# ------------------------------------------------------------------ behind the contact
def _settled(made: Script, basis: FamilyBasis) -> tuple[Trajectory, ...]:
    movers = [_mover(made, t) for t in made.trajectories]
    count = len(made.trajectories[0].t_s)
    table = {t.actor: t.pose for t in made.trajectories}
    hitches = [
        hitched((tractor, trailer), table[tractor][0], table[trailer][0], coupling_m(made.sizes[tractor]))
        for tractor, with_it in basis.coupled.items()
        for trailer in with_it
    ]
    poses, _ = Wreck(tuple(movers), count, hitches).settle()
    return tuple(_trajectory(t.actor, t.t_s, poses[t.actor]) for t in made.trajectories)


def _mover(made: Script, track: Trajectory) -> Mover:
    info = made.info(track.actor)
    size: Size = (info.length_m, info.width_m)
    mass = None if info.record.thing else mass_kg(info.type, info.length_m)
    grip = min(DRIVING.sliding_mps2(made.surface), made.friction_mps2)
    return Mover(track.actor, body((0.0, 0.0, 0.0), size, mass), track.pose, usual_drag(info.type, grip))
