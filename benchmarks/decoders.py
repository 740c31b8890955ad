"""What do decoders make of values that a report tells, and of those that it leaves open?

    python -m benchmarks.decoders [--count 200] [--config configs/mini.yaml] [--arms greedy adaptive ...]

First answers to made reports, half of them narratives alone, under one decoder after another, value by value against
the truth: told by the text, shown by the drawing, told by both, or by neither: then left out if the answer allows it,
else guessed, where a model can only know how often it is so. The same reports for every arm, phrases that no training
saw; brackets are 95 % bootstrap intervals over reports, p is a paired permutation test against the first arm, Holm's
correction over the arms of a column.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from benchmarks.first_answers import first_answers
from benchmarks.made import as_report
from mini.evaluate import fields, source
from mini.generator.report import Report, make_report
from sgcad_core.config import Config, load
from sgcad_core.errors import BadInput, ConfigError, MissingTool
from sgcad_core.metrics.statistics import holm, ratio_interval, swap_test
from sgcad_core.records import CrashReport, Floats

FIRST_SEED = 61_000_000
"""Held out from training, and neither those of the card nor those that the gate is calibrated on."""
MODES = {"text": 2.0, "both": 1.0, "image": 1.0}
COLUMNS = {
    "text": "told by the text",
    "diagram": "shown by the drawing",
    "both": "both",
    "left out": "to be left out",
    "guessed": "to be guessed",
}
"""Who tells a value, or what becomes of one that nobody tells -> head of its column."""
SOURCES = tuple(COLUMNS)
LEFT_OUT = {"light", "weather", "surface", "speed", "speed_limit", "lane", "median", "control", "turns", "curve"}
"""Fields that an answer leaves empty where nobody tells them."""
_MASKED = "decoder={name: cad, beta: 0.1, alpha: %s}"
ARMS: dict[str, str] = {
    "greedy": "decoder=greedy",
    "drawn at 0.3": "decoder={name: nucleus, temperature: 0.3, top_p: 1.0}",
    "plausibility": "decoder={name: plausible, beta: 0.1}",
    "alpha 0.5 without mask": "decoder={name: cad, alpha: 0.5}",
    "alpha 0.5": _MASKED % 0.5,
    "alpha 0.5 drawn at 0.3": "decoder={name: cad, beta: 0.1, alpha: 0.5, temperature: 0.3}",
    "alpha 1": _MASKED % 1,
    "alpha 2": _MASKED % 2,
    "adaptive": "decoder={name: adacad, beta: 0.1}",
}
"""Name -> what is set in the config; with the plausibility mask of 0.1 unless told otherwise."""


def marks(config: Config, reports: Sequence[tuple[Report, CrashReport]], jobs: int) -> Floats:
    """(reports, sources, 2): values right and values asked for; a refused report has neither.

    `reports`: with the truth, and as a config's model sees them.
    """
    found = np.zeros((len(reports), len(SOURCES), 2))

    def one(index: int) -> None:
        report, shown = reports[index]
        heard, _ = first_answers(config, shown)
        if "road" not in heard:
            return
        answers = [_read(heard[stage].text) if stage in heard else None for stage in ("road", "scenario")]
        for name, key, right in fields(report, (answers[0] or {}, answers[1])):
            found[index, SOURCES.index(_column(source(report, key), name))] += right, 1

    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, range(len(reports))))
    return found


def _column(told_by: str, name: str) -> str:
    return told_by if told_by != "none" else "left out" if name in LEFT_OUT else "guessed"


def _read(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:  # cut off
        return None


def table(found: dict[str, Floats]) -> str:
    """Arms by sources, over the reports of which every arm gave all that is asked for."""
    asked = np.stack([counts[:, :, 1] for counts in found.values()])
    answered = (asked == asked.max(axis=0)).all(axis=(0, 2)) & (asked.sum(axis=(0, 2)) > 0)
    if not answered.any():
        raise SystemExit("no report was answered under every decoder; give more reports (--count)")
    kept = {name: counts[answered] for name, counts in found.items()}
    first = next(iter(kept.values()))
    columns = [i for i in range(len(SOURCES)) if first[:, i, 1].sum()]
    heads = [COLUMNS[SOURCES[i]] for i in columns]
    lines = ["| decoder | " + " | ".join(heads) + " |", "|---" * (len(columns) + 1) + "|"]
    others = {name: counts for name, counts in kept.items() if counts is not first}
    p = {i: holm({n: swap_test(_pair(first, i), _pair(c, i)) for n, c in others.items()}) for i in columns}
    for name, counts in kept.items():
        lines.append(f"| {name} | " + " | ".join(_cell(counts, i, p[i].get(name)) for i in columns) + " |")
    n = ", ".join(f"{first[:, i, 1].sum():.0f} {head}" for i, head in zip(columns, heads, strict=True))
    kept_of = f"{int(answered.sum())} of {len(answered)} reports, those that every arm answers in full"
    return "\n".join([f"{kept_of}; values: {n}.", "", *lines])


def _pair(counts: Floats, source_index: int) -> tuple[Floats, Floats]:
    return counts[:, source_index, 0], counts[:, source_index, 1]


def _cell(counts: Floats, index: int, p: float | None) -> str:
    right, asked = _pair(counts, index)
    around = ratio_interval(right, asked)
    ends = f" [{around.low:.3f}, {around.high:.3f}]" if around else ""
    return f"{right.sum() / asked.sum():.3f}{ends}" + ("" if p is None else f" p {p:.2f}" if p >= 0.01 else " p < 0.01")


def main() -> None:
    """Make reports, ask, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="reports")
    parser.add_argument("--config", default="mini.yaml")
    parser.add_argument("--set", action="append", default=[], dest="overrides", help="key=value, as for sgcad")
    parser.add_argument("--arms", nargs="+", default=list(ARMS), choices=list(ARMS), help="the first is the reference")
    parser.add_argument("--jobs", type=int, default=8, help="reports asked at once")
    told = parser.parse_args()
    made = (make_report(seed, True, 0.6, MODES) for seed in range(FIRST_SEED, FIRST_SEED + told.count))
    reports = [(report, as_report(report)) for report in made]
    found: dict[str, Floats] = {}
    for name in told.arms:
        started = time.perf_counter()
        try:
            found[name] = marks(load(told.config, (*told.overrides, ARMS[name])), reports, told.jobs)
        except (BadInput, ConfigError, MissingTool) as fault:
            raise SystemExit(f"{name}: {fault}") from fault
        sys.stderr.write(f"{name}: {time.perf_counter() - started:.0f} s\n")
    sys.stdout.write(table(found) + "\n")


if __name__ == "__main__":
    main()
