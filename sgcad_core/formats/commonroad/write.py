"""A crash as a CommonRoad scenario: lanelets, obstacles with trajectories, and the ego as a planning problem.

Written by `commonroad-io`, format 2020a. Lanelets follow the lanes of the network; signals and signs are left
out, and crossings. Places are box centers, as everywhere in this project. Knows no file.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.errors import MissingTool
from sgcad_core.formats.lane_pieces import Piece, pieces_of
from sgcad_core.roads.lane_graph import LaneGraph

DT_S = 0.05
GOAL_M = 10.0
"""Length of the goal's box; it is as wide as a lane."""
LANE_M = 3.5
_SPEED = 0.02
"""Slower actors stand all the way where they also do not move."""
_TYPES = {
    "car": "CAR", "van": "CAR", "truck": "TRUCK", "semitrailer": "TRUCK", "trailer": "TRUCK", "bus": "BUS",
    "motorbike": "MOTORCYCLE", "bicycle": "BICYCLE", "pedestrian": "PEDESTRIAN", "tram": "TRAIN", "train": "TRAIN",
}  # fmt: skip
"""Obstacle types by the actor's category."""
AUTHOR, SOURCE = "SG-CADVLM", "crash report"


def write_commonroad(
    file: Path,
    case: str,
    graph: LaneGraph,
    infos: Mapping[str, ActorInfo],
    ego: Trajectory,
    others: Sequence[Trajectory],
) -> None:
    """Write the XML. `ego`: the motion of the report's driver, whose first and last state are the problem.

    Raises MissingTool without commonroad-io.
    """
    library = _library()
    scenario = library["scenario"].Scenario(DT_S, _scenario_id(library, case))
    numbers = _numbers(graph)
    scenario.add_objects(_network(library, graph, numbers))
    first = len(numbers) + 1
    for k, move in enumerate(others):
        scenario.add_objects(_obstacle(library, first + k, infos[move.actor], move))
    problem = _problem(library, first + len(others), ego)
    problems = library["problem"].PlanningProblemSet([problem])
    writer = library["writer"].CommonRoadFileWriter(
        scenario, problems, AUTHOR, AUTHOR, f"{SOURCE} {case}", {library["scenario"].Tag.CRITICAL}
    )
    overwrite = library["writer"].OverwriteExistingFile.ALWAYS
    writer.write_to_file(str(file), overwrite)


def read_commonroad(file: Path) -> tuple[Any, Any]:
    """Scenario and planning problems as the library's own reader gives them. Raises MissingTool."""
    found: tuple[Any, Any] = _library()["reader"].CommonRoadFileReader(str(file)).open()
    return found


def _library() -> dict[str, Any]:
    """The modules of commonroad-io that are used."""
    try:
        from commonroad.common import file_reader, file_writer, util
        from commonroad.geometry import shape
        from commonroad.planning import goal, planning_problem
        from commonroad.prediction import prediction
        from commonroad.scenario import lanelet, obstacle, scenario, state, trajectory
    except ImportError as fault:
        raise MissingTool(
            f"CommonRoad: {fault.name or 'commonroad'} is not installed; pip install 'sg-cadvlm[commonroad]'"
        ) from fault
    return {
        "reader": file_reader, "writer": file_writer, "util": util, "shape": shape, "goal": goal,
        "problem": planning_problem, "prediction": prediction, "lanelet": lanelet, "obstacle": obstacle,
        "scenario": scenario, "state": state, "trajectory": trajectory,
    }  # fmt: skip


def _scenario_id(library: Mapping[str, Any], case: str) -> Any:
    """The format names scenarios by country, map and numbers: the case's letters are the map, its digits the number."""
    letters = re.sub(r"[^A-Za-z]", "", case).capitalize() or "Crash"
    digits = int(re.sub(r"\D", "", case)[-9:] or 1) or 1
    return library["scenario"].ScenarioID(
        country_id="USA", map_name=letters, map_id=digits, configuration_id=1, obstacle_behavior="T", prediction_id=1
    )


