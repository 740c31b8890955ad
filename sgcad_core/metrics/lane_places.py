"""Where a motion drives: for every sample the lane that it is on, and whether that is a lane of its direction.

Pure functions on a lane graph and poses; knows no report, no actor and no contact. Metres and radians in the network's
frame. The place of a box is that of its center.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import Literal, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import Floats
from sgcad_core.metrics.drivability import STEP_S
from sgcad_core.roads.lane_graph import Edge, Lane, LaneGraph

Place = Literal["lane", "center_lane", "junction", "beside", "beyond", "opposing", "off"]
"""In a lane for cars of its direction; in a two-way left-turn lane; in the area of a junction; in a lane beside those
for cars (bicycle, parking, shoulder, sidewalk); on the straight run of a lane beyond the drawn end of its road; in a
lane for cars of the other direction; in none of these."""
PLACES: tuple[Place, ...] = ("lane", "center_lane", "junction", "beside", "beyond", "opposing", "off")
_LANE, _CENTER, _JUNCTION, _BESIDE, _BEYOND, _OPPOSING, _OFF = range(7)
EDGE_M = 0.3
"""By which a center may lie over the edge of a lane: the edge lines are 0.1 to 0.15 m wide, and lanes of one road do
not always join without a gap."""
_END_M = 0.6
"""Beyond the end of a lane by which a center is still in it."""
_LINK_M = 2.1
"""Half the width of a way across a junction: a lane's and the room that a turn sweeps."""
_STANDS_M = 0.01
"""Way between two samples below which a box stands."""
_BEYOND_M = 400.0
"""The run beyond the drawn end of a road: an approach of 8 s at 80 mph, and more."""


class LaneSteps(NamedTuple):
    """By sample: the code of its place (an index of `PLACES`), and the id of its lane, "" where it is in none."""

    codes: NDArray[np.int_]
    lanes: tuple[str, ...]

    @property
    def places(self) -> tuple[Place, ...]:
        """By sample the place in words."""
        return tuple(PLACES[code] for code in self.codes)

    @property
    def first(self) -> int | None:
        """The first sample in a lane; None where none is."""
        return next((k for k, name in enumerate(self.lanes) if name), None)

    def in_turn(self) -> str:
        """The lanes and places in their order, each with its seconds: "E_0 2.1 s, opposing W_1 1.4 s"."""
        shown = [
            f"{'' if place == 'lane' else place} {lane}".strip()
            for place, lane in zip(self.places, self.lanes, strict=True)
        ]
        runs = [(name, len(list(some))) for name, some in groupby(shown)]
        return ", ".join(f"{name} {count * STEP_S:.1f} s" for name, count in runs)


@dataclass(frozen=True, eq=False)
class _Pieces:
    """Straight pieces of center lines: (n, 2) ends, (n,) half widths, codes, lane numbers, and which may not be passed
    at their start or end."""

    starts: Floats
    ends: Floats
    halves: Floats
    codes: NDArray[np.int_]
    lanes: NDArray[np.int_]
    first: NDArray[np.bool_]
    last: NDArray[np.bool_]
    names: tuple[str, ...]
    areas: tuple[Floats, ...]


def lane_steps(graph: LaneGraph, poses: Floats) -> LaneSteps:
    """The places of (n, 3) poses."""
    pieces = _pieces_of(graph)
    codes, lanes = np.full(len(poses), _OFF), np.full(len(poses), -1)
    within = _within(pieces, poses)
    for code, which in _by_rank(pieces, poses, within):
        free = (codes == _OFF) & which.any(axis=1)
        codes[free] = code
        lanes[free] = pieces.lanes[which[free].argmax(axis=1)]
        if code == _CENTER:
            codes[(codes == _OFF) & _in_areas(pieces.areas, poses)] = _JUNCTION
    return LaneSteps(codes, tuple(pieces.names[lane] if lane >= 0 else "" for lane in lanes))


def _by_rank(pieces: _Pieces, poses: Floats, within: NDArray[np.bool_]) -> Iterator[tuple[int, NDArray[np.bool_]]]:
    """Codes with the (n, m) pieces that give them, those first that count where several fit."""
    way = pieces.ends - pieces.starts
    along = np.cos(poses[:, 2])[:, None] * way[:, 0] + np.sin(poses[:, 2])[:, None] * way[:, 1] > 0
    along |= _travel(poses) @ way.T > 0
    of = {code: within & (pieces.codes == code) for code in (_LANE, _CENTER, _JUNCTION, _BESIDE, _BEYOND)}
    yield _LANE, of[_LANE] & along
    yield _CENTER, of[_CENTER]
    yield _JUNCTION, of[_JUNCTION]
    yield _BEYOND, of[_BEYOND] & along
    yield _BESIDE, of[_BESIDE]
    yield _OPPOSING, (of[_LANE] | of[_BEYOND]) & ~along


def _travel(poses: Floats) -> Floats:
    """(n, 2) metres of travel around each sample; none where it stands. A box that backs up or slides in a lane faces
    against it, or goes against it, but not both."""
    if len(poses) < 3:
        return np.zeros((len(poses), 2))
    steps: Floats = np.gradient(poses[:, :2], axis=0)
    return np.where(np.hypot(*steps.T)[:, None] > _STANDS_M, steps, 0.0)


