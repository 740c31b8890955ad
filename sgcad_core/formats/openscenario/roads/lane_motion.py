"""A motion in lane terms: its start, its roads, and at most one shift to another lane or offset.

Motion that lanes cannot express (cut corners, skids, ways off the roads) gives None. Knows no XML but the map.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.case.records import Trajectory
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.openscenario.roads.way import LanePlace, Way
from sgcad_core.geometry.plane import Floats, arc_lengths, wrap_angle

KEEPS_M = 0.1
"""Beside a lane's line at most: such a motion keeps its lane."""
SHIFTS_M = 0.2
"""Beside the curve of a shift at most."""
TURNED_RAD = 0.02
"""Turned against the lane at the start at most."""
SAME_M = 1e-3
"""A lane place is written where it is this near to the pose."""
UNSEEN = 1.3
"""A shift that the contact cuts short leads so much farther than it was seen to at most."""
MOST_MPS2 = 6.0
"""Largest lateral acceleration of a shift; vehicles are not driven more abruptly."""
LOST_M = 0.3
"""By how much the way on the curve may be longer than the lane: players count speed along either."""
SKIDS_RAD = 0.12
"""Of a heading against the direction in which lane and shift lead, at most."""
AHEAD_M = 2.0
"""Distance at which a place counts as reached, since players hit no point exactly."""
STILL_M = 0.02
"""An entity that moves less than this in a step has no direction."""
INTO_M = 5.0
"""How far beyond a junction a route's last waypoint lies."""
CURVES: Mapping[str, Callable[[Floats], Floats]] = {
    "cubic": lambda u: u * u * (3 - 2 * u),
    "sinusoidal": lambda u: np.asarray((1 - np.cos(np.pi * u)) / 2),
}
"""Shapes of a shift that are level at both ends."""
CURVATURES: Mapping[str, float] = {"cubic": 6.0, "sinusoidal": math.pi**2 / 2}
"""Largest second derivative of each, of a change by 1 over a span of 1."""
_SHAPES = tuple(CURVES)
_SPANS_S = np.geomspace(0.8, 8.0, 28)
_ONSET_ROWS = 30
"""A smooth shift has begun so many rows at most before it shows."""


class Shift(NamedTuple):
    """An even change of the offset to the lane's line over time."""

    row: int
    """Of the motion, at which it begins."""
    shape: str
    span_s: float
    place: LanePlace
    """Where it begins: road, lane, s and offset."""
    lanes: int
    """How many lanes to the left it leads (right: negative), among those of one direction on one road; else 0."""
    offset_m: float
    """In the lane reached at the end, to the left of the road's direction."""
    lateral_mps2: float
    """Largest lateral acceleration of the curve, which defines the duration of an offset."""
    ahead: tuple[LanePlace, float, float] | None
    """A place AHEAD_M farther on the way, and its x and y; None at the end of the motion."""


class LaneMotion(NamedTuple):
    """The start in lane coordinates; the places a route leads over, if it passes a junction; the shift, if any."""

    place: LanePlace
    route: tuple[LanePlace, ...]
    shift: Shift | None
    end: LanePlace
    """Where the motion ends."""


class _Along(NamedTuple):
    """A motion seen from a way: at each row the distance on it, the metres to its left, the piece of its line beside
    it and the share of that piece."""

    way: Way
    s_m: Floats
    left_m: Floats
    piece: NDArray[np.intp]
    share: Floats

    def place(self, row: int) -> LanePlace:
        """The place in a lane at a row."""
        return self.way.place(int(self.piece[row]), float(self.share[row]), float(self.left_m[row]))[0]


def start_place(move: Trajectory, roads: XodrRoads) -> tuple[LanePlace | None, float]:
    """The first pose in lane coordinates, if it lies in a lane, and its turn against the lane, radians."""
    pose = _pose(move, 0)
    place = roads.nearest(pose)
    if place is None or not roads.covers(pose):
        return None, 0.0
    there = roads.lane_pose(*place)
    if math.dist(there[:2], pose[:2]) > SAME_M:
        return None, 0.0
    return place, float(wrap_angle(pose.heading_rad - there.heading_rad))


