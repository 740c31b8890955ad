"""A crash as a CommonRoad scenario: lanelets, obstacles with trajectories, and the ego as a planning problem.

Format 2020a. Lanelets follow the lanes of the network; signals and signs are left out, and crossings. Places are box
centers. The format's own library is not used: it asks for a protobuf that our other libraries exclude. Its reader reads
these files (`research/checks/commonroad_reader.py`). Knows no file.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sgcad_core.case.records import ActorInfo, Floats, Trajectory
from sgcad_core.formats.lane_pieces import Piece, pieces_of
from sgcad_core.geometry.plane import wrap_angle
from sgcad_core.roads.lane_graph import LaneGraph

DT_S = 0.05
GOAL_M, LANE_M = 10.0, 3.5
"""Length and width of the goal's box."""
STILL_M = 0.02
"""An actor that moves less than this all the way stands."""
AUTHOR = "SG-CADVLM"
_TYPES = {
    "car": "car", "van": "car", "truck": "truck", "semitrailer": "truck", "trailer": "truck", "bus": "bus",
    "motorbike": "motorcycle", "bicycle": "bicycle", "pedestrian": "pedestrian", "tram": "train", "train": "train",
}  # fmt: skip
"""Obstacle types by the actor's category."""


@dataclass(frozen=True)
class Problem:
    """What a file is made of."""

    case: str
    graph: LaneGraph
    infos: Mapping[str, ActorInfo]
    ego: Trajectory
    """The motion of the report's driver: its first state and where it ends are the problem."""
    others: Sequence[Trajectory]
    """On the same clock, 0.05 s a row."""
    date: str
    """As 2026-11-27."""


def write_commonroad(problem: Problem) -> str:
    """The XML."""
    pieces = pieces_of(problem.graph)
    numbers = {name: k for k, name in enumerate(pieces, 1)}
    free = len(numbers) + 1
    obstacles = (_obstacle(free + k, problem.infos[m.actor], m) for k, m in enumerate(problem.others))
    root = _node(
        "commonRoad", _location(), _node("scenarioTags", _node("critical")),
        *(_lanelet(piece, numbers) for piece in pieces.values()), *obstacles,
        _planning(free + len(problem.others), problem.ego),
        timeStepSize=f"{DT_S:g}", commonRoadVersion="2020a", author=AUTHOR, affiliation=AUTHOR,
        source=f"crash report {problem.case}", benchmarkID=benchmark_id(problem.case), date=problem.date,
    )  # fmt: skip
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def benchmark_id(case: str) -> str:
    """The format's name of a scenario: country, map, number, one configuration with trajectories."""
    letters = re.sub(r"[^A-Za-z]", "", case).capitalize() or "Crash"
    number = int(re.sub(r"\D", "", case)[-9:] or 1) or 1
    return f"USA_{letters}-{number}_1_T-1"


def _node(tag: str, *inside: ET.Element, text: str = "", **told: str) -> ET.Element:
    made = ET.Element(tag, told)
    made.text = text or None
    made.extend(inside)
    return made


def _number(tag: str, value: float) -> ET.Element:
    return _node(tag, text=f"{value + 0.0:.6g}" if abs(value) < 1e-4 else f"{value:.6f}".rstrip("0").rstrip("."))


def _exact(tag: str, value: float) -> ET.Element:
    return _node(tag, _number("exact", value))


def _point(x_m: float, y_m: float, tag: str = "point") -> ET.Element:
    return _node(tag, _number("x", x_m), _number("y", y_m))


def _location() -> ET.Element:
    """Nowhere on earth."""
    return _node(
        "location", _node("geoNameId", text="-999"), _node("gpsLatitude", text="999"), _node("gpsLongitude", text="999")
    )


# ------------------------------------------------------------------ map
def _lanelet(piece: Piece, numbers: Mapping[str, int]) -> ET.Element:
    kind = "intersection" if piece.crosses else "urban" if piece.cars else "sidewalk"
    return _node(
        "lanelet", _bound("leftBound", piece.side(1)), _bound("rightBound", piece.side(-1)),
        *(_node("predecessor", ref=str(numbers[name])) for name in piece.before),
        *(_node("successor", ref=str(numbers[name])) for name in piece.after),
        *_beside(piece, numbers), _node("laneletType", text=kind), id=str(numbers[piece.id]),
    )  # fmt: skip


def _beside(piece: Piece, numbers: Mapping[str, int]) -> Iterator[ET.Element]:
    for tag, name in (("adjacentLeft", piece.left), ("adjacentRight", piece.right)):
        if name:
            yield _node(tag, ref=str(numbers[name]), drivingDir="same")
        elif tag == "adjacentLeft" and piece.opposite:
            yield _node(tag, ref=str(numbers[piece.opposite]), drivingDir="opposite")


def _bound(tag: str, line: Floats) -> ET.Element:
    return _node(tag, *(_point(float(x), float(y)) for x, y in line))


# ------------------------------------------------------------------ actors
def _obstacle(number: int, info: ActorInfo, move: Trajectory) -> ET.Element:
    shape = _node("shape", _node("rectangle", _number("length", info.length_m), _number("width", info.width_m)))
    start = _node("initialState", *_state(move, 0))
    if float(np.ptp(move.points, axis=0).max()) < STILL_M:
        kind = "parkedVehicle" if info.record.axles else "roadBoundary"
        return _node("staticObstacle", _node("type", text=kind), shape, start, id=str(number))
    kind = _TYPES.get(info.record.category, "unknown")
    way = _node("trajectory", *(_node("state", *_state(move, row)) for row in range(1, len(move.t_s))))
    return _node("dynamicObstacle", _node("type", text=kind), shape, start, way, id=str(number))


def _state(move: Trajectory, row: int) -> list[ET.Element]:
    return [
        _node("position", _point(float(move.x_m[row]), float(move.y_m[row]))),
        _exact("orientation", _heading(move, row)),
        _node("time", _node("exact", text=str(row))),
        _exact("velocity", float(move.speed_mps[row])),
    ]


def _heading(move: Trajectory, row: int) -> float:
    return float(wrap_angle(float(move.heading_rad[row])))


def _planning(number: int, ego: Trajectory) -> ET.Element:
    """From the ego's start to where the report's driver would have been in the end, in twice its time."""
    last = len(ego.t_s) - 1
    start = [*_state(ego, 0), _exact("yawRate", 0.0), _exact("slipAngle", 0.0)]
    box = _node(
        "rectangle", _number("length", GOAL_M), _number("width", LANE_M), _number("orientation", _heading(ego, last)),
        _point(float(ego.x_m[last]), float(ego.y_m[last]), "center"),
    )  # fmt: skip
    time = _node("time", _node("intervalStart", text="0"), _node("intervalEnd", text=str(2 * last)))
    goal = _node("goalState", _node("position", box), time)
    return _node("planningProblem", _node("initialState", *start), goal, id=str(number))
