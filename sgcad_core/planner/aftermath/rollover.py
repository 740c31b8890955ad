"""The roll angle of vehicles with a stated rollover: onto the side, the roof, or over and over.

A plane simulation has no roll. It is added once the motion to rest is known: the vehicle rolls while it moves, from
shortly after its first contact, in the direction of its slide, and lies as stated at the end. Knows poses only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sgcad_core.geometry.plane import Floats, arc_lengths
from sgcad_core.metrics.rest_error import attitude_of, compass_rad
from sgcad_core.planner.motion import STEP_S
from sgcad_core.records.course import Attitude, CourseTold, sense_of

TRIPPED_S, _TRIPS_S = 0.3, 1.2
"""Time from the contact to the beginning of the roll, at least and at most: it first slides, or leaves the road, until
its side leads."""
_BROADSIDE_RAD = math.radians(45.0)
"""Angle between box and way from which on a side leads: what rolls about its long axis moves across it."""
_LEADS_RAD, _TURNS_M = math.radians(65.0), 9.0
"""Turn of a vehicle that touches nothing before it rolls, and the way on which it turns so far."""
_BARREL, _BARREL_M = 0.6, 4.0
"""Cost of a vehicle that rolls like a barrel that is screwed forward, and the way from which on it can turn first."""
_ROLLS_RADPS = math.radians(400.0)
"""At most; measured are 300 to 500 degrees a second (NHTSA, dolly and curb-trip tests)."""
_WAY_PER_QUARTER_M = 1.0
"""Least way on which a vehicle rolls by a quarter turn; half the girth of a car over four is 1.6 m, and it slides too.
What stands cannot be shown to roll: players keep no two vertices in one place."""
_SLIDES_MPS = 0.5
"""Lateral speed below which it rolls to the nearer side."""
_TO_THE_RIGHT: dict[Attitude, float] = {"right": 0.5, "roof": 1.0, "left": 1.5, "wheels": 2.0}
"""Half turns to the right until it lies like this."""


def rolls_over(told: CourseTold) -> bool:
    """Whether the report states a rollover of a vehicle."""
    return told.rolls or told.rest.attitude not in (None, "wheels")


def roll_angles(poses: Floats, hit: int, told: CourseTold, touches: Sequence[int] = ()) -> Floats:
    """(n,) roll of (n, 3) poses whose first contact is sample `hit`, radians, positive to the right (about x, z up).

    `touches`: samples of all its contacts, in order; those that are told before the roll are behind it.
    """
    first = _tripped(poses, _cause(poses, hit, touches[: told.rolls_after]))
    way = arc_lengths(poses[first:, :2])
    total = _total(_sideways_mps(poses, first), told, float(way[-1]))
    least = math.ceil(abs(total) / _ROLLS_RADPS / STEP_S)
    share = way / way[-1] if way[-1] > 0.0 else np.ones(len(way))
    slowest = np.arange(len(way)) / max(least, 1)
    roll = np.zeros(len(poses))
    roll[first:] = total * np.minimum(_eased(share), slowest)
    return roll


def _cause(poses: Floats, hit: int, touches: Sequence[int]) -> int:
    """The last contact before the roll behind which there is a way to roll on."""
    left = _ways_left_m(poses)
    return max((at for at in touches if at < len(left) and left[at] >= _WAY_PER_QUARTER_M), default=hit)


def _ways_left_m(poses: Floats) -> Floats:
    """(n,) metres from each of (n, 3) poses to the last one."""
    gone = arc_lengths(poses[:, :2])
    left: Floats = gone[-1] - gone
    return left


def _tripped(poses: Floats, hit: int) -> int:
    """The sample at which a vehicle begins to roll: the first one at which a side leads, in the time that it has."""
    least, most = (min(hit + round(s / STEP_S), len(poses) - 1) for s in (TRIPPED_S, _TRIPS_S))
    leads = np.abs(_slips(poses[least : most + 2])) >= math.sin(_BROADSIDE_RAD)
    return least + int(leads.argmax()) if leads.any() else least


def _slips(ways: Floats) -> Floats:
    """(m - 1, ...) sines of the angles from the ways of (m, ..., 3) poses to their headings; 0 of one that stands."""
    moves = np.diff(ways[..., :2], axis=0)
    c, s = np.cos(ways[:-1, ..., 2]), np.sin(ways[:-1, ..., 2])
    length = np.maximum(np.hypot(moves[..., 0], moves[..., 1]), 1e-6)
    sines: Floats = (s * moves[..., 0] - c * moves[..., 1]) / length
    return sines


def barrel_costs(told: CourseTold, ways: Floats) -> Floats:
    """(n,) costs of (m, n, 3) ways on which a vehicle that rolls over goes on with its front ahead: in the middle third
    of its way the told side leads, or either one."""
    if not rolls_over(told):
        return np.zeros(ways.shape[1])
    moved = np.cumsum(np.hypot(*np.diff(ways[..., :2], axis=0).transpose(2, 0, 1)), axis=0)
    middle = (moved >= moved[-1] / 3) & (moved <= moved[-1] * 2 / 3)
    sines = _slips(ways)
    leads = np.abs(sines) if told.rolls_to is None else sines * (1.0 if told.rolls_to == "right" else -1.0)
    share = (leads * middle).sum(axis=0) / np.maximum(middle.sum(axis=0), 1) / math.sin(_BROADSIDE_RAD)
    cost: Floats = _BARREL * np.where(moved[-1] >= _BARREL_M, np.clip(1.0 - share, 0.0, 1.0), 0.0)
    return cost


def quarters_short(poses: Floats, hit: int, told: CourseTold, touches: Sequence[int] = ()) -> int:
    """How many of the told quarter turns the way of a vehicle is too short for; as `roll_angles`."""
    rolls = abs(float(roll_angles(poses, hit, told, touches)[-1])) if told.roll_quarters else 0.0
    return (told.roll_quarters or 0) - round(rolls / (math.pi / 2))


def turned_over(poses: Floats, at: int, told: CourseTold) -> Floats:
    """(n, 3) poses of a vehicle that rolls over from sample `at` on, turned as it is told to lie while it moves on."""
    way = arc_lengths(poses[at:, :2])
    if way[-1] <= 0.0:
        return poses
    turning = poses.copy()
    if told.rest.facing_deg is None:
        turning[at:, 2] += _to_broadside(told) * _eased(np.minimum(way / min(way[-1], _TURNS_M), 1.0))
        return turning
    turn = math.remainder(compass_rad(told.rest.facing_deg) - float(poses[-1, 2]), 2 * math.pi)
    if sense_of(told.spin) * turn < 0:
        turn -= math.copysign(2 * math.pi, turn)
    turning[at:, 2] += turn * _eased(way / way[-1])
    return turning


def _to_broadside(told: CourseTold) -> float:
    """The turn, radians, that brings the side ahead which is told to lead; of an untold one that on which it lies, and
    the right one where neither is told."""
    leads = told.rolls_to or (told.rest.attitude if told.rest.attitude in ("left", "right") else "right")
    way = 1.0 if leads == "right" else -1.0
    if told.spin and told.rolls_to is None:
        way = 1.0 if told.spin == "counterclockwise" else -1.0
    return way * _LEADS_RAD


def _eased(share: Floats) -> Floats:
    """Smooth step: a roll is fastest in its middle."""
    eased: Floats = share * share * (3 - 2 * share)
    return eased


def _sideways_mps(poses: Floats, at: int) -> float:
    """Speed to the left of the box at a sample."""
    dx, dy = (poses[min(at + 1, len(poses) - 1), :2] - poses[max(at - 1, 0), :2]) / (2 * STEP_S)
    heading = float(poses[at, 2])
    return float(dy * math.cos(heading) - dx * math.sin(heading))


def _total(left_mps: float, told: CourseTold, way_m: float) -> float:
    """Total roll, radians: the told side leads, else that to which it slides, else the nearer one.

    So many quarter turns as are told and as its way allows; without them until it lies as told; without a stated end,
    onto its side.
    """
    to_left = told.rolls_to == "left" if told.rolls_to else left_mps > 0.0
    if told.roll_quarters:
        return _of_quarters(_possible(told.roll_quarters, way_m), to_left, told)
    wanted = told.rest.attitude or ("left" if to_left else "right")
    right = _TO_THE_RIGHT[wanted] * math.pi
    left = right - 2 * math.pi if wanted != "wheels" else -right
    if abs(left_mps) < _SLIDES_MPS and told.rolls_to is None:
        return min(right, left, key=abs)
    return left if to_left else right


def _possible(count: int, way_m: float) -> int:
    """The most quarter turns, no more than are told, that a way allows, and then such that it lies the same."""
    most = min(count, max(1, int(way_m / _WAY_PER_QUARTER_M)))
    return next((n for n in range(most, 0, -1) if (count - n) % 4 == 0), most)


def _of_quarters(count: int, to_left: bool, told: CourseTold) -> float:
    """A told number of quarter turns, radians; without a leading side to that from which it lies as told."""
    turned = count * math.pi / 2
    hand = -1.0 if to_left else 1.0
    if told.rolls_to is None and told.rest.attitude in ("left", "right") and count % 2:
        hand = 1.0 if attitude_of(turned) == told.rest.attitude else -1.0
    return hand * turned
