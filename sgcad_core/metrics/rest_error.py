"""Errors of a pose at rest against the stated rest: facing, place and side, each on its own.

The planner fits run-outs by these errors, and `sgcad score` counts them; the tolerances are defined here. Angles in
radians counter-clockwise from east unless a name says otherwise; metres.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats, Size, box_gaps, wrap_angle
from sgcad_core.metrics.told_lanes import ToldLane
from sgcad_core.records.course import AT_IMPACT_M, Attitude, Hand, RestLane, RestTold
from sgcad_core.records.specs import Compass
from sgcad_core.roads.surface import OfLane, RoadSurface

COMPASS_DEG: dict[str, float] = {
    "N": 0.0, "NE": 45.0, "E": 90.0, "SE": 135.0, "S": 180.0, "SW": 225.0, "W": 270.0, "NW": 315.0,
}  # fmt: skip
FACING_RAD = math.radians(20.0)
"""A facing is right within this angle: less than half of the step from one point of the compass to the next."""
SIDE_RAD = math.radians(68.0)
"""A side is right within this angle, seen from the nearest lane or the center of the junction; in the road no side is
right."""
SPINS_RAD = math.radians(8.0)
"""Rotation after its first contact from which a vehicle spins."""
_SPOT_M, _LAGS = 3.5, (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96)
"""Way on which a rotation is one on the spot; samples between two poses that are compared."""
SHOULDER_M = (0.0, 4.0)
"""Distances beyond the edge of the nearest lane of a box center on a shoulder."""
OFF_M = 0.0
"""Off the road from here on: the center is beyond the edge."""
_NEAR_SHARE, _NEAR_M = 0.3, 1.0
"""A distance is right within this share of it, or so many metres."""
_TURN_SHARE, _TURN_RAD = 0.25, math.radians(30.0)
"""A rotation is right within this share of it, or this angle."""
AGAINST_M = 1.5
"""A vehicle rests against a thing, or at it, within this gap: it rolls back a little off what it struck."""
_ACROSS, _CORNER_RAD = math.cos(math.radians(30.0)), math.radians(45.0)
"""A side lies beside a road that runs across it within 30 degrees; of other roads it is a corner of their junction, of
which each has a quarter."""
_CORNER_M = 45.0
"""A side is seen from the center of a junction within this distance."""
_EDGE_M = 0.3
"""By which a center may lie over the edge of its lane, as in `lane_places`, or over the ends of the lanes at its
junction."""
_SAME_WAY_RAD, _WAY_RAD = math.radians(120.0), math.radians(50.0)
"""A lane without a stated direction runs within this angle of the vehicle's heading at its first contact: it does not
run against it; one with a stated direction runs within this angle of that."""
_AGAINST = -0.5
"""Cosine of the angle between a heading and a lane from which on the lane runs against it."""
_CARRIED_M = 2.0
"""Way along a road that a vehicle crossed from which on it was carried along it."""
_SECOND = 2
"""The number of the other direction's lane where reports count the lanes of a two-lane road across its center line."""
_NO_LANE_M = 20.0
"""Error where no such lane is drawn."""


class RestErrors(NamedTuple):
    """(n,) errors of poses: 0 or less is right, None where the report states nothing."""

    facing_rad: Floats | None
    """Beyond what is allowed."""
    where_m: Floats | None
    side_rad: Floats | None
    lane_m: Floats | None = None
    """Beyond the edge of the stated lane."""

    def right(self) -> dict[str, bool]:
        """By stated part whether a single pose is right."""
        return {
            name: bool(error[0] <= 1e-9)
            for name, error in zip(("facing", "where", "side", "lane"), self, strict=True)
            if error is not None
        }


def rest_errors(
    told: RestTold, poses: Floats, came_rad: float, surface: RoadSurface, began: Floats | None = None
) -> RestErrors:
    """Errors of (n, 3) poses at rest.

    `came_rad`: the vehicle's heading before its first contact; `began`: (3,) its first pose, for what is told of the
    lane in which it began.
    """
    off, bearing, nearest = surface.nearest(poses[:, :2])
    facing = None if told.facing_deg is None else _apart(poses[:, 2], compass_rad(told.facing_deg)) - FACING_RAD
    where = None if told.where is None else _misplaced(told, poses, (off, bearing, nearest), surface)
    side = None if told.side is None or told.where in ("road", "intersection") else (
        np.where(
            off < SHOULDER_M[0], math.pi, _beside(told.side, poses, (bearing, nearest), (came_rad, began), surface)
        ) - SIDE_RAD
    )  # fmt: skip
    return RestErrors(facing, where, side, _beside_lane(told, poses, came_rad, surface, began))


