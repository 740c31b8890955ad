"""The geometry of the lanes of a road spec: smooth center lines, medians, and the left border of each direction.

Metres; x east, y north. Traffic keeps to the right, so a direction's lanes lie to the right of its left
border. Knows the spec and numpy; no SUMO, no OpenDRIVE.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from sgcad_core.geometry.plane import Floats, arc_lengths, offset_polyline, resample
from sgcad_core.kinds import DRIVEWAY
from sgcad_core.records.specs import Beside, Leg, Node, Road, RoadSpec, is_aisle
from sgcad_core.roads.alignment import Alignment, RoadSection, aligned, joined_road, throughs
from sgcad_core.roads.circle import SPLITTER_M

Direction = Literal["forward", "backward"]

LANE_M = 3.6
"""U.S. through lane (12 ft)."""
DRIVEWAY_LANE_M = 3.0
ALLEY_LANE_M = 2.7
"""Half of an alley of 18 ft; cities ask for 16 to 20 ft."""
CIRCLE_LANE_M = 4.9
"""Of a roundabout (16 ft, NCHRP 672)."""
MEDIAN_M = {"none": 0.0, "painted": 1.2, "raised": 2.4, "grass": 8.0, "barrier": 1.8}
"""Gap between the directions. Grass medians are often wider; beyond this a junction no longer looks like one."""
BESIDE_M: Mapping[Beside, float] = {"bike_lane": 1.5, "parking": 2.4, "shoulder": 2.4, "sidewalk": 1.8}
"""Usual widths (AASHTO 2018: 5, 8, 8 and 6 ft)."""
STALL_M = 5.5
"""Depth of the stalls along an aisle of a parking lot (18 ft), square to it."""
AISLE_LANE_M = 3.6
"""Half of an aisle between square stalls (24 ft)."""
ORDER: tuple[Beside, ...] = get_args(Beside)
STEP_M = 3.0
TAPER_M, TAPER_PER_M = 30.0, 10.0
"""Length over which a gap changes: at least, and for each metre by which a lane swings aside."""
WITHIN_M = 15.0
"""From a node to the corners of a junction of wide roads: up to there a gap keeps the width that it has at the node."""
OPENING_M = 15.0
"""Length of an opening in a median (AASHTO 2018, 9.8: 40 ft and more)."""
ISLAND_M = 40.0
"""Length of a roundabout's splitter island."""


@dataclass(frozen=True)
class Roadway:
    """A road with what its ends need: `gap_m` between the directions along the road and at (from, to)."""

    road: Road
    center: Floats
    gap_m: float
    end_gaps_m: tuple[float, float]
    has_twin: bool = False
    """One-way, and another one-way road joins the same nodes the other way."""
    opens: tuple[bool, bool] = (False, False)
    """Whether its (from, to) end opens into a roundabout: both directions part there as its splitter island widens."""

    def left_border(self, direction: Direction) -> Floats:
        """(n, 2) left border of a direction's lanes (the two-way left-turn lane included), in travel direction."""
        line = self.center if direction == "forward" else self.center[::-1]
        if len(line) == 2 and len({self.gap_m, *self.end_gaps_m}) > 1:
            length = arc_lengths(line)[-1]
            line = resample(line, np.linspace(0, length, 2 + int(length / STEP_M)))
        left = self._shift(direction) - self._gaps(line, direction) / 2
        return offset_polyline(line, left) if left.any() else line

    def _shift(self, direction: Direction) -> float:
        """Distance of the left border to the left of the center line, without medians.

        A two-way left-turn lane straddles the center line and belongs to the forward edge; a one-way road lies on its
        line, unless another road beside it carries the opposite traffic.
        """
        width = lane_width_m(self.road)
        if two_way(self.road):
            return has_center_lane(self.road) * width / 2 * (1 if direction == "forward" else -1)
        return 0.0 if self.has_twin else lanes(self.road, direction) * width / 2

    def _gaps(self, line: Floats, direction: Direction) -> Floats:
        """The gap at every point: the road's own, tapered smoothly to that of its ends."""
        along = arc_lengths(line)
        (start, end), (at_start, at_end) = self.end_gaps_m, self.opens
        if direction == "backward":
            start, end, at_start, at_end = end, start, at_end, at_start
        tapers = [max(TAPER_M, TAPER_PER_M * abs(self.gap_m - gap) / 2) for gap in (start, end)]
        from_start = _eased(along, float(along[-1]), tapers[0], at_start)
        from_end = _eased(along[-1] - along, float(along[-1]), tapers[1], at_end)
        return start + (self.gap_m - start) * from_start + (end - self.gap_m) * (1 - from_end)


