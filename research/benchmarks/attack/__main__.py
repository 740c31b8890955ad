"""The attack: `python -m research.benchmarks.attack [--kinds text,picture] [--count 1000] [--seed 1] [--out FILE]`.

Every input has to end as done or as a typed refusal, without a traceback, within 2 s of processor time for each 100 kB
begun and 500 MB of memory, and nothing may be written outside its folder. A hang or the death of a process is counted,
not fatal. Kinds of whole commands (kills, many, disasters) say what they tried. Prints a table in Markdown and each
fault with its number: an input is a function of kind, seed and number. Ends with 1 if there was any.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import ModuleType

from research.benchmarks.attack import campaign
from research.benchmarks.attack.kinds import Whole, count_of, kinds, limit_of

MOST_TOLD = 20


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables; 1 if anything was wrong."""
    known = kinds()
    parser = argparse.ArgumentParser(prog="python -m research.benchmarks.attack", description=__doc__.splitlines()[0])
    parser.add_argument("--kinds", default=",".join(known), help=f"names, with commas between: {', '.join(known)}")
    parser.add_argument("--count", type=int, help="inputs of every kind; default: 1000, fewer of whole commands")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="file to add the table to")
    asked = parser.parse_args(arguments)
    names = [name.strip() for name in asked.kinds.split(",")]
    if unknown := [name for name in names if name not in known]:
        parser.error(f"no such kind: {', '.join(unknown)}; there are: {', '.join(known)}")
    if asked.count is not None and asked.count < 1:
        parser.error(f"--count {asked.count}: at least 1 is needed")
    wrong = 0
    with tempfile.TemporaryDirectory(prefix="sgcad-attack-") as place:
        for name in names:
            began = time.monotonic()
            text, faults = _tried(known[name], asked.count or count_of(known[name]), asked.seed, Path(place))
            wrong += faults
            _show(f"{text}{_about(asked.seed, time.monotonic() - began)}\n", asked.out)
    return int(wrong > 0)


def _tried(kind: ModuleType, count: int, seed: int, place: Path) -> tuple[str, int]:
    """A kind's table with its faults, and their number."""
    if hasattr(kind, "whole"):
        told: Whole = kind.whole(count, seed, place / kind.NAME)
        lines = [f"{kind.NAME}: {told.tried:,} tried, {len(told.faults)} wrong", *_first(told.faults), told.table]
        return "\n".join(filter(None, lines)) + "\n", len(told.faults)
    found = []
    for one in campaign.fed(kind.NAME, count, seed, campaign.Limits(limit_of(kind)), place):
        found.append(one)
        if sys.stderr.isatty():
            sys.stderr.write(f"\r{kind.NAME}: {len(found)} of {count}")
    faults = [one for one in found if campaign.is_fault(one)]
    lines = [campaign.head(), campaign.row(kind.NAME, found), *_first([campaign.in_words(one) for one in faults])]
    return "\n".join(lines) + "\n", len(faults)


def _first(faults: Sequence[str]) -> Iterator[str]:
    yield from (f"  {line}" for line in faults[:MOST_TOLD])
    if len(faults) > MOST_TOLD:
        yield f"  and {len(faults) - MOST_TOLD} more"


def _about(seed: int, seconds: float) -> str:
    day = time.strftime("%d %B %Y").lstrip("0")
    return f"{day}, seed {seed}, {seconds:.0f} s, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores\n"


def _show(text: str, file: Path | None) -> None:
    sys.stdout.write(text)
    sys.stdout.flush()
    if file:
        with file.open("a", encoding="utf-8") as out:
            out.write(text)


if __name__ == "__main__":
    sys.exit(main())
