"""Whether vehicles are off the road where they strike a thing, by codes of real crashes: one table of a runs folder.

    python -m research.benchmarks.scenes.departures RUNS TRUTH [CONFIG ...] [--cases]

TRUTH holds a file CASE.json of codes for each case (the coded reports). Counted are cases whose first vehicle is coded
to have left the road on one side alone before its first harmful event, and in which it strikes a thing or rolls over:

- *generated*: how many of them end with a scenario
- *off the road*: its center or the middle of its front is beside the lanes at its first contact (at the end where it
  has none)
- *side*: it left them on the coded side
- *called whole on the road*: the account says that all is there, though it is not off the road

Nothing that a run says of its own departures is believed. `--cases` names every case that is counted against.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from research.benchmarks.run_tables import by_config, show
from research.benchmarks.scenes.lanes import Figures, Run
from sgcad_core.metrics.road_departure import left_road

HEAD = "| config | cases | generated | off the road | side | called whole on the road |"
_LIVING = ("animal", "pedestrian", "cyclist")


def coded_side(truth: dict[str, Any]) -> str | None:
    """The side on which the first vehicle of a crash is coded to leave the road; None where it is not, or on both."""
    vehicle = truth["vehicles"][0]
    events = truth.get("events") or [{}]
    if not str(vehicle.get("crash_family")).startswith("departure") or events[0].get("other") in _LIVING:
        return None
    words = [word.lower() for word in vehicle.get("pre_harmful_sequence") or [] if word.startswith("Roadway")]
    sides = {side for side in ("left", "right") for word in words if f"departure- {side}" in word}
    return sides.pop() if len(sides) == 1 else None


def count(folder: Path, figures: Figures, truth: Path) -> None:
    """Add one case's folder to the counts."""
    codes = truth / f"{folder.name}.json"
    side = coded_side(json.loads(codes.read_text(encoding="utf-8"))) if codes.exists() else None
    if side is None:
        return
    run = Run(folder)
    figures.counts["cases"] += 1
    if run.result.get("status") != "generated":
        figures.lines.append(f"{folder.name}: {run.result.get('status')}")
        return
    motion = next(m for m in run.motions if m.actor == "V1")
    seen = left_road(run.graph, run.before(motion), run.actors["V1"].length_m)
    whole = (run.result.get("account") or {}).get("verdict") == "whole"
    figures.counts.update(generated=1, off=seen is not None, side=seen == side, whole=seen is None and whole)
    if seen != side:
        figures.lines.append(f"{folder.name}: {seen or 'on the road'}, coded {side}{', whole' if whole else ''}")


def table(runs: Path, truth: Path, configs: Sequence[str], *, cases: bool = False) -> str:
    """The table, a row for each config."""
    found = by_config(runs, configs, Figures, partial(count, truth=truth))
    rows = [HEAD, "|---|" + "---:|" * 5]
    for name, figures in found.items():
        n = figures.counts
        rows.append(f"| {name} | {n['cases']} | {n['generated']} | {n['off']} | {n['side']} | {n['whole']} |")
        rows += figures.lines if cases else []
    return "\n".join(rows)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path, help="the folder given to --out")
    parser.add_argument("truth", type=Path, help="the folder of the cases' codes")
    parser.add_argument("configs", nargs="*", help="config names; default: all")
    parser.add_argument("--cases", action="store_true", help="name every case that is counted against")
    options = parser.parse_args(arguments)
    for folder in (options.runs, options.truth):
        if not folder.is_dir():
            raise SystemExit(f"{folder}: no such folder; give results and codes of the same cases")
    show(table(options.runs, options.truth, options.configs, cases=options.cases))


if __name__ == "__main__":
    main()