def _eased(from_end: Floats, length_m: float, taper_m: float, opens: bool) -> Floats:
    """0 to 1 with level ends, away from the end of a road; the last metres lie within the junction.

    Where a road opens into a roundabout, level at 1 only: it enters at an angle.
    """
    taper, held = (ISLAND_M, 0.0) if opens else (taper_m, min(WITHIN_M, length_m / 4))
    x = np.clip((from_end - held) / max(min(taper, length_m / 2 - held), 1e-9), 0.0, 1.0)
    return np.asarray(x * (2 - x) if opens else x * x * (3 - 2 * x), dtype=float)


def lanes(road: Road, direction: Direction) -> int:
    """Lanes that passenger cars use."""
    return road.lanes_forward if direction == "forward" else road.lanes_backward


def open_lanes(road: Road, direction: Direction) -> tuple[int, ...]:
    """Lanes of a direction that no work zone closes, from 0 at the right curb."""
    closed = road.closed_forward if direction == "forward" else road.closed_backward
    return tuple(i for i in range(lanes(road, direction)) if i + 1 not in closed)


def two_way(road: Road) -> bool:
    """Whether the road has lanes in both directions."""
    return road.lanes_forward > 0 and road.lanes_backward > 0


def has_center_lane(road: Road) -> bool:
    """Whether the road really has a two-way left-turn lane: a one-way road has not."""
    return road.center_turn_lane and two_way(road)


def lane_width_m(road: Road) -> float:
    """Lane width in metres."""
    if road.circle:
        return CIRCLE_LANE_M
    if is_aisle(road):
        return AISLE_LANE_M
    if road.alley:
        return ALLEY_LANE_M
    return DRIVEWAY_LANE_M if road.kind == DRIVEWAY else LANE_M


def beside_m(road: Road | Leg, what: Beside) -> float:
    """Width of what lies beside the lanes, metres."""
    return STALL_M if what == "parking" and is_aisle(road) else BESIDE_M[what]


def beside(road: Road) -> tuple[Beside, ...]:
    """What lies beside the lanes of either direction, from the lanes outwards, each once."""
    return tuple(what for what in ORDER if what in road.beside)


def roadways(spec: RoadSpec) -> dict[str, Roadway]:
    """Every road with its geometry, by id. The spec's references must hold (`road_spec.spec_findings`)."""
    nodes = {node.id: node for node in spec.nodes}
    meeting = _roads_at(spec)
    lined_up = aligned(list(throughs(nodes, meeting)), _section, lambda road: _is_single(road, meeting))
    return {road.id: _roadway(road, nodes, meeting, lined_up) for road in spec.roads}


def _section(road: Road) -> RoadSection:
    width = lane_width_m(road)
    gap = width if has_center_lane(road) else median_gap_m(road)
    return RoadSection(width, gap, -max(road.lanes_forward, road.lanes_backward) * width / 2)


def _is_single(road: Road, meeting: Mapping[str, Sequence[Road]]) -> bool:
    """Whether it is a one-way road without another beside it that carries the opposite traffic."""
    return not two_way(road) and not _has_twin(road, meeting[road.from_node])


def _roadway(
    road: Road, nodes: Mapping[str, Node], meeting: Mapping[str, Sequence[Road]], lined_up: Alignment
) -> Roadway:
    inner = [(p.x_m, p.y_m) for p in road.via]
    ends = nodes[road.from_node], nodes[road.to_node]
    points = np.array([(ends[0].x_m, ends[0].y_m), *inner, (ends[1].x_m, ends[1].y_m)], dtype=float)
    there = meeting[road.from_node], meeting[road.to_node]
    opens = _opens(road, there[0]), _opens(road, there[1])
    gaps = _end_gap(road, ends[0], there[0], lined_up), _end_gap(road, ends[1], there[1], lined_up)
    line = smooth(points) + _beside_road(road, nodes, meeting, lined_up)
    if aside := lined_up.aside_m.get(road.id):
        line = offset_polyline(line, -aside)
    line = _cut(line, ends[0].opening, ends[1].opening)
    return Roadway(road, line, median_gap_m(road), gaps, _has_twin(road, there[0]), opens)


def _cut(line: Floats, at_start: bool, at_end: bool) -> Floats:
    """A center line that ends before an opening in the median."""
    along = arc_lengths(line)
    start, end = OPENING_M / 2 * at_start, along[-1] - OPENING_M / 2 * at_end
    if end - start == along[-1] or end - start < STEP_M:
        return line
    return resample(line, np.array([start, *along[(along > start) & (along < end)], end]))


