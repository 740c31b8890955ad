"""How many scenarios of a runs folder another simulator loads, replays and ends in the declared contact.

    python -m research.benchmarks.scenes.judge [RUNS] [--random N] [--judge esmini] [--path BINARY] [--most N]

Takes every scenario.xosc with its road.xodr and trajectories.csv (our playing of it) that lies under RUNS, the vehicles
of its traffic among them, and those of `sgcad export --traffic`; nothing that a run says of a judge is believed. With
--random also crashes of two vehicles on so many seeded random maps: those that can be planned are played by both
players, and where ours sees the declared contact the judge has to. Prints one line of figures each and the
cases that disagree.
"""

from __future__ import annotations

import argparse
import itertools
import json
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, cast

from rich.console import Console

from flows.batch.second_simulator import show
from flows.case_files import case_folder
from flows.case_files.case_traffic import traffic_in
from research.benchmarks.scenes.random_roads import random_crashes
from research.benchmarks.written_files import written_files
from sgcad_core.case.records import ActorInfo, RoadNetwork, Scenario
from sgcad_core.errors import BadInput, SgcadError
from sgcad_core.execution.compare_executions import judge
from sgcad_core.execution.contact import realised
from sgcad_core.execution.playback import execution_of, played
from sgcad_core.interfaces import Simulator
from sgcad_core.records.specs import Contact
from sgcad_core.registry import plugin_class


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 if a scenario did not load or moved otherwise."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path, nargs="?", help="the folder given to --out, or a part of it")
    parser.add_argument("--random", type=int, default=0, help="crashes on so many random maps")
    parser.add_argument("--judge", default="esmini", help="a simulator's name")
    parser.add_argument("--path", default="", help="its binary, if it has one; default: variable or PATH")
    parser.add_argument("--most", type=int, help="no more cases than that, in the order of their folders")
    options = parser.parse_args(arguments)
    try:
        fields: dict[str, Any] = {"path": options.path} if options.path else {}
        simulator = cast("Simulator", plugin_class("simulator", options.judge)(**fields))
        simulator.ready()
        results = _results(options, simulator)
    except SgcadError as fault:
        sys.stderr.write(f"{fault}\n")
        return 2
    show(Console(width=110, highlight=False), results)
    judged = [r["judge"] for rows in results.values() for r in rows]
    return int(not all(j["loaded"] and j["same_motion"] for j in judged))


def _results(options: argparse.Namespace, simulator: Simulator) -> dict[str, list[dict[str, Any]]]:
    """Judged cases by where they come from. Raises BadInput where there is nothing to judge."""
    if options.runs is None and not options.random:
        raise BadInput("nothing to judge: name a runs folder, or give --random N")
    results = {}
    if options.runs is not None:
        results[options.runs.name] = list(itertools.islice(_judged_runs(options.runs, simulator), options.most))
    if options.random:
        results["random"] = list(_random(options.random, simulator))
    return results


def _judged_runs(folder: Path, simulator: Simulator) -> Iterator[dict[str, Any]]:
    """result.json of every executed scenario file under a folder, with what the simulator makes of it now.

    The files are believed: trajectories.csv is our playing, scenario.xosc and road.xodr are what is judged. Raises
    BadInput where there is none, MissingTool.
    """
    played_ones = [
        f.parent for f in written_files(folder, "scenario.xosc") if (f.parent / "trajectories.csv").is_file()
    ]
    if not played_ones:
        raise BadInput(f"{folder}: no scenario.xosc with a trajectories.csv beside it; name a runs folder")
    for place in played_ones:
        yield _judged(place, simulator)


def _result(place: Path) -> dict[str, Any]:
    """The case's result.json; where traffic was put around it afterwards, that of the case with this traffic."""
    around = place / "traffic.json"
    if not around.is_file():
        return cast("dict[str, Any]", _json(place / "result.json"))
    case = _json(place.parents[2] / "result.json")  # CASE/export/traffic/DENSITY
    return case | {"case": f"{case['case']}, {place.name} traffic", "traffic": _json(around)}


def _json(file: Path) -> Any:
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as fault:
        raise BadInput(f"{file}: cannot be read ({fault}); run the case again") from fault


def _judged(case: Path, simulator: Simulator) -> dict[str, Any]:
    result = _result(case)
    traffic = traffic_in(case, result)
    actors = (*(ActorInfo.model_validate(actor) for actor in result["actors"]), *(vehicle for vehicle, _ in traffic))
    declared = result["collision"]["declared"]
    scenario = Scenario(
        xosc=(case / "scenario.xosc").read_text(encoding="utf-8"),
        actors=actors,
        declared=Contact.model_validate(declared) if declared else None,
    )
    network = RoadNetwork(xodr=(case / "road.xodr").read_text(encoding="utf-8"))
    tracks = (*case_folder.read_trajectories(case / "trajectories.csv"), *(track for _, track in traffic))
    ours = execution_of("file", scenario, tracks)
    return result | {"judge": judge(simulator, ours, scenario, network).summary()}


def _random(count: int, simulator: Simulator) -> Iterator[dict[str, Any]]:
    """Crashes on random maps; how many could not be planned is told on stderr."""
    unplanned: Counter[str] = Counter()
    for name, network, scenario in random_crashes(count):
        if isinstance(scenario, str):
            unplanned["no network" if scenario.startswith("no network") else "no plan"] += 1
            continue
        ours = execution_of("ours", scenario, played(scenario, network))
        if not realised(scenario.declared, ours.contact):
            scenario = scenario.model_copy(update={"declared": None})
        yield {"case": name, "judge": judge(simulator, ours, scenario, network).summary()}
    sys.stderr.write("".join(f"{count} random maps: {n} x {why}\n" for why, n in unplanned.items()))


if __name__ == "__main__":
    raise SystemExit(main())
