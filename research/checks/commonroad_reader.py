"""How many CommonRoad files the format's own reader reads, and what it finds in them.

    python -m venv ENV && ENV/bin/pip install commonroad-io
    ENV/bin/python research/checks/commonroad_reader.py RUNS/template/*/export/commonroad/*.xml

In an environment of its own, for commonroad-io asks for an old protobuf. Each file has to have one planning problem, an
obstacle at least, and an ego whose start lies on a lanelet. Prints what fails, then one line of figures.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path


def main(files: Sequence[str]) -> int:
    """Read the files; 1 where one fails."""
    from commonroad.common.file_reader import CommonRoadFileReader

    good, on_lanes = 0, 0
    for name in files:
        try:
            scenario, problems = CommonRoadFileReader(name).open()
            (problem,) = problems.planning_problem_dict.values()
            obstacles = len(scenario.obstacles)
            places = scenario.lanelet_network.find_lanelet_by_position([problem.initial_state.position])
        except Exception as fault:  # noqa: BLE001 - whatever the reader raises is what is counted
            sys.stdout.write(f"{Path(name).name}: {type(fault).__name__}: {str(fault)[:200]}\n")
            continue
        good += obstacles > 0
        on_lanes += bool(places and places[0])
    sys.stdout.write(f"files {len(files)}; read {good}; ego starts on a lanelet {on_lanes}\n")
    return int(good < len(files))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
