"""Many cases in one command: memory, open files and databases per case."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from research.benchmarks.attack.kinds import Whole
from research.benchmarks.faults.places import Place
from research.benchmarks.services.growth import WHAT, Look, batch, cases, table

NAME = "many"
COUNT = 40


def whole(count: int, seed: int, folder: Path) -> Whole:
    """One `sgcad evaluate` of that many made reports. `seed` is not used: the reports are the same every time."""
    folder.mkdir(parents=True)
    cases(folder / "cases", count)
    looks = list(batch(Place(folder, stays=True), count))
    try:
        shown = table(looks)
    except ValueError:  # too few looks for slopes with intervals
        shown = first_and_last(looks)
    return Whole(count, (), shown)


def first_and_last(looks: Sequence[Look]) -> str:
    """The first look with cases and the last one with workers, and the growth per case between both."""
    working = [look for look in looks if look["done"] and look["workers_kb"]] or list(looks)
    first, last = working[0], working[-1]
    count = max(1.0, last["done"] - first["done"])
    lines = [f"| | at {first['done']:.0f} cases | at {last['done']:.0f} | a case |", "|---|---:|---:|---:|"]
    for name, what in WHAT.items():
        lines.append(f"| {what} | {first[name]:,.0f} | {last[name]:,.0f} | {(last[name] - first[name]) / count:.2f} |")
    return "\n".join(lines) + "\n"
