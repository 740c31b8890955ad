"""The LibSumo simulator's worker process for traffic: vehicles that SUMO drives around the actors of a crash.

The actors are no vehicles of SUMO's: on every lane that an actor's box reaches into, or will cross within the next
seconds, stands a shadow of it, which the traffic takes for a vehicle in that lane. So a wreck across three lanes stops
three lanes. libsumo may end its process. SI units; headings counter-clockwise from east.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

import libsumo
import numpy as np
from numpy.typing import NDArray

from plugins.sumo_session import AS_TOLD, QUIET, box_center, heading_of, running
from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import Floats
from sgcad_core.case.traffic import Driven, Entrant, TrafficOrder
from sgcad_core.errors import SimulationFailed
from sgcad_core.formats.sumo.traffic_routes import LANE_KEEPING
from sgcad_core.geometry.distances import nearest_on
from sgcad_core.geometry.plane import Size, arc_lengths, headings, resample, world_points

_OPTIONS = ("--collision.action", "none", *AS_TOLD, *QUIET, "--no-warnings", "true")
_KIND = "traffic"
_MODEL = {"id": _KIND, "minGap": "2.5", **LANE_KEEPING}
_KEEPS_LANE = f"<routes><vType {' '.join(f'{name}={quoteattr(value)}' for name, value in _MODEL.items())}/></routes>"
"""SUMO's Krauss model with its usual parameters; it never changes lanes, which SUMO does at a stroke."""
_REACH_M = 1.5
"""Half the strip that a lane's traffic takes: half a vehicle and half a metre."""
_GRID_M = 1.0
"""Mesh of the points along a box's sides whose lane is asked."""
_AHEAD = tuple(range(10, 41, 10))
"""Rows (up to 2 s) by which a crossing actor's shadow is before it."""
_CROSSES_RAD = math.radians(30.0)
_LEAST_M = 0.5


class _Lane(NamedTuple):
    id: str
    line: Floats


class _Shadow(NamedTuple):
    """An actor in a lane by row: where its front is there, SUMO's angle, its length and speed along the lane."""

    lane: str
    there: NDArray[np.bool_]
    fronts: Floats
    angles: Floats
    lengths_m: Floats
    speeds_mps: Floats


def drive_traffic(order: TrafficOrder) -> tuple[Driven, ...]:
    """Drives the entrants for as many rows as the fixtures have. Raises SimulationFailed with SUMO's message."""
    try:
        with running((*_OPTIONS, "--seed", str(order.seed)), order.net_xml, _KEEPS_LANE, STEP_S):
            return tuple(_drive(order))
    except libsumo.TraCIException as fault:
        raise SimulationFailed(f"SUMO cannot drive the traffic: {fault}") from fault


def _drive(order: TrafficOrder) -> Iterator[Driven]:
    sizes = tuple((f.length_m, f.width_m) for f in order.fixtures)
    cast = _Cast(_shadows(order.net_xml, sizes, tuple(f.poses.tobytes() for f in order.fixtures)))
    for entrant in order.entrants:
        _add(entrant)
    known, seen = {e.id: e.length_m for e in order.entrants}, dict[str, list[tuple[float, ...]]]()
    first: dict[str, int] = {}
    rows = len(order.fixtures[0].poses)
    for k in (0, *range(rows)):  # the shadows first, then what depart among them
        cast.place(k)
        for program, states in order.signals.items():
            libsumo.trafficlight.setRedYellowGreenState(program, states[k])
        libsumo.simulationStep()
        if libsumo.simulation.getTime() < 1.5 * STEP_S:
            continue
        for name in libsumo.vehicle.getIDList():
            if name in known:
                first.setdefault(name, k)
                seen.setdefault(name, []).append(_row(name, known[name]))
    for entrant in order.entrants:
        if entrant.id in seen:
            yield Driven(entrant.id, first[entrant.id], np.array(seen[entrant.id]))


def _row(name: str, length_m: float) -> tuple[float, ...]:
    heading = heading_of(libsumo.vehicle.getAngle(name))
    return *box_center(libsumo.vehicle.getPosition(name), heading, length_m), heading, libsumo.vehicle.getSpeed(name)


def _add(entrant: Entrant) -> None:
    libsumo.route.add(entrant.id, entrant.route)
    libsumo.vehicle.add(
        entrant.id, entrant.id, typeID=_KIND, depart=str(entrant.depart_s + STEP_S), departLane=str(entrant.lane),
        departPos=str(entrant.at_m), departSpeed="max",
    )  # fmt: skip
    libsumo.vehicle.setLength(entrant.id, entrant.length_m)
    libsumo.vehicle.setWidth(entrant.id, entrant.width_m)


