"""The options of an actor for its maneuver, the most ordinary first.

An option is a motion with a cost (its oddity): lines within the lane, stated speeds and usual turns cost nothing,
swerves, other speeds and skids cost more. Knows one actor, its course and its meeting place.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from sgcad_core.planner.actor_plan import PUSHED_M, Drift, Pacing, Role, Twist, facing, is_standing, usual_speed
from sgcad_core.planner.approach_pace import approach_pace
from sgcad_core.planner.encounter.maneuver_choices import FROM_OTHER_LANE, OTHER_LANE, OTHER_LANE_COST, drifts, homing
from sgcad_core.planner.encounter.meeting_place import TURNING
from sgcad_core.planner.encounter.out_of_lanes import OUT, out_of_lanes, stands_out_of_lanes, starts_beside
from sgcad_core.planner.encounter.pacing_choices import pacings
from sgcad_core.planner.encounter.place_cost import cost_outside, in_junction, misfit, out_of_zone, waiting_zone
from sgcad_core.planner.lines.axle_to_box import bent_before, box_path, easiest, offset, tightest
from sgcad_core.planner.lines.box_angles import aiming, skids, slides, spins
from sgcad_core.planner.lines.crossing import implied_crossings
from sgcad_core.planner.lines.departures import leaving
from sgcad_core.planner.lines.lost_control import entering_mps, slid
from sgcad_core.planner.lines.path import Path, ramp, ramp_length_m, widened_bends
from sgcad_core.planner.lines.turning import corner_lines
from sgcad_core.planner.long_things import meets_m, runs_along
from sgcad_core.planner.motion import HARD_MPS2, Motion, Pace, drive, stand
from sgcad_core.planner.stationary_actors import (
    any_angle,
    askew,
    beside_the_way,
    in_stall,
    placed_along,
    stand_offs,
    steps_aside,
)

_SWING_ASIDE_M = 5.0
"""Lateral room for steering aside; beyond it the speed is reduced."""
_MEETS_S, _PLAIN = np.linspace(-2.5, 2.5, 11), 4
"""Own times at which nearly all encounters are, and the number of the most ordinary options."""
_LEAST_SWING, _UNBRAKED, _UNDER_WAY_M = 1.2, 0.4, 2.5
"""Radius when steering aside, over the tightest of the vehicle; cost of a contact before the stated braking is visible
or behind its end; distance after a standing start from which the vehicle counts as moving."""
_SLOWED_M = 1.0
"""Slack of the stretch on which told braking or slowing shows."""
_NOT_STOPPED, _STOPPED_M = 1.5, 0.3
"""Cost of a contact before the place where a vehicle is told to have stopped, and how near it counts as there."""


@dataclass(frozen=True, eq=False)
class Option:
    """One option of driving; its motion is computed on demand."""

    role: Role
    drift: Drift
    pacing: Pacing
    twist: Twist
    extra_cost: float = 0.0
    dodge: Drift | None = None
    """A swerve on top of its line, away from a conflict."""

    @property
    def cost(self) -> float:
        """The oddity of this option."""
        return self.drift.cost + self.pacing.cost + self.twist.cost + self.extra_cost

    @property
    def oddity(self) -> float:
        """The cost without that of another lane, since reports often state lanes wrongly."""
        elsewhere = self.drift.note in (OTHER_LANE, FROM_OTHER_LANE)
        return self.cost - (min(self.drift.cost, OTHER_LANE_COST) if elsewhere else 0.0)

    @property
    def notes(self) -> tuple[str, ...]:
        """The changes of the stated maneuver, in words."""
        said = (self.drift.note, self.pacing.note, self.twist.note)
        return tuple(f"{self.role.actor.id} {words}" for words in said if words)

    @cached_property
    def motion(self) -> Motion:
        """The motion itself."""
        return standing(self) if is_standing(self.role) else driving(self)

    def motion_with(self, other: Option) -> Motion:
        """The motion in an encounter with another option: an object is placed in its path."""
        return in_the_way(self, other) if self.role.actor.record.thing else self.motion


def options(role: Role) -> list[Option]:
    """All options of an actor, cheapest first; cached by role, so that motions are computed once."""
    if "options" not in role.kept:
        role.kept["options"] = _sorted(role, _parts(role))
    return list(role.kept["options"])


def _parts(role: Role) -> Iterable[tuple[Drift, Pacing, Twist]]:
    if role.actor.record.thing:
        return product(beside_the_way(role), (Pacing(0.0),), any_angle(role))
    if is_standing(role):
        return product(stand_offs(role), (Pacing(0.0),), askew(role))
    if role.actor.record.walks:
        return product(steps_aside(), pacings(role), (Twist(0.0),))
    return product(drifts(role), pacings(role), skids(role))


def aimed(role: Role) -> list[Option]:
    """The options that turn the wanted side to the approaching actor; all options where it already faces there."""
    angles = [] if in_stall(role) else aiming(role)
    if not angles:
        return options(role)
    if is_standing(role):
        return _sorted(role, product(stand_offs(role), (Pacing(0.0),), angles))
    return _sorted(role, product(drifts(role, fine=False), pacings(role), angles))


def plainly(role: Role) -> list[Option]:
    """The few most ordinary options: as stated, slightly slower or faster, in the next lane."""
    return [option for option in options(role) if not option.twist.angle_rad][:_PLAIN]


def steeply(role: Role) -> list[Option]:
    """Those whose change of line is steep and implied by what is told; the plain ones where none is."""
    return along(role, implied_crossings(role), pacings(role)[:3])


def turned(role: Role) -> list[Option]:
    """All lines and usual speeds of a turn; the plain options of other maneuvers."""
    turns = role.course.turn is not None and role.actor.maneuver in TURNING
    return along(role, [Drift(0.0), *corner_lines(role)] if turns else [], pacings(role))


def along(role: Role, lines: Sequence[Drift], paces: Sequence[Pacing]) -> list[Option]:
    """The options along some lines; the plain ones where there are none."""
    return _sorted(role, product(lines, paces, (Twist(0.0),))) if lines else plainly(role)


def forced(role: Role) -> list[Option]:
    """A few options through the meeting place with the wanted side ahead, however odd."""
    if role.actor.record.laneless or is_standing(role):
        return aimed(role)
    return _sorted(role, product(homing(role), pacings(role)[:2], aiming(role)[-1:] or [Twist(0.0)]))


def spun(role: Role) -> list[Option]:
    """Its line with the box at any angle, where no driving explains the sides."""
    if role.actor.record.laneless:
        return options(role)
    lines = stand_offs(role)[:1] if is_standing(role) else homing(role)[::2]
    return _sorted(role, product(lines, pacings(role)[:1], spins(role)))


def sliding(role: Role) -> list[Option]:
    """Its line with the box sliding at any angle, where no steering brings the sides together."""
    if role.actor.record.laneless or is_standing(role):
        return spun(role)
    return _sorted(role, product(homing(role)[::2], pacings(role)[:1], slides(role)))


def _sorted(role: Role, parts: Iterable[tuple[Drift, Pacing, Twist]]) -> list[Option]:
    return sorted((Option(role, *part) for part in parts), key=lambda option: option.cost)


# ------------------------------------------------------------------ making a motion
def driving(option: Option) -> Motion:
    """A motion along the road with the option's changes."""
    role, place, drift = option.role, option.role.place.station_m, option.drift
    unusual = any((drift.note, option.twist.note, option.dodge, drift.earlier, drift.yaw_rad))
    speed = entering_mps(role, option.twist, usual_speed(role) * option.pacing.factor)
    pace = replace(approach_pace(role, option.pacing, speed, unusual=unusual), off=leaving(role, drift))
    line, path, drivable = _lines(option, pace)
    path, drag, unturned, skids_from_m = slid(role, path, option.twist, pace.cruise_mps)
    time, station = drive(line, pace, place, (path, role.course.path), drag)
    drivable = drivable and (bool(drift.earlier) or not starts_beside(role, line, (time, station)))
    path = path.turned(drift.yaw(path.s_m)) if drift.yaw_rad or drift.earlier else path
    begins = min(_begins(role, drift), skids_from_m)
    penalty = misfit(role, path, drift, begins) + unturned
    if drift.left_m or drift.before_m or option.twist.angle_rad or option.dodge:
        out = out_of_lanes(role, path, (time, station))
        penalty += out
        drivable = drivable and bool(np.interp(np.interp(_MEETS_S, time, station), path.s_m, out).min() < OUT)
    if pace.starts_at_m is not None:
        penalty = penalty + 1.5 * (path.s_m < pace.starts_at_m + (PUSHED_M / 2 if role.pushed else _UNDER_WAY_M))
    if pace.slow_at_m is not None and (pace.brakes or role.side == "back"):
        until_m = pace.slow_at_m + pace.slows_on_m + _SLOWED_M
        penalty = penalty + _UNBRAKED * ((path.s_m < pace.slow_at_m - _SLOWED_M) | (path.s_m > until_m))
    if pace.stops_at_m is not None:
        penalty = penalty + _NOT_STOPPED * (path.s_m < pace.stops_at_m - _STOPPED_M)
    starts = float(time[0]) if option.pacing.from_stop and not role.pushed else None
    return Motion(path, time, station, role.size, penalty, begins, axle=line, drivable=drivable, starts_s=starts)


