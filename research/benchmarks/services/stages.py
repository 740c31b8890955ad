"""What a case costs without a model: `python -m research.benchmarks.services.stages [--cases 48]`.

Runs the bundled reports, copied to a small and a large batch, through the real command (Prefect, MLflow on
sqlite, worker processes). The difference of the two batches is the cost of a further case, free of
start-up: wall time, and the main process' own processor time, which is orchestration, Prefect and MLflow
together. Stages and their shares come from result.json.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

DEMO = Path(__file__).resolve().parents[3] / "docs" / "demo"
SMALL = 6


class Cost(NamedTuple):
    """Of one batch, seconds; `main` is processor time of the command's own process, workers left out."""

    wall: float
    main: float
    stages: Counter[str]


def batch(count: int, folder: Path) -> Path:
    """A folder of `count` cases, the bundled reports in turn."""
    cases = folder / "cases"
    demo = sorted(p for p in DEMO.iterdir() if p.is_dir())
    for i in range(count):
        shutil.copytree(demo[i % len(demo)], cases / f"{i:04d}-{demo[i % len(demo)].name}")
    return cases


def cost(count: int, overrides: list[str]) -> Cost:
    """Run a batch in a process of its own and weigh it."""
    with tempfile.TemporaryDirectory() as folder:
        cases, out = batch(count, Path(folder)), Path(folder) / "runs"
        command = [
            sys.executable,
            "-m",
            "research.benchmarks.services.stages",
            "--inside",
            str(cases),
            str(out),
            *overrides,
        ]
        started = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, check=True)  # noqa: S603 - our own module
        wall = time.perf_counter() - started
        stages: Counter[str] = Counter()
        for result in out.glob("*/*/result.json"):
            stages.update(json.loads(result.read_text())["seconds"])
        return Cost(wall, float(done.stdout.split()[-1]), stages)


def inside(cases: Path, out: Path, overrides: list[str]) -> None:
    """The measured process: one batch; prints the processor seconds of this process without its children."""
    from flows.batch import plan_batch as batches
    from flows.batch import progress_bar, run_batch, summary
    from flows.case_files.find_cases import cases_in

    made = batches.batch_of(cases_in([cases]), [Path("template.yaml")], out, overrides)
    with progress_bar.batch_progress(summary.Tally(made)) as watch:
        run_batch.evaluate(made, watch.ended)
    usage = resource.getrusage(resource.RUSAGE_SELF)
    sys.stdout.write(f"{usage.ru_utime + usage.ru_stime}\n")
    sys.stdout.flush()
    os._exit(0)  # as the command does: Prefect's server thread would linger


def table(count: int, overrides: list[str]) -> str:
    """The figures as a Markdown table."""
    small, large = cost(SMALL, overrides), cost(count, overrides)
    more = count - SMALL
    per_case = {name: seconds / count for name, seconds in large.stages.items()}
    total = sum(per_case.values())
    lines = [
        f"{count} cases, {len(os.sched_getaffinity(0))} cores; a further case costs:", "",
        f"- wall time: {(large.wall - small.wall) / more:.2f} s",
        f"- orchestration, Prefect and MLflow (processor time of the main process): "
        f"{1000 * (large.main - small.main) / more:.0f} ms",
        f"- start-up of a batch: {small.wall - SMALL * (large.wall - small.wall) / more:.1f} s",
        "", "| stage | ms a case | share |", "|---|---|---|",
    ]  # fmt: skip
    lines += [f"| {n} | {1000 * s:.0f} | {s / total:.0%} |" for n, s in sorted(per_case.items(), key=lambda i: -i[1])]
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=48)
    parser.add_argument("--set", action="append", default=[], dest="overrides")
    parser.add_argument("--inside", nargs=2, metavar=("CASES", "OUT"), help=argparse.SUPPRESS)
    options, rest = parser.parse_known_args(arguments)
    if options.inside:
        inside(Path(options.inside[0]), Path(options.inside[1]), rest)
    else:
        sys.stdout.write(table(options.cases, options.overrides) + "\n")


if __name__ == "__main__":
    main()