def _within(pieces: _Pieces, poses: Floats) -> NDArray[np.bool_]:
    """(n, m) whether a pose's center is within a piece."""
    way = pieces.ends - pieces.starts
    square = np.maximum((way**2).sum(axis=1), 1e-9)
    dx, dy = (poses[:, i, None] - pieces.starts[None, :, i] for i in (0, 1))
    share = (dx * way[:, 0] + dy * way[:, 1]) / square
    over = _END_M / np.sqrt(square)
    near = np.clip(share, 0.0, 1.0)
    away = np.hypot(dx - near * way[:, 0], dy - near * way[:, 1])
    passed = (pieces.first & (share < -over)) | (pieces.last & (share > 1 + over))
    found: NDArray[np.bool_] = (away <= pieces.halves) & ~passed
    return found


def _in_areas(areas: tuple[Floats, ...], poses: Floats) -> NDArray[np.bool_]:
    """(n,) whether a center lies in one of some convex outlines (counter-clockwise)."""
    found = np.zeros(len(poses), dtype=bool)
    for outline in areas:
        way = np.roll(outline, -1, axis=0) - outline
        dx, dy = (poses[:, i, None] - outline[None, :, i] for i in (0, 1))
        found |= (way[:, 0] * dy - way[:, 1] * dx >= -EDGE_M * np.hypot(*way.T)).all(axis=1)
    return found


# ------------------------------------------------------------------ the pieces of a network
def _pieces_of(graph: LaneGraph) -> _Pieces:
    """The pieces of a network, made once."""
    key = "lane_places"
    if (known := graph.derived.get(key)) is None:
        known = graph.derived[key] = _made(graph)
    return cast("_Pieces", known)


def _made(graph: LaneGraph) -> _Pieces:
    names: list[str] = []
    rows: list[tuple[Floats, Floats, int, float, int, bool, bool]] = []
    for line, code, half, name in (*_lane_lines(graph), *_links(graph)):
        names.append(name)
        count = len(line) - 1
        ends = code != _JUNCTION
        rows += [
            (line[i], line[i + 1], code, half, len(names) - 1, ends and i == 0, ends and i == count - 1)
            for i in range(count)
        ]
    starts, ends_, codes, halves, lanes, first, last = (np.array(column) for column in zip(*rows, strict=True))
    return _Pieces(starts, ends_, halves, codes, lanes, first, last, tuple(names), tuple(_areas(graph)))


def _lane_lines(graph: LaneGraph) -> Iterator[tuple[Floats, int, float, str]]:
    """Center lines of all lanes with code, half width and id; and the straight runs beyond the ends of roads."""
    neighbors = _neighbors(graph)
    for edge in graph.edges.values():
        for lane in edge.lanes:
            code = _code_of(edge, lane)
            half = lane.width_m / 2 + EDGE_M
            yield lane.shape, code, half, lane.id
            for node, at, inner in ((edge.from_node, 0, 1), (edge.to_node, -1, -2)):
                if code == _LANE and len(neighbors[node]) < 2:
                    yield _run(lane.shape[inner], lane.shape[at], onward=at == -1), _BEYOND, half, lane.id


def _code_of(edge: Edge, lane: Lane) -> int:
    if lane in edge.laid_lanes:
        return _LANE
    return _BESIDE if lane.type else _CENTER


def _run(inner: Floats, end: Floats, *, onward: bool) -> Floats:
    """The straight run beyond the end of a line, in the direction of travel."""
    away = (end - inner) / max(float(np.hypot(*(end - inner))), 1e-9)
    far = end + _BEYOND_M * away
    return np.array([end, far] if onward else [far, end])


def _neighbors(graph: LaneGraph) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for edge in graph.edges.values():
        found.setdefault(edge.from_node, set()).add(edge.to_node)
        found.setdefault(edge.to_node, set()).add(edge.from_node)
    return found


def _links(graph: LaneGraph) -> Iterator[tuple[Floats, int, float, str]]:
    for link in graph.connections:
        if len(link.via_shape) > 1:
            yield link.via_shape, _JUNCTION, _LINK_M, ""


def _areas(graph: LaneGraph) -> Iterator[Floats]:
    """The convex outline of the ends of all lanes that meet at a node, for every node of two roads and more."""
    ends: dict[str, list[Floats]] = {}
    for edge in graph.edges.values():
        for lane in edge.lanes:
            for node, at, inner in ((edge.from_node, 0, 1), (edge.to_node, -1, -2)):
                way = lane.shape[inner] - lane.shape[at]
                across = np.array([-way[1], way[0]]) / max(float(np.hypot(*way)), 1e-9) * lane.width_m / 2
                ends.setdefault(node, []).extend((lane.shape[at] + across, lane.shape[at] - across))
    neighbors = _neighbors(graph)
    for node, points in ends.items():
        if len(neighbors[node]) > 1 and len(outline := _hull(points)) > 2:
            yield outline


def _hull(points: list[Floats]) -> Floats:
    """The convex outline of points, counter-clockwise (A. M. Andrew, 1979)."""
    order = sorted({(round(float(x), 3), round(float(y), 3)) for x, y in points})
    halves = [_half_hull(order), _half_hull(order[::-1])]
    return np.array(halves[0][:-1] + halves[1][:-1])


def _half_hull(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    chain: list[tuple[float, float]] = []
    for point in points:
        while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 0:
            chain.pop()
        chain.append(point)
    return chain


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def lane_heading(graph: LaneGraph, pose: Floats) -> float | None:
    """The direction of the lane for cars that a pose is on, radians; None where it is on none."""
    pieces = _pieces_of(graph)
    fits = _within(pieces, pose[None])[0] & (pieces.codes == _LANE)
    way = pieces.ends - pieces.starts
    fits &= np.cos(pose[2]) * way[:, 0] + np.sin(pose[2]) * way[:, 1] > 0
    if not fits.any():
        return None
    east, north = way[int(fits.argmax())]
    return float(np.arctan2(north, east))
