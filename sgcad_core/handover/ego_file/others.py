"""The others of an ego's file: each a timed line of its origin that begins on the cue. Knows a staging.

Up to the conflict the line is the script's, with the vertices that every player keeps; behind it, it is what
would have come without the ego, in coarser steps.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import ActorInfo, Floats, Trajectory
from sgcad_core.case.traffic import BRAKING_MPS2, ROLE, Background
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.writing.entities import center_ahead_m
from sgcad_core.formats.openscenario.writing.vertices import APART_M, vertex_rows
from sgcad_core.formats.openscenario.writing.writer import origin_motion
from sgcad_core.geometry.plane import arc_lengths, headings, wrap_angle
from sgcad_core.handover.ego_file.cue import Cue
from sgcad_core.handover.ego_file.elements import node
from sgcad_core.handover.lane_following import Start, continued_line
from sgcad_core.handover.script import Script, Staging
from sgcad_core.roads.lane_graph import LaneGraph

AFTER_S = 8.0
"""How long the lines go on behind the conflict."""
_COARSE = 4
"""Of so many samples behind the conflict one is written."""
INDENT = "  " * 15
"""Of the vertices."""
_STILL_M = 0.02
"""An actor that goes less than this from sample to sample all the way stands."""


@dataclass(frozen=True, eq=False)
class Other:
    """One actor beside the ego."""

    info: ActorInfo
    move: Trajectory
    """Its origin's motion from the start to some time behind the conflict."""
    rows: tuple[int, ...]
    """Those that are written; none of an actor that stands."""
    clock: str
    """Its parameters for the time have this name before them: its id, that of all traffic for a background vehicle."""

    @property
    def start(self) -> Pose:
        """Where its origin begins."""
        return self.pose(0)

    def pose(self, row: int) -> Pose:
        """Its origin at a row."""
        move = self.move
        return Pose(float(move.x_m[row]), float(move.y_m[row]), float(move.heading_rad[row]))

    def follow(self, minor: int) -> ET.Element:
        """The action: along the line in its time, which parameters stretch and shift."""
        name, line = self.info.id, node("Polyline")
        line.text = self.mark
        path = node("Trajectory", node("Shape", line), name=f"{name}_line", closed=False)
        timing = node(
            "Timing",
            domainAbsoluteRelative="relative",
            scale=f"${self.clock}_TimeScale",
            offset=f"${self.clock}_TimeOffset",
        )
        mode = node("TrajectoryFollowingMode", followingMode="position")
        told = [node("TrajectoryRef", path), node("TimeReference", timing), mode]
        if minor == 0:
            told = [path, node("TimeReference", timing), mode]
        return node("RoutingAction", node("FollowTrajectoryAction", *told))

    @property
    def mark(self) -> str:
        """Stands in the action for the vertices, which are many and quicker written as text."""
        return f"@{self.info.id}@"

    @cached_property
    def vertices(self) -> str:
        """The vertices of the line, one a line of text."""
        rows = list(self.rows)
        move = self.move
        table = np.column_stack((move.t_s[rows], move.x_m[rows], move.y_m[rows], wrap_angle(move.heading_rad[rows])))
        return "".join(
            f'\n{INDENT}<Vertex time="{t:.6g}"><Position><WorldPosition x="{x:.6f}" y="{y:.6f}" z="0" h="{h:.8f}" />'
            "</Position></Vertex>"
            for t, x, y, h in (table + 0.0).tolist()
        )


@lru_cache(maxsize=2)
def others_of(staging: Staging, contact_s: float, lead_rows: int) -> tuple[Other, ...]:
    """All actors but the ego and what is coupled to it, in the script's order; the last ones are remembered.

    `lead_rows`: of the script that they leave out at the beginning.
    """
    named = [a for a in staging.script.actors if a.id in staging.lines and a.id not in staging.coupled]
    rest_s = contact_s - lead_rows * STEP_S
    moves = (_from_row(motion_of(staging, actor.id, contact_s, AFTER_S), lead_rows) for actor in named)
    return tuple(_other(actor, move, rest_s) for actor, move in zip(named, moves, strict=True))


def _from_row(move: Trajectory, row: int) -> Trajectory:
    """A motion from a row on, on a clock that begins there; a shorter one stays where it ends."""
    first = min(row, len(move.t_s) - 1)
    told = {name: getattr(move, name)[first:] for name in ("x_m", "y_m", "heading_rad", "speed_mps")}
    return move.model_copy(update=told | {"t_s": move.t_s[first:] - move.t_s[first]})


