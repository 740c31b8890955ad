"""The input of one actor to the planning of an encounter, and its usual driving.

Knows one actor, its course and its meeting place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from sgcad_core.geometry.plane import SIDES, Floats, Size
from sgcad_core.metrics.rest_error import compass_rad
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner.encounter.meeting_place import STANDING, TURNING, Place, stop_m
from sgcad_core.planner.lines.actor_course import Course
from sgcad_core.planner.lines.path import Path, ramp
from sgcad_core.planner.motion import ACCELERATION_MPS2
from sgcad_core.planner.told_pace import BACKS_MPS, free_speed
from sgcad_core.records.course import CourseTold, sense_of
from sgcad_core.records.specs import Actor, Area, Surface
from sgcad_core.units import MPS_PER_MPH

IN_STALL_M = -1.0
"""Station of the middle of a box whose rear axle stands where the way out of its stall begins."""
BRAKED_TO = 0.72
"""Share of the speed that is left at the contact after braking: there is seldom time for more."""
PUSHED_M, BACKS_M = 0.8, 5.0
"""Distance that a standing actor rolls when it is pushed into another one; that which one backs along its lane."""
_QUEUE_M = 2.0
"""Between two that start from rest one behind the other."""
_AGAINST, _ONE_WAY_RAD = 0.8, 0.6
"""Cosine of the angle between two that come against each other; angle between two that drive in one direction."""
_SLIGHT_MPS = 6.5
"""Of two whose ways cross in a slight blow, and of one that passes from rest, at most."""
_STEEP_DEG = 60.0
"""Bearing of a vehicle alongside that is to be hit with the front."""


@dataclass(frozen=True)
class Role:
    """One actor in the planning of an encounter."""

    actor: Actor
    course: Course
    size: Size
    place: Place
    side: Area | None = None
    """The side on which the contact is declared."""
    other_mps: float = 0.0
    """Speed of the other one."""
    other_width_m: float = 1.8
    other_side: Area | None = None
    other_road: str | None = None
    """The road on which the other one starts."""
    surface: Surface | None = None
    other_spins: bool = False  # the report states how the impact turns the other one
    may_skid: bool = False  # the report states a loss of control
    other_parked: bool = False  # beside the lanes
    other_lost: bool = False  # the report states a loss of control of the other one
    other_moves_up_m: float = 0.0  # to its stop
    pushed: bool = False
    """Whether it stands until right before the contact, and is then set rolling into the other one."""
    told: CourseTold = field(default_factory=CourseTold)  # beside its maneuver
    goes_on: bool = False  # strikes something else after this contact
    other_long_m: float = 0.0
    """Depth of the other one where it is a thing that runs along the road; 0 of others."""
    other_leaves: int = 0
    """The hand on which the other one leaves the road: 1 left, -1 right; 0: it stays on it."""
    untouched: bool = False  # touches nothing, and nothing is near it
    leaves_lanes: bool = False
    """Whether it may drive out of its lanes untold: where the pair meets in no other way."""

    @cached_property
    def kept(self) -> dict[str, Any]:
        """Results computed once for this role."""
        return {}

    @property
    def glances(self) -> bool:
        """Whether it leaves the road or goes on to a further contact, which a full impact would prevent."""
        return self.goes_on or self.told.rest.where in ("off_road", "shoulder", "median")

    @property
    def spins(self) -> float:
        """Sense in which the impact turns it: 1 counter-clockwise, -1 clockwise; less where only the stated facing asks
        for it."""
        if self.told.spin:
            return float(sense_of(self.told.spin))
        if self.told.rest.facing_deg is None or self.actor.record.thing:
            return 0.0
        came = float(self.course.path.poses([self.place.station_m])[0, 2])
        turn = math.remainder(compass_rad(self.told.rest.facing_deg) - came, 2 * math.pi)
        return math.copysign(0.6, turn) if math.radians(50) < abs(turn) < math.radians(170) else 0.0

    @property
    def skids_as_told(self) -> float:
        """Sense in which it is told to turn out of control before the contact, as in `spins`."""
        return float(self.may_skid * sense_of(self.told.yaws))

    @property
    def grip_mps2(self) -> float:
        """Highest acceleration that tires transmit on the surface."""
        return DRIVING.friction_mps2(self.surface)


class Swing(NamedTuple):
    """A part of a line: to the left by `left_m` over `length_m`, ending at a station, the box turned by `yaw_rad`."""

    left_m: float
    length_m: float
    end_m: float
    yaw_rad: float = 0.0


class Drift(NamedTuple):
    """A change of line: to the left by `left_m` over `length_m`, ending at a station; `back`: and back again."""

    cost: float
    left_m: float = 0.0
    length_m: float = 30.0
    end_m: float = 0.0
    back: bool = False
    before_m: float = 0.0
    """Beside its lane already before the change (a lane that it comes from), metres to the left."""
    ahead_m: float = 0.0
    """Displaced along the heading at the meeting place as well (a course bent towards the other one's)."""
    note: str = ""
    holds_m: float = 0.0
    """Length between the change and the way back, where it goes `back`."""
    evades: bool = False
    """Whether it is the evasion that the report states."""
    earlier: tuple[Swing, ...] = ()
    """Told moves before this one; `left_m` is counted from the line before all of them."""
    yaw_rad: float = 0.0
    """Angle by which the box turns against its line meanwhile, in a told skid."""

    @property
    def begins_m(self) -> float:
        """The station at which it begins."""
        first = self.earlier[0] if self.earlier else self
        return first.end_m - first.length_m

    def profile(self, s_m: Floats) -> Floats:
        """(n,) metres to the left of the undisturbed line at stations."""
        rise = ramp(s_m, self.end_m - self.length_m, self.length_m)
        if self.back:
            rise = rise - ramp(s_m, self.end_m + self.holds_m, self.length_m)
        gone = sum(swing.left_m for swing in self.earlier)
        profile: Floats = self.before_m + (self.left_m - gone) * rise
        for swing in self.earlier:
            profile = profile + swing.left_m * ramp(s_m, swing.end_m - swing.length_m, swing.length_m)
        return profile

    def yaw(self, s_m: Floats) -> Floats:
        """(n,) angle of the box against its line at stations, radians."""
        angle: Floats = self.yaw_rad * ramp(s_m, self.end_m - self.length_m, self.length_m)
        for swing in self.earlier:
            angle = angle + swing.yaw_rad * ramp(s_m, swing.end_m - swing.length_m, swing.length_m)
        return angle

    def on(self, base: Path, place_m: float) -> Path:
        """A line with this change on it; `ahead_m` is measured along the heading at the station `place_m`."""
        if self.ahead_m:
            heading = float(base.poses([place_m])[0, 2])
            c, s = math.cos(heading), math.sin(heading)
            by = np.array([self.ahead_m * c - self.left_m * s, self.ahead_m * s + self.left_m * c])
            return base.displaced(ramp(base.s_m, self.end_m - self.length_m, self.length_m)[:, None] * by)
        return base.moved(self.profile(base.s_m)) if self.left_m or self.before_m or self.earlier else base


class Pacing(NamedTuple):
    """A choice of speed: factor on the usual one, or from a standing start."""

    cost: float
    factor: float = 1.0
    from_stop: bool = False
    note: str = ""


class Twist(NamedTuple):
    """A box turned before contact: steered aside, in a skid, or standing askew."""

    cost: float
    angle_rad: float = 0.0
    note: str = ""
    skids: bool = False
    """The box turns against its line; else the line turns with it."""
    told: bool = False
    """It skids in the told sense, from the loss of control into the contact."""
    through: bool = False
    """It swings out to the other side first, so that it still passes through the meeting place."""
    radius_m: float | None = None
    """Of the bend; None: as tight as the speed allows."""


def is_standing(role: Role) -> bool:
    """Whether the actor does not move before contact."""
    return role.actor.maneuver in STANDING or role.actor.record.thing


def usual_speed(role: Role) -> float:
    """Stated speed, else the limit as far as the kind of actor goes, m/s."""
    actor = role.actor
    top = free_speed(role.told.pace, role.course.limit_mps, actor.record.pace_mps)
    if actor.speed_mph:
        return max(actor.speed_mph * MPS_PER_MPH, 1.0)
    if actor.maneuver == "backing":
        return BACKS_MPS[role.told.pace]
    slow = role.told.slight and abs(role.place.angle_rad) > _ONE_WAY_RAD and not is_standing(role)
    slow = slow or (role.told.from_rest and actor.maneuver == "overtaking")
    return min(top, _SLIGHT_MPS if slow else 11.0 if actor.maneuver in TURNING else top)


def speed_there(role: Role) -> float:
    """Usual speed at the meeting place: turning traffic has slowed down."""
    if is_standing(role) or role.told.stops:
        return 0.0
    speed = min(usual_speed(role), 6.5) if role.actor.maneuver in TURNING else usual_speed(role)
    if role.told.from_rest:
        speed = min(speed, math.sqrt(2 * ACCELERATION_MPS2 * max(role.place.station_m - start_m(role), 1.0)))
    return BRAKED_TO * speed if role.told.brakes and not role.told.speed_at_impact else speed


def mismatch(role: Role) -> float:
    """From the wanted side's bearing to that from which the other one comes, radians in [-pi, pi], in its own frame as
    both pass the meeting place at their usual speeds."""
    if role.side is None or role.actor.record.thing:
        return 0.0
    bearing = _bearing_along(role) if along_with(role) else _bearing_across(role)
    return 0.0 if bearing is None else math.remainder(bearing - facing(role.side), 2 * math.pi)


def along_with(role: Role) -> bool:
    """Whether both drive in one direction, so that their speeds decide which one is behind."""
    return abs(role.place.angle_rad) < _ONE_WAY_RAD and not is_standing(role) and role.other_mps > 0


def comes_against(role: Role) -> bool:
    """Whether the other one comes the opposite way, within 37 degrees."""
    return math.cos(role.place.angle_rad) < -_AGAINST


def is_beside(side: Area | None) -> bool:
    """Whether a side is left or right."""
    return side in ("left", "right")


def _bearing_along(role: Role) -> float | None:
    """Ahead of the one behind, behind the one ahead; None where they run side by side."""
    own, other = role.side, role.other_side
    if own == "front" and is_beside(other):
        return math.radians(-_STEEP_DEG if other == "left" else _STEEP_DEG)
    if "back" not in (own, other) or own == other:
        return None
    return math.pi if own == "back" else 0.0


def _bearing_across(role: Role) -> float | None:
    angle, other = role.place.angle_rad, role.other_mps
    ahead, left = speed_there(role) - other * math.cos(angle), -other * math.sin(angle)
    return None if math.hypot(ahead, left) < 3.0 else math.atan2(left, ahead)


def facing(side: Area) -> float:
    """Bearing of a side as seen from its box, radians left of ahead."""
    return SIDES.index(side) * math.pi / 2


def starts_at_m(role: Role, pacing: Pacing) -> float | None:
    """The station up to which it stands; None without a standing start."""
    return role.place.station_m - PUSHED_M if role.pushed else start_m(role) if pacing.from_stop else None


def start_m(role: Role) -> float:
    """The station at which an actor that starts from rest stands: at its line, or behind the one that it runs into."""
    if role.actor.maneuver == "backing" and not role.course.stalls:
        return role.place.station_m - BACKS_M
    queued_m = (role.size[0] + _QUEUE_M + role.other_moves_up_m) * _waits_behind(role)
    if role.course.turn is not None:
        return stop_m(role.course.turn.entry_m - role.course.queued_m, role.size[0]) - queued_m
    return line_m(role) if role.course.stalls else min(line_m(role), role.place.station_m - 6.0) - queued_m


def _waits_behind(role: Role) -> bool:
    """Whether it starts from rest behind the one that it runs into."""
    starts = role.told.from_rest and not is_standing(role) and abs(role.place.angle_rad) < _ONE_WAY_RAD
    passes = role.actor.maneuver == "overtaking" and role.other_mps == 0.0
    return starts and (passes or (role.side, role.other_side) == ("front", "back"))


def line_m(role: Role) -> float:
    """The station of its center at the last stop line before the meeting place; in its stall when backing out."""
    if role.course.stalls and role.actor.maneuver == "backing":
        return IN_STALL_M
    entries = [p.entry_m for p in role.course.passages if p.entry_m < role.place.station_m]
    return stop_m(entries[-1] - role.course.queued_m if entries else role.place.station_m - 6.0, role.size[0])