def whirls(ways: Floats) -> Floats:
    """(n,) the most by which (m, n, 3) ways turn within a few metres: on the spot, as no sliding vehicle does."""
    gone = np.cumsum(np.hypot(*np.diff(ways[..., :2], axis=0, prepend=ways[:1, :, :2]).transpose(2, 0, 1)), axis=0)
    most = np.zeros(ways.shape[1])
    for lag in (n for n in _LAGS if n < len(ways)):
        turned = np.abs(ways[lag:, :, 2] - ways[:-lag, :, 2])
        most = np.maximum(most, np.where(gone[lag:] - gone[:-lag] <= _SPOT_M, turned, 0.0).max(axis=0))
    return most


def against_errors(poses: Floats, size: Size, thing: Floats, thing_size: Size) -> Floats:
    """(n,) metres beyond the allowed gap between boxes at (n, 3) poses and a thing at a (3,) pose; 0 or less is
    right."""
    there = np.repeat(thing[None], len(poses), axis=0)
    return box_gaps(poses, size, there, thing_size) - AGAINST_M


def near_m(distance_m: float) -> float:
    """By how much a distance may differ from one that is told."""
    if distance_m == AT_IMPACT_M:
        return AT_IMPACT_M
    return max(_NEAR_SHARE * distance_m, _NEAR_M)


def near_turn_rad(turn_rad: float) -> float:
    """By how much a rotation may differ from one that is told."""
    return max(_TURN_SHARE * turn_rad, _TURN_RAD)


def attitude_of(roll_rad: float) -> Attitude:
    """The side on which a vehicle lies after a roll (positive to the right): the nearest quarter turn."""
    lies: tuple[Attitude, ...] = ("wheels", "right", "roof", "left")
    return lies[round(roll_rad / (math.pi / 2)) % 4]


def compass_rad(degrees: float) -> float:
    """Clockwise degrees from north as radians counter-clockwise from east."""
    return math.radians(90.0 - degrees)


def _apart(angles: Floats, wanted: float) -> Floats:
    return np.abs(wrap_angle(angles - wanted))


def _misplaced(
    told: RestTold, poses: Floats, near: tuple[Floats, Floats, NDArray[np.int_]], surface: RoadSurface
) -> Floats:
    """Distance from the stated kind of place, metres; 0 or less is right."""
    off, bearing, nearest = near
    if told.where == "road":
        return surface.streets.off(poses[:, :2])[0] - OFF_M
    if told.where == "shoulder":
        return np.maximum(SHOULDER_M[0] - off, off - SHOULDER_M[1])
    if told.where == "intersection" and surface.junctions:
        closest: Floats = np.min([junction.out_m(poses[:, :2]) for junction in surface.junctions], axis=0)
        return closest - _EDGE_M
    if told.where == "intersection":
        return off - OFF_M
    beyond = OFF_M + 0.05 - off
    if told.where == "median":  # left of a lane without one beside it: between two carriageways
        on_right = np.sin(bearing - surface.ways[nearest]) < 0.0
        beyond = np.where((off > 0.0) & on_right, off, beyond)
    return beyond


def _beside_lane(
    told: RestTold, poses: Floats, came_rad: float, surface: RoadSurface, began: Floats | None
) -> Floats | None:
    """Distance beyond the edge of the stated lane, metres; None where none is stated, or none can be found."""
    if not told.in_lane or not surface.lanes or (told.lane == "own" and began is None):
        return None
    ways = surface.ways
    if told.lane == "own" and began is not None:
        fits, along = _own_lanes(surface, began), _apart(ways, float(began[2])) < _SAME_WAY_RAD
    else:
        fits = np.array([_is_lane(told.lane, lane) for lane in surface.lanes])
        along = _apart(ways, came_rad) < _SAME_WAY_RAD
    if told.lane_way is not None:
        along = _apart(ways, compass_rad(COMPASS_DEG[told.lane_way])) < _WAY_RAD
    chosen = np.flatnonzero(fits & (along | np.array([lane == "center" for lane in surface.lanes])))
    if not len(chosen) and told.lane == _SECOND and told.lane_way is None:
        chosen = _only_oncoming(surface, came_rad)
    if not len(chosen):
        return np.full(len(poses), _NO_LANE_M)
    return surface.part(chosen.tolist()).off(poses[:, :2])[0] - _EDGE_M


def _only_oncoming(surface: RoadSurface, came_rad: float) -> NDArray[np.int_]:
    """The pieces of the lanes that run against a heading on roads with one lane each way: their second lane."""
    single = np.array([not isinstance(lane, str) and lane.lanes == 1 for lane in surface.lanes])
    return np.flatnonzero(single & (np.cos(surface.ways - came_rad) < _AGAINST))