def lane_motion(move: Trajectory, roads: XodrRoads, further_m: float) -> LaneMotion | None:
    """The motion (of an origin) by lanes, on which it can go on for `further_m`; None where lanes do not tell it."""
    place, turn = start_place(move, roads)
    if place is None or abs(turn) > TURNED_RAD or _backwards(move):
        return None
    try:
        route = _route(move, roads, place, further_m)
        seen = _seen(move, roads, place, route)
    except ValueError:  # no road leads there, or the lane ends on the way
        return None
    if seen.s_m[-1] + further_m > arc_lengths(seen.way.points)[-1] or seen.s_m[-1] <= 0:
        return None
    if _skids(move, seen):
        return None
    keeps = np.abs(seen.left_m - seen.left_m[0]).max() <= KEEPS_M
    shift = None if keeps else _shift(move, seen, roads)
    return LaneMotion(place, route, shift, seen.place(-1)) if keeps or shift else None


def _pose(move: Trajectory, row: int) -> Pose:
    return Pose(float(move.x_m[row]), float(move.y_m[row]), float(move.heading_rad[row]))


def _backwards(move: Trajectory) -> bool:
    x, y = move.x_m - move.x_m[0], move.y_m - move.y_m[0]
    ahead = x * math.cos(move.heading_rad[0]) + y * math.sin(move.heading_rad[0])
    return bool(ahead.min() < -KEEPS_M)


# ------------------------------------------------------------------ the way
def driven_way(move: Trajectory, roads: XodrRoads, place: LanePlace) -> Way:
    """The lanes from a motion's first place to its last and on from there. Raises ValueError where none lead there."""
    end = roads.nearest(_pose(move, -1))
    sense = roads.road(place.road).sense(place.lane)
    return roads.drive(place, sense, roads.route([place, end], sense) if end else None)


def _route(move: Trajectory, roads: XodrRoads, place: LanePlace, further_m: float) -> tuple[LanePlace, ...]:
    """The start and a place beyond the last junction that the motion reaches; empty where it comes to none."""
    way = driven_way(move, roads, place)
    gone, at_m = arc_lengths(way.points), arc_lengths(move.points)[-1] + further_m
    inner = np.array([roads.road(road).junction != "-1" for road, _, _ in way.lanes])[way.which]
    if not inner[gone <= at_m].any():
        return ()
    last = int(np.flatnonzero(inner & (gone <= at_m))[-1])
    beyond = np.flatnonzero(~inner[last:] & (gone[last:] >= gone[last] + INTO_M))
    if not len(beyond):
        raise ValueError("the way ends in the junction")
    target, _ = way.place(last + int(beyond[0]), 0.0, 0.0)
    return place, target


def _seen(move: Trajectory, roads: XodrRoads, place: LanePlace, route: tuple[LanePlace, ...]) -> _Along:
    """The motion beside the line of the way that players take: from the start's lane over the route."""
    sense = roads.road(place.road).sense(place.lane)
    way = roads.drive(place._replace(offset_m=0.0), sense, roads.route(list(route), sense) if route else None)
    along = arc_lengths(way.points)
    points = move.points
    reach = int(np.searchsorted(along, arc_lengths(points)[-1] + 10.0)) + 2
    begin, step = way.points[: reach - 1], np.diff(way.points[:reach], axis=0)
    length = np.hypot(*step.T)
    ahead = points[:, None] - begin
    share = np.clip((ahead * step).sum(axis=2) / length**2, 0.0, 1.0)
    gap = np.hypot(*(ahead - share[..., None] * step).transpose(2, 0, 1))
    k = gap.argmin(axis=1)
    rows = np.arange(len(points))
    left = (step[k, 0] * ahead[rows, k, 1] - step[k, 1] * ahead[rows, k, 0]) / length[k]
    return _Along(way, along[k] + share[rows, k] * length[k], left, k, share[rows, k])


def _skids(move: Trajectory, seen: _Along) -> bool:
    """Whether it turns otherwise than its lane and its shift lead."""
    step = np.diff(seen.way.points, axis=0)[seen.piece]
    gone = np.gradient(seen.s_m)
    drift = np.arctan2(np.gradient(seen.left_m), gone)
    turned = np.abs(wrap_angle(move.heading_rad - np.arctan2(step[:, 1], step[:, 0]) - drift))
    return bool((turned > SKIDS_RAD)[gone > STILL_M].any())


