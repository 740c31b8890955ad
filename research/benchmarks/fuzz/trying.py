"""One input: how it ended, how long it took, and whether anything was written elsewhere."""

from __future__ import annotations

import os
import random
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from research.benchmarks.fuzz.kinds import Kind
from sgcad_core.errors import SgcadError

BASE_S, PER_KILOBYTE_S = 8.0, 0.4
"""Processor seconds an input may take: what a loaded machine needs for the least, and for each kilobyte."""


@dataclass(frozen=True)
class Outcome:
    """How an input ended: processor seconds, and what was wrong with it; empty if nothing."""

    kind: str
    seed: int
    seconds: float
    wrong: str


@contextmanager
def within(place: Path) -> Iterator[list[str]]:
    """Paths outside `place` that are opened for writing meanwhile, by way of the interpreter's audit hook."""
    outside: list[str] = []
    _watched.append((str(place), outside))
    try:
        yield outside
    finally:
        _watched.pop()


_watched: list[tuple[str, list[str]]] = []


def heed(event: str, arguments: tuple[object, ...]) -> None:
    if event != "open" or not _watched or not isinstance(arguments[0], str | bytes):
        return
    path, flags = os.path.abspath(os.fsdecode(arguments[0])), arguments[2]
    place, outside = _watched[-1]
    if isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR) and not path.startswith((place, "/dev/null")):
        outside.append(path)


def sample(kind: Kind, seed: int) -> bytes:
    """The input of a seed."""
    return kind.make(random.Random(f"{kind.name} {seed}"))


def tried(kind: Kind, seed: int, place: Path) -> Outcome:
    """Make the input of a seed and have it read."""
    content = sample(kind, seed)
    began = time.process_time()
    with within(place) as outside:
        wrong = _stumbled(kind, content, place)
    spent = time.process_time() - began
    if not wrong and outside:
        wrong = f"writes {outside[0]}"
    if not wrong and spent > BASE_S + PER_KILOBYTE_S * len(content) / 1000:
        wrong = f"{spent:.1f} s for {len(content)} bytes"
    return Outcome(kind.name, seed, spent, wrong)


def _stumbled(kind: Kind, content: bytes, place: Path) -> str:
    """An error that is none of ours, and where it came up; empty if there is none."""
    try:
        kind.read(content, place)
    except SgcadError:
        pass
    except Exception as fault:  # noqa: BLE001 - whatever it is, it is what is looked for
        where = traceback.extract_tb(fault.__traceback__)[-1]
        return f"{type(fault).__name__}: {str(fault)[:80]} ({Path(where.filename).name}:{where.lineno})"
    return ""
