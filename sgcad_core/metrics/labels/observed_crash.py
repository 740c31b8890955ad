"""An executed crash for comparison with labels: its contacts, and one vehicle's motion up to its first contact.

Derived from the motion and the roads alone. Knows no label.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from sgcad_core.geometry.distances import nearest_on
from sgcad_core.geometry.plane import Floats, box_gaps, prolonged, wrap_angle
from sgcad_core.metrics.labels.motion_label_match import Path, way_m
from sgcad_core.metrics.rest_error import rest_errors
from sgcad_core.records.course import RestTold
from sgcad_core.roads.lane_graph import Edge, Lane, LaneGraph
from sgcad_core.roads.surface import RoadSurface, road_surface

BEFORE_S = 3.5
"""Time before the first contact in which an evasion is searched."""
STEP_S = 0.05
_APART_S = 0.15
"""Time apart after which two actors touch again."""
_FAR_M = 8.0
"""Distance from a lane beyond which no vehicle starts in it."""


@dataclass(frozen=True)
class Crash:
    """An execution: motion of all actors, and the roads."""

    paths: Mapping[str, Path]
    graph: LaneGraph

    @cached_property
    def surface(self) -> RoadSurface:
        """The paved surface."""
        return road_surface(self.graph)

    @cached_property
    def touches(self) -> list[tuple[float, str, str]]:
        """The beginnings of all contacts in order: (time, actor, actor); a second one only after both were apart."""
        return sorted(hit for a, b in combinations(sorted(self.paths), 2) for hit in _touches(self.paths, a, b))

    def first_of(self, actor: str) -> int:
        """The sample of an actor's first contact; the last one where it has none."""
        path = self.paths[actor]
        times = [t for t, a, b in self.touches if actor in (a, b)]
        return int(np.searchsorted(path.t_s, times[0] - 1e-6)) if times else len(path.t_s) - 1


def _touches(paths: Mapping[str, Path], a: str, b: str) -> Iterator[tuple[float, str, str]]:
    count = min(len(paths[a].t_s), len(paths[b].t_s))
    gaps = box_gaps(paths[a].pose[:count], paths[a].size, paths[b].pose[:count], paths[b].size)
    if gaps[0] <= 0:
        return
    last = -math.inf
    for k in np.flatnonzero(gaps <= 0):
        t = float(paths[a].t_s[k])
        if t - last > _APART_S:
            yield t, a, b
        last = t


@dataclass(frozen=True)
class VehicleMotion:
    """One vehicle's motion, seen from its own first contact."""

    crash: Crash
    actor: str

    @cached_property
    def path(self) -> Path:
        return self.crash.paths[self.actor]

    @cached_property
    def hit(self) -> int:
        return self.crash.first_of(self.actor)

    @cached_property
    def turns_from(self) -> int:
        """The sample from which a told rotation is seen: that of its first contact, the first where it has none."""
        touched = any(self.actor in (a, b) for _, a, b in self.crash.touches)
        return self.hit if touched else 0

    @cached_property
    def before(self) -> Floats:
        """(n, 3) poses up to the contact."""
        return self.path.pose[: self.hit + 1]

    @cached_property
    def speed(self) -> Floats:
        """(n - 1,) m/s between the samples before the contact."""
        found: Floats = np.hypot(*np.diff(self.before[:, :2], axis=0).T) / np.diff(self.path.t_s[: self.hit + 1])
        return found

    @cached_property
    def home(self) -> tuple[Edge, Lane] | None:
        """The lane in which it starts: the nearest in its direction."""
        heading = self.before[0, 2]
        best: tuple[float, Edge, Lane] | None = None
        for edge in self.crash.graph.edges.values():
            for lane in edge.car_lanes:
                near = nearest_on(lane.shape, self.before[:1, :2])
                way = np.diff(lane.shape, axis=0)[near.segment[0]]
                turned = abs(float(wrap_angle(math.atan2(way[1], way[0]) - heading)))
                cost = abs(float(near.left_m[0])) + (_FAR_M if turned > math.pi / 2 else 0.0)
                best = (cost, edge, lane) if best is None or cost < best[0] else best
        return None if best is None or best[0] > _FAR_M else best[1:]

    @cached_property
    def aside(self) -> Floats:
        """(n,) metres to the left of its first lane and its continuation, up to the contact."""
        return self._aside_of(ahead_of(self.crash.graph, *self.home) if self.home else self.before[:2, :2])

    @cached_property
    def off_line(self) -> Floats:
        """(n,) metres to the left of the straight continuation of its first lane."""
        return self._aside_of(self.home[1].shape if self.home else self.before[:2, :2])

    def _aside_of(self, line: Floats) -> Floats:
        return nearest_on(prolonged(line, 200.0), self.before[:, :2]).left_m

    def recent(self) -> slice:
        """The samples of the last seconds before the contact."""
        return slice(max(0, self.hit - round(BEFORE_S / STEP_S)), self.hit + 1)

    def turned_deg(self) -> float:
        """Heading change up to the contact, left positive."""
        return math.degrees(float(wrap_angle(np.diff(self.before[:, 2])).sum()))

    def moved_m(self, kind: str | None) -> float:
        """The displacement up to the contact that tells a maneuver, metres."""
        return way_m(kind, self.before, self.path.t_s[: self.hit + 1])

    def rest(self, told: RestTold) -> dict[str, bool]:
        """By stated part of the rest whether the last pose is right."""
        return rest_errors(
            told, self.path.pose[-1:], float(self.before[-1, 2]), self.crash.surface, self.path.pose[0]
        ).right()


def ahead_of(graph: LaneGraph, edge: Edge, lane: Lane) -> Floats:
    """(n, 2) center line of a lane and of those that lead straight on from it, node after node."""
    line, seen = [lane.shape], {edge.id}
    while on := next((c for c in graph.leaving(edge.id, lane.index) if c.direction == "through"), None):
        if on.to_edge in seen:
            break
        edge = graph.edges[on.to_edge]
        lane = next(other for other in edge.lanes if other.index == on.to_lane)
        seen.add(edge.id)
        line += [on.via_shape, lane.shape]
    return np.vstack(line)
