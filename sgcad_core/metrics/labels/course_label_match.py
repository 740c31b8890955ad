"""The course of an executed crash against labels: maneuvers of every kind, lanes, speeds, evasion, rest, later impacts.

All marks follow from the motion and the roads; statements of the run are not used. docs/metrics.md lists the fields and
their rules. Only fields that a label states are marked.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import Floats, wrap_angle
from sgcad_core.metrics.labels.course_labels import POINT_DEG, CourseLabel, RestLabel, VehicleLabel
from sgcad_core.metrics.labels.motion_label_match import STILL_M, maneuver_shown
from sgcad_core.metrics.labels.observed_crash import STEP_S, Crash, VehicleMotion
from sgcad_core.metrics.rest_error import SPINS_RAD
from sgcad_core.records.course import RestTold, Steering, sense_of
from sgcad_core.units import MPS_PER_MPH

ASIDE_M = 0.8
"""Lateral offset from the lane of a lane change or a crossed line."""
BRAKES_MPS2, BRAKES_MPS = 2.0, 1.2
"""Least deceleration over half a second, and least loss of speed, of visible braking."""
STEERS_M, STEERS_RAD = 0.25, math.radians(3.0)
"""Least lateral offset, or heading against the lane, of visible steering."""
_OVER_LIMIT_MPS, _SLOW_LIMIT_SHARE = 1.0, 0.6
"""Least excess over the limit of what is told to be fast; share of the limit that what is slow may reach."""
_BACKS_MPS = 3.0
"""What one that backs seldom exceeds."""
_LEFTWARD = ("lane_change_left", "crossing_centerline", "overtaking", "departing_road_left")
_SPIN_S = 2.5


def course_marks(label: CourseLabel, crash: Crash | None) -> dict[str, list[float]]:
    """field -> a mark of each vehicle of which the label states it (of the case, for `later_impacts`).

    1 right, 0 wrong, or a share; a case without output (`crash` None) is wrong everywhere.
    """
    found: dict[str, list[float]] = {}
    for actor, vehicle in label.vehicles.items():
        for name, mark in _vehicle(actor, vehicle, crash):
            found.setdefault(name, []).append(mark)
    if len(label.impacts) > 1:
        found["later_impacts"] = [float(crash is not None and _in_order(label.impacts, crash))]
    return found


def vehicle_marks(label: CourseLabel, crash: Crash | None) -> dict[str, dict[str, float]]:
    """The same marks by vehicle, to inspect a case."""
    return {actor: dict(_vehicle(actor, vehicle, crash)) for actor, vehicle in label.vehicles.items()}


def _vehicle(actor: str, label: VehicleLabel, crash: Crash | None) -> Iterator[tuple[str, float]]:
    there = crash is not None and actor in crash.paths
    for name, judge in _JUDGES.items():
        if judge.stated(label):
            mark = judge.right(label, VehicleMotion(crash, actor)) if there and crash is not None else 0.0
            if mark is not None:
                yield name, float(mark)
    told = _rest_told(label.rest)
    if told is not None:
        marks = VehicleMotion(crash, actor).rest(told) if there and crash is not None else _all_wrong(told)
        yield "rest", float(all(marks.values()))
        yield from ((f"rest_{name}", float(right)) for name, right in marks.items())


def _rest_told(label: RestLabel) -> RestTold | None:
    facing = POINT_DEG[label.facing] if label.facing else None
    side = label.side if label.where not in ("road", "intersection") else None
    told = RestTold(facing, label.where, side)  # type: ignore[arg-type]
    return None if facing is None and label.where is None else told


def _all_wrong(told: RestTold) -> dict[str, bool]:
    names = {"facing": told.facing_deg, "where": told.where, "side": told.side}
    return {name: False for name, value in names.items() if value is not None}


# ------------------------------------------------------------------ fields
def _maneuver(label: VehicleLabel, one: VehicleMotion) -> bool | None:
    """Whether the path up to the first contact shows the maneuver; None for `other`."""
    kind, moved = label.maneuver, one.moved_m(label.maneuver)
    aside = _aside(one, 1.0 if kind in _LEFTWARD else -1.0)
    if (told := maneuver_shown(kind, moved, one.turned_deg())) is not None:
        return told
    if kind == "negotiating_curve":
        return moved >= STILL_M
    if kind == "slowing":
        return _slows(one)
    if kind == "backing":
        ahead = np.diff(one.before[:, :2], axis=0) @ np.array([math.cos(one.before[0, 2]), math.sin(one.before[0, 2])])
        return float(ahead.sum()) < -0.5
    if kind in _LEFTWARD:
        return aside > ASIDE_M
    if kind in ("lane_change_right", "departing_road_right"):
        return aside < -ASIDE_M
    if kind == "merge":  # its lane may itself lead into the other road
        return max(abs(aside), abs(float(one.off_line[-1] - one.off_line[0]))) > ASIDE_M
    return None


def _aside(one: VehicleMotion, way: float) -> float:
    """How far to the left it has moved at its first contact; of one that touches nothing, and may have come back, the
    most to one hand: 1 left, -1 right."""
    moved = one.aside - one.aside[0]
    return float(moved[-1]) if one.turns_from else way * float((way * moved).max())


def _slows(one: VehicleMotion) -> bool:
    """Whether it is visibly slower at the contact than before: by a fifth and 1.2 m/s."""
    fastest = float(one.speed.max(initial=0.0))
    return fastest - float(one.speed[-1]) > max(BRAKES_MPS, 0.2 * fastest) if len(one.speed) else False


def _lane(label: VehicleLabel, one: VehicleMotion) -> bool | None:
    """The lane on which it starts."""
    if one.home is None:
        return False
    edge, lane = one.home
    lanes = edge.car_lanes
    place = next(i for i, other in enumerate(lanes) if other.index == lane.index) + 1
    wanted = {"left": len(lanes), "right": 1, "middle": (len(lanes) + 1) // 2}
    if label.lane == "center_turn":
        return None
    return place == (wanted[label.lane] if isinstance(label.lane, str) else label.lane)


def _speed(label: VehicleLabel, one: VehicleMotion) -> bool:
    """Whether the stated speed is driven at some time up to the contact, to 5 % or 0.5 m/s."""
    told = (label.speed_mph or 0.0) * MPS_PER_MPH
    return bool((np.abs(one.speed - told) <= max(0.05 * told, 0.5)).any())


def _keeps_pace(label: VehicleLabel, one: VehicleMotion) -> bool | None:
    """Whether it drives faster than the limit of its first lane, or than one backs, at some time up to the contact, or
    never much more than slowly; None of one that stands."""
    fastest = float(one.speed.max(initial=0.0))
    if one.home is None or fastest < BRAKES_MPS:
        return None
    backs = np.einsum("ij,ij->i", np.diff(one.before[:, :2], axis=0), _ahead(one.before[:-1])).sum() < 0
    limit = _BACKS_MPS if backs else one.home[1].speed_mps
    return fastest > limit + _OVER_LIMIT_MPS if label.pace == "fast" else fastest <= _SLOW_LIMIT_SHARE * limit


def _ahead(pose: Floats) -> Floats:
    """(n, 2) unit vectors to where (n, 3) poses head."""
    return np.column_stack((np.cos(pose[:, 2]), np.sin(pose[:, 2])))


def _evades(label: VehicleLabel, one: VehicleMotion) -> float:
    """The share of the stated evasive actions that are visible."""
    deeds = label.evasion or ()
    return sum(_brakes(one) if deed == "brake" else _steers(deed, one) for deed in deeds) / len(deeds)


def _brakes(one: VehicleMotion) -> bool:
    return brakes(one.speed[one.recent().start : one.hit])


def brakes(speed_mps: Floats) -> bool:
    """Whether speeds at every step up to the contact show braking: lost over half a second, and in all."""
    if len(speed_mps) < 12:
        return False
    rate = (speed_mps[:-10] - speed_mps[10:]) / 0.5
    return float(rate.max()) >= BRAKES_MPS2 and float(speed_mps.max() - speed_mps[-1]) >= BRAKES_MPS


def _steers(deed: str, one: VehicleMotion) -> bool:
    """Steering to the stated side, or to either without one."""
    hand: Steering = "left" if deed == "steer_left" else "right" if deed == "steer_right" else "either"
    return steers(hand, one.aside[one.recent()], float(one.speed[-1]) * STEP_S if len(one.speed) else 0.0)


def steers(hand: Steering, aside_m: Floats, step_m: float) -> bool:
    """Whether (n,) metres to the left of the lane show steering to a hand: by the way, or by the heading of the last
    step, `step_m` long."""
    way = float(aside_m[-1] - aside_m[0])
    heading = math.atan2(float(aside_m[-1] - aside_m[-2]), max(step_m, 1e-6)) if len(aside_m) > 1 else 0.0
    sign = {"left": 1.0, "right": -1.0}.get(hand)
    if sign is None:
        return abs(way) > STEERS_M or abs(heading) > STEERS_RAD
    return way * sign > STEERS_M or heading * sign > STEERS_RAD


def _loses_control(label: VehicleLabel, one: VehicleMotion) -> bool | None:
    """A loss of control shows as slip, or as a path out of the lane."""
    if not label.lost_control or len(one.before) < 3:
        return None
    step = np.diff(one.before[:, :2], axis=0)
    moving = np.hypot(*step.T) > 0.05
    slip = np.abs(wrap_angle(np.arctan2(step[:, 1], step[:, 0]) - one.before[1:, 2]))[moving]
    return bool(slip.max(initial=0.0) > math.radians(8.0) or np.abs(one.aside - one.aside[0]).max() > ASIDE_M)


def _spins(label: VehicleLabel, one: VehicleMotion) -> bool:
    since = one.turns_from
    behind = one.path.pose[since : max(since + round(_SPIN_S / STEP_S), one.hit) + 1, 2]
    turned = float(wrap_angle(np.diff(behind)).sum())
    return sense_of(label.rest.spin) * turned > SPINS_RAD


class _Judge(NamedTuple):
    """Whether a label states a field, and whether a motion has it right (None: cannot be judged)."""

    stated: Callable[[VehicleLabel], bool]
    right: Callable[[VehicleLabel, VehicleMotion], float | bool | None]


_JUDGES: dict[str, _Judge] = {
    "maneuver_any": _Judge(lambda v: v.maneuver is not None, _maneuver),
    "lane_told": _Judge(lambda v: v.lane is not None, _lane),
    "speed_told": _Judge(lambda v: bool(v.speed_mph), _speed),
    "pace": _Judge(lambda v: v.pace is not None, _keeps_pace),
    "evasion": _Judge(lambda v: bool(v.evasion), _evades),
    "no_evasion": _Judge(lambda v: v.evasion == (), lambda _, one: not _brakes(one)),
    "lost_control": _Judge(lambda v: bool(v.lost_control), _loses_control),
    "spin": _Judge(lambda v: v.rest.spin is not None, _spins),
}


def _in_order(impacts: Sequence[tuple[str, str]], crash: Crash) -> bool:
    """Whether all stated contacts happen in their order; others may lie between. Objects are not distinguished."""
    seen: Iterator[frozenset[str]] = iter([_pair(a, b) for _, a, b in crash.touches])
    return all(any(_pair(*told) == one for one in seen) for told in impacts)


def _pair(a: str, b: str) -> frozenset[str]:
    return frozenset((_named(a), _named(b)))


def _named(who: str) -> str:
    """The id of a vehicle, person or animal; "thing" for objects."""
    return who if who[:1] in "VNPBAT" and who[1:].isdigit() else "thing"
