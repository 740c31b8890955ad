"""A second simulator's verdicts on a batch: how many scenarios loaded, moved alike and crashed as declared.

Reads the `judge` part of results. Knows no simulator.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flows.terminal import escape
from sgcad_core.execution.compare_executions import TOLERANCE_M, Judgement

MAX_TOLD = 10


def show(console: Console, results: Mapping[str, Sequence[Mapping[str, Any]]]) -> None:
    """Print the table of all configs and the first disagreements; nothing where no case was judged."""
    judged = {name: [r for r in those if "judge" in r] for name, those in results.items()}
    if not any(judged.values()):
        return
    console.print(_table(judged))
    told = [f"{name}/{r['case']}: {line}" for name, those in judged.items() for r in those if (line := _wrong(r))]
    for line in told[:MAX_TOLD]:
        console.print(escape(line[:300]), soft_wrap=True)
    if len(told) > MAX_TOLD:
        console.print(f"... and {len(told) - MAX_TOLD} more")


def _table(judged: Mapping[str, Sequence[Mapping[str, Any]]]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("config", overflow="fold", min_width=12)
    for name in ("judge", "loaded", f"within {TOLERANCE_M:g} m", "median m", "most m", "as declared"):
        table.add_column(name, justify="right", no_wrap=True)
    for name, results in judged.items():
        if results:
            table.add_row(escape(name), *figures([r["judge"] for r in results]))
    return table


def figures(verdicts: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """Judge, loaded, same motion, median and largest deviation, declared first contacts; counts as "n/m"."""
    away = [v["deviation"]["distance_m"] for v in verdicts if v["deviation"]]
    declared = [v for v in verdicts if v["declared"]]
    return (
        escape(", ".join(sorted({v["simulator"] for v in verdicts}))),
        _share([v["loaded"] for v in verdicts]),
        _share([v["same_motion"] for v in verdicts]),
        f"{np.median(away):.4f}" if away else "-",
        f"{max(away):.4f}" if away else "-",
        _share([v["as_declared"] for v in declared]),
    )


def _share(hits: Sequence[bool]) -> str:
    return f"{sum(hits)}/{len(hits)}" if hits else "-"


def _wrong(result: Mapping[str, Any]) -> str:
    told = Judgement.model_validate({k: result["judge"][k] for k in Judgement.model_fields}).lines()
    return "; ".join(told)
