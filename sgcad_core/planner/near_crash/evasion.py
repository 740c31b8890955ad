"""Evasive changes of a motion: braking, accelerating, steering aside.

A reaction begins at an own time of the motion; its strength is a share of the most that a driver does. The motion
before it is unchanged. Knows one actor and not the conflict. SI units.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import CHANGES
from sgcad_core.planner.actor_plan import Drift, Role
from sgcad_core.planner.encounter.motion_options import Option
from sgcad_core.planner.lines.path import ramp_length_m
from sgcad_core.planner.motion import STEP_S, Motion
from sgcad_core.records.specs import EvasiveManeuver, Maneuver

MOST_STEER_M = 4.2
"""Sideways at most: a lane and a little."""
SLIGHT_STEER_M = 1.2
"""Sideways at most while braking: within the lane and its edge."""
_FIRM, _ACCELERATES = 0.6, 0.35
"""Shares of the friction for braking (dry: 5 m/s2) and for accelerating; steering takes what `Pace` plans with."""
_MOST_ACCELERATION_MPS2 = 3.0
"""More than most cars can do at the speeds of traffic."""
_EASE = 1.15
"""Length of the lane change over the shortest for a usual swerve of 6 m/s2."""
_SWERVE_MPS2 = 6.0
_OVER_CRUISE = 1.35
"""Highest speed when accelerating, over the planned one."""
_LASTS_S = 14.0
_PASSES_S = 2.0
"""Time beside the other one before the way back into the lane."""
_WORDS: dict[EvasiveManeuver, str] = {
    "none": "does not evade", "braking": "brakes", "steering": "steers aside", "steering_left": "steers left",
    "steering_right": "steers right", "braking_and_steering": "brakes and steers aside",
    "braking_and_steering_left": "brakes and steers left", "braking_and_steering_right": "brakes and steers right",
    "accelerating": "accelerates",
}  # fmt: skip


CROSSES: Maneuver = "crossing_centerline"


class Reaction(NamedTuple):
    """The reaction of a driver from an own time on; shares 0 (nothing) to 1 of the most that a driver does."""

    from_s: float
    braking: float = 0.0
    accelerating: float = 0.0
    left_m: float = 0.0
    """Sideways, to the left; the whole of it."""
    down_to_mps: float = 0.0
    """Braking ends at this speed."""
    stays: bool = False
    """Whether it stays where it steered to; else it comes back on its line."""
    hard: float = 1.0
    """Factor on the usual share of the friction that braking takes."""

    def scaled(self, share: float) -> Reaction:
        """A share of this reaction, from the same time on."""
        return self._replace(
            braking=share * self.braking, accelerating=share * self.accelerating, left_m=share * self.left_m
        )

    def braking_mps2(self, grip_mps2: float) -> float:
        """Deceleration on a surface of some grip."""
        return self.braking * self.hard * _FIRM * grip_mps2

    def accelerating_mps2(self, grip_mps2: float) -> float:
        """Acceleration on a surface of some grip."""
        return self.accelerating * min(_ACCELERATES * grip_mps2, _MOST_ACCELERATION_MPS2)


def reacted(option: Option, motion: Motion, reaction: Reaction) -> Motion:
    """The motion of an option with a reaction; the part before it and the clock are unchanged."""
    if reaction.left_m:
        motion = _steered(option, motion, reaction)
    grip = option.role.grip_mps2
    slower, faster = reaction.braking_mps2(grip), reaction.accelerating_mps2(grip)
    if slower or faster:
        motion = _paced(motion, reaction, faster - slower)
    begins = float(motion.stations([reaction.from_s])[0])
    return replace(motion, begins_m=min(motion.begins_m, begins))


def _steered(option: Option, motion: Motion, reaction: Reaction) -> Motion:
    """The option with a swerve added, as long as friction asks; its clock agrees with the motion at the beginning."""
    station, ahead = (float(s) for s in motion.stations([reaction.from_s, reaction.from_s + STEP_S]))
    speed = (ahead - station) / STEP_S
    length = ramp_length_m(reaction.left_m, _EASE * speed, _SWERVE_MPS2)
    holds = _PASSES_S * speed
    dodge = Drift(
        0.0, reaction.left_m, length, station + length, back=not reaction.stays, holds_m=holds, note="steers aside"
    )
    steered = replace(option, dodge=dodge).motion
    late = steered.time_at(station) - reaction.from_s
    return replace(steered, time_s=steered.time_s - late)


def _paced(motion: Motion, reaction: Reaction, gain_mps2: float) -> Motion:
    """The same line at another pace from the reaction on, in bends never faster than planned (when accelerating: a
    third)."""
    line = motion.axle or motion.path
    along = line.lengths
    before = motion.time_s < reaction.from_s
    station = float(motion.stations([reaction.from_s])[0])
    at = _integrated(motion, reaction, gain_mps2, float(np.interp(station, line.s_m, along)))
    stations = np.interp(at, along, line.s_m)
    times = reaction.from_s + STEP_S * np.arange(len(stations))
    rises = np.append(True, np.diff(stations) > 1e-9)
    last = stations[-1] + np.array([1e-6])
    return replace(
        motion,
        time_s=np.concatenate((motion.time_s[before], times[rises], times[-1:] + 600.0)),
        station_m=np.concatenate((motion.station_m[before], stations[rises], last)),
    )


def _integrated(motion: Motion, reaction: Reaction, gain_mps2: float, start_m: float) -> Floats:
    """Distance along the line of the rear axle at each step from the reaction on, metres."""
    own = reaction.from_s + STEP_S * np.arange(round(_LASTS_S / STEP_S) + 1)
    line = motion.axle or motion.path
    usual_m = np.interp(motion.stations(own), line.s_m, line.lengths)
    usual_mps = np.gradient(usual_m, own)
    most = usual_mps * (_OVER_CRUISE if gain_mps2 > 0 else 1.0)
    speed, at = float(usual_mps[0]), start_m
    floor = min(reaction.down_to_mps, speed)
    found = [at]
    for _ in own[1:]:
        wanted = max(speed + gain_mps2 * STEP_S, floor)
        new = min(wanted, max(float(np.interp(at, usual_m, most)), floor))
        at += (speed + new) / 2 * STEP_S
        speed = new
        found.append(at)
    return np.array(found)


def returns_m(option: Option, maneuver: EvasiveManeuver) -> float:
    """How far to the left an evasion leads back into the lane from which it began to change, or over the middle of the
    road; 0 for others."""
    role = option.role
    change = 1 if role.actor.maneuver == CROSSES else CHANGES.get(role.actor.maneuver, 0)
    if not change or not maneuver.endswith("steering_right" if change > 0 else "steering_left"):
        return 0.0
    return -option.drift.left_m if role.actor.maneuver == CROSSES else -change * role.course.lane_width_m


def told_of(role: Role, maneuver: EvasiveManeuver, done: Reaction, onset_s: float) -> str:
    """The evasion of one actor, its strength and its beginning, in words."""
    how = [
        f"{a:.1f} m/s2" for a in (done.braking_mps2(role.grip_mps2), done.accelerating_mps2(role.grip_mps2)) if a > 0.05
    ]
    how += [f"{abs(done.left_m):.1f} m aside"] if done.left_m else []
    words = _WORDS[maneuver]
    if maneuver.endswith("steering"):
        words = words.replace("steers aside", "steers left" if done.left_m > 0 else "steers right")
    return f"{role.actor.id} {words} from {onset_s:.1f} s before the conflict on: {', '.join(how)}"
