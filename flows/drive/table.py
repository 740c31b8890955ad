"""Outcomes counted: one row per driver and role, shares with Wilson's interval. Reads contents of drive.json."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, TextIO

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flows.terminal import escape
from sgcad_core.handover.outcome import OUTCOMES
from sgcad_core.kinds import CRASH_ROLES
from sgcad_core.metrics.statistics import wilson
from sgcad_core.rules.records import RULES, WORDS

WIDTH = 118
MAX_TOLD = 10


class Tally:
    """Counts of drives; of the drives only the first failed ones are kept."""

    def __init__(self) -> None:
        self._counts: dict[tuple[str, str], Counter[str]] = {}
        self.failed, self.faults = 0, list[str]()

    def add(self, told: Mapping[str, Any]) -> None:
        """Count a drive's result."""
        if told["outcome"] == "failed":
            self.failed += 1
            if self.failed <= MAX_TOLD:
                self.faults.append(f"{told['case']} {told['driver']} {told['ego']}: {told['reason']}"[:300])
            return
        rules = _broken(told)
        counts = self._counts.setdefault((told["driver"], told["role"]), Counter())
        counts.update(["n", told["outcome"], *rules])
        counts["breaks"] += bool(rules)
        counts["traffic"] += bool((told.get("traffic") or {}).get("touched"))
        if told["as_declared"] is not None:
            counts.update({"declared": 1, "as_declared": int(told["as_declared"])})

    def rows(self) -> list[dict[str, Any]]:
        """Rows by driver and role: n, counts of outcomes, shares with intervals, as declared; without failed drives."""
        drivers = dict.fromkeys(driver for driver, _ in self._counts)
        cells = ((d, role) for d in drivers for role in CRASH_ROLES if (d, role) in self._counts)
        return [_row(*cell, self._counts[cell]) for cell in cells]


def rows(told: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The rows of some drives."""
    tally = Tally()
    for one in told:
        tally.add(one)
    return tally.rows()


def show(console: Console, tally: Tally) -> None:
    """Print the table and the failed drives."""
    console.width = max(console.width, WIDTH)
    console.print(_table(tally.rows()))
    for row in tally.rows():
        if told := _told_rules(row):
            console.print(escape(f"{row['driver']}, {row['role']}: {told}"), soft_wrap=True)
        if row["traffic"]:
            told = f"{row['traffic']} of {row['n']} drives touch the replayed traffic"
            console.print(escape(f"{row['driver']}, {row['role']}: {told}"), soft_wrap=True)
    for line in tally.faults:
        console.print(escape(line), soft_wrap=True)
    if tally.failed > len(tally.faults):
        console.print(f"... and {tally.failed - len(tally.faults)} more failed")


def _row(driver: str, role: str, counts: Mapping[str, int]) -> dict[str, Any]:
    n = counts["n"]
    row: dict[str, Any] = {"driver": driver, "role": role, "n": n}
    row |= {o: counts.get(o, 0) for o in OUTCOMES}
    for name in ("avoided", "mitigated"):
        low, high = wilson(row[name], n)
        row |= {f"{name}_share": row[name] / n, f"{name}_low": low, f"{name}_high": high}
    row |= {"breaks": counts.get("breaks", 0), "traffic": counts.get("traffic", 0)} | {
        rule: counts.get(rule, 0) for rule in RULES
    }
    return row | {"as_declared": counts.get("as_declared", 0), "declared": counts.get("declared", 0)}


def _table(found: Sequence[Mapping[str, Any]]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("driver", overflow="fold", min_width=10)
    for name in ("role", "n", "avoided", "95 %", "mitigated", "95 %", "unchanged", "worse", "lost", "breaks a rule"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in found:
        table.add_row(
            escape(row["driver"]), row["role"], str(row["n"]),
            *(cell for name in ("avoided", "mitigated") for cell in _share(row, name)),
            *(str(row[name]) for name in ("unchanged", "worse", "lost")),
            f"{row['breaks']} ({100 * row['breaks'] / row['n']:.0f} %)",
        )  # fmt: skip
    return table


def _told_rules(row: Mapping[str, Any]) -> str:
    """Which rules the drives of a row broke, the commonest first; "" for none."""
    most = sorted((r for r in RULES if row[r]), key=lambda r: -row[r])
    return ", ".join(f"{WORDS[r]} {row[r]}" for r in most)


def _broken(told: Mapping[str, Any]) -> list[str]:
    """The rules that the ego of a drive broke."""
    return list(dict.fromkeys(f["rule"] for f in told.get("rules", ()) if broken_of(f, told["ego"])))


def broken_of(finding: Mapping[str, Any], ego: str) -> bool:
    """Whether a finding in drive.json says that the ego broke a rule."""
    return bool(finding["status"] == "broken" and finding["actor"] == ego)


def _share(row: Mapping[str, Any], name: str) -> tuple[str, str]:
    interval = f"{100 * row[f'{name}_low']:.0f}-{100 * row[f'{name}_high']:.0f}"
    return f"{row[name]} ({100 * row[f'{name}_share']:.0f} %)", interval


NAMES = ("case", "driver", "ego", "role", "outcome", "as_declared", "braked_s", "braked_at_ttc_s", "hardest_mps2",
         "closest_m", "least_ttc_s", "pet_s", "lag_s", "seconds")  # fmt: skip
HARDNESS = ("delta_v_mps", "scripted_delta_v_mps", "risk", "scripted_risk")


def as_csv(out: TextIO, told: Iterable[Mapping[str, Any]]) -> Iterator[Mapping[str, Any]]:
    """Write one line per drive while the drives pass through."""
    writer = csv.writer(out)
    writer.writerow([*NAMES, *HARDNESS, "rules"])
    for t in told:
        writer.writerow([*(t.get(name) for name in NAMES), *_hardness(t), " ".join(_broken(t))])
        yield t


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
