"""Does our player read our own files alike whichever version of OpenSCENARIO they are written in?

    python -m benchmarks.versions RUNS [--most N]

Every trajectories.csv under RUNS is a plan, written in versions 1.0 to 1.3 and both encodings and played again. Prints
per encoding how many plans play alike to the last digit in all versions, the largest distance between two of them, and
of the timed ones that to the plan itself (slow centimetres are not written: `formats.openscenario.vertices`).
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import get_args

import numpy as np

from flows import store
from sgcad_core.execution.playback import execution_of
from sgcad_core.formats.openscenario.events import Handover
from sgcad_core.formats.openscenario.player import play
from sgcad_core.formats.openscenario.writer import DEFAULT_VERSION, Encoding, Version, write_xosc
from sgcad_core.records import ActorInfo, Scenario, Trajectory

VERSIONS: tuple[Version, ...] = get_args(Version)
ENCODINGS: tuple[Encoding, ...] = get_args(Encoding)
Moves = tuple[Trajectory, ...]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 where a version plays otherwise than another, 2 where there is nothing to play."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--most", type=int, help="no more cases than that, in the order of their folders")
    options = parser.parse_args(arguments)
    rows = list(islice(_cases(options.runs), options.most))
    if not rows:
        sys.stderr.write(f"{options.runs}: no trajectories.csv beside a road.xodr; give a folder of runs\n")
        return 2
    sys.stdout.write("| encoding | alike in all versions | most m apart | most m from the plan |\n|---|---|---|---|\n")
    for encoding in ENCODINGS:
        apart = [case[encoding][0] for case in rows]
        near = f"{max(case[encoding][1] for case in rows):.3f}" if encoding == "timed" else "-"
        sys.stdout.write(f"| {encoding} | {apart.count(0.0)} of {len(rows)} | {max(apart):.6f} | {near} |\n")
    return int(any(case[encoding][0] for case in rows for encoding in ENCODINGS))


def _cases(runs: Path) -> Iterator[dict[Encoding, tuple[float, float]]]:
    """Per case and encoding: the largest distance between two versions, and from the plan."""
    for case in sorted(file.parent for file in runs.glob("**/trajectories.csv")):
        if not (case / "road.xodr").is_file():
            continue
        result = json.loads((case / "result.json").read_text(encoding="utf-8"))
        actors = tuple(ActorInfo.model_validate(actor) for actor in result["actors"])
        plan, xodr = tuple(store.read_trajectories(case / "trajectories.csv")), (case / "road.xodr").read_text("utf-8")
        contact = execution_of("plan", Scenario(actors=actors), plan).contact
        yield {
            "timed": _apart(actors, plan, None, xodr),
            "events": _apart(actors, plan, Handover(contact, xodr), xodr),
        }


def _apart(actors: Sequence[ActorInfo], plan: Moves, way: Handover | None, xodr: str) -> tuple[float, float]:
    seen = {v: play(write_xosc(actors, plan, None, version=v, handover=way), xodr) for v in VERSIONS}
    usual = seen[DEFAULT_VERSION]
    return max(most_m(usual, other) for other in seen.values()), most_m(plan, usual)


def most_m(first: Sequence[Trajectory], second: Sequence[Trajectory]) -> float:
    """The largest distance between the box centers of the same actors; infinite where one lasts longer."""
    by_name = {t.actor: t for t in second}
    if any(len(t.t_s) != len(by_name[t.actor].t_s) for t in first):
        return float("inf")
    pairs = ((t, by_name[t.actor]) for t in first)
    return max(float(np.hypot(a.x_m - b.x_m, a.y_m - b.y_m).max()) for a, b in pairs)


if __name__ == "__main__":
    sys.exit(main())