def _other(actor: ActorInfo, center: Trajectory, contact_s: float) -> Other:
    move, last = origin_motion(actor, center), len(center.t_s)
    moves = last > 1 and bool((np.hypot(*np.diff(move.points, axis=0).T) > _STILL_M).any())
    return Other(actor, move, _rows(move, center_ahead_m(actor), contact_s) if moves else (), actor.id)


def background_of(script: Script, background: Background, cue: Cue) -> tuple[Other, ...]:
    """The traffic as others: it begins with them, and behind the script it brakes to a stand in its lane."""
    return tuple(_in_background(script, info, track, cue) for info, track in background)


def _in_background(script: Script, info: ActorInfo, track: Trajectory, cue: Cue) -> Other:
    move = origin_motion(info, _from_row(stopped_behind(script.graph, track, info.maneuver), cue.lead_rows))
    moves = bool((np.hypot(*np.diff(move.points, axis=0).T) > _STILL_M).any())
    rows = _rows(move, center_ahead_m(info), 0.0) if moves else ()
    return Other(info, move, rows, ROLE)


def stopped_behind(graph: LaneGraph, track: Trajectory, maneuver: str) -> Trajectory:
    """A motion and, behind it, braking to a stand along the lanes."""
    speed = float(track.speed_mps[-1])
    x, y, heading = (float(v) for v in track.pose[-1])
    way_m, lasts_s = speed**2 / (2 * BRAKING_MPS2), speed / BRAKING_MPS2
    if lasts_s < STEP_S:
        return track
    t_s = np.arange(1, int(lasts_s / STEP_S) + 1) * STEP_S
    line = continued_line(graph, Start(x, y, heading), way_m, maneuver)
    along = arc_lengths(line)
    at = np.clip(speed * t_s - BRAKING_MPS2 * t_s**2 / 2, 0.0, along[-1])
    more = np.column_stack([np.interp(at, along, line[:, k]) for k in (0, 1)] + [np.interp(at, along, headings(line))])
    pose = np.vstack((track.pose, more))
    end = float(track.t_s[-1])
    return track.model_copy(update={
        "t_s": np.append(track.t_s, end + t_s), "x_m": pose[:, 0], "y_m": pose[:, 1],
        "heading_rad": np.unwrap(pose[:, 2]),
        "speed_mps": np.append(track.speed_mps, np.maximum(speed - BRAKING_MPS2 * t_s, 0.0)),
    })  # fmt: skip


def motion_of(staging: Staging, name: str, contact_s: float, after_s: float) -> Trajectory:
    """A box center's motion: the script's up to the conflict, that instant included, then what would have come.

    A line ends one sample before the contact, and two that only graze would miss each other there.
    """
    line = staging.way if name == staging.ego else staging.lines[name]
    n = min(round((contact_s + after_s) / STEP_S) + 1, len(line.t_s))
    track = next(t for t in staging.script.trajectories if t.actor == name)
    told = min(round(contact_s / STEP_S) + 1, n, len(track.t_s))
    pose = np.vstack((track.pose[:told], line.pose[told:n]))
    x, y, heading = pose[:, 0], pose[:, 1], np.unwrap(pose[:, 2])
    t_s, speed = line.t_s[:n], line.speed_mps[:n]
    return Trajectory(actor=name, t_s=t_s, x_m=x, y_m=y, heading_rad=heading, speed_mps=speed)


def _rows(move: Trajectory, ahead_m: float, contact_s: float) -> tuple[int, ...]:
    """Up to the conflict what players keep, then some."""
    near = min(round(contact_s / STEP_S) + 1, len(move.t_s))
    names = ("t_s", "x_m", "y_m", "heading_rad", "speed_mps")
    before = move.model_copy(update={name: getattr(move, name)[:near] for name in names} | {"roll_rad": None})
    rows = vertex_rows(before, ahead_m) if near > 1 else [0]
    for row in range(rows[-1] + 1, len(move.t_s)):
        last = row == len(move.t_s) - 1
        if last or ((row - near) % _COARSE == 0 and _away_m(move.points, rows[-1], row) >= APART_M):
            rows.append(row)
    return tuple(rows)


def _away_m(points: Floats, first: int, second: int) -> float:
    return float(np.hypot(*(points[second] - points[first])))