def _beside_road(
    road: Road, nodes: Mapping[str, Node], meeting: Mapping[str, Sequence[Road]], lined_up: Alignment
) -> Floats:
    """(2,) shift of a ramp to the right of the line through its nodes, so that it meets the outer lane of its road."""
    way = joined_road(road, nodes, meeting)
    if way is None:
        return np.zeros(2)
    both, width = two_way(way.road), lane_width_m(way.road)
    inner = (median_gap_m(way.road) + has_center_lane(way.road) * width) / 2 if both else -way.lanes * width / 2
    right = np.array([way.travel[1], -way.travel[0]])
    aside = lined_up.aside_m.get(way.road.id, 0.0) * (1 if way.forward else -1)
    found: Floats = right * (inner + aside + (way.lanes - 0.5) * width)
    return found


def _opens(road: Road, meeting: Sequence[Road]) -> bool:
    """Whether a two-way road opens into a circle at a node."""
    return two_way(road) and not road.circle and any(other.circle for other in meeting)


def _has_twin(road: Road, meeting: Sequence[Road]) -> bool:
    start, end = flow(road)
    return not two_way(road) and any(not two_way(r) and flow(r) == (end, start) for r in meeting)


def flow(road: Road) -> tuple[str, str]:
    """Nodes of a one-way road in travel direction (of a two-way road in forward direction)."""
    return (road.from_node, road.to_node) if road.lanes_forward else (road.to_node, road.from_node)


def median_gap_m(road: Road) -> float:
    """Gap between the directions; none on a one-way road nor where a two-way left-turn lane takes its place."""
    return MEDIAN_M[road.median] if two_way(road) and not road.center_turn_lane else 0.0


def _roads_at(spec: RoadSpec) -> dict[str, list[Road]]:
    found: dict[str, list[Road]] = {node.id: [] for node in spec.nodes}
    for road in spec.roads:
        found[road.from_node].append(road)
        found[road.to_node].append(road)
    return found


def _end_gap(road: Road, node: Node, meeting: Sequence[Road], lined_up: Alignment) -> float:
    """At a node of two roads both have the narrower gap, so that lanes meet; at a junction that of what goes on there.

    Of a road with a two-way left-turn lane: what lies between the directions besides that lane.
    """
    if _opens(road, meeting):
        return max(SPLITTER_M, median_gap_m(road))
    centered = any(has_center_lane(r) for r in meeting)
    if len(meeting) == 2 and not centered:
        return min(median_gap_m(r) for r in meeting)
    gap = lined_up.gaps_m.get((road.id, node.id))
    return median_gap_m(road) if gap is None else gap - has_center_lane(road) * lane_width_m(road)


# ------------------------------------------------------------------ smoothing
def smooth(points: Floats, step_m: float = STEP_M) -> Floats:
    """A cubic spline through (n, 2) points, a vertex about every `step_m`; two points stay a line.

    Parameter: chord length; ends: as curved as their neighbors, so that points of an arc give the arc (its
    turn is spread evenly). Points nearer than 0.5 m to the one before are dropped.
    """
    points = _apart(points)
    if len(points) < 3:
        return points
    chords = np.hypot(*np.diff(points, axis=0).T)
    bends = _bends(points, chords)
    pieces = [_piece(points[i : i + 2], bends[i : i + 2], float(h), step_m) for i, h in enumerate(chords)]
    return np.vstack([*pieces, points[-1:]])


def _apart(points: Floats, least_m: float = 0.5) -> Floats:
    kept = [points[0]]
    for point in points[1:-1]:
        if min(np.hypot(*(point - kept[-1])), np.hypot(*(point - points[-1]))) >= least_m:
            kept.append(point)
    return np.array([*kept, points[-1]])


def _bends(points: Floats, chords: Floats) -> Floats:
    """(n, 2) second derivatives of the spline at its points."""
    n = len(points)
    rows, slopes = np.zeros((n, n)), np.zeros((n, 2))
    rows[0, :2], rows[-1, -2:] = (1, -1), (-1, 1)
    for i in range(1, n - 1):
        rows[i, i - 1 : i + 2] = chords[i - 1], 2 * (chords[i - 1] + chords[i]), chords[i]
    speeds = np.diff(points, axis=0) / chords[:, None]
    slopes[1:-1] = 6 * np.diff(speeds, axis=0)
    return np.asarray(np.linalg.solve(rows, slopes), dtype=float)


def _piece(ends: Floats, bends: Floats, chord: float, step_m: float) -> Floats:
    """The spline between two points, without the second."""
    t = np.linspace(0, chord, max(1, round(chord / step_m)), endpoint=False)[:, None]
    u = chord - t
    found: Floats = (bends[0] * u**3 + bends[1] * t**3) / (6 * chord)
    found += (ends[0] / chord - bends[0] * chord / 6) * u + (ends[1] / chord - bends[1] * chord / 6) * t
    return found
