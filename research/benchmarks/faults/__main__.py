"""Faults on purpose, counted: `python -m research.benchmarks.faults [--kills 100] [--seed 1] [--only evaluate disk
...]`.

Kills five commands at random points and breaks what they stand on, each in a place of its own; then runs the same
command again and compares the results with an undisturbed run's. Ends with 1 if anything was wrong; the places of the
trials that went wrong stay for looking at. With `--kept FILE` every trial is written there as it ends, and those that
stand there are not made again. `make bench-faults`.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TypeVar

from research.benchmarks.faults.disasters import DISASTERS, Happened
from research.benchmarks.faults.kills import Trial, Undisturbed, trial, undisturbed
from research.benchmarks.faults.targets import TARGETS

Tried = TypeVar("Tried", Trial, Happened)


@dataclass(frozen=True)
class Kept:
    """What was tried so far, in a file of JSON lines; without a file nothing is kept."""

    file: Path | None
    seed: int

    def of(self, kind: type[Tried]) -> dict[str, Tried]:
        """Trials of the seed, or disasters, by key."""
        if not self.file or not self.file.is_file():
            return {}
        rows = [json.loads(line) for line in self.file.read_text(encoding="utf-8").splitlines()]
        mine = [row for row in rows if row["kind"] == kind.__name__ and row["seed"] == self.seed]
        return {row["key"]: kind(**{**row["told"], "faults": tuple(row["told"]["faults"])}) for row in mine}

    def add(self, key: str, told: Trial | Happened) -> None:
        """One more."""
        if self.file:
            row = {"kind": type(told).__name__, "seed": self.seed, "key": key, "told": asdict(told)}
            with self.file.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")


def kills(names: Sequence[str], numbers: range, kept: Kept, folder: Path) -> list[Trial]:
    """Kills of those numbers, shared by the targets in turn; a line on stderr for each."""
    asked = {f"{number} {names[number % len(names)]}": number for number in numbers}
    told = {key: one for key, one in kept.of(Trial).items() if key in asked}
    left = {key: number for key, number in asked.items() if key not in told}
    if not left:
        return list(told.values())
    peace: dict[str, Undisturbed] = {}
    home = None
    for name in names:
        peace[name] = undisturbed(TARGETS[name], folder / f"peace-{name}", home)
        home = home or peace[name].home
        sys.stderr.write(f"{name} undisturbed: {peace[name].seconds:.1f} s\n")
    for key, number in left.items():
        name, rng = names[number % len(names)], random.Random(f"{kept.seed} {number}")
        one = told[key] = trial(peace[name], folder / f"kill-{number:03d}-{name}", rng)
        kept.add(key, one)
        _say(f"{number + 1}/{numbers.stop} {name}, {one.hit} at {one.at_s:.1f} s", one.faults)
    return list(told.values())


def disasters(names: Sequence[str], kept: Kept, folder: Path) -> list[Happened]:
    """Every disaster once."""
    told = {name: one for name, one in kept.of(Happened).items() if name in names}
    left = [name for name in names if name not in told]
    peace = undisturbed(TARGETS["evaluate"], folder / "peace-disasters") if left else None
    for name in left:
        assert peace is not None  # noqa: S101 - there is something left
        told[name] = DISASTERS[name](peace, folder / f"disaster-{name}")
        kept.add(name, told[name])
        _say(f"{name}: {told[name].said}", told[name].faults)
    return list(told.values())


def _say(what: str, faults: Sequence[str]) -> None:
    sys.stderr.write(f"{what}: {'well' if not faults else '; '.join(faults)}\n")


def tables(killed: Sequence[Trial], happened: Sequence[Happened]) -> str:
    """Both tables in Markdown."""
    lines = []
    if killed:
        hits = Counter((t.target, "command" if t.hit == "command" else "child") for t in killed if t.hit != "nothing")
        lines += [
            "| command | killed itself | a child of it | over before | wrong afterwards |",
            "|---|---:|---:|---:|---:|",
        ]
        for name in dict.fromkeys(t.target for t in killed):
            mine = [t for t in killed if t.target == name]
            over, wrong = sum(t.hit == "nothing" for t in mine), sum(bool(t.faults) for t in mine)
            lines.append(f"| {name} | {hits[name, 'command']} | {hits[name, 'child']} | {over} | {wrong} |")
    if happened:
        lines += ["", "| disaster | what was seen | wrong afterwards |", "|---|---|---|"]
        lines += [f"| {h.name} | {h.said} | {'; '.join(h.faults) or 'nothing'} |" for h in happened]
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables; 1 if anything was wrong."""
    parser = argparse.ArgumentParser(prog="python -m research.benchmarks.faults", description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=100, help="how many, shared by the commands in turn")
    parser.add_argument("--first", type=int, default=0, help="number of the first kill")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kept", type=Path, help="file of what was tried so far; goes on from there")
    parser.add_argument(
        "--only", nargs="+", choices=[*TARGETS, *DISASTERS], help="commands and disasters; default: all"
    )
    asked = parser.parse_args(arguments)
    folder, began = Path(tempfile.mkdtemp(prefix="sgcad-faults-")), time.monotonic()
    targets = [name for name in TARGETS if not asked.only or name in asked.only]
    named = [name for name in DISASTERS if not asked.only or name in asked.only]
    kept = Kept(asked.kept, asked.seed)
    numbers = range(asked.first, asked.first + asked.kills)
    killed = kills(targets, numbers, kept, folder) if targets and asked.kills else []
    happened = disasters(named, kept, folder) if named else []
    sys.stdout.write(tables(killed, happened))
    wrong = [*(t for t in killed if t.faults), *(h for h in happened if h.faults)]
    sys.stdout.write(f"\nseed {asked.seed}, {time.monotonic() - began:.0f} s, load {os.getloadavg()[0]:.1f} on ")
    sys.stdout.write(f"{os.cpu_count()} cores; {len(wrong)} wrong" + (f", see {folder}" if wrong else "") + "\n")
    if not wrong:
        for place in folder.iterdir():
            _remove(place)
        folder.rmdir()
    return int(bool(wrong))


def _remove(place: Path) -> None:
    import shutil

    shutil.rmtree(place, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