def _lines(option: Option, pace: Pace) -> tuple[Path, Path, bool]:
    """As `_boxed`; options whose line does not depend on the speed share it: the dearest part of a motion."""
    role, base, place = option.role, option.role.course.path, option.role.place.station_m
    of = option.drift, option.dodge, place, role.size, role.actor.kind, role.actor.maneuver
    if (bends := bool(option.twist.angle_rad) and not option.twist.skids) or of not in base.derived:
        line = _steered(option.drift.on(base, place), option, pace)
        made = _boxed(role, line if option.dodge is None else line.moved(option.dodge.profile(line.s_m)))
        if bends:
            return made
        base.derived[of] = made
    return base.derived[of]


def _boxed(role: Role, line: Path) -> tuple[Path, Path, bool]:
    """The line of the rear axle, the path of the center, with the stations of the center, and whether it can be
    driven."""
    if role.actor.record.walks:
        return line, line, True
    length, backing = role.size[0], role.actor.maneuver == "backing"
    line = widened_bends(line, tightest(length) if role.actor.maneuver == "u_turn" else easiest(length))
    path = box_path(line, length, backing=backing)
    drivable = bool(np.abs(line.curvature).max() < 1.1 * tightest(length))
    return replace(line, s_m=path.s_m), path, drivable