# ------------------------------------------------------------------ shadows
class _Cast:
    """The shadows that stand on the roads at a row."""

    def __init__(self, shadows: Sequence[_Shadow]) -> None:
        self._shadows = shadows
        self._there: dict[int, str] = {}
        self._made = 0

    def place(self, k: int) -> None:
        """Puts every shadow on its place at row k, and takes away those whose actor is not in their lane."""
        for number, shadow in enumerate(self._shadows):
            if shadow.there[k]:
                if number not in self._there:
                    self._there[number] = self._new(shadow.lane)
                _put(self._there[number], shadow, k)
            elif (name := self._there.pop(number, None)) is not None:
                libsumo.vehicle.remove(name)

    def _new(self, lane: str) -> str:
        self._made += 1
        name, edge = f"shadow {self._made}", _edge_of(lane)[0]
        if edge.startswith(":"):
            edge = next(e for e in libsumo.edge.getIDList() if not e.startswith(":"))
        if (route := f"of {edge}") not in libsumo.route.getIDList():
            libsumo.route.add(route, [edge])
        libsumo.vehicle.add(name, route, typeID="DEFAULT_VEHTYPE")
        libsumo.vehicle.setSpeedMode(name, 0)
        libsumo.vehicle.setLaneChangeMode(name, 0)
        libsumo.vehicle.setMinGap(name, 0.0)
        return name


def _put(name: str, shadow: _Shadow, k: int) -> None:
    edge, index = _edge_of(shadow.lane)
    x, y = (float(v) for v in shadow.fronts[k])
    libsumo.vehicle.setLength(name, float(shadow.lengths_m[k]))
    angle = float(shadow.angles[k])
    libsumo.vehicle.moveToXY(name, edge, index, x, y, angle=angle, keepRoute=2, matchThreshold=_REACH_M)
    libsumo.vehicle.setSpeed(name, float(shadow.speeds_mps[k]))


def _edge_of(lane: str) -> tuple[str, int]:
    edge, _, index = lane.rpartition("_")
    return edge, int(index)


@lru_cache(maxsize=1)
def _shadows(net_xml: str, sizes: tuple[Size, ...], poses: tuple[bytes, ...]) -> tuple[_Shadow, ...]:
    """All shadows on the network that SUMO has open, `net_xml`; kept for the next round."""
    lanes = [lane for name in libsumo.lane.getIDList() if (lane := _lane(name)) is not None]
    boxes = [(size, np.frombuffer(rows).reshape(-1, 4)) for size, rows in zip(sizes, poses, strict=True)]
    return tuple(shadow for lane in lanes for box in boxes if (shadow := _shadow(lane, *box)) is not None)


def _lane(name: str) -> _Lane | None:
    """A lane for cars, within junctions too; None for any other."""
    allowed = libsumo.lane.getAllowed(name)
    line = np.array(libsumo.lane.getShape(name), dtype=float)
    if (allowed and "passenger" not in allowed) or "passenger" in libsumo.lane.getDisallowed(name) or len(line) < 2:
        return None
    return _Lane(name, line)


def _shadow(lane: _Lane, size: Size, poses: Floats) -> _Shadow | None:
    """An actor's shadow in a lane; None where it never comes there."""
    rear, front = _reached(lane.line, size, poses)
    if np.isnan(front).all():
        return None
    along = headings(lane.line)[np.clip(nearest_on(lane.line, poses[:, :2]).segment, 0, len(lane.line) - 2)]
    turned = np.cos(poses[:, 2] - along)
    speed = np.maximum(poses[:, 3] * turned, 0.0)
    crosses = (np.abs(turned) < math.cos(_CROSSES_RAD)) & (poses[:, 3] > _LEAST_M)
    for ahead in _AHEAD:
        then = np.minimum(np.arange(len(front)) + ahead, len(front) - 1)
        open_yet = np.isnan(front) & crosses[then] & ~np.isnan(front[then])
        rear, front = np.where(open_yet, rear[then], rear), np.where(open_yet, front[then], front)
        speed = np.where(open_yet, 0.0, speed)
    there = ~np.isnan(front)
    at = np.where(there, front, 0.0)
    step = np.clip(np.searchsorted(arc_lengths(lane.line), at, side="right") - 1, 0, len(lane.line) - 2)
    angles = (90.0 - np.degrees(headings(lane.line)[step])) % 360.0
    lengths = np.maximum(np.where(there, front - rear, _LEAST_M), _LEAST_M)
    return _Shadow(lane.id, there, resample(lane.line, at), angles, lengths, speed)


def _reached(line: Floats, size: Size, poses: Floats) -> tuple[Floats, Floats]:
    """(n,) least and largest station of a line at which the box is in the strip beside it; nan where it is not.

    The points that are asked lie along the sides, which are nearer to each other than the strip is wide.
    """
    rear = np.full(len(poses), np.nan)
    front = rear.copy()
    near = np.abs(nearest_on(line, poses[:, :2]).left_m) <= math.hypot(*size) / 2 + _REACH_M
    rows = np.flatnonzero(near)
    if not len(rows):
        return rear, front
    along = np.linspace(-size[0] / 2, size[0] / 2, max(2, math.ceil(size[0] / _GRID_M) + 1))
    local = np.array([(x, y) for x in along for y in (-size[1] / 2, size[1] / 2)])
    points = world_points(poses[rows, :3], local[None])
    at = nearest_on(line, points.reshape(-1, 2))
    within = (np.abs(at.left_m) <= _REACH_M).reshape(points.shape[:2])
    station = at.station_m.reshape(points.shape[:2])
    there = within.any(axis=1)
    rear[rows[there]] = np.where(within, station, np.inf).min(axis=1)[there]
    front[rows[there]] = np.where(within, station, -np.inf).max(axis=1)[there]
    return rear, front
