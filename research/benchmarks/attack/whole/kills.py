"""SIGKILL at random points of commands, then the same command again, whose results have to be those without a kill."""

from __future__ import annotations

from pathlib import Path

from research.benchmarks.attack.kinds import Whole
from research.benchmarks.faults.__main__ import Kept, kills, tables
from research.benchmarks.faults.kills import Trial

NAME = "kills"
COUNT = 20
COMMANDS = ("run", "revise", "evaluate", "play", "inbox", "study", "index")
"""The training is left to `python -m research.benchmarks.faults`: it takes a minute a kill."""


def whole(count: int, seed: int, folder: Path) -> Whole:
    """That many kills, shared by the commands in turn; a command that fails without a kill is a fault of its own."""
    folder.mkdir(parents=True)
    told: list[Trial] = []
    faults: list[str] = []
    for place, name in enumerate(COMMANDS[:count]):
        first, share = place * count, len(range(place, count, len(COMMANDS)))
        try:
            told += kills([name], range(first, first + share), Kept(None, seed), folder)
        except RuntimeError as fault:
            faults.append(str(fault)[:300].replace("\n", " "))
    faults += [f"{one.target}, {one.hit} at {one.at_s:.1f} s: {'; '.join(one.faults)}" for one in told if one.faults]
    return Whole(len(told), tuple(faults), tables(told, ()))