# ------------------------------------------------------------------ the shift
class _Fit(NamedTuple):
    """An even change of the offset: largest error (m), row at which it begins, shape, span, metres to the left."""

    error_m: float
    row: int
    shape: str
    span_s: float
    by_m: float

    @property
    def across_mps2(self) -> float:
        """Largest lateral acceleration."""
        return CURVATURES[self.shape] * abs(self.by_m) / self.span_s**2

    @property
    def drives(self) -> bool:
        """Whether it fits the motion and is drivable."""
        return self.error_m <= SHIFTS_M and self.across_mps2 <= MOST_MPS2


def _shift(move: Trajectory, seen: _Along, roads: XodrRoads) -> Shift | None:
    """The one even shift that tells all offsets, if there is one: into the next lane if that does, else an offset."""
    aside = seen.left_m - seen.left_m[0]
    lost = float(np.sum(np.diff(seen.left_m) ** 2 / (2 * np.maximum(np.diff(seen.s_m), STILL_M))))
    if lost > LOST_M:
        return None
    for lanes, by_m in _neighbors(move, seen, roads):
        if (fit := _fitted(move.t_s, aside, by_m)).drives:
            return _told(seen, roads, fit, lanes, 0.0)
    fit = _fitted(move.t_s, aside)
    if not fit.drives or abs(fit.by_m) > UNSEEN * np.abs(aside).max():
        return None
    begin = seen.place(fit.row)
    left = (float(seen.left_m[0]) + fit.by_m) * roads.sense(begin, float(move.heading_rad[fit.row]))
    return _told(seen, roads, fit, 0, left)


def _told(seen: _Along, roads: XodrRoads, fit: _Fit, lanes: int, offset_m: float) -> Shift:
    begin = seen.place(fit.row)
    return Shift(fit.row, fit.shape, fit.span_s, begin, lanes, offset_m, fit.across_mps2, _ahead(seen, fit.row, roads))


def _neighbors(move: Trajectory, seen: _Along, roads: XodrRoads) -> Iterator[tuple[int, float]]:
    """1 for the next lane to the left, -1 to the right, whichever way it shifts; how far to the left its line lies (m).

    Only where traffic goes the same way there, and while the motion stays on one road: lanes are told by the ids of the
    road where the shift begins.
    """
    end = seen.place(-1)
    row = int(np.flatnonzero(np.abs(seen.left_m - seen.left_m[0]) > KEEPS_M / 2)[0])
    begin = seen.place(row)
    line, sense = roads.road(begin.road), roads.sense(begin, float(move.heading_rad[row]))
    side = 1 if seen.left_m[-1] > seen.left_m[0] else -1
    lane = begin.lane + side * sense
    if begin.road != end.road or lane == 0 or line.sense(lane) != sense:
        return
    if all(lane in line.section(place.s_m).lanes for place in (begin, end)):
        across = (line.lane_t(lane, begin.s_m) - line.lane_t(begin.lane, begin.s_m)) * sense
        yield side, across - float(seen.left_m[0])


def _fitted(t_s: Floats, aside_m: Floats, by_m: float | None = None) -> _Fit:
    """The best even change, to a given offset or to any."""
    shows = int(np.flatnonzero(np.abs(aside_m) > KEEPS_M / 2)[0])
    rows = range(max(0, shows - _ONSET_ROWS), shows + 1)
    return min(_fit(t_s, aside_m, row, shape, by_m) for row in rows for shape in _SHAPES)


def _fit(t_s: Floats, aside_m: Floats, row: int, shape: str, by_m: float | None) -> _Fit:
    """The best of all spans; without a given offset that of least squares."""
    share = np.clip((t_s - t_s[row]) / _SPANS_S[:, None], 0.0, 1.0)
    curve = CURVES[shape](share)
    free = (curve @ aside_m) / np.maximum((curve * curve).sum(axis=1), 1e-9)
    by = free if by_m is None else np.full(len(free), by_m)
    error = np.abs(by[:, None] * curve - aside_m).max(axis=1)
    best = int(error.argmin())
    return _Fit(float(error[best]), row, shape, float(_SPANS_S[best]), float(by[best]))


def _ahead(seen: _Along, row: int, roads: XodrRoads) -> tuple[LanePlace, float, float] | None:
    """A place in the lane some way ahead of a row."""
    further = int(np.searchsorted(seen.s_m, seen.s_m[row] + AHEAD_M))
    if further >= len(seen.s_m):
        return None
    place = seen.place(further)._replace(offset_m=seen.place(row).offset_m)
    there = roads.lane_pose(*place)
    return place, there.x_m, there.y_m
