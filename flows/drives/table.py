"""Outcomes counted: a row a driver and role, shares with Wilson's interval. Knows the contents of drive.json."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flows.terminal import escape
from sgcad_core.handover.outcome import OUTCOMES
from sgcad_core.kinds import CRASH_ROLES
from sgcad_core.metrics.statistics import wilson

WIDTH = 118
MAX_TOLD = 10


def show(console: Console, told: Sequence[Mapping[str, Any]]) -> None:
    """Print the table and what failed."""
    console.width = max(console.width, WIDTH)
    console.print(_table(told))
    failed = [t for t in told if t["outcome"] == "failed"]
    for t in failed[:MAX_TOLD]:
        console.print(escape(f"{t['case']} {t['driver']} {t['ego']}: {t['reason']}"[:300]), soft_wrap=True)
    if len(failed) > MAX_TOLD:
        console.print(f"... and {len(failed) - MAX_TOLD} more failed")


def rows(told: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """One a driver and role: n, counts of the outcomes, shares with intervals, as declared; without failed drives."""
    drivers = dict.fromkeys(t["driver"] for t in told if t["outcome"] != "failed")
    found = []
    for driver in drivers:
        for role in CRASH_ROLES:
            mine = [t for t in told if t["driver"] == driver and t["role"] == role and t["outcome"] != "failed"]
            if mine:
                found.append(_row(driver, role, mine))
    return found


def _row(driver: str, role: str, mine: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    n = len(mine)
    row: dict[str, Any] = {"driver": driver, "role": role, "n": n}
    row |= {o: sum(t["outcome"] == o for t in mine) for o in OUTCOMES}
    for name in ("avoided", "mitigated"):
        low, high = wilson(row[name], n)
        row |= {f"{name}_share": row[name] / n, f"{name}_low": low, f"{name}_high": high}
    declared = [t["as_declared"] for t in mine if t["as_declared"] is not None]
    return row | {"as_declared": sum(declared), "declared": len(declared)}


def _table(told: Sequence[Mapping[str, Any]]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("driver", overflow="fold", min_width=10)
    for name in ("role", "n", "avoided", "95 %", "mitigated", "95 %", "unchanged", "worse", "lost", "as declared"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows(told):
        table.add_row(
            escape(row["driver"]), row["role"], str(row["n"]),
            *(cell for name in ("avoided", "mitigated") for cell in _share(row, name)),
            *(str(row[name]) for name in ("unchanged", "worse", "lost")), f"{row['as_declared']}/{row['declared']}",
        )  # fmt: skip
    return table


def _share(row: Mapping[str, Any], name: str) -> tuple[str, str]:
    interval = f"{100 * row[f'{name}_low']:.0f}-{100 * row[f'{name}_high']:.0f}"
    return f"{row[name]} ({100 * row[f'{name}_share']:.0f} %)", interval


def write_csv(file: Path, told: Sequence[Mapping[str, Any]]) -> None:
    """One line a drive: what a figure in the table counts."""
    names = ("case", "driver", "ego", "role", "outcome", "as_declared", "braked_s", "braked_at_ttc_s",
             "hardest_mps2", "closest_m", "least_ttc_s", "pet_s", "lag_s", "seconds")  # fmt: skip
    with file.open("w", encoding="utf-8", newline="") as out:
        writer = csv.writer(out)
        more = ("delta_v_mps", "scripted_delta_v_mps", "risk", "scripted_risk")
        writer.writerow([*names, *more])
        for t in told:
            writer.writerow([*(t.get(name) for name in names), *_hardness(t)])


def _hardness(t: Mapping[str, Any]) -> list[Any]:
    """Delta-v of the ego now and in the script, and the worst risk of both."""
    now, then = t.get("severity"), t.get("scripted")
    return [_delta(now, t["ego"]), _delta(then, t["ego"]), _risk(now), _risk(then)]


def _delta(hardness: Mapping[str, Any] | None, ego: str) -> float | None:
    sides = [hardness["first"], hardness["second"]] if hardness else []
    return next((float(s["delta_v_mps"]) for s in sides if s["actor"] == ego), None)


def _risk(hardness: Mapping[str, Any] | None) -> float | None:
    risks = [s["risk"] for s in (hardness["first"], hardness["second"]) if s["risk"] is not None] if hardness else []
    return max(risks, default=None)
