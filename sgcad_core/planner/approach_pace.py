"""How fast an actor comes to its encounter: as usual, braking or slowing until it, standing there, or at a told speed.

Knows one actor and its meeting place; no lines and no other actor's motion.
"""

from __future__ import annotations

from dataclasses import replace

from sgcad_core.planner.actor_plan import BRAKED_TO, Pacing, Role, along_with, starts_at_m, usual_speed
from sgcad_core.planner.encounter.meeting_place import turns_off
from sgcad_core.planner.motion import Pace

_SLOWS_M, _RIGHT_BEFORE_M, _CRAWLS_MPS, _SLOW_S = (3.0, 15.0), 12.0, 1.5, 2.0
"""Distance before its place at which a vehicle is slow; before one right before a junction; how slow at least, and the
time for which a slower one is."""
_SLOWED_TO, _NEARLY_STOPPED = 0.35, 0.15
"""Shares of the speed to which one slows that is struck; and one that the blow pushes into another, short of which it
would else have stopped."""
_BRAKED_ON_TO, _IMPACT_SLACK = 0.4, 0.9
"""Share of the speed down to which told braking goes on until the contact; the same of a speed told at the impact."""
_AS_FAST_AS_BEHIND = 1.3
"""Untold speed of one that slows, over that of the one that drives behind it, at most."""
_TURNS_MPS, _U_TURNS_MPS, _LEAST_TURN_MPS = 6.5, 4.5, 3.0


def approach_pace(role: Role, pacing: Pacing, speed: float, *, unusual: bool) -> Pace:
    """The pace of one choice of speed, m/s. `unusual`: its line or its box departs from ordinary driving."""
    told = role.actor.speed_mph is not None
    usual = _U_TURNS_MPS if role.actor.maneuver == "u_turn" else _TURNS_MPS
    curve = max(usual * pacing.factor, speed if told else _LEAST_TURN_MPS)
    starts = starts_at_m(role, pacing)
    pace = Pace(speed, curve, starts, grip_mps2=role.grip_mps2, hard=told or unusual, stops_at_m=stops_at_m(role))
    if role.actor.maneuver == "slowing" and not role.untouched:
        return _slowing(role, pace)
    return _braking(role, pace) if role.told.brakes else pace


def stops_at_m(role: Role) -> float | None:
    """The station at which it stands at its contact after its maneuver; None of one that still moves."""
    return role.place.station_m if role.told.stops and not role.untouched else None


def _braking(role: Role, pace: Pace) -> Pace:
    """Braking until the contact; from a higher speed where the told one is that of the impact."""
    speed, at = pace.cruise_mps, role.place.station_m - role.size[0] / 2 - 1.0
    if role.told.speed_at_impact:
        pace = replace(pace, cruise_mps=speed / BRAKED_TO)
        return replace(pace, slow_at_m=at, slow_mps=speed, least_mps=_IMPACT_SLACK * speed, brakes=True)
    slowed, least = (max(share * speed, min(speed, _CRAWLS_MPS)) for share in (BRAKED_TO, _BRAKED_ON_TO))
    return replace(pace, slow_at_m=at, slow_mps=slowed, least_mps=least, brakes=True)


def _slowing(role: Role, pace: Pace) -> Pace:
    """Slower and slower until the contact, from no more than the speed of the one behind that strikes it."""
    speed, struck = pace.cruise_mps, role.side == "back"
    if struck and along_with(role) and role.actor.speed_mph is None:
        speed = min(speed, max(_AS_FAST_AS_BEHIND * role.other_mps, _CRAWLS_MPS))
    slowed = (_NEARLY_STOPPED if struck and role.goes_on else _SLOWED_TO) * speed
    before_m, cruise = _SLOWS_M[_before_junction(role)], speed
    if slowed < _CRAWLS_MPS and struck and not role.goes_on:  # it slows to that speed, from that of the one behind
        slowed, cruise = speed, max(speed, min(usual_speed(role), role.other_mps))
    slowed = max(slowed, min(speed, _CRAWLS_MPS))
    least = min(speed, _CRAWLS_MPS) if struck else slowed  # one that strikes keeps what speed it has
    at = role.place.station_m - (min(before_m, _SLOW_S * slowed) if struck else before_m)
    return replace(
        pace, cruise_mps=cruise, slow_at_m=at, slow_mps=slowed, least_mps=min(slowed, least), brakes=role.told.brakes
    )


def _before_junction(role: Role) -> bool:
    """Whether its place lies right before a junction that it goes straight through."""
    entries = (p.entry_m - role.place.station_m for p in role.course.passages if p.is_junction)
    return not turns_off(role.course) and any(0.0 < away < _RIGHT_BEFORE_M for away in entries)