def _is_lane(told: int | RestLane | None, lane: OfLane) -> bool:
    """Whether a piece of the surface is a part of a stated lane; None: of any for cars."""
    if lane == "center":
        return told in ("center_turn", "left_turn")
    if lane == "junction" or told == "center_turn":
        return False
    if told is None:
        return True
    return ToldLane.of(told).is_at(lane)


def _own_lanes(surface: RoadSurface, began: Floats) -> NDArray[np.bool_]:
    """(n,) the pieces of lanes that lie as the lane in which a vehicle began, from the right or from the left."""
    along = np.cos(surface.ways - began[2]) > 0.0
    lanes = [n for n in np.flatnonzero(along).tolist() if not isinstance(surface.lanes[n], str)]
    if not lanes:
        return np.zeros(len(surface.lanes), bool)
    home = surface.lanes[lanes[int(surface.part(lanes).nearest(began[None, :2])[2][0])]]
    return np.array([
        not isinstance(lane, str) and not isinstance(home, str)
        and (lane.place == home.place or lane.lanes - lane.place == home.lanes - home.place)
        and (lane.lanes != home.lanes or lane.place == home.place)
        for lane in surface.lanes
    ])  # fmt: skip


def _beside(
    side: Compass | Hand,
    poses: Floats,
    lane: tuple[Floats, NDArray[np.int_]],
    came: tuple[float, Floats | None],
    surface: RoadSurface,
) -> Floats:
    """Angle between the stated side and the direction of the point: from the nearest lane, or from the center of the
    junction. `lane`: bearing from the nearest lane, and its piece; `came`: as in `rest_errors`.
    """
    bearing, nearest = lane
    if side in ("left", "right"):
        return _on_hand(math.pi / 2 if side == "left" else -math.pi / 2, poses, bearing, surface.ways[nearest], came)
    wanted = compass_rad(COMPASS_DEG[side])
    best = _apart(bearing, wanted)
    across = np.abs(np.sin(surface.ways[nearest] - wanted)) > _ACROSS
    for junction in surface.junctions:
        dx, dy = poses[:, 0] - junction.x_m, poses[:, 1] - junction.y_m
        near = np.hypot(dx, dy) < _CORNER_M
        seen = _apart(np.arctan2(dy, dx), wanted)
        best = np.where(near, np.where(across, np.minimum(best, seen), seen * SIDE_RAD / _CORNER_RAD), best)
    return best


def _on_hand(
    hand_rad: float, poses: Floats, bearing: Floats, ways: Floats, came: tuple[float, Floats | None]
) -> Floats:
    """Angle between a hand of the road and the direction of the point from the nearest lane, which runs along `ways`.

    Between two carriageways a point lies left of both: seen from the far one it would lie on the right. A road that
    runs across the way of a vehicle has its hands as seen in the direction in which it was carried along that road.
    """
    came_rad, began = came
    beyond = (np.sin(bearing - ways) > 0.0) & (np.cos(ways - came_rad) < _AGAINST)
    own = _apart(np.where(beyond, bearing + math.pi, bearing), came_rad + hand_rad)
    if began is None:
        return own
    along_m = (poses[:, 0] - began[0]) * np.cos(ways) + (poses[:, 1] - began[1]) * np.sin(ways)
    across = (np.abs(np.cos(ways - came_rad)) < -_AGAINST) & (np.abs(along_m) > _CARRIED_M)
    carried = np.where(along_m > 0.0, ways, ways + math.pi)
    return np.where(across, np.abs(wrap_angle(bearing - carried - hand_rad)), own)


def in_words(rest: RestTold, errors: RestErrors) -> Iterator[str]:
    """The missed parts of a rest, for people."""
    facing, where, side, lane = errors
    if facing is not None and facing[0] > 0:
        off = math.degrees(float(facing[0]) + FACING_RAD)
        yield f"comes to rest facing {off:.0f} degrees off what is told"
    if where is not None and where[0] > 0:
        yield f"comes to rest {float(where[0]):.1f} m from the told place ({(rest.where or '').replace('_', ' ')})"
    if side is not None and side[0] > 0:
        yield f"comes to rest on another side than told ({rest.side})"
    if lane is not None and lane[0] > 0:
        yield f"comes to rest {float(lane[0]):.1f} m from the told {_lane_in_words(rest)}"


def _lane_in_words(rest: RestTold) -> str:
    named = f"lane {rest.lane}" if isinstance(rest.lane, int) else f"{rest.lane or ''} lane".replace("_", " ")
    return " ".join(filter(None, [named.strip(), f"({rest.lane_way})" if rest.lane_way else ""]))
