"""How many CommonRoad files the format's own reader reads, what it finds there, and what the drivability checker says.

    python -m venv ENV && ENV/bin/pip install commonroad-io
    ENV/bin/python research/checks/commonroad_reader.py RUNS/template/*/export/commonroad/*.xml

In an environment of its own, for commonroad-io asks for an old protobuf. Each file has to have one planning problem, an
obstacle at least, and an ego whose start lies on a lanelet. Where `commonroad-drivability-checker` is installed too
(2025.4 needs `commonroad-io==2024.3`), it makes its collision checker and the edge of the road from the file, and tells
whether an ego of a car's size touches an obstacle or the edge at its start, and whether it meets an obstacle when it
goes on straight at its first speed. Prints what fails, then one line of figures.
"""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

LENGTH_M, WIDTH_M = 4.5, 1.8
"""Size of the ego that is checked; the format gives a planning problem none."""


def main(files: Sequence[str]) -> int:
    """Read the files; 1 where one fails."""
    from commonroad.common.file_reader import CommonRoadFileReader

    counts, checked = Counter[str](), bool(find_spec("commonroad_dc") and find_spec("commonroad.geometry.shape"))
    for name in files:
        try:
            scenario, problems = CommonRoadFileReader(name).open()
            (problem,) = problems.planning_problem_dict.values()
            found = [*_read(scenario, problem), *(_driven(scenario, problem) if checked else ())]
        except Exception as fault:  # noqa: BLE001 - whatever the reader raises is what is counted
            sys.stdout.write(f"{Path(name).name}: {type(fault).__name__}: {str(fault)[:200]}\n")
            continue
        counts.update(found)
        if odd := [what for what in found if what.startswith("at the start")]:
            sys.stdout.write(f"{Path(name).name}: {', '.join(odd)}\n")
    told = "".join(f"; {what} {number}" for what, number in counts.items())
    sys.stdout.write(f"files {len(files)}{told}\n")
    return int(counts["read"] < len(files))


def _read(scenario: Any, problem: Any) -> Iterator[str]:
    """What the reader found in a file."""
    if scenario.obstacles:
        yield "read"
    places = scenario.lanelet_network.find_lanelet_by_position([problem.initial_state.position])
    if places and places[0]:
        yield "ego starts on a lanelet"


def _driven(scenario: Any, problem: Any) -> Iterator[str]:
    """What the drivability checker says of the ego's start and of its way on at constant speed."""
    from commonroad_dc.boundary.boundary import create_road_boundary_obstacle
    from commonroad_dc.collision.collision_detection.pycrcc_collision_dispatch import create_collision_checker
    from commonroad_dc.pycrcc import CollisionChecker, RectOBB, TimeVariantCollisionObject

    obstacles, edge = create_collision_checker(scenario), CollisionChecker()
    edge.add_collision_object(create_road_boundary_obstacle(scenario, return_scenario_obstacle=False))
    yield "checked"
    start = problem.initial_state
    step, heading = start.velocity * scenario.dt, start.orientation
    dx, dy = step * math.cos(heading), step * math.sin(heading)
    moves = [o.prediction.final_time_step for o in scenario.dynamic_obstacles if o.prediction]
    steps = 1 + max(moves, default=0)
    way = TimeVariantCollisionObject(0)
    for k in range(steps):
        x, y = start.position[0] + k * dx, start.position[1] + k * dy
        way.append_obstacle(RectOBB(LENGTH_M / 2, WIDTH_M / 2, heading, x, y))
    first = TimeVariantCollisionObject(0)
    first.append_obstacle(RectOBB(LENGTH_M / 2, WIDTH_M / 2, heading, *start.position))
    if obstacles.collide(first):
        yield "at the start it touches an obstacle"
    if edge.collide(first):
        yield "at the start it touches the edge of the road"
    if obstacles.collide(way):
        yield "straight on it meets an obstacle"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
