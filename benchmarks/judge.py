"""How many scenarios of a runs folder another simulator loads, replays and ends in the declared contact.

    python -m benchmarks.judge RUNS [--judge esmini] [--path BINARY] [--most N]

Takes every scenario.xosc with its road.xodr and trajectories.csv (our playing of it) that lies under RUNS; nothing that
a run says of a judge is believed. Prints one line of figures and the cases that disagree.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

from rich.console import Console

from flows.judging import judged_runs, show
from sgcad_core.errors import SgcadError
from sgcad_core.interfaces import Simulator
from sgcad_core.registry import plugin_class


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 if a scenario did not load or moved otherwise."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path, help="the folder given to --out, or a part of it")
    parser.add_argument("--judge", default="esmini", help="a simulator's name")
    parser.add_argument("--path", default="", help="its binary, if it has one; default: variable or PATH")
    parser.add_argument("--most", type=int, help="no more cases than that, in the order of their folders")
    options = parser.parse_args(arguments)
    try:
        fields: dict[str, Any] = {"path": options.path} if options.path else {}
        simulator = cast("Simulator", plugin_class("simulator", options.judge)(**fields))
        simulator.ready()
        results = list(itertools.islice(judged_runs(options.runs, simulator), options.most))
    except SgcadError as fault:
        sys.stderr.write(f"{fault}\n")
        return 2
    show(Console(width=110, highlight=False), {options.runs.name: results})
    return int(not all(r["judge"]["loaded"] and r["judge"]["same_motion"] for r in results))


if __name__ == "__main__":
    raise SystemExit(main())
