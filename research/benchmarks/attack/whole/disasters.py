"""What a batch stands on, broken while it works: disk, database, processes, memory, and people who edit meanwhile."""

from __future__ import annotations

from pathlib import Path

from research.benchmarks.attack.kinds import Whole
from research.benchmarks.faults.__main__ import Kept, disasters, tables
from research.benchmarks.faults.disasters import DISASTERS

NAME = "disasters"
COUNT = len(DISASTERS)


def whole(count: int, seed: int, folder: Path) -> Whole:
    """The first `count` disasters, once each."""
    folder.mkdir(parents=True)
    told = disasters(list(DISASTERS)[:count], Kept(None, seed), folder)
    faults = [f"{one.name}: {'; '.join(one.faults)}" for one in told if one.faults]
    return Whole(len(told), tuple(faults), tables((), told))
