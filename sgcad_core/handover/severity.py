"""Severity of a contact: closing speed, change of velocity of both, energy, and risk of death.

`severity`: one impulse at the first touch, planar with restitution and friction
(`sgcad_core.planner.aftermath.impact`); the same for the script and for a drive, which ends at its contact, so that
they can be compared. `executed_severity`: of the motion through the contact, as it was executed. Masses are typical of
kind and length. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import ActorInfo, ObservedContact, Record, Trajectory
from sgcad_core.geometry.plane import Size
from sgcad_core.kinds import actor_kind, mass_kg
from sgcad_core.planner.aftermath.impact import FRICTION, RESTITUTION, Body, body, collide
from sgcad_core.planner.aftermath.wreck_bodies import center_of, separation, touch_points
from sgcad_core.records.specs import ActorKind
from sgcad_core.units import MPS_PER_MPH

MPH_PER_MPS = 1 / MPS_PER_MPH
_PULSE = 2
"""Samples from the first overlap until a crush is over: 0.1 s, as at a pole (`sgcad_core.planner.aftermath.crush`)."""


class Struck(Record):
    """Effect of a contact on one actor."""

    actor: str
    speed_mps: float
    """On the ground, before."""
    delta_v_mps: float
    """Change of the center's velocity."""
    delta_v_ahead_mps: float
    """Its part along the heading, negative: slowed."""
    risk: float | None
    """Of a fatal injury (see `fatality_risk`); None: an object."""


class Severity(Record):
    """A contact in figures."""

    closing_mps: float
    """Relative speed of the centers."""
    energy_j: float
    """Kinetic energy that the contact took."""
    first: Struck
    second: Struck

    @property
    def worst_delta_v_mps(self) -> float:
        """The larger change of velocity of both."""
        return max(self.first.delta_v_mps, self.second.delta_v_mps)

    def of(self, actor: str) -> Struck:
        """The effect on one of the two actors."""
        return self.first if self.first.actor == actor else self.second


def severity(contact: ObservedContact, trajectories: Sequence[Trajectory], infos: Mapping[str, ActorInfo]) -> Severity:
    """The figures of a first contact, from the motion of both up to the sample before it."""
    return _found(contact, trajectories, infos, lambda pair: exchanged(pair[0], pair[1]))


def executed_severity(
    contact: ObservedContact, trajectories: Sequence[Trajectory], infos: Mapping[str, ActorInfo]
) -> Severity:
    """The figures of a first contact, from the motion of both before it and behind its pulse."""
    track = {t.actor: t for t in trajectories}

    def changed(pair: Sequence[Body]) -> list[tuple[float, float]]:
        found = []
        for one, name in zip(pair, (contact.actor, contact.other), strict=True):
            vx, vy = one.vx, one.vy
            if not infos[name].record.thing:
                one.vx, one.vy, one.spin = _velocity(track[name], _sample(track[name], contact.t_s) + _PULSE)
            found.append((one.vx - vx, one.vy - vy))
        return found

    return _found(contact, trajectories, infos, changed)


def _found(
    contact: ObservedContact, trajectories: Sequence[Trajectory], infos: Mapping[str, ActorInfo],
    change: Callable[[Sequence[Body]], Sequence[tuple[float, float]]],
) -> Severity:  # fmt: skip
    """The figures of a contact; `change` gives both bodies their motion after it, and the changes of velocity."""
    track, names = {t.actor: t for t in trajectories}, (contact.actor, contact.other)
    pair = [_body(track[name], infos[name], contact.t_s) for name in names]
    before, energy = [(b.vx, b.vy) for b in pair], sum(b.energy for b in pair)
    changes = change(pair)
    closing = math.hypot(before[0][0] - before[1][0], before[0][1] - before[1][1])
    struck = [_struck(infos[n], b, v, c, closing) for n, b, v, c in zip(names, pair, before, changes, strict=True)]
    return Severity(
        closing_mps=closing, energy_j=max(energy - sum(b.energy for b in pair), 0.0), first=struck[0], second=struck[1]
    )


def exchanged(
    first: Body, second: Body, restitution: float = RESTITUTION, friction: float = FRICTION
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Exchanges the momentum of two touching bodies at once; the changes of velocity of their centers, m/s."""
    before = [(b.vx, b.vy) for b in (first, second)]
    at = center_of(touch_points(first, second))
    collide(first, second, at, separation(first, second).normal, restitution, friction)
    changes = [(b.vx - v[0], b.vy - v[1]) for b, v in zip((first, second), before, strict=True)]
    return changes[0], changes[1]


def _body(track: Trajectory, info: ActorInfo, t_s: float) -> Body:
    """A box at the contact with the velocity that it had until the sample before."""
    k = _sample(track, t_s)
    a, b = max(k - 2, 0), max(k - 1, min(1, len(track.t_s) - 1))
    size: Size = (info.length_m, info.width_m)
    mass = None if info.record.thing else mass_kg(info.type, info.length_m)
    made = body((float(track.x_m[k]), float(track.y_m[k]), float(track.heading_rad[k])), size, mass)
    if b > a and mass is not None:
        step = (b - a) * STEP_S
        made.vx, made.vy = float(track.x_m[b] - track.x_m[a]) / step, float(track.y_m[b] - track.y_m[a]) / step
        made.spin = float(track.heading_rad[b] - track.heading_rad[a]) / step
    return made


def _sample(track: Trajectory, t_s: float) -> int:
    return min(max(round(t_s / STEP_S), 0), len(track.t_s) - 1)


def _velocity(track: Trajectory, k: int) -> tuple[float, float, float]:
    """The velocity and the spin from a sample to the next one."""
    k = min(k, len(track.t_s) - 2)
    if k < 0:
        return 0.0, 0.0, 0.0
    dx, dy = track.x_m[k + 1] - track.x_m[k], track.y_m[k + 1] - track.y_m[k]
    turned = math.remainder(float(track.heading_rad[k + 1] - track.heading_rad[k]), 2 * math.pi)
    return float(dx) / STEP_S, float(dy) / STEP_S, turned / STEP_S


def _struck(
    info: ActorInfo, body: Body, before: tuple[float, float], change: tuple[float, float], closing: float
) -> Struck:
    delta = math.hypot(*change)
    along = change[0] * math.cos(body.heading) + change[1] * math.sin(body.heading)
    risk = None if info.record.thing or info.record.pulled else fatality_risk(info.type, delta, closing)
    return Struck(actor=info.id, speed_mps=math.hypot(*before), delta_v_mps=delta, delta_v_ahead_mps=along, risk=risk)


def fatality_risk(kind: ActorKind, delta_v_mps: float, closing_mps: float) -> float:
    """Probability that the contact kills: of a vehicle's driver, of a pedestrian or cyclist that is struck.

    Occupants: (delta-v / 71 mph)^4, H. C. Joksch, Velocity change and fatality risk in a crash: a rule of thumb,
    Accident Analysis and Prevention 25 (1993) 103. People: 1 / (1 + exp(6.9 - 0.090 v)) with v the impact speed in
    km/h, E. Rosen, U. Sander, Pedestrian fatality risk as a function of car impact speed, ibid. 41 (2009) 536.
    """
    if actor_kind(kind).exposed:
        return 1 / (1 + math.exp(6.9 - 0.090 * closing_mps * 3.6))
    return min((delta_v_mps * MPH_PER_MPS / 71.0) ** 4, 1.0)
