"""One member of a family: the script with other speeds, times, offsets and sizes, and the same crash.

Both of the declared pair keep their lines, run at another pace so that they come to the contact's place at its time
(the struck one later or earlier, if so drawn), beside their lines, in other lanes and in other sizes; whose lane is
crossed elsewhere comes as much sooner or later. A told evasion may begin later. A clock that begins earlier than the
script goes back straight. What touches otherwise than declared is no member. Behind the contact everything is settled
anew by the planner's wreck. Knows scripts and parameters; no file.
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
from sgcad_core.handover.script import Script, staged
from sgcad_core.kinds import actor_kind, mass_kg
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.aftermath.ground_friction import Drag
from sgcad_core.planner.aftermath.hitch import hitched
from sgcad_core.planner.aftermath.impact import body
from sgcad_core.planner.aftermath.wreck import Wreck
from sgcad_core.planner.aftermath.wreck_bodies import Mover
from sgcad_core.planner.scene import AFTER_S, BRAKED_MPS2, THROWN_MPS2
from sgcad_core.planner.towing import coupling_m
from sgcad_core.records.specs import ActorKind

Values = Mapping[str, float]
_CREEPS_MPS = 1.0


@dataclass(frozen=True, eq=False)
class Basis:
    """A script ready to be varied: everybody's undisturbed line, and when the declared pair meets."""

    script: Script
    lines: Mapping[str, Way]
    contact_s: float
    coupled: Mapping[str, frozenset[str]]
    """By actor of the pair: what is coupled to it and moves with it."""
    delays: Mapping[str, Delay] = field(default_factory=dict)
    """By actor of the pair: how its braking before the contact can come later."""
    crossed: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """By actor: whose line it crosses, and how much later on its own line it meets it, s a metre of that one's lane."""

    def owner(self, actor: str) -> str:
        """Whose parameters move an actor: its own, or those of what it is coupled to."""
        return next((n for n, with_it in self.coupled.items() if actor in with_it), actor)

    def lane_m(self, who: str, values: Values) -> float:
        """How far to the left of the script's lane one of the pair comes."""
        return values.get(f"{who}_lane_m", 0.0) + (values.get(f"{PAIR}_lane_m", 0.0) if who in self.coupled else 0.0)

    def further_s(self, who: str, values: Values) -> float:
        """How much further on its own line's clock one is at the contact, since the other comes in another lane."""
        other, per_m = self.crossed.get(who, ("", 0.0))
        return per_m * values.get(f"{other}_lane_m", 0.0)


def basis_of(script: Script) -> Basis | None:
    """The basis of a family; None where the script does not begin with its declared contact, or of nobody driven."""
    contact = first_contact(script.trajectories, script.sizes)
    if script.declared is None or contact is None or not realised(script.declared, contact):
        return None
    lines: dict[str, Way] = {}
    for name in (contact.actor, contact.other):
        with_it = staged(script, name) if _drivable(script, name) else None
        if with_it is not None:
            lines |= dict(with_it.lines) | {name: with_it.way}
    if len(lines) < len(script.trajectories):
        return None
    pair = contact.actor, contact.other
    coupled = {n: script.coupled_to(n) for n in pair}
    delays = {n: d for n in pair if (d := delay_of(lines[n], contact.t_s)) is not None}
    crossed = {a: (b, _crossing(lines[a], lines[b], contact.t_s)) for a, b in (pair, pair[::-1])}
    return Basis(script, lines, contact.t_s, coupled, delays, crossed)


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


def _drivable(script: Script, name: str) -> bool:
    return script.info(name).record.driven


def undisturbed(basis: Basis, values: Values) -> Script:
    """The member's script before anything touches: motion on through whatever is there."""
    script = basis.script
    actors = tuple(_sized(a, values) for a in script.actors)
    tracks = tuple(_moved(basis, t.actor, values) for t in script.trajectories)
    return replace(script, actors=actors, trajectories=tracks, grip=values.get("friction"))


def member(basis: Basis, values: Values) -> Script | None:
    """The member with everything settled behind the contact; None where it is another crash."""
    made = undisturbed(basis, values)
    if not realised(made.declared, first_contact(made.trajectories, made.sizes)):
        return None
    settled = replace(made, trajectories=_settled(made, basis))
    return settled if realised(made.declared, first_contact(settled.trajectories, made.sizes)) else None


def prolonged(made: Script, back_s: float) -> tuple[Trajectory, ...]:
    """A member's motion with so much straight run before it: its contact comes that much later on its clock."""
    n = round(back_s / STEP_S)
    found = []
    for t in made.trajectories:
        pose = np.column_stack((t.x_m, t.y_m, t.heading_rad))
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


def _moved(basis: Basis, actor: str, values: Values) -> Trajectory:
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
    pose = np.column_stack([np.interp(own, line.t_s, line.pose[:, i]) for i in range(3)])
    before = own < 0
    if before.any() and len(line.t_s) > 1:
        step = (line.pose[1, :2] - line.pose[0, :2]) / STEP_S
        pose[before, :2] = line.pose[0, :2] + own[before, None] * step
    return pose


def _trajectory(actor: str, t: Floats, pose: Floats) -> Trajectory:
    step = np.hypot(*np.diff(pose[:, :2], axis=0).T) / STEP_S
    speed = np.concatenate((step[:1], (step[1:] + step[:-1]) / 2, step[-1:]))
    return Trajectory(actor=actor, t_s=t, x_m=pose[:, 0].copy(), y_m=pose[:, 1].copy(),
                      heading_rad=np.unwrap(pose[:, 2]), speed_mps=speed)  # fmt: skip


# ------------------------------------------------------------------ behind the contact
def _settled(made: Script, basis: Basis) -> tuple[Trajectory, ...]:
    movers = [_mover(made, t) for t in made.trajectories]
    count = len(made.trajectories[0].t_s)
    table = {t.actor: np.column_stack((t.x_m, t.y_m, t.heading_rad)) for t in made.trajectories}
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
    script = np.column_stack((track.x_m, track.y_m, track.heading_rad))
    return Mover(track.actor, body((0.0, 0.0, 0.0), size, mass), script, _drag(made, info.type))


def _drag(made: Script, kind: ActorKind) -> Drag:
    """As the planner has it: struck vehicles brake along their wheels, people slide."""
    grip = min(DRIVING.sliding_mps2(made.surface), made.friction_mps2)
    if actor_kind(kind).tumbles:
        return Drag(min(THROWN_MPS2, grip), min(THROWN_MPS2, grip))
    return Drag(min(BRAKED_MPS2, grip), grip)