# ------------------------------------------------------------------ map
def _numbers(graph: LaneGraph) -> dict[str, int]:
    return {name: k for k, name in enumerate(pieces_of(graph), 1)}


def _network(library: Mapping[str, Any], graph: LaneGraph, numbers: Mapping[str, int]) -> Any:
    pieces = pieces_of(graph)
    lanelets = [_lanelet(library, piece, numbers) for piece in pieces.values()]
    return library["lanelet"].LaneletNetwork.create_from_lanelet_list(lanelets)


def _lanelet(library: Mapping[str, Any], piece: Piece, numbers: Mapping[str, int]) -> Any:
    kinds = library["lanelet"].LaneletType
    kind = kinds.INTERSECTION if piece.crosses else kinds.URBAN if piece.cars else kinds.SIDEWALK
    beside = {"left": piece.left, "right": piece.right}
    told = {f"adjacent_{side}": numbers[name] for side, name in beside.items() if name}
    told |= {f"adjacent_{side}_same_direction": True for side, name in beside.items() if name}
    return library["lanelet"].Lanelet(
        piece.side(1), piece.line, piece.side(-1), numbers[piece.id],
        predecessor=[numbers[name] for name in piece.before], successor=[numbers[name] for name in piece.after],
        lanelet_type={kind}, **told,
    )  # fmt: skip


# ------------------------------------------------------------------ actors
def _obstacle(library: Mapping[str, Any], number: int, info: ActorInfo, move: Trajectory) -> Any:
    shape = library["shape"].Rectangle(info.length_m, info.width_m)
    kinds, start = library["obstacle"].ObstacleType, _initial(library, move)
    still = float(np.ptp(move.points, axis=0).max()) < _SPEED
    if still:
        kind = kinds.PARKED_VEHICLE if info.record.axles else kinds.ROAD_BOUNDARY
        return library["obstacle"].StaticObstacle(number, kind, shape, start)
    kind = getattr(kinds, _TYPES.get(info.record.category, "UNKNOWN"))
    states = [_state(library, move, k) for k in range(1, len(move.t_s))]
    way = library["trajectory"].Trajectory(1, states)
    prediction = library["prediction"].TrajectoryPrediction(way, shape)
    return library["obstacle"].DynamicObstacle(number, kind, shape, start, prediction)


def _state(library: Mapping[str, Any], move: Trajectory, row: int) -> Any:
    place = np.array([float(move.x_m[row]), float(move.y_m[row])])
    return library["state"].CustomState(
        time_step=row, position=place, orientation=_heading(library, move, row), velocity=float(move.speed_mps[row])
    )


def _initial(library: Mapping[str, Any], move: Trajectory) -> Any:
    place = np.array([float(move.x_m[0]), float(move.y_m[0])])
    return library["state"].InitialState(
        time_step=0, position=place, orientation=_heading(library, move, 0), velocity=float(move.speed_mps[0]),
        acceleration=0.0, yaw_rate=0.0, slip_angle=0.0,
    )  # fmt: skip


def _heading(library: Mapping[str, Any], move: Trajectory, row: int) -> float:
    return float(library["util"].make_valid_orientation(float(move.heading_rad[row])))


def _problem(library: Mapping[str, Any], number: int, ego: Trajectory) -> Any:
    """From the ego's start to where the report's driver would have been in the end."""
    last = len(ego.t_s) - 1
    center = np.array([float(ego.x_m[last]), float(ego.y_m[last])])
    box = library["shape"].Rectangle(GOAL_M, LANE_M, center, _heading(library, ego, last))
    time = library["util"].Interval(0, 2 * last)
    goal = library["goal"].GoalRegion([library["state"].CustomState(time_step=time, position=box)])
    return library["problem"].PlanningProblem(number, _initial(library, ego), goal)