def _steered(line: Path, option: Option, pace: Pace) -> Path:
    """The line turned before the meeting place, unless the box skids."""
    twist, role, place = option.twist, option.role, option.role.place
    if not twist.angle_rad or twist.skids:
        return line
    least = _LEAST_SWING / tightest(role.size[0])
    near = _SWING_ASIDE_M / max(1 - math.cos(twist.angle_rad), 1e-6)
    radius = twist.radius_m or max(min(pace.cruise_mps**2 / pace.lateral_mps2, near), least)
    turned = bent_before(line, twist.angle_rad, place.station_m, radius)
    if not twist.through:
        return turned
    ahead, left = offset(line, turned, place.station_m)
    off = place.aside_m - left
    length = ramp_length_m(off, 1.7 * pace.cruise_mps, HARD_MPS2)
    end = place.station_m - ahead + place.ahead_m
    begin = end - abs(twist.angle_rad) * radius * 1.4 - 2.0
    return bent_before(line.moved(off * ramp(line.s_m, begin - length, length)), twist.angle_rad, end, radius)


def standing(option: Option) -> Motion:
    """A "motion" that enumerates places to stand at."""
    role, base = option.role, option.role.course.path
    path = base.moved(np.full(len(base.s_m), option.drift.left_m)).turned(option.twist.angle_rad)
    time, station = stand(path, role.place.station_m)
    penalty = cost_outside(path.s_m, *waiting_zone(role), out_of_zone(role))
    penalty += in_junction(role, path.s_m)
    kept, thing = not stands_out_of_lanes(role, option.drift.left_m, option.twist.angle_rad), role.actor.record.thing
    return Motion(path, time, station, role.size, penalty, -math.inf, standing=True, fixed=thing, drivable=kept)


def in_the_way(option: Option, other: Option) -> Motion:
    """Places for an object along the line that another actor takes, `left_m` beside it; a long one faces the road, not
    the box that comes, and lies beside the corner that meets it."""
    path, road, role = other.motion.path, other.role.course.path, option.role
    if runs_along(role.actor):
        along = np.interp(path.s_m, road.s_m, road.heading_rad)
        out = along + option.twist.angle_rad + (facing(role.side) if role.side else 0.0) + math.pi
        reach = meets_m(other.role.size, other.role.side, out - path.heading_rad, turned=other.twist.told)
        path = path.displaced((reach + role.size[0] / 2)[:, None] * np.column_stack((np.cos(out), np.sin(out))))
        path = replace(path, heading_rad=along)
    return placed_along(option.role, option.drift, option.twist, path, stand(path, other.role.place.station_m))


def _begins(role: Role, drift: Drift) -> float:
    """Station at which the maneuver begins to show."""
    shown = [turn.entry_m - 2.0] if (turn := role.course.turn) is not None else []
    shown += [drift.begins_m] if drift.earlier or (drift.left_m and drift.end_m > 0) else []
    return min(shown, default=role.place.station_m - (3.0 if role.actor.record.walks else 10.0))
