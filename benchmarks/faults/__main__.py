"""Faults on purpose, counted: `python -m benchmarks.faults [--kills 100] [--seed 1] [--only evaluate disk ...]`.

Kills five commands at random points and breaks what they stand on, each in a place of its own; then runs the same
command again and compares the results with an undisturbed run's. Ends with 1 if anything was wrong; the places of the
trials that went wrong stay for looking at. `make bench-faults`.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from benchmarks.faults.disasters import DISASTERS, Happened
from benchmarks.faults.kills import Trial, Undisturbed, trial, undisturbed
from benchmarks.faults.targets import TARGETS


def kills(names: Sequence[str], count: int, seed: int, folder: Path) -> list[Trial]:
    """`count` kills shared by the targets in turn; a line on stderr for each."""
    peace: dict[str, Undisturbed] = {}
    home = None
    for name in names:
        peace[name] = undisturbed(TARGETS[name], folder / f"peace-{name}", home)
        home = home or peace[name].home
        sys.stderr.write(f"{name} undisturbed: {peace[name].seconds:.1f} s\n")
    told = []
    for number in range(count):
        name, rng = names[number % len(names)], random.Random(f"{seed} {number}")
        told.append(trial(peace[name], folder / f"kill-{number:03d}-{name}", rng))
        _say(f"{number + 1}/{count} {name}, {told[-1].hit} at {told[-1].at_s:.1f} s", told[-1].faults)
    return told


def disasters(names: Sequence[str], folder: Path) -> list[Happened]:
    """Every disaster once."""
    told = []
    peace = undisturbed(TARGETS["evaluate"], folder / "peace-disasters")
    for name in names:
        told.append(DISASTERS[name](peace, folder / f"disaster-{name}"))
        _say(f"{name}: {told[-1].said}", told[-1].faults)
    return told


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
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=100, help="how many, shared by the commands in turn")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--only", nargs="+", choices=[*TARGETS, *DISASTERS], help="commands and disasters; default: all"
    )
    asked = parser.parse_args(arguments)
    folder, began = Path(tempfile.mkdtemp(prefix="sgcad-faults-")), time.monotonic()
    targets = [name for name in TARGETS if not asked.only or name in asked.only]
    named = [name for name in DISASTERS if not asked.only or name in asked.only]
    killed = kills(targets, asked.kills, asked.seed, folder) if targets and asked.kills else []
    happened = disasters(named, folder) if named else []
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
