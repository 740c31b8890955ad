"""One member of a family: the script with other speeds, times, offsets and sizes, and the same crash.

Both of the declared pair keep their lines, run at another pace so that they come to the contact's place at its time
(the struck one later or earlier, if so drawn), beside their lines and in other sizes. A clock that begins earlier
than the script goes back straight. What touches otherwise than declared is no member. Behind the contact everything is
settled anew by the planner's wreck. Knows scripts and parameters; no file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sgcad_core.execution.contact import first_contact, realised
from sgcad_core.geometry.plane import Floats, Size
from sgcad_core.handover.script import DRIVEN, Script, staged
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.ground import Drag
from sgcad_core.planner.hitch import hitched
from sgcad_core.planner.impact import body, mass_kg
from sgcad_core.planner.movers import Mover
from sgcad_core.planner.scene import AFTER_S, BRAKED_MPS2, THROWN_MPS2
from sgcad_core.planner.towing import coupling_m
from sgcad_core.planner.wreck import Wreck
from sgcad_core.records import ActorInfo, Trajectory
from sgcad_core.seat import STEP_S, Way
from sgcad_core.specs import ActorKind

Values = Mapping[str, float]
_TUMBLE: frozenset[ActorKind] = frozenset({"pedestrian", "bicycle", "motorcycle"})


@dataclass(frozen=True, eq=False)
class Basis:
    """A script ready to be varied: everybody's undisturbed line, and when the declared pair meets."""

    script: Script
    lines: Mapping[str, Way]
    contact_s: float
    coupled: Mapping[str, frozenset[str]]
    """By actor of the pair: what is coupled to it and moves with it."""


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
    coupled = {n: script.coupled_to(n) for n in (contact.actor, contact.other)}
    return Basis(script, lines, contact.t_s, coupled)


def _drivable(script: Script, name: str) -> bool:
    return script.info(name).type in DRIVEN


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
    who = next((n for n, with_it in basis.coupled.items() if actor in with_it), actor)
    pace, late = values.get(f"{who}_pace", 1.0), values.get(f"{who}_late_s", 0.0)
    t = np.round(np.arange(round((basis.contact_s + AFTER_S) / STEP_S) + 1) * STEP_S, 3)
    own = basis.contact_s + (t - late - basis.contact_s) * pace
    pose = _poses(line, own)
    left = values.get(f"{who}_aside_m", 0.0)
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
    mass = None if info.type == "object" else mass_kg(info.type, size)
    script = np.column_stack((track.x_m, track.y_m, track.heading_rad))
    return Mover(track.actor, body((0.0, 0.0, 0.0), size, mass), script, _drag(made, info.type))


def _drag(made: Script, kind: ActorKind) -> Drag:
    """As the planner has it: struck vehicles brake along their wheels, people slide."""
    grip = min(DRIVING.sliding_mps2(made.surface), made.friction_mps2)
    if kind in _TUMBLE:
        return Drag(min(THROWN_MPS2, grip), min(THROWN_MPS2, grip))
    return Drag(min(BRAKED_MPS2, grip), grip)
